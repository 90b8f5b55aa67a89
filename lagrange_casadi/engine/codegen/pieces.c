/* The forces of a link as curves over time, for a pack of instants, as results/pieces.py has them: among the curves are those that are
   largest in size along the link.

   In a part between two marks, which are load points and places at which something along the link begins or ends, and in a cell between
   two breaks of the density, what acts is a polynomial. A force is its integral from the tip, a moment the length times the integral of the
   force. Polynomials are in Bernstein's form, of x from 0 at the end towards the tip to 1 at that towards the base. */

/* Kept from low to high; low for what is none. */
LANES_INLINE casadi_real designs_kept(casadi_real u, casadi_real low, casadi_real high) {
  return lanes_less(low, u, lanes_less(u, high, u, high), low);
}

/* The ratio beyond which a section carries what acts at load points, as it is on the tip's side of one that is there, and on the base's: see
   edge in engine/section_function.py. */
LANES_INLINE casadi_real designs_section_edge(casadi_real u, int side) {
  if (side) return lanes_less(DESIGNS_END, u - DESIGNS_END, u - DESIGNS_END, DESIGNS_END);
  return lanes_less(u + DESIGNS_END, 1 - DESIGNS_END, u + DESIGNS_END, 1 - DESIGNS_END);
}

/* The value of a polynomial of degree n. */
LANES_INLINE casadi_real designs_value(const casadi_real* c, int n, casadi_real x) {
  const casadi_real beside = 1 - x;
  casadi_real sum = c[0]*beside, power = x;
  int i;
  if (n == 0) return c[0];
  for (i = 1; i < n; ++i) {
    sum = (sum + power*(designs_binomial[n][i]*c[i]))*beside;
    power = power*x;
  }
  return sum + power*c[n];
}

/* The product of a polynomial of degree n with a line from first to last. */
LANES_INLINE void designs_times(casadi_real* c, int n, casadi_real first, casadi_real last) {
  int i;
  c[n + 1] = c[n]*last;
  for (i = n; i > 0; --i) c[i] = c[i]*(first*((lanes_real) (n + 1 - i)/(n + 1))) + c[i - 1]*(last*((lanes_real) i/(n + 1)));
  c[0] = c[0]*first;
}

/* A polynomial of degree n as one of a higher degree. */
LANES_INLINE void designs_raised(casadi_real* c, int n, int degree) {
  for (; n < degree; ++n) designs_times(c, n, 1, 1);
}

/* A polynomial of degree n on a part of 0 to 1 (de Casteljau). */
LANES_INLINE void designs_within(casadi_real* c, int n, casadi_real from, casadi_real to) {
  const casadi_real first = lanes_less(0, to, from/to, 0);
  int i, k;
  for (i = 1; i <= n; ++i) for (k = n; k >= i; --k) c[k] = c[k - 1] + to*(c[k] - c[k - 1]);
  for (i = 1; i <= n; ++i) for (k = 0; k <= n - i; ++k) c[k] = c[k] + first*(c[k + 1] - c[k]);
}

/* Add the product of two polynomials, of degrees n and m. */
static inline void designs_add_product(const casadi_real* a, int n, const casadi_real* b, int m, casadi_real* sum) {
  int i, j;
  for (i = 0; i <= n; ++i) {
    for (j = 0; j <= m; ++j) {
      sum[i + j] = sum[i + j] + a[i]*b[j]*(designs_binomial[n][i]*designs_binomial[m][j]/designs_binomial[n + m][i + j]);
    }
  }
}

/* A root that is kept from 0 to 1, and whether a polynomial turns there in that direction. */
LANES_INLINE casadi_real designs_root(casadi_real root, casadi_real direction, casadi_real* turns) {
  *turns = lanes_less(0, root, lanes_less(root, 1, direction, 0), 0);
  return designs_kept(root, 0, 1);
}

/* The root of a parabola at which it falls, or the other at which it rises; the root that would cancel comes from the other one. */
LANES_INLINE casadi_real designs_parabola(const casadi_real* c, int rises, casadi_real* turns) {
  const casadi_real half = c[1] - c[0], bend = c[0] - 2*c[1] + c[2], square = half*half - bend*c[0];
  const casadi_real root = DESIGNS_ROOT(lanes_less(0, square, square, 0)), far = -half - lanes_less(0, half, root, -root);
  const casadi_real one = far/bend, other = lanes_less(0, root, c[0]/far, one);
  const casadi_real found = rises ? lanes_less(0, half, other, one) : lanes_less(0, half, one, other);
  return designs_root(found, lanes_less(0, root, rises ? -1 : 1, 0), turns);
}

/* The zero of a polynomial that has one or none between low and high, or else the end that is nearer to zero: by Newton's method kept within
   what encloses it. turns becomes 1 where it falls through zero, -1 where it rises, else 0. No lane moves once it is there. */
static inline casadi_real designs_between(const casadi_real* c, const casadi_real* slope, int n, casadi_real low, casadi_real high,
                                          casadi_real* turns) {
  const casadi_real at_low = designs_value(c, n, low), at_high = designs_value(c, n, high);
  const casadi_real begin = lanes_less(at_low, 0, -1, 1), there = -begin*lanes_less(at_high, 0, -1, 1);
  const casadi_real nearer = lanes_less(lanes_size(at_high), lanes_size(at_low), high, low);
  casadi_real x = low + (high - low)*(at_low/(at_low - at_high)), left = there, now, before, step, ahead, tight, inside;
  int trial;
  for (trial = 0; trial < 60 && lanes_where_less(0, left); ++trial) {
    now = designs_value(c, n, x);
    before = begin*lanes_less(now, 0, -1, 1);
    low = lanes_less(0, before, x, low);
    high = lanes_less(0, before, high, x);
    step = lanes_less(0, lanes_size(now), now/(n*designs_value(slope, n - 1, x)), 0);  /* 0/0 where zeros meet */
    ahead = x - step;
    tight = lanes_less(DESIGNS_CLOSE, high - low, 0, 1);
    /* At an end that is a zero, too, there is another one between. */
    inside = lanes_less(low, ahead, lanes_less(ahead, high, 1, tight), tight);
    ahead = lanes_less(0, inside, designs_kept(ahead, low, high), DESIGNS_HALF*(low + high));
    x = lanes_less(0, left, ahead, x);
    left = lanes_less(lanes_size(step), DESIGNS_CLOSE, lanes_less(0, inside, 0, left), left);
  }
  *turns = lanes_less(0, there, begin, 0);
  return lanes_less(0, there, x, nearer);
}

/* The curves of designs_along, of a link in the plane of even mass, with nothing along it: its matter is its length and its mass. */
LANES_INLINE void designs_even(const casadi_real* matter, const casadi_real* law, casadi_real* value, casadi_real* place) {
  const casadi_real l = matter[0], m = matter[1];
  casadi_real c[4], tip, base, turns;
  int k;
  for (k = 0; k < 2; ++k, value += 3, law += 3) {
    tip = m*(law[1] + law[2]*l);
    base = m*law[1];
    c[0] = law[0];
    c[1] = c[0] + DESIGNS_HALF*tip;
    c[2] = c[1] + DESIGNS_HALF*base;
    place[k] = designs_kept(-law[1]/(law[2]*l), 0, 1);
    value[0] = c[2];
    value[1] = c[0];
    value[2] = designs_value(c, 2, 1 - place[k]);
  }
  place[2] = 1 - designs_parabola(c, 0, &turns);
  place[3] = 1 - designs_parabola(c, 1, &turns);
  base = l*((lanes_real) 1/3);
  c[3] = c[2];
  tip = law[0];
  for (k = 0; k < 4; ++k) {
    const casadi_real next = tip + base*c[k];
    c[k] = tip;
    tip = next;
  }
  value[0] = c[3];
  value[1] = c[0];
  for (k = 0; k < 2; ++k) value[2 + k] = designs_value(c, 3, 1 - place[2 + k]);
}

#if DESIGNS_PIECES

/* Put places in order. */
LANES_INLINE void designs_sort(casadi_real* marks, int count) {
  casadi_real swap;
  int k, s;
  for (s = count - 1; s > 0; --s) {
    for (k = 0; k < s; ++k) {
      swap = lanes_less(marks[k + 1], marks[k], marks[k + 1], marks[k]);
      marks[k + 1] = lanes_less(marks[k + 1], marks[k], marks[k], marks[k + 1]);
      marks[k] = swap;
    }
  }
}

/* The zeros from 0 to 1 of a polynomial of degree n, all among n places, and whether it falls (1) or rises (-1) there: see zeros in
   base/bernstein.py. */
static void designs_zeros(const casadi_real* c, int n, casadi_real* at, casadi_real* turns) {
  casadi_real slope[DESIGNS_DEGREE + 1], inner[DESIGNS_DEGREE + 2], changes;
  int i, k, many;
  if (n == 1) {
    at[0] = designs_root(c[0]/(c[0] - c[1]), lanes_less(0, c[0], 1, -1), turns);
    return;
  }
  if (n == 2) {
    for (k = 0; k < 2; ++k) at[k] = designs_parabola(c, k, turns + k);
    return;
  }
  changes = 0;
  for (i = 0; i < n; ++i) {
    slope[i] = c[i + 1] - c[i];
    changes = changes + lanes_less(lanes_less(c[i], 0, -1, 1)*lanes_less(c[i + 1], 0, -1, 1), 0, 1, 0);
  }
  many = 0;
  if (lanes_where_less(1, changes)) {
    many = n - 1;
    designs_zeros(slope, many, inner + 1, turns);
    if (many == 2) designs_sort(inner + 1, 2);
  }
  inner[0] = 0;
  inner[many + 1] = 1;
  for (k = 0; k <= many; ++k) at[k] = designs_between(c, slope, n, inner[k], inner[k + 1], turns + k);
  for (k = many + 1; k < n; ++k) {
    at[k] = at[many];
    turns[k] = 0;
  }
}

/* A section force: where its coefficients stand in the law, whether two of them go with mass; the member of a load point that acts, and the
   directions of loads along the link and of their couples, -1 for none. A moment, which has an arm, is that times the integral of a shear. */
typedef struct {
  int law, mass, acting, spread, couple, shear, arm;
} designs_force;

/* A link: its forces, and resultants, each of two of them; cells of its density between breaks, so many ordinates in each; the degree of
   what acts; load points, of so many members, place first, that and so many other marks divide the link; loads along it, of so many powers
   in so many directions, width and end first. Its matter is its length and the ordinates of all cells. */
typedef struct {
  int forces, sizes;
  const designs_force* force;
  const int (*parts)[2];
  int cells, terms, degree;
  const lanes_real* breaks;
  int stations, members, marks, spreads, directions;
  const int* powers;
  const casadi_real *matter, *law, *loads, *spread;
} designs_link;

/* A part of a link between two marks, and the edge of a section at its end towards the base; the smooth part of each force at the end of a
   cell, and what acts in the cell: ordinates of each force and of its slope. */
typedef struct {
  casadi_real low, high, edge, start, stop;
  casadi_real smooth[DESIGNS_FORCES], value[DESIGNS_FORCES][DESIGNS_ORDINATES], slope[DESIGNS_FORCES][DESIGNS_ORDINATES];
} designs_piece;

/* What acts at load points beyond an edge, on a section at a ratio. */
LANES_INLINE casadi_real designs_steps(const designs_link* link, const designs_force* force, casadi_real u, casadi_real edge) {
  const casadi_real* load = link->loads;
  casadi_real sum = 0, acts;
  int s;
  for (s = 0; s < link->stations; ++s, load += link->members) {
    acts = load[force->acting];
    if (force->arm) acts = acts + load[link->force[force->shear].acting]*(force->arm*link->matter[0]*(load[0] - u));
    sum = sum + lanes_less(edge, load[0], acts, 0);
  }
  return sum;
}

/* Add loads along the link, in one of their directions, as a polynomial of a degree. */
static inline void designs_loaded(const designs_link* link, const designs_piece* piece, int direction, int degree, casadi_real* sum) {
  const casadi_real middle = DESIGNS_HALF*(piece->low + piece->high), *load = link->spread;
  casadi_real c[DESIGNS_ORDINATES], from, to, begin, wide;
  int s, i, j;
  for (s = 0; s < link->spreads; ++s) {
    const int many = link->powers[s];
    const casadi_real* terms = load + 2 + direction*many;
    begin = load[1] - load[0];
    from = (load[1] - piece->stop)/load[0];
    to = lanes_less(begin, piece->start, (load[1] - piece->start)/load[0], 1);
    c[0] = terms[many - 1];
    for (j = many - 2; j >= 0; --j) {
      designs_times(c, many - 2 - j, from, to);
      for (i = 0; i < many - j; ++i) c[i] = c[i] + terms[j];
    }
    designs_raised(c, many - 1, degree);
    wide = link->matter[0]*load[0]*(to - from);
    wide = lanes_less(begin, middle, lanes_less(middle, load[1], wide, 0), 0);
    for (i = 0; i <= degree; ++i) sum[i] = sum[i] + c[i]*wide;
    load += 2 + link->directions*many;
  }
}

/* All forces in a cell, from its end towards the tip on. */
static void designs_cell(const designs_link* link, int cell, designs_piece* piece) {
  const casadi_real *density = link->matter + 1 + cell*link->terms, l = link->matter[0];
  const lanes_real base = link->breaks[cell], tip = link->breaks[cell + 1];
  const casadi_real start = piece->start = designs_kept(base, piece->low, piece->high);
  const casadi_real stop = piece->stop = designs_kept(tip, piece->low, piece->high), wide = stop - start;
  casadi_real mass[DESIGNS_ORDINATES], steps[DESIGNS_FORCES], *slope, *value, smooth, acts;
  int i, k, n;
  for (i = 0; i < link->terms; ++i) mass[i] = density[i];
  if (link->terms > 1) designs_within(mass, link->terms - 1, (tip - stop)/(tip - base), (tip - start)/(tip - base));
  for (k = 0; k < link->forces; ++k) {
    const designs_force* force = link->force + k;
    const casadi_real* law = link->law + force->law;
    n = link->degree + (force->arm != 0);
    slope = piece->slope[k];
    value = piece->value[k];
    steps[k] = designs_steps(link, force, stop, piece->edge);
    value[0] = piece->smooth[k] + steps[k];
    smooth = 0;
    for (i = 0; i <= n; ++i) slope[i] = 0;
    if (force->arm) {
      acts = force->arm*l*wide;
      for (i = 0; i <= n; ++i) slope[i] = acts*piece->value[force->shear][i];
      smooth = -acts*steps[force->shear];
    } else if (force->mass) {
      for (i = 0; i < link->terms; ++i) slope[i] = mass[i];
      designs_times(slope, link->terms - 1, wide*(law[1] + law[2]*(l*stop)), wide*(law[1] + law[2]*(l*start)));
      designs_raised(slope, link->terms, n);
    }
    if (force->spread >= 0) designs_loaded(link, piece, force->spread, n, slope);
    if (force->couple >= 0) designs_loaded(link, piece, force->couple, n, slope);
    for (i = 0; i <= n; ++i) value[i + 1] = value[i] + slope[i]*((lanes_real) 1/(n + 1));
    /* What acts at load points is no part of what is smooth. */
    piece->smooth[k] = piece->smooth[k] + (value[n + 1] - value[0] + smooth);
  }
}

/* Where a force, or a resultant, is looked at in a part: at two places; the largest sizes at turns that were found, and what the ends of the
   part are like: slopes of a force, sizes of a resultant. */
typedef struct {
  casadi_real place[2], best[2], at_high, at_low;
} designs_turns;

/* The value of a force, or the size of a resultant, at a place of a cell. */
LANES_INLINE casadi_real designs_force_at(const designs_link* link, const designs_piece* piece, int k, casadi_real x) {
  const int* of = k < link->forces ? &k : link->parts[k - link->forces];
  const int n = link->degree + 1 + (link->force[of[0]].arm != 0);
  const casadi_real first = designs_value(piece->value[of[0]], n, x);
  casadi_real second;
  if (k < link->forces) return first;
  second = designs_value(piece->value[of[1]], n, x);
  return DESIGNS_ROOT(first*first + second*second);
}

/* Seek turns in a cell: of a parabola, in the only cell, both, and else the two that are largest in size. */
static void designs_seek(const designs_link* link, const designs_piece* piece, int cell, int k, designs_turns* turns) {
  const int single = k < link->forces, *of = single ? &k : link->parts[k - link->forces];
  const int n = link->degree + (link->force[of[0]].arm != 0), degree = single ? n : 2*n + 1;
  const casadi_real wide = piece->stop - piece->start;
  casadi_real slope[DESIGNS_DEGREE + 1], at[DESIGNS_DEGREE], falls[DESIGNS_DEGREE], size, u;
  int i, j;
  for (i = 0; i <= degree; ++i) slope[i] = single ? piece->slope[k][i] : (casadi_real) 0;
  for (j = 0; j < 2 && !single; ++j) designs_add_product(piece->value[of[j]], n + 1, piece->slope[of[j]], n, slope);
  designs_zeros(slope, degree, at, falls);
  if (single && link->cells == 1 && degree <= 2) {
    for (j = 0; j < 2; ++j) turns->place[j] = piece->stop - wide*at[degree == 2 ? j : 0];
    return;
  }
  for (i = 0; i < degree; ++i) {
    size = lanes_size(designs_force_at(link, piece, k, at[i]));
    size = lanes_less(0, wide, lanes_less(0, single ? falls[i]*falls[i] : falls[i], size, -1), -1);
    u = piece->stop - wide*at[i];
    turns->place[1] = lanes_less(turns->best[0], size, turns->place[0], lanes_less(turns->best[1], size, u, turns->place[1]));
    turns->best[1] = lanes_less(turns->best[0], size, turns->best[0], lanes_less(turns->best[1], size, size, turns->best[1]));
    turns->place[0] = lanes_less(turns->best[0], size, u, turns->place[0]);
    turns->best[0] = lanes_less(turns->best[0], size, size, turns->best[0]);
  }
  if (single) {
    size = lanes_less(0, wide, lanes_size(slope[0])/wide, -1);
    turns->at_high = lanes_less(turns->at_high, 0, size, turns->at_high);
    turns->at_low = lanes_less(0, wide, lanes_size(slope[degree])/wide, turns->at_low);
  } else {
    if (cell == link->cells - 1) turns->at_high = designs_force_at(link, piece, k, 0);
    if (cell == 0) turns->at_low = designs_force_at(link, piece, k, 1);
  }
}

/* Decide on the places, in order. One turn is both of them. Without a turn a resultant is looked at where it is larger, at one of its ends; a
   force nearer to that end at which its slope is smaller: a turn comes in there, and goes, by rounding where the slope is zero. */
static inline void designs_settle(const designs_piece* piece, int single, designs_turns* turns) {
  const casadi_real both = turns->at_high + turns->at_low;
  casadi_real u = lanes_less(turns->at_high, turns->at_low, piece->low, piece->high);
  if (single) u = piece->high - (piece->high - piece->low)*lanes_less(0, both, turns->at_high/both, DESIGNS_HALF);
  turns->place[0] = lanes_less(turns->best[0], 0, u, turns->place[0]);
  turns->place[1] = lanes_less(turns->best[1], 0, turns->place[0], turns->place[1]);
  designs_sort(turns->place, 2);
}

/* value becomes, of each force and then of each resultant, that at the base, at the tip, at each mark on the tip's side and on the base's,
   and where it turns in each part; place becomes the ratios of turns, in that order, and of marks. A force of mass alone turns once, where
   n1 + n2 l u is zero: what else its slope has as a factor, the density, is positive. There are so many turns of each in a part, none or one
   or two. */
LAGRANGE_CASADI_PART static void designs_along(const designs_link* link, const int* many, casadi_real* marks, casadi_real* value, casadi_real* place) {
  const int all = link->forces + link->sizes, count = link->marks, parts = count + 1;
  casadi_real smooth[DESIGNS_FORCES], *values[DESIGNS_ALL], *places[DESIGNS_ALL], *end, u, x;
  designs_turns turns[DESIGNS_ALL];
  designs_piece piece;
  int cell, j, k, s, side;
  designs_sort(marks, count);
  for (k = 0; k < all; ++k) {
    values[k] = value;
    places[k] = place;
    value += 2 + 2*count + many[k]*parts;
    place += many[k]*parts;
  }
  for (k = 0; k < count; ++k) place[k] = marks[k];
  for (k = 0; k < link->forces; ++k) piece.smooth[k] = link->law[link->force[k].law];
  for (s = count; s >= -1; --s) {
    u = s == count ? 1 : 0;
    if (0 <= s && s < count) u = marks[s];
    for (side = 0; side < (0 <= s && s < count ? 2 : 1); ++side) {
      j = s == count ? 1 : s < 0 ? 0 : 2 + 2*s + side;
      for (k = 0; k < link->forces; ++k) values[k][j] = piece.smooth[k] + designs_steps(link, link->force + k, u, designs_section_edge(u, side));
      for (; k < all; ++k) {
        const casadi_real first = values[link->parts[k - link->forces][0]][j], second = values[link->parts[k - link->forces][1]][j];
        values[k][j] = DESIGNS_ROOT(first*first + second*second);
      }
    }
    if (s < 0) break;
    piece.high = u;
    piece.low = 0;
    if (s > 0) piece.low = marks[s - 1];
    piece.edge = designs_section_edge(piece.low, 0);
    for (k = 0; k < all; ++k) {
      turns[k].best[0] = turns[k].best[1] = turns[k].at_high = turns[k].at_low = -1;
      turns[k].place[0] = turns[k].place[1] = piece.low;
    }
    for (k = 0; k < link->forces; ++k) smooth[k] = piece.smooth[k];
    for (cell = link->cells - 1; cell >= 0; --cell) {
      designs_cell(link, cell, &piece);
      for (k = 0; k < all; ++k) if (many[k] == 2) designs_seek(link, &piece, cell, k, turns + k);
    }
    for (k = 0; k < all; ++k) {
      const int single = k < link->forces;
      const casadi_real* law = link->law + (single ? link->force[k].law : 0);
      if (many[k] == 1) turns[k].place[0] = designs_kept(-law[1]/(law[2]*link->matter[0]), piece.low, piece.high);
      if (many[k] == 2 && !(single && link->cells == 1 && link->degree + (link->force[k].arm != 0) <= 2)) {
        designs_settle(&piece, single, turns + k);
      }
    }
    if (link->cells > 1) for (k = 0; k < link->forces; ++k) piece.smooth[k] = smooth[k];
    for (cell = link->cells - 1; cell >= 0; --cell) {
      if (link->cells > 1) designs_cell(link, cell, &piece);
      for (k = 0; k < all; ++k) {
        for (j = 0; j < many[k]; ++j) {
          u = turns[k].place[j];
          x = designs_force_at(link, &piece, k, designs_kept((piece.stop - u)/(piece.stop - piece.start), 0, 1));
          end = values[k] + 2 + 2*count + j*parts + s;
          if (cell < link->cells - 1) x = lanes_less(piece.stop, u, *end, x);
          *end = x;
          places[k][j*parts + s] = u;
        }
      }
    }
  }
}

#endif

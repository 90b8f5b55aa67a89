/* Where along a link a force is largest in size, or the size of two: the zeros of a slope that is a polynomial. */

/* How a slope that is a polynomial becomes coefficients of Chebyshev's polynomials: its degree, nodes from -1 to 1, and what each value
   there adds to each coefficient. */
typedef struct {
  int degree;
  const lanes_real *nodes, *weights;
} designs_nodes;

/* What is looked at: a force of a link, by its number, or the size of both planes' forces; and where: in a part between two stations, by
   its middle and the edge of a section at its first. */
typedef struct {
  const designs_link* planes;
  int many, force;
  casadi_real middle, edge;
} designs_between;

/* Coefficients of the derivative of a polynomial of a degree. */
static inline void designs_derived(const casadi_real* of, int degree, casadi_real* slope) {
  casadi_real c[DESIGNS_DEGREE + 1];
  int j;
  for (j = 0; j <= degree; ++j) c[j] = of[j];
  for (j = degree; j > 2; --j) {
    slope[j - 1] = (lanes_real) (2*j)*c[j];
    c[j - 2] = c[j - 2] + c[j]*((lanes_real) j/(j - 2));
  }
  if (degree > 1) slope[1] = 4*c[2];
  slope[0] = c[1];
}

static inline casadi_real designs_polynomial(const casadi_real* c, int degree, casadi_real x) {
  casadi_real last = 0, before = 0, now;
  int j;
  for (j = degree; j > 0; --j) {
    now = c[j] + 2*x*last - before;
    before = last;
    last = now;
  }
  return c[0] + x*last - before;
}

/* The zero of what is monotonic from low to high, by Newton's method kept within what encloses it; or the end that is nearer to zero.
   turns becomes 1 where it falls through zero, -1 where it rises, else 0. */
static inline casadi_real designs_monotonic(const casadi_real* c, const casadi_real* slope, int degree, casadi_real low, casadi_real high,
                                            casadi_real at_low, casadi_real at_high, casadi_real* turns) {
  const casadi_real begin = lanes_less(0, at_low, 1, -1), there = begin*lanes_less(0, at_high, -1, 1);
  const casadi_real nearer = lanes_less(designs_size(at_high), designs_size(at_low), high, low);
  casadi_real x = DESIGNS_HALF*(low + high), now, same, next, half, moved;
  int trial;
  for (trial = 0; trial < 60; ++trial) {
    now = designs_polynomial(c, degree, x);
    same = begin*lanes_less(0, now, 1, -1);
    low = lanes_less(0, same, x, low);
    high = lanes_less(0, same, high, x);
    half = DESIGNS_HALF*(low + high);
    next = x - now/designs_polynomial(slope, degree - 1, x);
    next = lanes_less(low, next, lanes_less(next, high, next, half), half);
    moved = designs_size(next - x);
    x = next;
    /* What a place is off changes a summit by the square of that. */
    if (!lanes_where_less(64*DESIGNS_CLOSE, lanes_less(there, 0, 0, moved))) break;
  }
  *turns = lanes_less(0, there, begin, 0);
  return lanes_less(0, there, x, nearer);
}

/* Loads along a link, per length, at a ratio in a part, in one of their directions. */
static inline casadi_real designs_here(const designs_link* link, int direction, casadi_real u, casadi_real middle) {
  const casadi_real* load = link->spread;
  casadi_real sum = 0, x, value;
  int s, j;
  for (s = 0; s < link->spreads; ++s) {
    const int many = link->powers[s];
    const casadi_real* terms = load + 2 + direction*many;
    x = (load[1] - u)/load[0];
    value = 0;
    for (j = many - 1; j >= 0; --j) value = value*x + terms[j];
    sum = sum + lanes_less(load[1] - load[0], middle, lanes_less(middle, load[1], value, 0), 0);
    load += 2 + link->directions*many;
  }
  return sum;
}

/* The slope of the axial force or the shear of one plane in a cell, but for a factor that is positive: without loads along the link a
   density is one too. */
static inline casadi_real designs_falling(const designs_link* link, int force, int cell, casadi_real u, casadi_real middle) {
  const casadi_real *density = designs_cell(link, cell) + 3, *law = link->law + 3*force, l = link->matter[0];
  casadi_real p = 0;
  int j;
  if (!link->spreads) return -(law[1] + law[2]*(l*u));
  for (j = link->terms - 1; j >= 0; --j) p = p*(link->breaks[cell + 1] - u) + density[j];
  return -(p*(law[1] + law[2]*(l*u)) + l*designs_here(link, force ? link->across : link->axial, u, middle));
}

/* The slope of the bending moment of one plane: less its shear, and what the rotary inertia of slices does. */
static inline casadi_real designs_bending(const designs_link* link, casadi_real shear, casadi_real u, casadi_real middle) {
  casadi_real here;
  if (!link->couple) return -shear;
  here = designs_here(link, link->couple, u, middle);
  return link->back ? here - shear : -here - shear;
}

/* The size of what is looked at. */
static inline casadi_real designs_looked_at(const designs_between* of, casadi_real u) {
  casadi_real force[3], sum;
  designs_within(of->planes, u, of->edge, force);
  if (of->many == 1) return designs_size(force[of->force]);
  sum = force[of->force]*force[of->force];
  designs_within(of->planes + 1, u, of->edge, force);
  return DESIGNS_ROOT(sum + force[of->force]*force[of->force]);
}

/* Its slope, or that of its square, but for a factor that is positive. */
static inline casadi_real designs_slope(const designs_between* of, int cell, casadi_real u) {
  const int bends = of->force == 2;
  casadi_real force[3], sum = 0;
  int k;
  if (of->many == 1 && !bends) return designs_falling(of->planes, of->force, cell, u, of->middle);
  for (k = 0; k < of->many; ++k) {
    designs_within(of->planes + k, u, of->edge, force);
    if (of->many == 1) return designs_bending(of->planes, force[1], u, of->middle);
    sum = sum + force[of->force]*(bends ? designs_bending(of->planes + k, force[1], u, of->middle) : designs_falling(of->planes + k, 1, cell, u, of->middle));
  }
  return sum;
}

/* The two largest summits of the size of what is looked at between low and high, in order along the link: see results/turning.py. */
static inline void designs_summits_between(const designs_between* of, const designs_nodes* nodes, casadi_real low, casadi_real high,
                                           casadi_real summit[2]) {
  const int n = nodes->degree;
  casadi_real level[DESIGNS_DEGREE + 1][DESIGNS_DEGREE + 1], at[DESIGNS_DEGREE + 2], next[DESIGNS_DEGREE + 2], turns;
  casadi_real value[DESIGNS_DEGREE + 2], start, stop, middle, half, u, size, best[2], first = 0, last = 0;
  int cell, i, j, k;
  best[0] = best[1] = -1;
  summit[0] = summit[1] = low;
  for (cell = 0; cell < of->planes[0].cells; ++cell) {
    start = of->planes[0].breaks[cell];
    stop = of->planes[0].breaks[cell + 1];
    start = lanes_less(start, low, low, lanes_less(high, start, high, start));
    stop = lanes_less(stop, low, low, lanes_less(high, stop, high, stop));
    middle = DESIGNS_HALF*(start + stop);
    half = DESIGNS_HALF*(stop - start);
    if (of->many == 1) {
      size = designs_size(designs_slope(of, cell, start));
      first = lanes_less(low, stop, lanes_less(low, start, first, size), first);
      size = designs_size(designs_slope(of, cell, stop));
      last = lanes_less(start, high, lanes_less(stop, high, last, size), last);
    }
    for (j = 0; j <= n; ++j) level[0][j] = 0;
    for (i = 0; i <= n; ++i) {
      size = designs_slope(of, cell, middle + half*nodes->nodes[i]);
      for (j = 0; j <= n; ++j) level[0][j] = level[0][j] + size*nodes->weights[i*(n + 1) + j];
    }
    for (k = 0; k < n; ++k) designs_derived(level[k], n - k, level[k + 1]);
    at[0] = -1;
    at[1] = 1;
    for (k = n - 1; k >= 0; --k) {
      /* A polynomial of degree n - k is monotonic between what its derivative left. */
      for (j = 0; j <= n - k; ++j) value[j] = designs_polynomial(level[k], n - k, at[j]);
      next[0] = -1;
      for (j = 0; j < n - k; ++j) {
        next[j + 1] = designs_monotonic(level[k], level[k + 1], n - k, at[j], at[j + 1], value[j], value[j + 1], &turns);
        if (k > 0) continue;
        u = middle + half*next[j + 1];
        u = lanes_less(u, start, start, lanes_less(stop, u, stop, u));
        if (of->many == 1) turns = turns*turns;
        size = lanes_less(0, half, lanes_less(0, turns, designs_looked_at(of, u), -1), -1);
        summit[1] = lanes_less(best[0], size, summit[0], lanes_less(best[1], size, u, summit[1]));
        best[1] = lanes_less(best[0], size, best[0], lanes_less(best[1], size, size, best[1]));
        summit[0] = lanes_less(best[0], size, u, summit[0]);
        best[0] = lanes_less(best[0], size, size, best[0]);
      }
      for (j = 0; j <= n - k; ++j) at[j] = next[j];
      at[n - k + 1] = 1;
    }
  }
  /* Where there is none, a size rests at its larger end, and a force nearer to that end at which its slope is smaller: a summit comes in
     there, and goes, by rounding where the slope is zero. */
  if (of->many == 1) u = low + (high - low)*lanes_less(0, first + last, first/(first + last), DESIGNS_HALF);
  else u = lanes_less(designs_looked_at(of, low), designs_looked_at(of, high), high, low);
  summit[0] = lanes_less(best[0], 0, u, summit[0]);
  summit[1] = lanes_less(best[1], 0, summit[0], summit[1]);
  u = summit[0];
  summit[0] = lanes_less(summit[1], u, summit[1], u);
  summit[1] = lanes_less(summit[1], u, u, summit[1]);
}

/* Of any link, as designs_along does it without loads along it: each force is largest in size at an end of a part, or at one of its two
   largest summits there, and nodes are those of the axial force and the shear, and of the bending moment. */
static inline void designs_along_loaded(const designs_link* link, const designs_nodes* of_force, const designs_nodes* of_bending,
                                        casadi_real* marks, casadi_real* value, casadi_real* place) {
  const int count = link->stations, parts = count + 1, many = 2 + 2*count + 2*parts;
  casadi_real sides[2][3], force[3], summit[2], u;
  designs_between between;
  int k, j, s;
  for (s = -2; s < count; ++s) {
    u = s == -2 ? 0 : 1;
    if (s >= 0) u = marks[s] = place[6*parts + s] = designs_on_link(link->loads[4*s]);
    designs_beside(link, u, sides);
    for (k = 0; k < 3; ++k) {
      for (j = 0; j < (s < 0 ? 1 : 2); ++j) value[k*many + (s < 0 ? s + 2 : 2 + 2*s + j)] = sides[j][k];
    }
  }
  designs_sort(marks, count);
  between.planes = link;
  between.many = 1;
  for (s = 0; s < parts; ++s) {
    casadi_real low = 0, high = 1;
    if (s > 0) low = marks[s - 1];
    if (s < count) high = marks[s];
    between.middle = DESIGNS_HALF*(low + high);
    between.edge = designs_section_edge(low, 0);
    for (k = 0; k < 3; ++k) {
      between.force = k;
      designs_summits_between(&between, k == 2 ? of_bending : of_force, low, high, summit);
      for (j = 0; j < 2; ++j) {
        place[(2*k + j)*parts + s] = summit[j];
        designs_within(link, summit[j], between.edge, force);
        value[k*many + 2 + 2*count + j*parts + s] = force[k];
      }
    }
  }
}

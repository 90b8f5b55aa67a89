/* The forces of a link as curves over time, for a pack of instants: among them are those that are largest in size along the link, for
   the forces are polynomials between stations.

   law holds n0, n1, n2, f0, f1, f2, m0. value becomes, of the axial force, the shear and the bending moment in turn, the force at the
   base, at the tip, at each station as it is on the tip's side and on the base's, and where it turns between two stations, or next to
   that: the bending moment where the shear rises through zero, then where it falls. place becomes the ratios u = xi/l of where the
   forces turn, in that order, and of the stations. */

LANES_INLINE casadi_real designs_size(casadi_real x) { return DESIGNS_FABS(x); }

LANES_INLINE casadi_real designs_larger(casadi_real x, casadi_real y) { return lanes_larger(x, y); }

/* A ratio on the link; 0 for what is none. */
LANES_INLINE casadi_real designs_on_link(casadi_real u) { return lanes_less(0, u, lanes_less(u, 1, u, 1), 0); }

/* The ratio beyond which a section carries what acts at load points, as it is on the tip's side of one that is there, and on the base's: see
   edge in engine/section_function.py. */
LANES_INLINE casadi_real designs_section_edge(casadi_real u, int side) {
  if (side) return lanes_less(DESIGNS_END, u - DESIGNS_END, u - DESIGNS_END, DESIGNS_END);
  return lanes_less(u + DESIGNS_END, 1 - DESIGNS_END, u + DESIGNS_END, 1 - DESIGNS_END);
}

/* Of a uniform link without stations, whose matter is its length and its mass. */
LANES_INLINE void designs_uniform(const casadi_real* matter, const casadi_real* law, casadi_real* value, casadi_real* place) {
  const casadi_real l = matter[0], m = matter[1];
  casadi_real u, v, a, b, q, half, first, second, rising, falling;
  int k;
  for (k = 0; k < 2; ++k) {
    first = law[3*k + 1]*m;
    second = law[3*k + 2]*(DESIGNS_HALF*l*m);
    u = designs_on_link(-law[3*k + 1]/(law[3*k + 2]*l));
    value[3*k] = law[3*k] + (first + second);
    value[3*k + 1] = law[3*k];
    value[3*k + 2] = law[3*k] + (first + second*(1 + u))*(1 - u);
    place[k] = u;
  }
  /* With v = 1 - u the shear is f0 + b v + a v^2; the root that would cancel comes from the other one. */
  first = law[4]*m;
  second = law[5]*(l*m);
  half = DESIGNS_HALF*second;
  a = -half;
  b = first + second;
  q = b*b - 4*a*law[3];
  q = DESIGNS_ROOT(lanes_less(q, 0, 0, q));
  q = -DESIGNS_HALF*(b + lanes_less(b, 0, -q, q));
  rising = q/a;
  falling = law[3]/q;
  place[2] = designs_on_link(1 - lanes_less(b, 0, falling, rising));
  place[3] = designs_on_link(1 - lanes_less(b, 0, rising, falling));
  first = DESIGNS_HALF*first;
  second = DESIGNS_SIXTH*second;
  value[6] = law[6] + l*(law[3] + (first + half - second));
  value[7] = law[6];
  for (k = 0; k < 2; ++k) {
    v = 1 - place[2 + k];
    value[8 + k] = law[6] + l*v*(law[3] + v*(first + half - second*v));
  }
}

/* A link with a cell of density between each two breaks, and with what acts at stations. Its matter is its length and, a cell, the
   moments T0, T1, T2 of what is beyond it, and the density as a polynomial of the distance from the end that is nearer to the tip.
   loads holds station, n, f, m of each station. spread holds of each load along the link its width and where it ends, and then, for each of
   so many directions, so many powers; those that act along the axis and across it are given, and, where slices have rotary inertia, that
   of the couple that bends, and whether it does so the other way round. Where they begin and end are stations at which nothing acts. */
typedef struct {
  int cells, terms, stations;
  const lanes_real* breaks;
  const casadi_real *matter, *law, *loads;
  int spreads, directions, across;
  const int* powers;
  const casadi_real* spread;
  int axial, couple, back;
} designs_link;

LANES_INLINE const casadi_real* designs_cell(const designs_link* link, int cell) {
  return link->matter + 1 + cell*(3 + link->terms);
}

/* T0, T1 and T2 at ratios in a cell; every term is positive, so nothing cancels. */
LANES_INLINE void designs_tails(const designs_link* link, int cell, casadi_real u, casadi_real* tail) {
  const casadi_real *beyond = designs_cell(link, cell), *density = beyond + 3;
  const casadi_real x = link->breaks[cell + 1] - u;
  casadi_real own[3];
  int j;
  own[0] = own[1] = own[2] = 0;
  for (j = link->terms - 1; j >= 0; --j) {
    own[0] = own[0]*x + density[j]*((lanes_real) 1/(j + 1));
    own[1] = own[1]*x + density[j]*((lanes_real) 1/((j + 1)*(j + 2)));
    own[2] = own[2]*x + density[j]*((lanes_real) 2/((j + 1)*(j + 2)*(j + 3)));
  }
  tail[0] = beyond[0] + x*own[0];
  tail[1] = beyond[1] + x*(beyond[0] + x*own[1]);
  tail[2] = beyond[2] + x*(2*beyond[1] + x*(beyond[0] + x*own[2]));
}

LANES_INLINE casadi_real designs_shear(const designs_link* link, int cell, casadi_real u) {
  const casadi_real* law = link->law;
  casadi_real tail[3];
  designs_tails(link, cell, u, tail);
  return law[3] + law[4]*tail[0] + law[5]*(link->matter[0]*(u*tail[0] + tail[1]));
}

/* What sections at a ratio carry of loads along the link: see engine/distributed_loads.py. */
static inline void designs_spread(const designs_link* link, casadi_real u, casadi_real* force) {
  const casadi_real *load = link->spread, l = link->matter[0];
  casadi_real x, reach, lever, power, share;
  int s, j;
  for (s = 0; s < link->spreads; ++s) {
    const int many = link->powers[s];
    const casadi_real *along = load + 2 + link->axial*many, *across = load + 2 + link->across*many;
    const casadi_real* couple = load + 2 + link->couple*many;
    x = designs_on_link((load[1] - u)/load[0]);
    reach = l*load[0];
    lever = load[1] - load[0] - u;
    lever = l*lanes_less(0, lever, lever, 0);
    power = x;
    for (j = 0; j < many; ++j) {
      share = reach*power*((lanes_real) 1/(j + 1));
      force[0] = force[0] + along[j]*share;
      force[1] = force[1] + across[j]*share;
      force[2] = force[2] + across[j]*(share*(reach*x*((lanes_real) 1/(j + 2)) + lever));
      if (link->couple) force[2] = link->back ? force[2] - couple[j]*share : force[2] + couple[j]*share;
      power = power*x;
    }
    load += 2 + link->directions*many;
  }
}

/* All forces at a ratio, but for what acts at stations. */
static inline void designs_smooth(const designs_link* link, casadi_real u, casadi_real* force) {
  const casadi_real l = link->matter[0], *law = link->law;
  casadi_real tail[3], other[3];
  int k, s;
  designs_tails(link, 0, u, tail);
  for (k = 1; k < link->cells; ++k) {
    designs_tails(link, k, u, other);
    for (s = 0; s < 3; ++s) tail[s] = lanes_less(u, link->breaks[k], tail[s], other[s]);
  }
  for (k = 0; k < 2; ++k) force[k] = law[3*k] + law[3*k + 1]*tail[0] + law[3*k + 2]*(l*(u*tail[0] + tail[1]));
  force[2] = law[6] + law[3]*(l*(1 - u)) + law[4]*(l*tail[1]) + law[5]*(l*l*(u*tail[1] + tail[2]));
  designs_spread(link, u, force);
}

/* And what acts at stations beyond an edge. */
static inline void designs_act(const designs_link* link, casadi_real u, casadi_real edge, casadi_real* force) {
  const casadi_real* load = link->loads;
  int s;
  for (s = 0; s < link->stations; ++s, load += 4) {
    force[0] = force[0] + lanes_less(edge, load[0], load[1], 0);
    force[1] = force[1] + lanes_less(edge, load[0], load[2], 0);
    force[2] = force[2] + lanes_less(edge, load[0], load[3] + load[2]*(link->matter[0]*(load[0] - u)), 0);
  }
}

/* All forces at a ratio, as they are on the tip's side of a station that is there, and on the base's. */
static inline void designs_beside(const designs_link* link, casadi_real u, casadi_real sides[2][3]) {
  int k;
  designs_smooth(link, u, sides[0]);
  for (k = 0; k < 3; ++k) sides[1][k] = sides[0][k];
  for (k = 0; k < 2; ++k) designs_act(link, u, designs_section_edge(u, k), sides[k]);
}

/* All forces at a ratio between two stations, by the edge of a section at the first. */
static inline void designs_within(const designs_link* link, casadi_real u, casadi_real edge, casadi_real* force) {
  designs_smooth(link, u, force);
  designs_act(link, u, edge, force);
}

/* The zero of the shear in a part of a cell where it is monotonic and has one, by Newton's method kept within what encloses it. */
static inline casadi_real designs_zero(const designs_link* link, int cell, casadi_real acting, casadi_real low, casadi_real high,
                                       casadi_real begin) {
  const casadi_real *density = designs_cell(link, cell) + 3, *law = link->law;
  casadi_real u = DESIGNS_HALF*(low + high), now, next, slope, end, p;
  int j, trial;
  for (trial = 0; trial < 60; ++trial) {
    now = designs_shear(link, cell, u) + acting;
    p = 0;
    for (j = link->terms - 1; j >= 0; --j) p = p*(link->breaks[cell + 1] - u) + density[j];
    slope = -p*(law[4] + link->matter[0]*u*law[5]);
    end = lanes_less(now, 0, -1, 1)*begin;
    low = lanes_less(0, end, lanes_less(low, high, u, low), low);
    high = lanes_less(end, 0, lanes_less(low, high, u, high), high);
    next = u - now/slope;
    next = lanes_less(low, next, lanes_less(next, high, next, DESIGNS_HALF*(low + high)), DESIGNS_HALF*(low + high));
    p = designs_size(next - u);
    u = next;
    if (!lanes_where_less(DESIGNS_CLOSE, lanes_less(low, high, p, 0))) break;
  }
  return u;
}

/* The zero of the shear where it is monotonic, or else the end at which it is nearer to zero. */
static inline casadi_real designs_zero_between(const designs_link* link, casadi_real acting, casadi_real low, casadi_real high) {
  casadi_real zero, from, to, begin, end, ends[2];
  int k, j;
  for (j = 0; j < 2; ++j) {
    const casadi_real u = j ? high : low;
    ends[j] = designs_shear(link, 0, u);
    for (k = 1; k < link->cells; ++k) ends[j] = lanes_less(u, link->breaks[k], ends[j], designs_shear(link, k, u));
    ends[j] = ends[j] + acting;
  }
  zero = lanes_less(designs_size(ends[1]), designs_size(ends[0]), high, low);
  for (k = 0; k < link->cells; ++k) {
    from = link->breaks[k];
    to = link->breaks[k + 1];
    from = lanes_less(from, low, low, from);
    to = lanes_less(high, to, high, to);
    to = lanes_less(from, to, to, from);
    begin = lanes_less(designs_shear(link, k, from) + acting, 0, -1, 1);
    end = lanes_less(designs_shear(link, k, to) + acting, 0, -1, 1)*begin;
    to = lanes_less(end, 0, to, from);
    if (!lanes_where_less(from, to)) continue;
    zero = lanes_less(from, to, designs_zero(link, k, acting, from, to, begin), zero);
  }
  return zero;
}

/* Put places in order. */
static inline void designs_sort(casadi_real* marks, int count) {
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

/* Of any link without loads along it. */
static inline void designs_along(const designs_link* link, casadi_real* marks, casadi_real* value, casadi_real* place) {
  const casadi_real *law = link->law, l = link->matter[0];
  const int count = link->stations, parts = count + 1, many = 3 + 3*count;
  casadi_real *bending = value + 2*many, sides[2][3], force[3], low, high, edge, acting, zero[2], turn[2], u, rises;
  int k, j, s;
  for (s = -2; s < count; ++s) {
    u = s == -2 ? 0 : 1;
    if (s >= 0) u = marks[s] = place[4*parts + s] = designs_on_link(link->loads[4*s]);
    designs_beside(link, u, sides);
    for (k = 0; k < 3; ++k) {
      for (j = 0; j < (s < 0 ? 1 : 2); ++j) value[k*many + (s < 0 ? s + 2 : 2 + 2*s + j)] = sides[j][k];
    }
  }
  for (k = 0; k < 2; ++k) turn[k] = designs_on_link(-law[3*k + 1]/(law[3*k + 2]*l));
  /* Before it turns the shear rises where this is positive: where it turns at an end, its values there differ by rounding alone. */
  rises = lanes_less(0, 1/law[5], 1, 0);
  designs_sort(marks, count);
  for (s = 0; s < parts; ++s) {
    low = 0;
    high = 1;
    if (s > 0) low = marks[s - 1];
    if (s < count) high = marks[s];
    edge = designs_section_edge(low, 0);
    acting = 0;
    for (k = 0; k < count; ++k) acting = acting + lanes_less(edge, link->loads[4*k], link->loads[4*k + 2], 0);
    for (k = 0; k < 2; ++k) {
      u = place[k*parts + s] = lanes_less(turn[k], low, low, lanes_less(high, turn[k], high, turn[k]));
      designs_within(link, u, edge, force);
      value[k*many + 2 + 2*count + s] = force[k];
    }
    zero[0] = designs_zero_between(link, acting, low, u);
    zero[1] = designs_zero_between(link, acting, u, high);
    for (k = 0; k < 2; ++k) {
      u = place[(2 + k)*parts + s] = lanes_less(0, rises, zero[k], zero[1 - k]);
      designs_within(link, u, edge, force);
      bending[2 + 2*count + k*parts + s] = force[2];
    }
  }
}

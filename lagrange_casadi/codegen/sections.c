/* Where along a link its forces are largest in size, for a pack of instants: exactly, for they are polynomials between stations.

   law holds n0, n1, n2, f0, f1, f2, m0; value and place become the three forces, with their signs, and the ratios u = xi/l. */
#ifdef __cplusplus
#define DESIGNS_INLINE LANES_INLINE
#else
#define DESIGNS_INLINE static inline
#define lanes_less(x, y, a, b) ((x) < (y) ? (a) : (b))
#define lanes_any_less(x, y) ((x) < (y))
#endif

DESIGNS_INLINE casadi_real designs_size(casadi_real x) { return lanes_less(x, 0, -x, x); }

/* A ratio on the link; 0 for what is none. */
DESIGNS_INLINE casadi_real designs_inside(casadi_real u) { return lanes_less(0, u, lanes_less(u, 1, u, 1), 0); }

DESIGNS_INLINE void designs_take(casadi_real u, casadi_real x, casadi_real* value, casadi_real* place) {
  const casadi_real before = designs_size(*value), now = designs_size(x);
  *place = lanes_less(before, now, u, *place);
  *value = lanes_less(before, now, x, *value);
}

/* Of a uniform link without stations, whose matter is its length and its mass. */
DESIGNS_INLINE void designs_uniform(const casadi_real* matter, const casadi_real* law, casadi_real* value, casadi_real* place) {
  const casadi_real l = matter[0], m = matter[1];
  casadi_real u, v, a, b, q, half, first, second;
  int k;
  for (k = 0; k < 2; ++k) {
    first = law[3*k + 1]*m;
    second = law[3*k + 2]*(DESIGNS_HALF*l*m);
    value[k] = law[3*k] + (first + second);
    place[k] = 0;
    designs_take(1, law[3*k], value + k, place + k);
    u = designs_inside(-law[3*k + 1]/(law[3*k + 2]*l));
    designs_take(u, law[3*k] + (first + second*(1 + u))*(1 - u), value + k, place + k);
  }
  /* With v = 1 - u the shear is f0 + b v + a v^2; the root that would cancel comes from the other one. */
  first = law[4]*m;
  second = law[5]*(l*m);
  half = DESIGNS_HALF*second;
  a = -half;
  b = first + second;
  q = DESIGNS_ROOT(b*b - 4*a*law[3]);
  q = -DESIGNS_HALF*(b + lanes_less(b, 0, -q, q));
  first = DESIGNS_HALF*first;
  second = DESIGNS_SIXTH*second;
  value[2] = law[6] + l*(law[3] + (first + half - second));
  place[2] = 0;
  designs_take(1, law[6], value + 2, place + 2);
  for (k = 0; k < 2; ++k) {
    u = designs_inside(1 - (k == 0 ? q/a : law[3]/q));
    v = 1 - u;
    designs_take(u, law[6] + l*v*(law[3] + v*(first + half - second*v)), value + 2, place + 2);
  }
}

/* A link with a cell of density between each two breaks, and with what acts at stations. Its matter is its length and, a cell, the
   moments T0, T1, T2 of what is beyond it, and the density as a polynomial of the distance from the end that is nearer to the tip.
   loads holds station, n, f, m of each station. */
typedef struct {
  int cells, terms, stations;
  const DESIGNS_REAL* breaks;
  const casadi_real *matter, *law, *loads;
} designs_link;

DESIGNS_INLINE const casadi_real* designs_cell(const designs_link* link, int cell) {
  return link->matter + 1 + cell*(3 + link->terms);
}

/* T0, T1 and T2 at ratios in a cell; every term is positive, so nothing cancels. */
DESIGNS_INLINE void designs_tails(const designs_link* link, int cell, casadi_real u, casadi_real* tail) {
  const casadi_real *beyond = designs_cell(link, cell), *density = beyond + 3;
  const casadi_real x = link->breaks[cell + 1] - u;
  casadi_real own[3];
  int j;
  own[0] = own[1] = own[2] = 0;
  for (j = link->terms - 1; j >= 0; --j) {
    own[0] = own[0]*x + density[j]*((DESIGNS_REAL) 1/(j + 1));
    own[1] = own[1]*x + density[j]*((DESIGNS_REAL) 1/((j + 1)*(j + 2)));
    own[2] = own[2]*x + density[j]*((DESIGNS_REAL) 2/((j + 1)*(j + 2)*(j + 3)));
  }
  tail[0] = beyond[0] + x*own[0];
  tail[1] = beyond[1] + x*(beyond[0] + x*own[1]);
  tail[2] = beyond[2] + x*(2*beyond[1] + x*(beyond[0] + x*own[2]));
}

DESIGNS_INLINE casadi_real designs_shear(const designs_link* link, int cell, casadi_real u) {
  const casadi_real* law = link->law;
  casadi_real tail[3];
  designs_tails(link, cell, u, tail);
  return law[3] + law[4]*tail[0] + law[5]*(link->matter[0]*(u*tail[0] + tail[1]));
}

/* Try all forces at a ratio, on both sides of a station that is there. */
static inline void designs_consider(const designs_link* link, casadi_real u, casadi_real* value, casadi_real* place) {
  const casadi_real l = link->matter[0], *law = link->law;
  casadi_real tail[3], other[3], smooth[3], sides[2][3];
  int k, s, side;
  designs_tails(link, 0, u, tail);
  for (k = 1; k < link->cells; ++k) {
    designs_tails(link, k, u, other);
    for (s = 0; s < 3; ++s) tail[s] = lanes_less(u, link->breaks[k], tail[s], other[s]);
  }
  for (k = 0; k < 2; ++k) smooth[k] = law[3*k] + law[3*k + 1]*tail[0] + law[3*k + 2]*(l*(u*tail[0] + tail[1]));
  smooth[2] = law[6] + law[3]*(l*(1 - u)) + law[4]*(l*tail[1]) + law[5]*(l*l*(u*tail[1] + tail[2]));
  for (k = 0; k < 3; ++k) sides[0][k] = sides[1][k] = smooth[k];
  for (s = 0; s < link->stations; ++s) {
    const casadi_real *load = link->loads + 4*s, station = load[0];
    const casadi_real at_tip = lanes_less(u, 1, 0, lanes_less(station, 1, 0, 1));
    casadi_real acting[3], seen[2];
    acting[0] = load[1];
    acting[1] = load[2];
    acting[2] = load[3] + load[2]*(l*(station - u));
    seen[0] = lanes_less(u, station, 1, at_tip);
    seen[1] = lanes_less(station, u, at_tip, 1);
    for (side = 0; side < 2; ++side) {
      for (k = 0; k < 3; ++k) sides[side][k] = sides[side][k] + lanes_less(0, seen[side], acting[k], 0);
    }
  }
  for (side = 0; side < 2; ++side) {
    for (k = 0; k < 3; ++k) designs_take(u, sides[side][k], value + k, place + k);
  }
}

/* The zero of the shear in a part of a cell where it is monotonic, by Newton's method kept within what encloses it; whether any
   instant has one. */
static inline int designs_zero(const designs_link* link, int cell, casadi_real low, casadi_real high, casadi_real* zero) {
  const casadi_real *density = designs_cell(link, cell) + 3, *law = link->law, middle = DESIGNS_HALF*(low + high);
  casadi_real acting = 0, u = middle, begin, end, now, next, slope, p;
  int j, s, trial;
  for (s = 0; s < link->stations; ++s) acting = acting + lanes_less(middle, link->loads[4*s], link->loads[4*s + 2], 0);
  begin = lanes_less(designs_shear(link, cell, low) + acting, 0, -1, 1);
  end = lanes_less(designs_shear(link, cell, high) + acting, 0, -1, 1);
  high = lanes_less(begin*end, 0, high, low);
  if (!lanes_any_less(low, high)) return 0;
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
    if (!lanes_any_less(DESIGNS_CLOSE, lanes_less(low, high, p, 0))) break;
  }
  *zero = u;
  return 1;
}

/* Of any link: its ends, its stations, where the first two forces turn, and where the shear is zero. */
static inline void designs_along(const designs_link* link, casadi_real* marks, casadi_real* value, casadi_real* place) {
  const casadi_real *law = link->law, l = link->matter[0];
  const int count = link->stations + 1;
  casadi_real low, high, swap, u;
  int k, s;
  for (k = 0; k < 3; ++k) value[k] = place[k] = 0;
  designs_consider(link, 0, value, place);
  designs_consider(link, 1, value, place);
  designs_consider(link, designs_inside(-law[1]/(law[2]*l)), value, place);
  marks[0] = designs_inside(-law[4]/(law[5]*l));
  for (s = 0; s < link->stations; ++s) marks[s + 1] = designs_inside(link->loads[4*s]);
  for (s = 0; s < count; ++s) designs_consider(link, marks[s], value, place);
  for (s = count - 1; s > 0; --s) {
    for (k = 0; k < s; ++k) {
      swap = lanes_less(marks[k + 1], marks[k], marks[k + 1], marks[k]);
      marks[k + 1] = lanes_less(marks[k + 1], marks[k], marks[k], marks[k + 1]);
      marks[k] = swap;
    }
  }
  for (k = 0; k < link->cells; ++k) {
    for (s = 0; s <= count; ++s) {
      low = link->breaks[k];
      high = link->breaks[k + 1];
      if (s > 0) low = lanes_less(low, marks[s - 1], marks[s - 1], low);
      if (s < count) high = lanes_less(marks[s], high, marks[s], high);
      if (!lanes_any_less(low, high)) continue;
      if (designs_zero(link, k, low, lanes_less(low, high, high, low), &u)) designs_consider(link, u, value, place);
    }
  }
}

/* The same of a link in space. Its law holds n0, n1, n2, fy0, fy1, fy2, mz0, fz0, fz1, fz2, my0, mx0, its loads station, n, fy, fz, mx,
   my, mz of each station. Either plane of bending is that of a planar link; a positive moment about z bends as one in the plane does, one
   about y the other way round.

   value becomes, of the axial force, the shear forces along y and z, torsion, the bending moments about y and z, and the resultants of
   shear and bending in turn, the force at the base, at the tip, on both sides of each station, and where it turns between two stations:
   torsion nowhere, a resultant at its two largest summits. place becomes the ratios of where they turn, in that order, and of the
   stations. */

/* How a slope that is a polynomial becomes coefficients of Chebyshev's polynomials: its degree, nodes from -1 to 1, and what each value
   there adds to each coefficient. */
typedef struct {
  int degree;
  const DESIGNS_REAL *nodes, *weights;
} designs_nodes;

/* Both planes of a link, and where it is looked at: between the stations around the middle of a part. */
typedef struct {
  const designs_link* planes;
  casadi_real middle;
  int bends;
} designs_between;

/* Coefficients of the derivative of a polynomial of a degree. */
static inline void designs_derived(const casadi_real* of, int degree, casadi_real* slope) {
  casadi_real c[DESIGNS_DEGREE + 1];
  int j;
  for (j = 0; j <= degree; ++j) c[j] = of[j];
  for (j = degree; j > 2; --j) {
    slope[j - 1] = (DESIGNS_REAL) (2*j)*c[j];
    c[j - 2] = c[j - 2] + c[j]*((DESIGNS_REAL) j/(j - 2));
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
   falls becomes 1 where it falls through zero, else 0. */
static inline casadi_real designs_monotonic(const casadi_real* c, const casadi_real* slope, int degree, casadi_real low, casadi_real high,
                                            casadi_real at_low, casadi_real at_high, casadi_real* falls) {
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
  *falls = lanes_less(0, there, lanes_less(0, begin, 1, 0), 0);
  return lanes_less(0, there, x, nearer);
}

/* Both components of a resultant at a ratio. */
static inline void designs_components(const designs_between* of, casadi_real u, casadi_real shear[2], casadi_real moment[2]) {
  casadi_real force[3];
  int k;
  for (k = 0; k < 2; ++k) {
    designs_within(of->planes + k, u, of->middle, force);
    shear[k] = force[1];
    moment[k] = force[2];
  }
}

static inline casadi_real designs_resultant(const designs_between* of, casadi_real u) {
  casadi_real shear[2], moment[2], *parts = of->bends ? moment : shear;
  designs_components(of, u, shear, moment);
  return DESIGNS_ROOT(parts[0]*parts[0] + parts[1]*parts[1]);
}

/* The slope of the square of a resultant, but for a factor that is not negative: -V . M, or -w . V with V' = -p w. */
static inline casadi_real designs_slope(const designs_between* of, casadi_real u) {
  const casadi_real l = of->planes[0].matter[0];
  casadi_real shear[2], moment[2], sum = 0;
  int k;
  designs_components(of, u, shear, moment);
  for (k = 0; k < 2; ++k) {
    const casadi_real* law = of->planes[k].law;
    sum = sum - shear[k]*(of->bends ? moment[k] : law[4] + law[5]*(l*u));
  }
  return sum;
}

/* The two largest summits of a resultant between low and high, in order along the link: see instants/turning.py. */
static inline void designs_summits_between(const designs_between* of, const designs_nodes* nodes, casadi_real low, casadi_real high,
                                           casadi_real summit[2]) {
  const int n = nodes->degree;
  casadi_real level[DESIGNS_DEGREE + 1][DESIGNS_DEGREE + 1], at[DESIGNS_DEGREE + 2], next[DESIGNS_DEGREE + 2], falls;
  casadi_real value[DESIGNS_DEGREE + 2], start, stop, middle, half, u, size, best[2];
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
    for (j = 0; j <= n; ++j) level[0][j] = 0;
    for (i = 0; i <= n; ++i) {
      size = designs_slope(of, middle + half*nodes->nodes[i]);
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
        next[j + 1] = designs_monotonic(level[k], level[k + 1], n - k, at[j], at[j + 1], value[j], value[j + 1], &falls);
        if (k > 0) continue;
        u = middle + half*next[j + 1];
        u = lanes_less(u, start, start, lanes_less(stop, u, stop, u));
        size = lanes_less(0, half, lanes_less(0, falls, designs_resultant(of, u), -1), -1);
        summit[1] = lanes_less(best[0], size, summit[0], lanes_less(best[1], size, u, summit[1]));
        best[1] = lanes_less(best[0], size, best[0], lanes_less(best[1], size, size, best[1]));
        summit[0] = lanes_less(best[0], size, u, summit[0]);
        best[0] = lanes_less(best[0], size, size, best[0]);
      }
      for (j = 0; j <= n - k; ++j) at[j] = next[j];
      at[n - k + 1] = 1;
    }
  }
  /* Where there is none, the larger end: a summit comes and goes there by rounding where the slope is zero. */
  u = lanes_less(designs_resultant(of, low), designs_resultant(of, high), high, low);
  summit[0] = lanes_less(best[0], 0, u, summit[0]);
  summit[1] = lanes_less(best[1], 0, summit[0], summit[1]);
  u = summit[0];
  summit[0] = lanes_less(summit[1], u, summit[1], u);
  summit[1] = lanes_less(summit[1], u, u, summit[1]);
}

/* The forces of one plane among those of space: which force it is there, -1 for none, and its sign. */
static inline void designs_of_plane(const casadi_real* from, const casadi_real* where, int many, int turns, int sign, casadi_real** value,
                                    casadi_real** place) {
  int k;
  for (k = 0; k < many + turns; ++k) *(*value)++ = sign < 0 ? -from[k] : from[k];
  for (k = 0; k < turns; ++k) *(*place)++ = where[k];
}

/* room takes, of either plane, a law, loads, values and places; marks is for the stations. */
static inline void designs_along_in_space(const designs_link* link, const designs_nodes* of_shear, const designs_nodes* of_bending,
                                          casadi_real* marks, casadi_real* room, casadi_real* value, casadi_real* place) {
  const int count = link->stations, parts = count + 1, many = 2 + 2*count;
  const casadi_real* law = link->law;
  casadi_real *values[2], *places[2], torsion, station, at_tip, seen, *from;
  designs_link planes[2];
  designs_between between;
  int k, s, j, bends;
  for (k = 0; k < 2; ++k) {
    casadi_real *own = room, *acting = room + 7;
    room += 7 + 4*count;
    values[k] = room;
    places[k] = room + 3*many + 4*parts;
    room += 3*many + 8*parts + count;
    for (j = 0; j < 3; ++j) own[j] = law[j];
    for (j = 0; j < 4; ++j) own[3 + j] = law[3 + 4*k + j];
    if (k) own[6] = -own[6];
    for (s = 0; s < count; ++s) {
      const casadi_real* load = link->loads + 7*s;
      acting[4*s] = load[0];
      acting[4*s + 1] = load[1];
      acting[4*s + 2] = load[2 + k];
      acting[4*s + 3] = k ? -load[5] : load[6];
    }
    planes[k] = *link;
    planes[k].law = own;
    planes[k].loads = acting;
    designs_along(planes + k, marks, values[k], places[k]);
  }
  designs_of_plane(values[0], places[0], many, parts, 1, &value, &place);
  for (k = 0; k < 2; ++k) designs_of_plane(values[k] + many + parts, places[k] + parts, many, parts, 1, &value, &place);
  for (s = -2; s < 2*count; ++s) {
    const casadi_real u = s == -2 ? 0 : s == -1 ? 1 : designs_on_link(link->loads[7*(s/2)]);
    torsion = law[11];
    for (j = 0; j < count; ++j) {
      station = link->loads[7*j];
      at_tip = lanes_less(u, 1, 0, lanes_less(station, 1, 0, 1));
      seen = s < 0 || s % 2 == 0 ? lanes_less(u, station, 1, at_tip) : lanes_less(station, u, at_tip, 1);
      torsion = torsion + lanes_less(0, seen, link->loads[7*j + 4], 0);
    }
    *value++ = torsion;
  }
  for (k = 1; k >= 0; --k) {
    designs_of_plane(values[k] + 2*(many + parts), places[k] + 2*parts, many, 2*parts, k ? -1 : 1, &value, &place);
  }
  between.planes = planes;
  for (bends = 0; bends < 2; ++bends) {
    for (j = 0; j < many; ++j) {
      from = values[0] + (1 + bends)*(many + parts) + j;
      at_tip = values[1][(1 + bends)*(many + parts) + j];
      *value++ = DESIGNS_ROOT(*from*(*from) + at_tip*at_tip);
    }
    between.bends = bends;
    for (s = 0; s < parts; ++s) {
      casadi_real low = 0, high = 1, summit[2];
      if (s > 0) low = marks[s - 1];
      if (s < count) high = marks[s];
      between.middle = DESIGNS_HALF*(low + high);
      designs_summits_between(&between, bends ? of_bending : of_shear, low, high, summit);
      for (k = 0; k < 2; ++k) {
        place[k*parts + s] = summit[k];
        value[k*parts + s] = designs_resultant(&between, summit[k]);
      }
    }
    value += 2*parts;
    place += 2*parts;
  }
  for (s = 0; s < count; ++s) place[s] = designs_on_link(link->loads[7*s]);
}

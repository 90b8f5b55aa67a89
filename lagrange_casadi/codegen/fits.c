/* Curves through a few values at equal steps of time, and where they are largest. */
#define DESIGNS_FIT 7
/* What a polynomial may miss, of its curve, in its middle and near its ends: where it misses more, its slope may be off by other things
   as well. */
#define DESIGNS_TRUST ((designs_real) 1e-5)
#define DESIGNS_TRUST_ASIDE ((designs_real) 1e-7)

/* Seven values at equal steps, where to begin, and bounds, in steps from the middle one; then what a polynomial through them says. */
typedef struct {
  designs_real y[DESIGNS_FIT][LANES], x[LANES], low[LANES], high[LANES];
  designs_real size[LANES], slope[LANES], curve[LANES], steep[LANES], rough[LANES];
} designs_fit;

/* Where to look next for a summit, and what is expected there: its size, and the size's slope and curve by steps of time. What a
   polynomial misses there bends its slope by steep times that; its sixth difference tells how rough it is. */
typedef struct {
  int summit, last;
  double t, step;
  designs_real size, slope, curve, steep, rough, trust, found, place;
} designs_look;

static void designs_solve(designs_fit* fit) {
  casadi_real y[DESIGNS_FIT], a[DESIGNS_FIT], d[4], o[4], x, low, high, slope, curve, square;
  int k, trial;
  memcpy(y, fit->y, sizeof y);
  memcpy(&x, fit->x, sizeof x);
  memcpy(&low, fit->low, sizeof x);
  memcpy(&high, fit->high, sizeof x);
  for (k = 1; k < 4; ++k) {
    d[k] = DESIGNS_HALF*(y[3 + k] + y[3 - k]) - y[3];
    o[k] = DESIGNS_HALF*(y[3 + k] - y[3 - k]);
  }
  a[0] = y[3];
  a[1] = (45*o[1] - 9*o[2] + o[3])*((designs_real) 1/30);
  a[2] = (270*d[1] - 27*d[2] + 2*d[3])*((designs_real) 1/180);
  a[3] = (8*o[2] - 13*o[1] - o[3])*((designs_real) 1/24);
  a[4] = (12*d[2] - 39*d[1] - d[3])*((designs_real) 1/72);
  a[5] = (5*o[1] - 4*o[2] + o[3])*((designs_real) 1/120);
  a[6] = (15*d[1] - 6*d[2] + d[3])*((designs_real) 1/360);
  for (trial = 0;; ++trial) {
    slope = a[1] + x*(2*a[2] + x*(3*a[3] + x*(4*a[4] + x*(5*a[5] + x*(6*a[6])))));
    curve = 2*a[2] + x*(6*a[3] + x*(12*a[4] + x*(20*a[5] + x*(30*a[6]))));
    if (trial == 4) break;
    x = lanes_less(curve, 0, x - slope/curve, x);
    x = lanes_less(low, x, lanes_less(x, high, x, high), low);
  }
  square = x*x;
  y[0] = a[0] + x*(a[1] + x*(a[2] + x*(a[3] + x*(a[4] + x*(a[5] + x*a[6])))));
  /* The product of x - j over the seven places j, and its slope. */
  y[1] = (((7*square - 70)*square + 147)*square - 36)/(x*(((square - 14)*square + 49)*square - 36));
  memcpy(fit->x, &x, sizeof x);
  memcpy(fit->size, y, sizeof x);
  memcpy(fit->slope, &slope, sizeof x);
  memcpy(fit->curve, &curve, sizeof x);
  memcpy(fit->steep, y + 1, sizeof x);
  y[2] = designs_size(720*a[6]);
  memcpy(fit->rough, y + 2, sizeof x);
}

/* Begin at value j of seven, or of as many as there are, of which the first of the seven is told; an end keeps a little inside. */
static void designs_begin(designs_fit* fit, int lane, casadi_int j, casadi_int first, casadi_int count) {
  const designs_real from = (designs_real) (j - first - 3), off = (designs_real) 1e-5;
  fit->x[lane] = from;
  fit->low[lane] = j == 0 ? from + off : from - 1;
  fit->high[lane] = j == count - 1 ? from - off : from + 1;
}

static casadi_int designs_window(casadi_int j, casadi_int count) {
  return j < 3 ? 0 : j > count - 4 ? count - DESIGNS_FIT : j - 3;
}

static void designs_from_fit(const designs_fit* fit, int lane, int summit, double start, double step, designs_look* look) {
  look->summit = summit;
  look->last = 0;
  look->t = start + step*(double) (fit->x[lane] + 3);
  look->step = step;
  look->size = fit->size[lane];
  look->slope = fit->slope[lane];
  look->curve = fit->curve[lane];
  look->steep = fit->steep[lane];
  look->rough = fit->rough[lane];
  look->trust = fit->x[lane] > -2 && fit->x[lane] < 2 ? DESIGNS_TRUST : DESIGNS_TRUST_ASIDE;
  look->found = 0;
}

/* Where two parabolas through three values on either side of value j meet, in steps from it: a kink, if they are steep there. */
static int designs_kink(const designs_real* y, designs_real* x, designs_real* size) {
  const designs_real a1 = y[-1] - y[-2], a2 = (y[-1] - 2*y[-2] + y[-3])/2, b1 = y[1] - y[2], b2 = (y[1] - 2*y[2] + y[3])/2;
  const designs_real bend = 2*((a2 < 0 ? -a2 : a2) + (b2 < 0 ? -b2 : b2));
  designs_real left, right, up, down, at = 0;
  int trial;
  for (trial = 0;; ++trial) {
    left = y[-1] + (at + 1)*(a1 + (at + 2)*a2);
    right = y[1] + (1 - at)*(b1 + (2 - at)*b2);
    up = a1 + (2*at + 3)*a2;
    down = b1 + (3 - 2*at)*b2;
    if (trial == 4) break;
    at -= (left - right)/(up + down);
    at = at > -1 ? (at < 1 ? at : 1) : -1;
  }
  *x = at;
  *size = left;
  return up > bend && down > bend;
}

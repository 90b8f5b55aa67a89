/* What curves may do between equal steps of time, told by their values at them: how far they go, and where they may do anything. */
/* So many instants, or times inside a step, t, with a row for every curve, its place, and what is watched. hiding becomes, of each
   step, whether something may hide in it, and then whether it was searched. */
typedef struct {
  casadi_int n, stride;
  const double* t;
  designs_real *rows, *watched;
  signed char *hiding, *kinks;
} designs_panel;

enum { DESIGNS_HIDES = 1, DESIGNS_DONE = 2 };

static designs_real* designs_panel_row(const designs_panel* panel, int k) { return panel->rows + k*panel->stride + LANES; }

/* What bends a row at a value downwards. */
static designs_real designs_bend(const designs_real* y) { return 2*y[0] - y[-1] - y[1]; }

static designs_real designs_magnitude(designs_real x) { return x < 0 ? -x : x; }

static designs_real designs_upper(designs_real x, designs_real y) { return x > y ? x : y; }

/* How far what bends the flanks of a kink in step i of n - 1 upwards may take it beyond their chords. */
static designs_real designs_flanks(const designs_real* row, casadi_int i, casadi_int n, designs_real sign) {
  const designs_real* y = row + i;
  if (i < 2) return 2*designs_magnitude(designs_bend(y + 2));
  if (i > n - 4) return 2*designs_magnitude(designs_bend(y - 1));
  return designs_upper(-sign*designs_bend(y - 1), 0) + designs_upper(-sign*designs_bend(y + 2), 0);
}

/* What a curve bends upwards beside step i of n - 1. */
static designs_real designs_inflected(const designs_real* row, casadi_int i, casadi_int n, designs_real sign) {
  const designs_real *y = row + i, before = i > 1 ? -sign*designs_bend(y - 1) : 0, after = i < n - 3 ? -sign*designs_bend(y + 2) : 0;
  return designs_upper(before, 0) + designs_upper(after, 0);
}

/* Upper bounds of a curve in step i of n - 1, and of what it is below zero. Where it bends downwards at both ends of a step, a curve is
   below the chords of the steps beside it; where upwards, below its own. Where it bends both ways, and in the first step and the last,
   it rises above an end at most as far as a kink in the middle would that bends it as much. To all this comes what the flanks of a kink
   bend upwards; so beside an inflection, through which the chord rises though the curve may fall. */
static void designs_bounds(const designs_real* row, casadi_int i, casadi_int n, designs_real* up, designs_real* down) {
  const designs_real *y = row + i, a = y[0], b = y[1];
  const designs_real left = i == 0 ? 2*designs_bend(y + 1) : designs_bend(y);
  const designs_real right = i == n - 2 ? 2*designs_bend(y) : designs_bend(y + 1);
  const designs_real l = designs_magnitude(left)/2, r = designs_magnitude(right)/2;
  *up = designs_upper(a, b);
  *down = designs_upper(-a, -b);
  if (i > 0 && i < n - 2 && left >= 0 && right >= 0) {
    if (a > y[-1] && b > y[2]) *up = a + (a - y[-1])*(right/(left + right)) + designs_flanks(row, i, n, 1);
    else *up += designs_inflected(row, i, n, 1);
  } else if (i > 0 && i < n - 2 && left <= 0 && right <= 0) {
    if (a < y[-1] && b < y[2]) *down = (y[-1] - a)*(right/(left + right)) - a + designs_flanks(row, i, n, -1);
    else *down += designs_inflected(row, i, n, -1);
  } else {
    *up = designs_upper(a + l, b + r) + designs_flanks(row, i, n, 1);
    *down = designs_upper(l - a, r - b) + designs_flanks(row, i, n, -1);
  }
}

/* An upper bound of its size. */
static designs_real designs_furthest(const designs_real* row, casadi_int i, casadi_int n) {
  designs_real up, down;
  designs_bounds(row, i, n, &up, &down);
  return designs_upper(up, down);
}

#if DESIGNS_WATCHES
static designs_real designs_floor(designs_real x) { return x - x == 0 ? (designs_real) floor((double) x) : x; }

/* How many kinks one of the watched has in a step, 2 for more; or DESIGNS_MANY where it may do anything. Unless it may have a kink
   itself there, as bent tells, one that bends little beside how far it goes stays between its ends. */
#define DESIGNS_MANY 100
#define DESIGNS_NUMBERED(kind) ((kind) == DESIGNS_IS_SWITCH || (kind) == DESIGNS_IS_KNOT)
static int designs_kinks(const designs_real* row, casadi_int i, casadi_int n, int kind, const designs_real* at, int count, double step,
                         int bent) {
  const designs_real a = row[i], b = row[i + 1], least = a < b ? a : b, most = a < b ? b : a;
  designs_real low, high, nearest, sizes, turned;
  casadi_int j;
  int k, kinks = 0;
  if (kind == DESIGNS_IS_RATE) {
    nearest = (a < 0 ? -a : a) < (b < 0 ? -b : b) ? (b < 0 ? -b : b) : (a < 0 ? -a : a);
    return (double) nearest*step > DESIGNS_RATE ? DESIGNS_MANY : 0;
  }
  if (kind == DESIGNS_IS_TURN) {
    for (j = i > 0 ? i - 1 : i; j <= i + 1 && j < n - 1; ++j) {
      turned = row[j + 1] - row[j];
      turned -= DESIGNS_TURN*designs_floor(turned*(1/DESIGNS_TURN) + DESIGNS_HALF);
      if ((turned < 0 ? -turned : turned) > DESIGNS_RATE) return DESIGNS_MANY;
    }
    return 0;
  }
  designs_bounds(row, i, n, &high, &low);
  low = -low;
  if (!bent && most - least >= DESIGNS_STRAIGHT*((high - most) + (least - low))) {
    low = least;
    high = most;
  }
  if (kind == DESIGNS_IS_POLE || kind == DESIGNS_IS_ROOT) {
    nearest = a > 0 ? low : -high;
    if (kind == DESIGNS_IS_ROOT) return (a > 0) != (b > 0) || nearest < 0;
    sizes = (a < 0 ? -a : a) < (b < 0 ? -b : b) ? (a < 0 ? -a : a) : (b < 0 ? -b : b);
    if ((a > 0) != (b > 0) || nearest < DESIGNS_DIP*sizes) return DESIGNS_MANY;
    if ((a - a == 0 || a != a) && (b - b == 0 || b != b)) return 0;
    for (j = 0; j < n; ++j) if (row[j] - row[j] == 0 || row[j] != row[j]) return DESIGNS_MANY;
    return 0;
  }
  if (DESIGNS_NUMBERED(kind)) {
    for (k = 0; k < count; ++k) {
      if ((a > at[k]) != (b > at[k])) {
        kinks += kinks < 2;
      } else if (a > at[k] && b > at[k] ? low < at[k] : high > at[k]) {
        if (kind == DESIGNS_IS_SWITCH) return DESIGNS_MANY;
        kinks += kinks < 2;
      }
    }
    return kinks;
  }
  if (kind == DESIGNS_IS_STEP) {
    if (designs_floor(high) > designs_floor(most) || designs_floor(low) < designs_floor(least)) return DESIGNS_MANY;
    nearest = designs_floor(most) - designs_floor(least);
    return nearest > 1 ? 2 : nearest > 0;
  }
  if (kind == DESIGNS_IS_SOFT) {
    if ((high > most + DESIGNS_CHANGE || low < least - DESIGNS_CHANGE) && low < at[0] && high > -at[0]) return DESIGNS_MANY;
    return most - least > DESIGNS_CHANGE && least < at[0] && most > -at[0];
  }
  nearest = -DESIGNS_LARGEST;
  for (j = 0; j < n; ++j) nearest = row[j] > nearest ? row[j] : nearest;
  return high > most + DESIGNS_RISE && high > nearest - DESIGNS_NEGLIGIBLE ? DESIGNS_MANY : 0;
}

/* Whether any step may have a kink in one of the watched or more; to be asked of ordinary rows, so it looks at packs. */
static int designs_is_sharp(designs_real* row, casadi_int n, int kind, double step) {
  const designs_real rate = (designs_real) (DESIGNS_RATE/step);
  casadi_real here, before, after, bend;
  casadi_int i;
  if (kind != DESIGNS_IS_RATE && kind != DESIGNS_IS_POLE) return 1;
  row[-1] = row[0];
  for (i = n; i < n + LANES; ++i) row[i] = row[n - 1];
  for (i = 0; i < n; i += LANES) {
    memcpy(&here, row + i, sizeof here);
    if (kind == DESIGNS_IS_RATE) {
      if (lanes_where_less(rate, designs_size(here))) return 1;
      continue;
    }
    memcpy(&before, row + i - 1, sizeof here);
    memcpy(&after, row + i + 1, sizeof here);
    bend = before - here + (after - here);
    if (lanes_where_less(designs_size(here), 16*designs_size(bend)) || lanes_where_less(here*after, DESIGNS_LEAST)) return 1;
  }
  return 0;
}
#endif

/* Tell in which steps of a panel something may hide; inside a step between instants, kinks of the motion are counted too. In the
   finest steps rounding makes kinks, where what is watched is nearly zero, and poles alone hide more. */
static void designs_hide(const designs_panel* panel, int depth) {
  const casadi_int steps = panel->n - 1;
#if DESIGNS_WATCHES || DESIGNS_KNOTS
  const double step = (panel->t[steps] - panel->t[0])/(double) steps;
  casadi_int i;
  int any = 0, k;
#endif
  memset(panel->kinks, 0, (size_t) steps);
#if DESIGNS_WATCHES || DESIGNS_KNOTS
#if DESIGNS_KNOTS
  for (k = 0; depth > 0 && k < DESIGNS_KNOTS; ++k) {
    if (!(designs_knot[k] >= panel->t[0] && designs_knot[k] <= panel->t[steps])) continue;
    for (i = 0; i < steps - 1 && designs_knot[k] >= panel->t[i + 1]; ++i) {}
    panel->kinks[i] += panel->kinks[i] < 2;
    any = depth < DESIGNS_FINEST;
  }
#endif
#if DESIGNS_WATCHES
  for (k = 0; k < DESIGNS_WATCHES; ++k) {
    designs_real* row = panel->watched + k*panel->stride + LANES;
    if (!designs_is_sharp(row, panel->n, designs_watch[k], step)) continue;
    for (i = 0; i < steps; ++i) {
      const int found = designs_kinks(row, i, panel->n, designs_watch[k], designs_watch_at + designs_watch_first[k],
                                      designs_watch_first[k + 1] - designs_watch_first[k], step,
                                      panel->kinks[i] || panel->hiding[i] & DESIGNS_HIDES);
      if (found == DESIGNS_MANY) {
        if (depth < DESIGNS_FINEST || designs_watch[k] == DESIGNS_IS_POLE) panel->hiding[i] |= DESIGNS_HIDES;
        continue;
      }
      panel->kinks[i] = (signed char) (panel->kinks[i] + found > 2 ? 2 : panel->kinks[i] + found);
      any |= found > 0 && depth < DESIGNS_FINEST;
    }
  }
#endif
  /* One in a step shows; two, or one in each of two steps, may not. */
  for (i = 0; any && i < steps; ++i) {
    if (!panel->kinks[i]) continue;
    if (panel->kinks[i] > 1 || (i > 0 && panel->kinks[i - 1]) || (i < steps - 1 && panel->kinks[i + 1])) panel->hiding[i] |= DESIGNS_HIDES;
  }
#endif
  (void) depth;
}

/* Whether a kink may be in a step. */
static int designs_kinked(const designs_panel* panel, casadi_int step) {
  int k, kinked = panel->kinks[step] || panel->hiding[step] & DESIGNS_HIDES;
  for (k = 0; k < DESIGNS_KNOTS; ++k) kinked |= designs_knot[k] > panel->t[step] && designs_knot[k] < panel->t[step + 1];
  return kinked;
}

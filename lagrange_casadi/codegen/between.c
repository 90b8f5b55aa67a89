/* What curves may do between equal steps of time, judged by their values at them: how far they go, and where they may do anything. */
/* What bends a row at a value downwards. */
static search_real search_bend(const search_real* y) { return 2*y[0] - y[-1] - y[1]; }

/* How far what bends the flanks of a kink in step i of n - 1 upwards may take it beyond their chords. */
static search_real search_flanks(const search_real* row, long long i, long long n, search_real sign) {
  const search_real* y = row + i;
  if (i < 2) return 2*search_magnitude(search_bend(y + 2));
  if (i > n - 4) return 2*search_magnitude(search_bend(y - 1));
  return search_upper(-sign*search_bend(y - 1), 0) + search_upper(-sign*search_bend(y + 2), 0);
}

/* What a curve bends upwards beside step i of n - 1. */
static search_real search_inflected(const search_real* row, long long i, long long n, search_real sign) {
  const search_real *y = row + i, before = i > 1 ? -sign*search_bend(y - 1) : 0, after = i < n - 3 ? -sign*search_bend(y + 2) : 0;
  return search_upper(before, 0) + search_upper(after, 0);
}

/* Upper bounds of a curve in step i of n - 1, and of what it is below zero. Where it bends downwards at both ends of a step, a curve is
   below the chords of the steps beside it; where upwards, below its own. Where it bends both ways, and in the first step and the last,
   it rises above an end at most as far as a kink in the middle would that bends it as much. To all this comes what the flanks of a kink
   bend upwards; so beside an inflection, through which the chord rises though the curve may fall. */
static void search_bounds(const search_real* row, long long i, long long n, search_real* up, search_real* down) {
  const search_real *y = row + i, a = y[0], b = y[1];
  const search_real left = i == 0 ? 2*search_bend(y + 1) : search_bend(y);
  const search_real right = i == n - 2 ? 2*search_bend(y) : search_bend(y + 1);
  const search_real l = search_magnitude(left)/2, r = search_magnitude(right)/2;
  *up = search_upper(a, b);
  *down = search_upper(-a, -b);
  if (i > 0 && i < n - 2 && left >= 0 && right >= 0) {
    if (a > y[-1] && b > y[2]) *up = a + (a - y[-1])*(right/(left + right)) + search_flanks(row, i, n, 1);
    else *up += search_inflected(row, i, n, 1);
  } else if (i > 0 && i < n - 2 && left <= 0 && right <= 0) {
    if (a < y[-1] && b < y[2]) *down = (y[-1] - a)*(right/(left + right)) - a + search_flanks(row, i, n, -1);
    else *down += search_inflected(row, i, n, -1);
  } else {
    *up = search_upper(a + l, b + r) + search_flanks(row, i, n, 1);
    *down = search_upper(l - a, r - b) + search_flanks(row, i, n, -1);
  }
}

/* An upper bound of its size. */
static search_real search_furthest(const search_real* row, long long i, long long n) {
  search_real up, down;
  search_bounds(row, i, n, &up, &down);
  return search_upper(up, down);
}

static search_real search_floor(search_real x) { return x - x == 0 ? (search_real) floor((double) x) : x; }

/* How many kinks one of the watched has in a step, 2 for more; or SEARCH_MANY where it may do anything. Unless it may have a kink
   itself there, as bent says, one that bends little beside how far it goes stays between its ends. */
#define SEARCH_MANY 100
#define SEARCH_NUMBERED(kind) ((kind) == SEARCH_IS_SWITCH || (kind) == SEARCH_IS_KNOT)
static int search_kinks(const search_real* row, long long i, long long n, int kind, const search_real* at, int count, double step,
                         int bent) {
  const search_real a = row[i], b = row[i + 1], least = a < b ? a : b, most = a < b ? b : a;
  search_real low, high, nearest, sizes, turned;
  long long j;
  int k, kinks = 0;
  if (kind == SEARCH_IS_RATE) {
    nearest = (a < 0 ? -a : a) < (b < 0 ? -b : b) ? (b < 0 ? -b : b) : (a < 0 ? -a : a);
    return (double) nearest*step > SEARCH_RATE ? SEARCH_MANY : 0;
  }
  if (kind == SEARCH_IS_TURN) {
    for (j = i > 0 ? i - 1 : i; j <= i + 1 && j < n - 1; ++j) {
      turned = row[j + 1] - row[j];
      turned -= SEARCH_TURN*search_floor(turned*(1/SEARCH_TURN) + SEARCH_HALF);
      if ((turned < 0 ? -turned : turned) > SEARCH_RATE) return SEARCH_MANY;
    }
    return 0;
  }
  search_bounds(row, i, n, &high, &low);
  low = -low;
  if (!bent && most - least >= SEARCH_STRAIGHT*((high - most) + (least - low))) {
    low = least;
    high = most;
  }
  if (kind == SEARCH_IS_POLE || kind == SEARCH_IS_ROOT) {
    nearest = a > 0 ? low : -high;
    if (kind == SEARCH_IS_ROOT) return (a > 0) != (b > 0) || nearest < 0;
    sizes = (a < 0 ? -a : a) < (b < 0 ? -b : b) ? (a < 0 ? -a : a) : (b < 0 ? -b : b);
    if ((a > 0) != (b > 0) || nearest < SEARCH_DIP*sizes) return SEARCH_MANY;
    if ((a - a == 0 || a != a) && (b - b == 0 || b != b)) return 0;
    for (j = 0; j < n; ++j) if (row[j] - row[j] == 0 || row[j] != row[j]) return SEARCH_MANY;
    return 0;
  }
  if (SEARCH_NUMBERED(kind)) {
    for (k = 0; k < count; ++k) {
      if ((a > at[k]) != (b > at[k])) {
        kinks += kinks < 2;
      } else if (a > at[k] && b > at[k] ? low < at[k] : high > at[k]) {
        if (kind == SEARCH_IS_SWITCH) return SEARCH_MANY;
        kinks += kinks < 2;
      }
    }
    return kinks;
  }
  if (kind == SEARCH_IS_STEP) {
    if (search_floor(high) > search_floor(most) || search_floor(low) < search_floor(least)) return SEARCH_MANY;
    nearest = search_floor(most) - search_floor(least);
    return nearest > 1 ? 2 : nearest > 0;
  }
  if (kind == SEARCH_IS_SOFT) {
    if ((high > most + SEARCH_CHANGE || low < least - SEARCH_CHANGE) && low < at[0] && high > -at[0]) return SEARCH_MANY;
    return most - least > SEARCH_CHANGE && least < at[0] && most > -at[0];
  }
  nearest = -SEARCH_LARGEST;
  for (j = 0; j < n; ++j) nearest = row[j] > nearest ? row[j] : nearest;
  return high > most + SEARCH_RISE && high > nearest - SEARCH_NEGLIGIBLE ? SEARCH_MANY : 0;
}

/* Whether any step may have a kink in one of the watched or more; to be asked of ordinary rows, so it looks at packs. */
static int search_is_sharp(search_real* row, long long n, int kind, double step) {
  const search_real rate = (search_real) (SEARCH_RATE/step);
  lanes_pack here, before, after, bend;
  long long i;
  if (kind != SEARCH_IS_RATE && kind != SEARCH_IS_POLE) return 1;
  row[-1] = row[0];
  for (i = n; i < n + LANES; ++i) row[i] = row[n - 1];
  for (i = 0; i < n; i += LANES) {
    memcpy(&here, row + i, sizeof here);
    if (kind == SEARCH_IS_RATE) {
      if (lanes_where_less(rate, search_size(here))) return 1;
      continue;
    }
    memcpy(&before, row + i - 1, sizeof here);
    memcpy(&after, row + i + 1, sizeof here);
    bend = before - here + (after - here);
    if (lanes_where_less(search_size(here), 16*search_size(bend)) || lanes_where_less(here*after, SEARCH_LEAST)) return 1;
  }
  return 0;
}

/* Find in which steps of a panel something may hide; inside a step between instants, kinks of the motion are counted too. In the
   finest steps rounding makes kinks, where what is watched is nearly zero, and poles alone hide more. */
static void search_hide(const search_now* now, const search_panel* panel, int depth) {
  const lagrange_casadi_curves* curves = now->curves;
  const long long steps = panel->n - 1;
  const double step = search_width(panel);
  long long i;
  int any = 0, k;
  memset(panel->kinks, 0, (size_t) steps);
  for (k = 0; depth > 0 && k < curves->knots; ++k) {
    if (!(curves->knot[k] >= panel->t[0] && curves->knot[k] <= panel->t[steps])) continue;
    for (i = 0; i < steps - 1 && curves->knot[k] >= panel->t[i + 1]; ++i) {}
    panel->kinks[i] += panel->kinks[i] < 2;
    any = depth < SEARCH_FINEST;
  }
  for (k = 0; k < curves->watches; ++k) {
    search_real* row = search_watched(panel, k);
    const int kind = curves->watch[k], first = curves->watch_first[k];
    if (!search_is_sharp(row, panel->n, kind, step)) continue;
    for (i = 0; i < steps; ++i) {
      const int found = search_kinks(row, i, panel->n, kind, curves->watch_at + first, curves->watch_first[k + 1] - first, step,
                                     panel->kinks[i] || panel->hiding[i] & SEARCH_HIDES);
      if (found == SEARCH_MANY) {
        if (depth < SEARCH_FINEST || kind == SEARCH_IS_POLE) panel->hiding[i] |= SEARCH_HIDES;
        continue;
      }
      panel->kinks[i] = (signed char) (panel->kinks[i] + found > 2 ? 2 : panel->kinks[i] + found);
      any |= found > 0 && depth < SEARCH_FINEST;
    }
  }
  /* One in a step shows; two, or one in each of two steps, may not. */
  for (i = 0; any && i < steps; ++i) {
    if (!panel->kinks[i]) continue;
    if (panel->kinks[i] > 1 || (i > 0 && panel->kinks[i - 1]) || (i < steps - 1 && panel->kinks[i + 1])) panel->hiding[i] |= SEARCH_HIDES;
  }
}

/* Whether a kink may be in a step. */
static int search_kinked(const search_now* now, const search_panel* panel, long long step) {
  const double* knot = now->curves->knot;
  int k, kinked = panel->kinks[step] || panel->hiding[step] & SEARCH_HIDES;
  for (k = 0; k < now->curves->knots; ++k) kinked |= knot[k] > panel->t[step] && knot[k] < panel->t[step + 1];
  return kinked;
}

/* What curves may do between equal steps of time, judged by their values at them: how far they go, and where they may do anything. */
/* What bends a row at a value downwards. */
static search_real search_bend(const search_real* y) { return 2*y[0] - y[-1] - y[1]; }

/* What a curve bends upwards beside step i of n - 1. */
static search_real search_inflected(const search_real* row, long long i, long long n, search_real sign) {
  const search_real *y = row + i, before = i > 1 ? -sign*search_bend(y - 1) : 0, after = i < n - 3 ? -sign*search_bend(y + 2) : 0;
  return search_upper(before, 0) + search_upper(after, 0);
}

/* How far what bends the flanks of a kink in step i of n - 1 upwards may take it beyond their chords. */
static search_real search_flanks(const search_real* row, long long i, long long n, search_real sign) {
  if (i < 2) return 2*search_magnitude(search_bend(row + i + 2));
  if (i > n - 4) return 2*search_magnitude(search_bend(row + i - 1));
  return search_inflected(row, i, n, sign);
}

/* An upper bound of a curve, times a sign, in step i of n - 1. Where it bends downwards at both ends of a step, a curve is below the
   chords of the steps beside it; where upwards, below its own. Where it bends both ways, and in the first step and the last, it rises
   above an end at most as far as a kink in the middle would that bends it as much. To all this comes what the flanks of a kink bend
   upwards; so beside an inflection, through which the chord rises though the curve may fall. */
LANES_INLINE search_real search_above(const search_real* row, long long i, long long n, search_real sign) {
  const search_real *y = row + i, a = sign*y[0], b = sign*y[1];
  const search_real left = sign*(i == 0 ? 2*search_bend(y + 1) : search_bend(y));
  const search_real right = sign*(i == n - 2 ? 2*search_bend(y) : search_bend(y + 1));
  if (i == 0 || i == n - 2 || !((left >= 0 && right >= 0) || (left <= 0 && right <= 0))) {
    return search_upper(a + search_magnitude(left)/2, b + search_magnitude(right)/2) + search_flanks(row, i, n, sign);
  }
  if (left < 0 || right < 0) return search_upper(a, b);
  if (a > sign*y[-1] && b > sign*y[2]) return a + (a - sign*y[-1])*(right/(left + right)) + search_flanks(row, i, n, sign);
  return search_upper(a, b) + search_inflected(row, i, n, sign);
}

/* An upper bound of its size. */
static search_real search_furthest(const search_real* row, long long i, long long n) {
  return search_upper(search_above(row, i, n, 1), search_above(row, i, n, -1));
}

static search_real search_floor(search_real x) { return x - x == 0 ? (search_real) floor((double) x) : x; }

/* The first of a watched argument's numbers, which increase, that is not below x. */
static int search_from(const search_now* now, int watch, search_real x) {
  const lagrange_casadi_curves* curves = now->curves;
  int first = curves->watch_first[watch], last = curves->watch_first[watch + 1], middle;
  while (first < last) {
    middle = (first + last)/2;
    if (curves->watch_at[middle] < x) first = middle + 1;
    else last = middle;
  }
  return first;
}

/* Whether a curve may jump, or have a kink, where one of the watched passes a number. */
static int search_is_switching(const search_now* now, int watch) {
  const int kind = now->curves->watch[watch];
  return kind == SEARCH_IS_STEP || kind == SEARCH_IS_SWITCH || kind == SEARCH_IS_KNOT || kind == SEARCH_IS_ROOT;
}

/* How many kinks one of the watched has in step i of a panel, 2 for more; or SEARCH_MANY where it may do anything. Unless it may have a
   kink itself there, as bent says, one that bends little beside how far it goes stays between its ends. */
#define SEARCH_MANY 100
static int search_kinks(const search_now* now, const search_panel* panel, int watch, long long i, int bent) {
  const search_real *row = search_watched(now, panel, watch), *at = now->curves->watch_at;
  const search_real a = row[i], b = row[i + 1], least = search_lower(a, b), most = search_upper(b, a);
  const int kind = now->curves->watch[watch], last = now->curves->watch_first[watch + 1];
  const long long n = panel->n;
  search_real low, high, nearest, turned;
  long long j;
  int k, kinks = 0;
  if (kind == SEARCH_IS_RATE) {
    nearest = search_upper(search_magnitude(b), search_magnitude(a));
    return (double) nearest*search_width(panel) > SEARCH_RATE ? SEARCH_MANY : 0;
  }
  if (kind == SEARCH_IS_TURN) {
    for (j = i > 0 ? i - 1 : i; j <= i + 1 && j < n - 1; ++j) {
      turned = row[j + 1] - row[j];
      turned -= SEARCH_TURN*search_floor(turned*(1/SEARCH_TURN) + SEARCH_HALF);
      if (search_magnitude(turned) > SEARCH_RATE) return SEARCH_MANY;
    }
    return 0;
  }
  high = search_above(row, i, n, 1);
  low = -search_above(row, i, n, -1);
  if (!bent && most - least >= SEARCH_STRAIGHT*((high - most) + (least - low))) {
    low = least;
    high = most;
  }
  if (kind == SEARCH_IS_POLE) {
    nearest = a > 0 ? low : -high;
    if ((a > 0) != (b > 0) || nearest < SEARCH_DIP*search_lower(search_magnitude(a), search_magnitude(b))) return SEARCH_MANY;
    if ((a - a == 0 || a != a) && (b - b == 0 || b != b)) return 0;
    for (j = 0; j < n; ++j) if (row[j] - row[j] == 0 || row[j] != row[j]) return SEARCH_MANY;
    return 0;
  }
  if (kind == SEARCH_IS_STEP) {
    if (search_floor(high) > search_floor(most) || search_floor(low) < search_floor(least)) return SEARCH_MANY;
    nearest = search_floor(most) - search_floor(least);
    return nearest > 1 ? 2 : nearest > 0;
  }
  if (search_is_switching(now, watch)) {
    high = search_upper(high, most);
    for (k = search_from(now, watch, search_lower(low, least)); k < last && at[k] < high; ++k) {
      if ((a > at[k]) != (b > at[k])) {
        kinks += kinks < 2;
      } else if (a > at[k] && b > at[k] ? low < at[k] : high > at[k]) {
        if (kind == SEARCH_IS_SWITCH) return SEARCH_MANY;
        kinks += kinks < 2;
      }
    }
    return kinks;
  }
  if (kind == SEARCH_IS_SOFT) {
    if ((high > most + SEARCH_CHANGE || low < least - SEARCH_CHANGE) && low < at[last - 1] && high > -at[last - 1]) return SEARCH_MANY;
    return most - least > SEARCH_CHANGE && least < at[last - 1] && most > -at[last - 1];
  }
  nearest = -SEARCH_LARGEST;
  for (j = 0; j < n; ++j) nearest = row[j] > nearest ? row[j] : nearest;
  return high > most + SEARCH_RISE && high > nearest - SEARCH_NEGLIGIBLE ? SEARCH_MANY : 0;
}

/* What a row's values beside step i of n - 1 are off by rounding: where third differences are no smaller than second ones, and change
   their sign to and fro, as those of a steep flank do not. Where all are so near that they differ by nothing else, these need not. */
#define SEARCH_QUIET 10
static search_real search_shaken(const search_real* row, long long step, long long n, int near) {
  search_real sorted[2][SEARCH_QUIET], x, median[2], before = 0;
  long long first = step - SEARCH_QUIET/2 + 1;
  int j, k, order, count, turns = 0;
  if (n < SEARCH_QUIET) return 0;
  first = first < 0 ? 0 : first > n - SEARCH_QUIET ? n - SEARCH_QUIET : first;
  row += first;
  for (order = 0; order < 2; ++order) {
    count = SEARCH_QUIET - 2 - order;
    for (j = 0; j < count; ++j) {
      x = order ? row[j + 3] - 3*row[j + 2] + 3*row[j + 1] - row[j] : row[j + 2] - 2*row[j + 1] + row[j];
      turns += order && j && ((x < 0 && before > 0) || (x > 0 && before < 0));
      before = x;
      x = x < 0 ? -x : x;
      for (k = j; k > 0 && sorted[order][k - 1] > x; --k) sorted[order][k] = sorted[order][k - 1];
      sorted[order][k] = x;
    }
    median[order] = count % 2 ? sorted[order][count/2] : (sorted[order][count/2 - 1] + sorted[order][count/2])/2;
  }
  return near || (turns >= 2 && median[1] >= median[0]) ? 3*median[1] : 0;
}

/* How far one of the watched is from the nearest number at which it switches. */
static search_real search_gap(const search_now* now, int watch, search_real x) {
  const lagrange_casadi_curves* curves = now->curves;
  search_real gap = SEARCH_LARGEST;
  int j, k;
  if (curves->watch[watch] == SEARCH_IS_STEP) return search_magnitude(x - search_floor(x + SEARCH_HALF));
  for (k = search_from(now, watch, x), j = k - 1; j <= k; ++j) {
    if (j < curves->watch_first[watch] || j == curves->watch_first[watch + 1]) continue;
    gap = search_lower(search_magnitude(x - curves->watch_at[j]), gap);
  }
  return gap;
}

/* On which side of the numbers at which it switches one of the watched is: twice as many as are below it, and one more at one. */
static search_real search_side(const search_now* now, int watch, search_real x) {
  const lagrange_casadi_curves* curves = now->curves;
  const int k = search_from(now, watch, x);
  if (curves->watch[watch] == SEARCH_IS_STEP) return 2*search_floor(x) + (search_floor(x) == x);
  return (search_real) (2*k + (k < curves->watch_first[watch + 1] && curves->watch_at[k] == x));
}

static int search_depends(const search_now* now, int watch, int quantity) {
  return now->curves->depends[watch*now->curves->quantities + quantity];
}

/* Whether what is found at a time of a panel counts for a quantity: where one of the watched that it depends on may be on a side by
   rounding, that must be one that it has at an instant before or after. */
static int search_counts(const search_now* now, int quantity, const search_panel* panel, long long at) {
  const double x = (panel->t[at] - now->all.t[0])/(2*now->half);
  long long i = now->step >= 0 ? now->step : x > 0 ? (long long) x : 0;
  search_real value, side;
  int j, k, seen;
  i = i < now->all.n - 2 ? i : now->all.n - 2;
  for (k = 0; k < now->curves->watches; ++k) {
    const int kind = now->curves->watch[k];
    if ((kind != SEARCH_IS_SWITCH && kind != SEARCH_IS_STEP) || now->ignored[k] || !search_depends(now, k, quantity)) continue;
    value = search_watched(now, panel, k)[at];
    if (now->step >= 0 && !(now->noise[k] > 0 && search_gap(now, k, value) <= now->noise[k])) continue;
    side = search_side(now, k, value);
    for (seen = j = 0; j < 2; ++j) {
      seen |= side == search_side(now, k, search_watched(now, &now->all, k)[i + j]);
      seen |= now->step >= 0 && side == now->sides[2*k + j];
    }
    if (!seen) return 0;
  }
  return 1;
}

/* How near to a kink, a jump or rest its sides are. */
static double search_beside(const search_now* now, const search_panel* panel) {
  const double beside = SEARCH_SIDE*2*now->half, least = search_spacing(panel);
  return beside < least ? least : beside;
}

/* Whether one of the watched may be at a number at which it switches in more than a point of a step between instants: it comes near
   to one, but does not go on from one side to another. */
static int search_lingers(const search_now* now, int watch, long long step) {
  const search_real *row = search_watched(now, &now->all, watch) + step, change = search_magnitude(row[1] - row[0]);
  const search_real gap = search_lower(search_gap(now, watch, row[0]), search_gap(now, watch, row[1]));
  search_real low = search_lower(row[0], row[1]), high = search_upper(row[0], row[1]);
  const long long before = step > 0 ? -1 : 0, after = step + 2 < now->all.n ? 2 : 1;
  const search_real apart = search_side(now, watch, row[before]) - search_side(now, watch, row[after]);
  low = search_lower(low, search_lower(row[before], row[after]));
  high = search_upper(high, search_upper(row[before], row[after]));
  if (search_magnitude(apart) >= 2 && change >= SEARCH_EVEN*(high - low)) return 0;
  return gap <= SEARCH_HALF*change + search_magnitude(high - low - (search_real) (after - before)*change);
}

/* Begin to search a step between instants: how large is the rounding of what switches there, as some times next to both instants show,
   and on which sides it is beyond that, before and after. */
static void search_measure(search_now* now, long long step) {
  const search_panel* all = &now->all;
  const int watches = (int) now->curves->watches;
  const double beside = search_beside(now, all);
  double t[2*SEARCH_QUIET];
  const search_panel near = search_few(t, 2*SEARCH_QUIET, now->found);
  long long at;
  int j, k, any = 0;
  for (k = 0; k < watches; ++k) {
    now->noise[k] = 0;
    if (!search_is_switching(now, k) || now->ignored[k] || any) continue;
    any = search_lingers(now, k, step);
  }
  now->step = step;
  if (!any || !(2*SEARCH_QUIET*beside < all->t[step + 1] - all->t[step])) return;
  for (j = 0; j < SEARCH_QUIET; ++j) {
    t[j] = all->t[step] + j*beside;
    t[SEARCH_QUIET + j] = all->t[step + 1] - j*beside;
  }
  search_evaluate(now, &near, 0, 2*SEARCH_QUIET, 0);
  for (k = 0; k < watches; ++k) {
    const search_real *row = search_watched(now, all, k), *ends = search_watched(now, &near, k);
    if (!search_is_switching(now, k)) continue;
    now->noise[k] = search_upper(search_shaken(ends, 0, SEARCH_QUIET, 1), search_shaken(ends + SEARCH_QUIET, 0, SEARCH_QUIET, 1));
    for (at = step; at > 0 && search_gap(now, k, row[at]) <= now->noise[k]; --at) {}
    now->sides[2*k] = search_side(now, k, row[at]);
    for (at = step + 1; at < all->n - 1 && search_gap(now, k, row[at]) <= now->noise[k]; ++at) {}
    now->sides[2*k + 1] = search_side(now, k, row[at]);
  }
}

/* Whether one of the watched hides nothing in a step, where rounding decides, at both ends of it or of a step beside, on which side of a
   number it is. */
static int search_undecided(const search_now* now, const search_panel* panel, int watch, long long step) {
  const search_real *row = search_watched(now, panel, watch), noise = now->noise[watch];
  long long i;
  if (now->step < 0 || !(noise > 0) || step < 0 || step > panel->n - 2) return 0;
  for (i = step > 0 ? step - 1 : 0; i < step + 2 && i < panel->n - 1; ++i) {
    if (search_gap(now, watch, row[i]) <= noise && search_gap(now, watch, row[i + 1]) <= noise) return 1;
  }
  return 0;
}

/* Whether rounding switches a curve in a step, which is no kink of it. */
static int search_switches(const search_now* now, const search_panel* panel, int curve, long long step) {
  int k;
  for (k = 0; k < now->curves->watches; ++k) {
    if (search_depends(now, k, now->quantity[curve]) && search_undecided(now, panel, k, step)) return 1;
  }
  return 0;
}

/* Take in a value of a curve, and return whether it counts; what is nothing has its peak at an instant. */
static int search_note(search_now* now, const search_panel* panel, int curve, long long i) {
  search_peak* peak = now->peaks + now->quantity[curve];
  const search_real value = search_row(panel, curve)[i], size = search_magnitude(value);
  const double t = panel->t[i];
  if (!search_counts(now, now->quantity[curve], panel, i)) return 0;
  if (!(size - size == 0) || search_lacks(now, curve, t)) return 1;
  if (now->call->tops) search_list_top(now, panel, curve, i);
  if (size > peak->best) {
    search_grow(now, now->quantity[curve], size);
    if (peak->size >= size - peak->rounding && peak->t < t - now->half) return 1;
  } else if (!(peak->limit <= SEARCH_LARGEST && size >= peak->best - peak->rounding && t < peak->t - now->half)) {
    return 1;
  }
  peak->size = size;
  peak->t = t;
  peak->place = search_ratio(now, panel, curve, i);
  peak->sign = value < 0 ? -1 : 1;
  return 1;
}

/* Take in all of a panel of a few times. */
static void search_note_all(search_now* now, const search_panel* panel) {
  long long i;
  int k;
  for (i = 0; i < panel->n; ++i) {
    for (k = 0; k < now->curves->curves; ++k) search_note(now, panel, k, i);
  }
}

/* Sample ever closer to both ends of steps in a row in which rounding switches one of the watched: what that switches is largest at one
   of them. Becomes the last of these steps. */
static long long search_toward_ends(search_now* now, const search_panel* panel, int watch, long long step) {
  long long first = step, last = step;
  double t[2*SEARCH_INNER], width;
  const search_panel near = search_few(t, 2*SEARCH_INNER, now->found);
  int j;
  while (search_undecided(now, panel, watch, first - 1)) --first;
  while (search_undecided(now, panel, watch, last + 1)) ++last;
  width = panel->t[last + 1] - panel->t[first];
  for (j = 0; j < SEARCH_INNER; ++j) {
    width /= SEARCH_INNER + 1;
    t[j] = panel->t[first] + width;
    t[SEARCH_INNER + j] = panel->t[last + 1] - width;
  }
  search_evaluate(now, &near, 0, 2*SEARCH_INNER, ~0ull);
  search_note_all(now, &near);
  return last;
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
      if (lanes_where_less(rate, lanes_size(here))) return 1;
      continue;
    }
    memcpy(&before, row + i - 1, sizeof here);
    memcpy(&after, row + i + 1, sizeof here);
    bend = before - here + (after - here);
    if (lanes_where_less(lanes_size(here), 16*lanes_size(bend)) || lanes_where_less(here*after, SEARCH_LEAST)) return 1;
  }
  return 0;
}

/* Whether a quantity that jumps in a step may matter there: at most as far as it goes on from the values on one side. */
static int search_leaps(const search_now* now, const search_panel* panel, int watch, long long step) {
  const long long last = panel->n - 2;
  search_real before, after;
  int k;
  for (k = 0; k < now->curves->curves; ++k) {
    const search_real* row = search_row(panel, k) + step;
    if (!search_depends(now, watch, now->quantity[k])) continue;
    before = step > 0 ? 2*row[0] - row[-1] : row[0];
    after = step < last ? 2*row[1] - row[2] : row[1];
    before = search_magnitude(before) + (step > 1 ? search_magnitude(search_bend(row - 1)) : 0);
    after = search_magnitude(after) + (step < last - 1 ? search_magnitude(search_bend(row + 2)) : 0);
    if (search_upper(before, after) > search_level(now, panel, k, step)) return 1;
  }
  return 0;
}

/* Find in which steps of a panel something may hide; inside a step between instants, kinks of the motion are counted too. In the
   finest steps rounding makes kinks, where what is watched is nearly zero, and poles alone hide more. */
static void search_hide(search_now* now, const search_panel* panel, int depth) {
  const lagrange_casadi_curves* curves = now->curves;
  const long long steps = panel->n - 1;
  long long i, sampled;
  int any = 0, k;
  memset(panel->kinks, 0, (size_t) steps);
  for (k = 0; depth > 0 && k < curves->knots; ++k) {
    if (!(curves->knot[k] >= panel->t[0] && curves->knot[k] <= panel->t[steps])) continue;
    for (i = 0; i < steps - 1 && curves->knot[k] >= panel->t[i + 1]; ++i) {}
    panel->kinks[i] += panel->kinks[i] < 2;
    any = depth < SEARCH_FINEST;
  }
  for (k = 0; k < curves->watches; ++k) {
    search_real* row = search_watched(now, panel, k);
    const int kind = curves->watch[k];
    if (now->ignored[k] || !search_is_sharp(row, panel->n, kind, search_width(panel))) continue;
    for (sampled = -1, i = 0; i < steps; ++i) {
      const int found = search_kinks(now, panel, k, i, panel->kinks[i] || panel->hiding[i] & SEARCH_HIDES);
      if (found && search_undecided(now, panel, k, i)) {
        if (i > sampled && depth < SEARCH_FINEST && !now->call->error) sampled = search_toward_ends(now, panel, k, i);
        continue;
      }
      if (found == SEARCH_MANY) {
        if (depth < SEARCH_FINEST || kind == SEARCH_IS_POLE) panel->hiding[i] |= SEARCH_HIDES;
        continue;
      }
      if (found && (kind == SEARCH_IS_SWITCH || kind == SEARCH_IS_STEP) && search_leaps(now, panel, k, i)) panel->hiding[i] |= SEARCH_HIDES;
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

/* Whether one of the watched may hide something in a step, alone or with another kink there or beside it. */
static int search_hides_at(const search_now* now, const search_panel* panel, int watch, long long step) {
  long long i;
  int found;
  for (i = step > 0 ? step - 1 : 0; i <= step + 1 && i < panel->n - 1; ++i) {
    found = search_kinks(now, panel, watch, i, 0);
    if (found && (i == step || found != SEARCH_MANY) && !search_undecided(now, panel, watch, i)) return 1;
  }
  return 0;
}

/* Whether only what is ignored hides something in a step. */
static int search_is_ignored(const search_now* now, const search_panel* panel, long long step) {
  int k, any = 0;
  for (k = 0; now->ignoring && k < now->curves->watches; ++k) {
    if (!search_hides_at(now, panel, k, step)) continue;
    if (!now->ignored[k]) return 0;
    any = 1;
  }
  return any;
}

/* End the search of the quantities for which a step takes too many panels: that of a curve, or of what depends on what hides there, which
   is ignored. Half as many panels are left for others. */
static void search_give_up(search_now* now, const search_panel* panel, int curve, long long step) {
  const int quantities = (int) now->curves->quantities;
  int k, q, any = 0;
  for (k = 0; curve < 0 && k < now->curves->watches; ++k) {
    if (!search_hides_at(now, panel, k, step)) continue;
    any = now->ignoring = now->ignored[k] = 1;
    for (q = 0; q < quantities; ++q) now->peaks[q].unlocated |= search_depends(now, k, q);
  }
  for (q = 0; q < quantities; ++q) {
    now->peaks[q].unlocated |= curve < 0 ? !any : q == now->quantity[curve];
    search_grow(now, q, now->peaks[q].best);
  }
  now->quota /= 2;
  now->left = now->quota;
}

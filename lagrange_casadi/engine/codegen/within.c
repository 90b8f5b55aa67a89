/* Steps that are searched as panels of their own: cut into nine, and before that in two where a kink or a jump is. */
/* How often a kink is sought, and by how many of the watched. */
#define SEARCH_TRIALS 3
#define SEARCH_WATCHED 2

LANES_INLINE void search_panel_of(search_now* now, const search_panel* panel, int depth);

/* Take in what a curve is at the times inside a step, where it is larger than what is known: of local peaks none of their flanks. */
static void search_note_inner(search_now* now, const search_panel* within, int curve) {
  const int q = now->quantity[curve];
  const search_real known = now->call->tops ? now->peaks[q].least : now->peaks[q].best;
  search_real *row = search_row(within, curve), size, beside;
  int j, beyond = 0;
  for (j = 1; j <= SEARCH_INNER; ++j) beyond |= !(search_magnitude(row[j]) <= known);
  for (j = 1; beyond && j <= SEARCH_INNER; ++j) {
    size = search_magnitude(row[j]);
    beside = search_upper(search_magnitude(row[j - 1]), search_magnitude(row[j + 1]));
    if (size > known && !(now->call->tops && size < beside)) search_note(now, within, curve, j);
    /* What has no value is nothing, and hides what is beside it. */
    if (row[j] - row[j] == 0) continue;
    within->hiding[j - 1] = within->hiding[j] = SEARCH_HIDES;
    row[j] = 0;
  }
}

/* Search what is between two times, those of values of panels, as a panel; beside rest, where what switches is no number, only so deep. */
static void search_part(search_now* now, const search_panel* from, long long first, const search_panel* to, long long last, int depth) {
  const double start = from->t[first], stop = to->t[last], width = (stop - start)/(SEARCH_INNER + 1);
  const int rows = search_rows(now), curves = (int) now->curves->curves;
  double t[SEARCH_WITHIN];
  signed char hiding[SEARCH_WITHIN], kinks[SEARCH_WITHIN];
  search_panel within = search_few(t, SEARCH_WITHIN, now->inner + depth*rows*SEARCH_STRIDE + LANES);
  search_real* row;
  int j, k;
  for (k = 0; now->call->rests && depth >= SEARCH_BESIDE_REST && k < curves; ++k) {
    if (search_lacks(now, k, (start + stop)/2)) return;
  }
  within.hiding = hiding;
  within.kinks = kinks;
  memset(hiding, 0, sizeof hiding);
  for (j = 0; j < SEARCH_WITHIN; ++j) t[j] = j <= SEARCH_INNER ? start + j*width : stop;
  search_evaluate(now, &within, 1, SEARCH_INNER, ~0ull);
  for (k = 0; k < rows; ++k) {
    row = search_row(&within, k);
    row[0] = search_row(from, k)[first];
    row[SEARCH_WITHIN - 1] = search_row(to, k)[last];
    if (k >= curves) continue;
    if (!search_lacks(now, k, (start + stop)/2)) search_note_inner(now, &within, k);
    else memset(row, 0, SEARCH_WITHIN*sizeof *row);
  }
  search_panel_of(now, &within, depth + 1);
}

/* Where between value i of n and the next, in steps from it, a row passes a number: by a polynomial in the values. */
static double search_where(const search_real* row, long long i, long long n, search_real level) {
  const long long first = search_window(i, n);
  double value[SEARCH_FIT], place[SEARCH_FIT];
  int j, k;
  for (k = 0; k < SEARCH_FIT; ++k) {
    value[k] = (double) row[first + k] - (double) level;
    place[k] = (double) (first + k - i);
  }
  for (j = 1; j < SEARCH_FIT; ++j) {
    for (k = 0; k < SEARCH_FIT - j; ++k) place[k] = (value[k + j]*place[k] - value[k]*place[k + 1])/(value[k + j] - value[k]);
  }
  if (place[0] >= 0 && place[0] <= 1) return place[0];
  return ((double) level - (double) row[i])/((double) row[i + 1] - (double) row[i]);
}

/* Whether a number is beyond one at which a watched one switches: a whole one is beyond itself. */
static int search_beyond(int whole, search_real value, search_real level) { return whole ? value >= level : value > level; }

/* Evaluate both sides of where one of the watched passes a number in a step, and there; whether they are on both sides. */
static int search_apart(search_now* now, const search_panel* panel, long long step, int watch, search_real level, double* t,
                        const search_panel* sides) {
  const search_real *row = search_watched(now, panel, watch), *ends = search_watched(now, sides, watch);
  const int whole = now->curves->watch[watch] == SEARCH_IS_STEP;
  const double start = panel->t[step], stop = panel->t[step + 1], beside = search_beside(now, panel);
  double at, place = search_where(row, step, panel->n, level), slope = (double) row[step + 1] - (double) row[step], before = 0, was = 0;
  search_real sum;
  int trial, apart, j, k;
  for (trial = 0; trial < SEARCH_TRIALS && place >= 0 && place <= 1; ++trial) {
    at = start + place*(stop - start);
    for (j = 0; j < 3; ++j) {
      t[j] = j == 0 ? at - beside : j == 1 ? at + beside : at;
      t[j] = t[j] < start ? start : t[j] > stop ? stop : t[j];
    }
    search_evaluate(now, sides, 0, 3, ~0ull);
    sum = 0;
    for (k = 0; k < now->curves->curves; ++k) {
      for (j = 0; j < 3; ++j) sum += 0*search_row(sides, k)[j];
    }
    apart = sum == 0;
    for (j = 0; j < 2; ++j) {
      if (t[j] == panel->t[step + j]) continue;
      apart &= search_beyond(whole, ends[j], level) == search_beyond(whole, row[step + j], level);
    }
    if (apart) return 1;
    if (trial) slope = ((double) ends[2] - was)/(place - before);
    before = place;
    was = (double) ends[2];
    place += ((double) level - was)/slope;
  }
  return 0;
}

/* Find a kink or a jump in a step, and what is beside it; whether there is one, and nothing else hides there. */
static int search_find_sides(search_now* now, const search_panel* panel, long long step, double* t, const search_panel* sides) {
  const lagrange_casadi_curves* curves = now->curves;
  search_real low, high, level;
  int j, k, tried = 0;
  if (panel->n < SEARCH_FIT || !panel->kinks[step]) return 0;
  if (!(panel->t[step + 1] - panel->t[step] > 8*search_beside(now, panel))) return 0;
  for (k = 0; k < curves->watches; ++k) {
    if (!search_is_switching(now, k) && !now->ignored[k] && search_kinks(now, panel, k, step, 0) == SEARCH_MANY) return 0;
  }
  for (k = 0; k < curves->watches; ++k) {
    const search_real* row = search_watched(now, panel, k);
    const int whole = curves->watch[k] == SEARCH_IS_STEP;
    low = search_lower(row[step], row[step + 1]);
    high = search_upper(row[step], row[step + 1]);
    if (!search_is_switching(now, k) || now->ignored[k] || !(high - low <= SEARCH_LARGEST)) continue;
    if (search_undecided(now, panel, k, step) || (whole && search_floor(high) != search_floor(low) + 1)) continue;
    for (j = search_from(now, k, low); j < (whole ? curves->watch_first[k] + 1 : curves->watch_first[k + 1]); ++j) {
      level = whole ? search_floor(high) : curves->watch_at[j];
      if (search_beyond(whole, low, level) || !search_beyond(whole, high, level)) continue;
      if (tried++ == SEARCH_WATCHED) return 0;
      if (search_apart(now, panel, step, k, level, t, sides)) return 1;
    }
  }
  return 0;
}

/* Search a step as a panel of its own, or as two if it is known where in it a kink or a jump is. */
static void search_inside(search_now* now, const search_panel* panel, long long step, int depth) {
  const double least = 2*search_beside(now, panel);
  double t[3];
  const search_panel sides = search_few(t, 3, now->beside + depth*search_rows(now)*SEARCH_STRIDE);
  if (!search_find_sides(now, panel, step, t, &sides)) {
    search_part(now, panel, step, panel, step + 1, depth);
    return;
  }
  search_note_all(now, &sides);
  --now->left;
  if (t[0] - panel->t[step] > least) search_part(now, panel, step, &sides, 0, depth);
  if (panel->t[step + 1] - t[1] > least) search_part(now, &sides, 1, panel, step + 1, depth);
}

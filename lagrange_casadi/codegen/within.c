/* Steps that are searched as panels of their own: cut into nine, and before that in two where a kink or a jump is. */
#define DESIGNS_WITHIN (DESIGNS_INNER + 2)
#define DESIGNS_PANEL_ROWS (DESIGNS_CURVES + DESIGNS_PLACES + DESIGNS_WATCHES)
/* How often a kink is sought, and by how many of the watched. */
#define DESIGNS_TRIALS 3
/* Panels within each other beside an instant at which friction at rest leaves a curve open. */
#define DESIGNS_BESIDE_REST 3
#define DESIGNS_WATCHED 2

static void designs_search(designs_now* now, const designs_panel* panel, int depth);

/* Just before and just after a kink or a jump, and at itself: the times, and what a panel has there. */
typedef struct {
  double t[3], beside;
  designs_real rows[3][DESIGNS_PANEL_ROWS];
} designs_sides;

/* What a panel has at a time. */
static void designs_column(const designs_panel* panel, casadi_int i, designs_real* column) {
  int k;
  for (k = 0; k < DESIGNS_CURVES + DESIGNS_PLACES; ++k) column[k] = designs_panel_row(panel, k)[i];
  for (k = 0; k < DESIGNS_WATCHES; ++k) column[DESIGNS_CURVES + DESIGNS_PLACES + k] = (panel->watched + k*panel->stride + LANES)[i];
}

/* Search what is between two times as a panel. */
static void designs_part(designs_now* now, double start, double stop, const designs_real* first, const designs_real* last, int depth) {
  const double width = (stop - start)/(DESIGNS_INNER + 1);
  double t[DESIGNS_WITHIN], times[DESIGNS_INNER + LANES];
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_CURVES], place[DESIGNS_SOME(DESIGNS_PLACES)];
  casadi_int near[LANES];
  signed char hiding[DESIGNS_WITHIN], kinks[DESIGNS_WITHIN];
  designs_panel within;
  designs_real *row, x;
  int i, j, k;
  for (k = 0; now->rests && depth >= DESIGNS_BESIDE_REST && k < DESIGNS_CURVES; ++k) {
    if (designs_lacks(now, k, (start + stop)/2)) return;
  }
  within.n = DESIGNS_WITHIN;
  within.stride = DESIGNS_STRIDE;
  within.t = t;
  within.rows = now->inner + depth*DESIGNS_PANEL_ROWS*DESIGNS_STRIDE;
  within.watched = within.rows + (DESIGNS_CURVES + DESIGNS_PLACES)*DESIGNS_STRIDE;
  within.hiding = hiding;
  within.kinks = kinks;
  memset(hiding, 0, sizeof hiding);
  for (j = 0; j < DESIGNS_WITHIN; ++j) t[j] = j <= DESIGNS_INNER ? start + j*width : stop;
  for (j = 0; j < DESIGNS_INNER + LANES; ++j) times[j] = t[j < DESIGNS_INNER ? j + 1 : DESIGNS_INNER];
  for (i = 0; i < DESIGNS_INNER; i += LANES) {
    for (j = 0; j < LANES; ++j) near[j] = designs_near(now, times[i + j]);
    designs_at(now, times + i, near, y);
    designs_curves(y, now->matter, ~0ull, value, place);
    for (k = 0; k < DESIGNS_CURVES; ++k) {
      memcpy(designs_panel_row(&within, k) + 1 + i, value + k, sizeof *value);
      if (!lanes_where_less(now->peaks[designs_of[k]].best, designs_size(value[k])) && !lanes_any_nan(value[k])) continue;
      for (j = 1 + i; j <= DESIGNS_INNER && j < 1 + i + LANES; ++j) {
        x = designs_panel_row(&within, k)[j];
        if ((x < 0 ? -x : x) > now->peaks[designs_of[k]].best) designs_note(now, k, x, t[j], designs_ratio(k, place, j - 1 - i));
        /* What has no value is nothing, and hides what is beside it. */
        if (x - x == 0 || designs_lacks(now, k, (start + stop)/2)) continue;
        hiding[j - 1] = hiding[j] = DESIGNS_HIDES;
        designs_panel_row(&within, k)[j] = 0;
      }
    }
    for (k = 0; k < DESIGNS_PLACES; ++k) memcpy(designs_panel_row(&within, DESIGNS_CURVES + k) + 1 + i, place + k, sizeof *place);
    for (k = 0; k < DESIGNS_WATCHES; ++k) {
      memcpy(within.watched + k*DESIGNS_STRIDE + LANES + 1 + i, y + DESIGNS_OUTPUTS + k, sizeof *y);
    }
  }
  for (k = 0; k < DESIGNS_PANEL_ROWS; ++k) {
    row = within.rows + k*DESIGNS_STRIDE + LANES;
    row[0] = first[k];
    row[DESIGNS_WITHIN - 1] = last[k];
  }
  for (k = 0; now->rests && k < DESIGNS_CURVES; ++k) {
    if (!designs_lacks(now, k, (start + stop)/2)) continue;
    for (j = 0; j < DESIGNS_WITHIN; ++j) designs_panel_row(&within, k)[j] = 0;
  }
  designs_search(now, &within, depth + 1);
}

#if DESIGNS_WATCHES
/* Where between value i of n and the next, in steps from it, a row passes a number: by a polynomial in the values. */
static double designs_where(const designs_real* row, casadi_int i, casadi_int n, designs_real level) {
  const casadi_int first = designs_window(i, n);
  double value[DESIGNS_FIT], place[DESIGNS_FIT];
  int j, k;
  for (k = 0; k < DESIGNS_FIT; ++k) {
    value[k] = (double) row[first + k] - (double) level;
    place[k] = (double) (first + k - i);
  }
  for (j = 1; j < DESIGNS_FIT; ++j) {
    for (k = 0; k < DESIGNS_FIT - j; ++k) place[k] = (value[k + j]*place[k] - value[k]*place[k + 1])/(value[k + j] - value[k]);
  }
  if (place[0] >= 0 && place[0] <= 1) return place[0];
  return ((double) level - (double) row[i])/((double) row[i + 1] - (double) row[i]);
}

static int designs_beyond(int watch, designs_real value, designs_real level) {
  return designs_watch[watch] == DESIGNS_IS_STEP ? value >= level : value > level;
}

/* Evaluate both sides of where one of the watched passes a number in a step; whether they are on both sides. */
static int designs_apart(designs_now* now, const designs_panel* panel, casadi_int step, int watch, designs_real level,
                         designs_sides* sides) {
  const designs_real* row = panel->watched + watch*panel->stride + LANES;
  const double start = panel->t[step], stop = panel->t[step + 1];
  double at, place = designs_where(row, step, panel->n, level), slope = (double) row[step + 1] - (double) row[step], times[3 + LANES];
  double before = 0, was = 0;
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_CURVES], ratio[DESIGNS_SOME(DESIGNS_PLACES)];
  casadi_int near[LANES];
  designs_real ends[3], sum;
  int trial, apart, i, j, k;
  for (trial = 0; trial < DESIGNS_TRIALS && place >= 0 && place <= 1; ++trial) {
    at = start + place*(stop - start);
    for (j = 0; j < 3 + LANES; ++j) {
      times[j] = j == 0 ? at - sides->beside : j == 1 ? at + sides->beside : at;
      times[j] = times[j] < start ? start : times[j] > stop ? stop : times[j];
    }
    sum = 0;
    for (i = 0; i < 3; i += LANES) {
      for (j = 0; j < LANES; ++j) near[j] = designs_near(now, times[i + j]);
      designs_at(now, times + i, near, y);
      designs_curves(y, now->matter, ~0ull, value, ratio);
      for (j = i; j < 3 && j < i + LANES; ++j) {
        for (k = 0; k < DESIGNS_CURVES; ++k) sum += 0*(sides->rows[j][k] = designs_lane(value + k, j - i));
        for (k = 0; k < DESIGNS_PLACES; ++k) sides->rows[j][DESIGNS_CURVES + k] = designs_lane(ratio + k, j - i);
        for (k = 0; k < DESIGNS_WATCHES; ++k) {
          sides->rows[j][DESIGNS_CURVES + DESIGNS_PLACES + k] = designs_lane(y + DESIGNS_OUTPUTS + k, j - i);
        }
      }
    }
    apart = sum == 0;
    for (j = 0; j < 3; ++j) {
      sides->t[j] = times[j];
      ends[j] = sides->rows[j][DESIGNS_CURVES + DESIGNS_PLACES + watch];
      if (j == 2 || times[j] == panel->t[step + j]) continue;
      apart &= designs_beyond(watch, ends[j], level) == designs_beyond(watch, row[step + j], level);
    }
    if (apart) return 1;
    if (trial) slope = ((double) ends[2] - was)/(place - before);
    before = place;
    was = (double) ends[2];
    place += ((double) level - was)/slope;
  }
  return 0;
}
#endif

/* Find a kink or a jump in a step, and what is beside it; whether there is one, and nothing else hides there. */
static int designs_find_sides(designs_now* now, const designs_panel* panel, casadi_int step, designs_sides* sides) {
#if DESIGNS_WATCHES
  const double ago = -panel->t[0], late = panel->t[panel->n - 1], least = DESIGNS_SPACING*(ago > late ? ago : late);
  const double length = (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1);
  designs_real low, high, level;
  int kind, j, k, tried = 0;
  sides->beside = DESIGNS_SIDE*2*now->half;
  if (sides->beside < least) sides->beside = least;
  if (panel->n < DESIGNS_FIT || !panel->kinks[step] || !(panel->t[step + 1] - panel->t[step] > 8*sides->beside)) return 0;
  for (k = 0; k < DESIGNS_WATCHES; ++k) {
    if (designs_watch[k] == DESIGNS_IS_STEP || DESIGNS_NUMBERED(designs_watch[k])) continue;
    j = designs_watch_first[k];
    if (designs_kinks(panel->watched + k*panel->stride + LANES, step, panel->n, designs_watch[k], designs_watch_at + j,
                      designs_watch_first[k + 1] - j, length, 0) == DESIGNS_MANY) return 0;
  }
  for (kind = 0; kind < 2; ++kind) {
    for (k = 0; k < DESIGNS_WATCHES; ++k) {
      const designs_real* row = panel->watched + k*panel->stride + LANES;
      if (kind ? !DESIGNS_NUMBERED(designs_watch[k]) : designs_watch[k] != DESIGNS_IS_STEP) continue;
      low = row[step] < row[step + 1] ? row[step] : row[step + 1];
      high = row[step] < row[step + 1] ? row[step + 1] : row[step];
      if (!(high - low <= DESIGNS_LARGEST) || (!kind && designs_floor(high) != designs_floor(low) + 1)) continue;
      for (j = designs_watch_first[k]; j < (kind ? designs_watch_first[k + 1] : designs_watch_first[k] + 1); ++j) {
        level = kind ? designs_watch_at[j] : designs_floor(high);
        if (designs_beyond(k, low, level) || !designs_beyond(k, high, level)) continue;
        if (tried++ == DESIGNS_WATCHED) return 0;
        if (designs_apart(now, panel, step, k, level, sides)) return 1;
      }
    }
  }
#else
  (void) now; (void) panel; (void) step; (void) sides;
#endif
  return 0;
}

/* Search a step as a panel of its own, or as two if it is known where in it a kink or a jump is. */
static void designs_inside(designs_now* now, const designs_panel* panel, casadi_int step, int depth) {
  const double start = panel->t[step], stop = panel->t[step + 1];
  designs_real first[DESIGNS_PANEL_ROWS], last[DESIGNS_PANEL_ROWS];
  designs_sides sides;
  int j, k, at;
  designs_column(panel, step, first);
  designs_column(panel, step + 1, last);
  if (!designs_find_sides(now, panel, step, &sides)) {
    designs_part(now, start, stop, first, last, depth);
    return;
  }
  for (j = 0; j < 3; ++j) {
    for (k = 0; k < DESIGNS_CURVES; ++k) {
      at = designs_placed[k];
      designs_note(now, k, sides.rows[j][k], sides.t[j], at >= 0 ? sides.rows[j][DESIGNS_CURVES + at] : designs_ratio(k, 0, 0));
    }
  }
  --now->left;
  if (sides.t[0] - start > 2*sides.beside) designs_part(now, start, sides.t[0], first, sides.rows[0], depth);
  if (stop - sides.t[1] > 2*sides.beside) designs_part(now, sides.t[1], stop, sides.rows[1], last, depth);
}

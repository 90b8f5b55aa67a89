/* What is searched: curves over time, by their values at equal steps, and at more times where these leave it open. What curves there
   are, and how they are evaluated, is passed in by the caller: lagrange_casadi_curves and lagrange_casadi_search_call. */
/* Times inside a step that becomes a panel, and with its ends; values of a row of such a panel, two packs beside them. */
#define SEARCH_WITHIN (SEARCH_INNER + 2)
#define SEARCH_STRIDE 64
/* What has no place along a link, and what is at its ends. */
enum { SEARCH_AT_BASE = -1, SEARCH_AT_TIP = -2 };

/* The largest size of a quantity that is known, and at the instants; and the first that is as large but for rounding: its size, with
   its sign, its time and its ratio xi/l. least is what a summit must reach that matters. going is its size where it grows on and no
   end of that is found. base is what values are counted from. Open: not searched. unlocated: the search would take too many
   panels, and has ended. */
typedef struct {
  double t;
  search_real best, rounding, least, limit, sampled, size, place, sign, going, base;
  int open, unlocated;
} search_peak;

/* So many instants, or times inside a step, t, with a row for every curve, its place, and what is watched. hiding becomes, of each
   step, whether something may hide in it, and then whether it was searched. */
typedef struct {
  long long n, stride;
  const double* t;
  search_real *rows, *watched;
  signed char *hiding, *kinks;
} search_panel;

enum { SEARCH_HIDES = 1, SEARCH_DONE = 2 };

/* A search. left are panels that it may still take of a quota; none says which curves are no number at any instant, ignored which of
   the watched hide too much. In a step between instants that is searched, noise is the rounding of what is watched, and sides are those on which it is before and after;
   step is below zero elsewhere, near are columns of times near its ends. inner are rows of panels within each other, columns what such panels
   have at their ends, found what was evaluated last. */
typedef struct {
  const lagrange_casadi_search_call* call;
  const lagrange_casadi_curves* curves;
  const int *quantity, *link, *placed;
  long long n, left, quota, step;
  const double* t;
  double half;
  search_panel all;
  search_peak* peaks;
  search_real *scale, *inner, *columns, *found, *noise, *sides, *near;
  signed char *zigzags, *none, *ignored;
  int ignoring, stopped;
} search_now;

static search_real search_magnitude(search_real x) { return x < 0 ? -x : x; }

static search_real search_upper(search_real x, search_real y) { return x > y ? x : y; }

static search_real search_lower(search_real x, search_real y) { return x < y ? x : y; }

static search_real* search_row(const search_panel* panel, int k) { return panel->rows + k*panel->stride; }

static search_real* search_watched(const search_panel* panel, int k) { return panel->watched + k*panel->stride; }

static double search_width(const search_panel* panel) { return (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1); }

/* The shortest step, so far from zero. */
static double search_spacing(const search_panel* panel) {
  const double ago = -panel->t[0], late = panel->t[panel->n - 1];
  return SEARCH_SPACING*(ago > late ? ago : late);
}

/* How many rows there are: of curves, of their places, of what is watched. */
static int search_rows(const search_now* now) { return now->curves->curves + now->curves->places + now->curves->watches; }

/* Count so many values of a curve from the base of its quantity, which of sizes is zero. */
static void search_count(const search_now* now, int curve, search_real* row, long long many) {
  const search_real base = now->peaks[now->quantity[curve]].base, way = (search_real) now->call->way;
  long long i;
  for (i = 0; i < many; ++i) row[i] = way*row[i] - base;
}

/* Evaluate at up to as many times as go together, into rows that are so far apart. need names links by bits. */
static void search_evaluate(search_now* now, const double* t, int many, unsigned long long need, search_real* rows, long long apart) {
  int k;
  if (now->stopped || now->call->at(now->call->of, many, t, need, rows, apart)) now->stopped = 1;
  for (k = 0; now->call->way && k < now->curves->curves; ++k) search_count(now, k, rows + k*apart, many);
}

static search_real search_found(const search_now* now, int k, int j) { return now->found[k*now->call->together + j]; }

/* What is found at times, in columns one after another. */
static void search_columns_at(search_now* now, const double* t, int many, unsigned long long need, search_real* columns) {
  const int together = now->call->together, rows = search_rows(now);
  int i, j, k;
  for (i = 0; i < many; i += together) {
    search_evaluate(now, t + i, many - i < together ? many - i : together, need, now->found, together);
    for (j = i; j < many && j < i + together; ++j) {
      for (k = 0; k < rows; ++k) columns[j*rows + k] = search_found(now, k, j - i);
    }
  }
}

/* The ratio xi/l of a curve, of rows of places that begin so and are so far apart. */
static search_real search_ratio(const search_now* now, int curve, const search_real* places, long long apart) {
  const int k = now->placed[curve];
  return k >= 0 ? places[k*apart] : k == SEARCH_AT_BASE ? 0 : k == SEARCH_AT_TIP ? 1 : (search_real) NAN;
}

static search_real search_ratio_in(const search_now* now, const search_panel* panel, int curve, long long i) {
  return search_ratio(now, curve, search_row(panel, now->curves->curves) + i, panel->stride);
}

/* A quantity's largest size becomes this; what is nothing beside others of its unit has no limit that a curve could rise above. Where
   local peaks are listed, these matter down to their share of it. */
static void search_grow(const search_now* now, int q, search_real best) {
  search_peak* peak = now->peaks + q;
  const search_real scale = now->scale[now->curves->unit[q]];
  peak->best = best;
  peak->rounding = SEARCH_ROUNDING*(best + SEARCH_BESIDE*scale);
  peak->least = now->call->tops ? (search_real) now->call->share*best : best - peak->rounding;
  peak->limit = !(best > SEARCH_NOTHING*scale) || peak->open || peak->unlocated ? (search_real) INFINITY
                : now->call->tops ? peak->least : best + peak->rounding;
}

/* What a curve must rise above in a step to matter: where local peaks are listed, above both ends too. */
static search_real search_level(const search_now* now, const search_panel* panel, int curve, long long step) {
  const search_peak* peak = now->peaks + now->quantity[curve];
  const search_real* row = search_row(panel, curve) + step;
  const search_real end = search_upper(search_magnitude(row[0]), search_magnitude(row[1]));
  return search_upper(peak->limit, end + peak->rounding);
}

/* Where friction at rest leaves a curve open at an instant, its row holds a zero with a minus sign, which no other value of it has. */
static int search_nothing(search_real x) { return x == 0 && 1/x < 0; }

/* Whether a curve is not sought at a time: in steps beside rest those that are open at an end are left out. */
static int search_lacks(const search_now* now, int curve, double t) {
  const double x = (t - now->t[0])/(2*now->half);
  long long i = x > 0 ? (long long) x : 0;
  const search_real* row = search_row(&now->all, curve) + (i < now->n - 2 ? i : now->n - 2);
  return now->call->rests && now->n > 1 && (search_nothing(row[0]) || search_nothing(row[1]));
}

/* List what a curve is at a time: the largest of what is less than a step apart, and the largest of these where there are many. */
static void search_list_top(search_now* now, int curve, search_real value, double t, search_real place) {
  const int q = now->quantity[curve];
  double *rows = now->call->tops + 4*SEARCH_TOPS*q, *row, *into = rows;
  const double size = (double) search_magnitude(value);
  int j;
  if (!(size >= (double) now->peaks[q].least)) return;
  for (j = 0; j < SEARCH_TOPS; ++j) {
    row = rows + 4*j;
    if (row[0] == curve && t - row[1] <= 2*now->half && row[1] - t <= 2*now->half) {
      into = row;
      break;
    }
    if (row[0] != row[0] || fabs(row[3]) < fabs(into[3])) into = row;
    if (row[0] != row[0]) break;
  }
  if (into[0] == into[0] && fabs(into[3]) >= size) return;
  into[0] = curve;
  into[1] = t;
  into[2] = (double) place;
  into[3] = (double) value;
}

/* Take in what a curve is at a time; what is nothing has its peak at an instant. */
static void search_note(search_now* now, int curve, search_real value, double t, search_real place) {
  search_peak* peak = now->peaks + now->quantity[curve];
  const search_real size = search_magnitude(value);
  if (!(size - size == 0) || search_lacks(now, curve, t)) return;
  if (now->call->tops) search_list_top(now, curve, value, t, place);
  if (size > peak->best) {
    search_grow(now, now->quantity[curve], size);
    if (peak->size >= size - peak->rounding && peak->t < t - now->half) return;
  } else if (!(peak->limit <= SEARCH_LARGEST && size >= peak->best - peak->rounding && t < peak->t - now->half)) {
    return;
  }
  peak->size = size;
  peak->t = t;
  peak->place = place;
  peak->sign = value < 0 ? -1 : 1;
}

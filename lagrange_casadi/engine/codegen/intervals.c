/* What is searched: curves over time, by their values at equal steps, and at more times where these leave it open. What curves there
   are, and how they are evaluated, is passed in by the caller: lagrange_casadi_curves and lagrange_casadi_search_call. */
/* Times inside a step that becomes a panel, and with its ends; values of a row of such a panel, two packs beside them. */
#define SEARCH_WITHIN (SEARCH_INNER + 2)
#define SEARCH_STRIDE 64
/* What has no place along a link, and what is at its ends. */
enum { SEARCH_AT_BASE = -1, SEARCH_AT_TIP = -2 };

/* The largest size of a quantity that is known; and the first that is as large but for rounding: its size, with its sign, its time and
   its ratio xi/l. least is what a summit must reach that matters, going its size where it grows on and no end of that is found, base
   what values are counted from. Open: not searched. unlocated: the search would take too many panels, and has ended. */
typedef struct {
  double t;
  search_real best, rounding, least, limit, size, place, sign, going, base;
  int open, unlocated;
} search_peak;

/* So many instants, or times inside a step, t, with a row for every curve, its place, and what is watched. hiding becomes, of each
   step, whether something may hide in it, and then whether it was searched. */
typedef struct {
  long long n, stride;
  const double* t;
  search_real* rows;
  signed char *hiding, *kinks;
} search_panel;

enum { SEARCH_HIDES = 1, SEARCH_DONE = 2 };

/* A search. left are panels that it may still take of a quota; none says which
   curves are no number at any instant, ignored which of the watched hide too much. In a step between instants that is searched, noise is
   the rounding of what is watched, and sides are those on which it is before and after; step is below zero elsewhere. inner are rows of
   panels within each other, beside those of the sides of kinks in their steps, found those that were evaluated last. */
typedef struct {
  const lagrange_casadi_search_call* call;
  const lagrange_casadi_curves* curves;
  const int* quantity;
  long long left, quota, step;
  double half;
  search_panel all;
  search_peak* peaks;
  search_real *scale, *inner, *beside, *found, *noise, *sides;
  signed char *zigzags, *none, *ignored;
  int ignoring, stopped;
} search_now;

static search_real search_magnitude(search_real x) { return x < 0 ? -x : x; }

static search_real search_upper(search_real x, search_real y) { return x > y ? x : y; }

static search_real search_lower(search_real x, search_real y) { return x < y ? x : y; }

static search_real* search_row(const search_panel* panel, int k) { return panel->rows + k*panel->stride; }

static search_real* search_watched(const search_now* now, const search_panel* panel, int k) {
  return search_row(panel, (int) (now->curves->curves + now->curves->places) + k);
}

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

/* A panel of a few times. */
static search_panel search_few(double* t, long long n, search_real* rows) {
  const search_panel panel = {n, SEARCH_STRIDE, t, rows, 0, 0};
  return panel;
}

/* Evaluate such a panel at so many of its times. need names links by bits. */
static void search_evaluate(search_now* now, const search_panel* panel, int first, int many, unsigned long long need) {
  const int together = now->call->together, last = first + many;
  int i, k, some;
  for (i = first; i < last && !now->stopped; i += together) {
    some = last - i < together ? last - i : together;
    now->stopped = now->call->at(now->call->of, some, panel->t + i, need, panel->rows + i, panel->stride);
  }
  for (k = 0; now->call->way && k < now->curves->curves; ++k) search_count(now, k, search_row(panel, k) + first, many);
}

/* The ratio xi/l of a value of a curve. */
static search_real search_ratio(const search_now* now, const search_panel* panel, int curve, long long i) {
  const int k = now->curves->placed[curve];
  if (k >= 0) return search_row(panel, (int) now->curves->curves + k)[i];
  return k == SEARCH_AT_BASE ? 0 : k == SEARCH_AT_TIP ? 1 : (search_real) NAN;
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
  const double x = (t - now->all.t[0])/(2*now->half);
  long long i = x > 0 ? (long long) x : 0;
  const search_real* row = search_row(&now->all, curve) + (i < now->all.n - 2 ? i : now->all.n - 2);
  return now->call->rests && now->all.n > 1 && (search_nothing(row[0]) || search_nothing(row[1]));
}

/* List a value of a curve: the largest of what is less than a step apart, and the largest of these where there are many. */
static void search_list_top(search_now* now, const search_panel* panel, int curve, long long i) {
  const int q = now->quantity[curve];
  double *rows = now->call->tops + 4*SEARCH_TOPS*q, *row, *into = rows;
  const double t = panel->t[i], value = (double) search_row(panel, curve)[i];
  int j;
  if (!(fabs(value) >= (double) now->peaks[q].least)) return;
  for (j = 0; j < SEARCH_TOPS; ++j) {
    row = rows + 4*j;
    if (row[0] == curve && fabs(t - row[1]) <= 2*now->half) {
      into = row;
      break;
    }
    if (row[0] != row[0] || fabs(row[3]) < fabs(into[3])) into = row;
    if (row[0] != row[0]) break;
  }
  if (into[0] == into[0] && fabs(into[3]) >= fabs(value)) return;
  into[0] = curve;
  into[1] = t;
  into[2] = (double) search_ratio(now, panel, curve, i);
  into[3] = value;
}

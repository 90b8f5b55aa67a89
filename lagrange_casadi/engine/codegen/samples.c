/* Looks at curves where polynomials say that they are largest. */
#define SEARCH_SUMMITS 64
#define SEARCH_ENTRIES (3*SEARCH_SUMMITS)
/* Of a step: times that are one. */
#define SEARCH_SAME_TIME 1e-11

/* A step in which a curve may rise, and to where. */
typedef struct {
  long long step;
  int curve;
  search_real bound;
} search_entry;

/* What of a panel is to be looked at, and what is left open. */
typedef struct {
  search_summit summits[SEARCH_SUMMITS];
  search_entry entries[SEARCH_ENTRIES];
  int looks, open;
} search_list;

/* Look at so many times, each for a curve: the values found there. What is proportional has its summits at the same time, but for
   rounding, and takes no further lane of a pack. */
static void search_look(search_now* now, double step, const double* times, const int* curves, search_real* found, int many) {
  const double same = SEARCH_SAME_TIME*step;
  const int together = now->call->together;
  search_panel panel;
  double t[SEARCH_SUMMITS];
  unsigned long long need;
  int lane[SEARCH_SUMMITS], apart = 0, known, first, j, k;
  for (k = 0; k < many; ++k) {
    known = apart;
    /* No loop that ends early, for compilers make packs of this one. */
    for (j = 0; j < apart; ++j) known = (times[k] - t[j])*(times[k] - t[j]) <= same*same ? j : known;
    lane[k] = known;
    if (known == apart) t[apart++] = times[k];
  }
  for (first = 0; first < apart; first += together) {
    panel = search_few(t + first, apart - first < together ? apart - first : together, now->found);
    need = 0;
    for (k = 0; k < many; ++k) {
      j = now->curves->link[curves[k]];
      if (lane[k] >= first && lane[k] < first + together && j >= 0) need |= 1ull << (j < 63 ? j : 63);
    }
    search_evaluate(now, &panel, 0, (int) panel.n, need);
    for (k = 0; k < many; ++k) {
      j = lane[k] - first;
      if (j < 0 || j >= together) continue;
      found[k] = search_note(now, &panel, curves[k], j) ? search_row(&panel, curves[k])[j] : (search_real) NAN;  /* which closes nothing */
    }
  }
}

/* What a curve's values beside a step are off by rounding. */
static search_real search_noise(const search_now* now, const search_panel* panel, int curve, long long step) {
  const search_peak* peak = now->peaks + now->quantity[curve];
  const search_real off = search_shaken(search_row(panel, curve), step, panel->n, 0);
  return off <= 3*SEARCH_NOISE*(peak->best + SEARCH_BESIDE*now->scale[now->curves->unit[now->quantity[curve]]]) ? off : 0;
}

/* Whether what was found closes both steps beside a summit; else, if it is worth another look, the summit says where. */
static int search_closed(const search_now* now, const search_panel* panel, search_summit* summit, search_real found) {
  const search_peak* peak = now->peaks + now->quantity[summit->curve];
  const search_real rounding = peak->rounding, missed = found - summit->size, off = search_magnitude(missed);
  search_real slope, gain;
  if (summit->broken || !(summit->curve_there < 0 && summit->rough <= rounding - SEARCH_ROUGH*summit->curve_there)) return 0;
  if (!(off <= rounding || off <= -summit->trust*summit->curve_there)) return 0;
  /* What is missed by rounding says nothing of the slope, however near a value is. */
  slope = off <= SEARCH_CLOSE*peak->best ? summit->slope : summit->slope + missed*summit->steep;
  gain = slope*slope/(-2*summit->curve_there);
  if (!(slope - slope == 0) || gain <= rounding) return 1;
  /* At an end from which it falls there is nothing more to find. */
  if ((summit->at == 0 && slope < 0) || (summit->at == panel->n - 1 && slope > 0)) {
    return found < summit->sign*search_row(panel, summit->curve)[summit->at];
  }
  if (search_magnitude(slope) > -summit->curve_there) return 0;
  summit->again = 1;
  summit->t -= search_width(panel)*(double) (slope/summit->curve_there);
  summit->size = found + gain;
  summit->slope = 0;
  return 0;
}

/* Whether a curve is nothing but rounding: it zigzags at the instants, where no kink explains that. */
static int search_rounded(const search_now* now, int curve) {
  const search_panel* all = &now->all;
  const search_real* row = search_row(all, curve);
  search_real bend, before = 0;
  long long i, turns = 0;
  if (all->n < 2*SEARCH_QUIET) return 0;
  for (i = 1; i < all->n - 1; ++i) {
    bend = search_bend(row + i);
    if (!(search_magnitude(bend) > SEARCH_RAGGED*search_upper(search_magnitude(row[i]),
                                                               search_upper(search_magnitude(row[i - 1]), search_magnitude(row[i + 1])))) ||
        search_kinked(now, all, i - 1) || search_kinked(now, all, i)) {
      bend = 0;
    }
    turns += (bend < 0 && before > 0) || (bend > 0 && before < 0);
    before = bend;
  }
  return 2*turns >= all->n;
}

/* Leave a step open in which a curve may rise, unless that is rounding; anywhere, if what was found there was not what was expected. */
static void search_open(search_now* now, const search_panel* panel, search_list* list, int curve, long long step, int anywhere) {
  search_entry* entry = list->entries + list->open;
  const search_real limit = search_level(now, panel, curve, step), noise = search_noise(now, panel, curve, step);
  if (search_switches(now, panel, curve, step)) return;
  entry->curve = curve;
  entry->step = step;
  entry->bound = search_furthest(search_row(panel, curve), step, panel->n);
  if (noise > 0 ? entry->bound <= limit + noise : !anywhere && entry->bound <= limit) return;
  if (now->zigzags[curve] < 0) now->zigzags[curve] = (signed char) search_rounded(now, curve);
  if (now->zigzags[curve]) return;
  if (anywhere) entry->bound = (search_real) INFINITY;
  ++list->open;
}

/* Whether a curve may jump, or have a kink in its slope, between any of the seven values from the first on. A polynomial through these does
   not show that: its sixth difference is zero for a kink at some places. */
static int search_broken(const search_now* now, const search_panel* panel, int curve, long long first) {
  long long i;
  int k;
  for (k = 0; k < now->curves->watches; ++k) {
    if (!search_is_switching(now, k) || now->curves->watch[k] == SEARCH_IS_KNOT) continue;
    if (!search_depends(now, k, now->quantity[curve])) continue;
    for (i = first; i < first + SEARCH_FIT - 1; ++i) if (search_kinks(now, panel, k, i, 0)) return 1;
  }
  return 0;
}

/* Where polynomials through the values around each summit say to look, unless one goes straight on. All are begun, then all solved:
   what is solved waits for divisions, in which the next may begin. */
static void search_aim(const search_now* now, const search_panel* panel, search_list* list) {
  const double step = search_width(panel);
  search_fit fits[SEARCH_SUMMITS/LANES], *fit;
  long long first;
  int j, k, lane;
  for (j = 0; j < list->looks; j += LANES) {
    fit = fits + j/LANES;
    for (lane = 0; lane < LANES; ++lane) {
      const search_summit* summit = list->summits + (j + lane < list->looks ? j + lane : list->looks - 1);
      const search_real* row = search_row(panel, summit->curve);
      first = search_window(summit->at, panel->n);
      for (k = 0; k < SEARCH_FIT; ++k) fit->y[k].lane[lane] = summit->sign*row[first + k];
      search_begin(fit, lane, summit->at, first, panel->n);
    }
  }
  for (j = 0; j < list->looks; j += LANES) search_solve(fits + j/LANES);
  for (j = 0; j < list->looks; ++j) {
    search_summit* summit = list->summits + j;
    const search_peak* peak = now->peaks + now->quantity[summit->curve];
    if (summit->straight) continue;
    fit = fits + j/LANES;
    lane = j % LANES;
    first = search_window(summit->at, panel->n);
    summit->t = panel->t[first] + step*(double) (fit->x.lane[lane] + 3);
    summit->size = fit->size.lane[lane];
    summit->slope = fit->slope.lane[lane];
    summit->curve_there = fit->curve.lane[lane];
    summit->steep = fit->steep.lane[lane];
    summit->rough = fit->rough.lane[lane];
    summit->trust = SEARCH_TRUST;
    summit->broken = search_broken(now, panel, summit->curve, first);
    summit->closed = !summit->broken && summit->curve_there < 0 && summit->rough <= -SEARCH_ROUGH*summit->curve_there &&
                     summit->size + summit->rough < peak->least;
    summit->again = !summit->closed;
  }
}

/* Look for all summits of a list, for some twice; what is left open becomes its entries. */
static void search_settle(search_now* now, const search_panel* panel, search_list* list) {
  double times[SEARCH_SUMMITS];
  search_real found[SEARCH_SUMMITS];
  int curves[SEARCH_SUMMITS], look, many, k;
  search_summit *summit, *const end = list->summits + list->looks;
  long long step;
  search_aim(now, panel, list);
  for (look = 0; look < 2; ++look) {
    many = 0;
    for (summit = list->summits; summit < end; ++summit) {
      if (!summit->again) continue;
      times[many] = summit->t;
      curves[many++] = summit->curve;
    }
    search_look(now, search_width(panel), times, curves, found, many);
    many = 0;
    for (summit = list->summits; summit < end; ++summit) {
      if (!summit->again) continue;
      summit->again = 0;
      summit->closed = search_closed(now, panel, summit, summit->sign*found[many++]);
    }
  }
  for (summit = list->summits; summit < end; ++summit) {
    for (k = 0; k < 2 && !summit->closed; ++k) {
      step = summit->at - 1 + k;
      if (step < 0 || step > panel->n - 2) continue;
      search_open(now, panel, list, summit->curve, step, summit->t >= panel->t[step] && summit->t < panel->t[step + 1]);
    }
  }
  list->looks = 0;
}

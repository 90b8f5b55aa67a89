/* What is known of each quantity, and looks at curves where polynomials say that they are largest. */
#define DESIGNS_SUMMITS 64
#define DESIGNS_ENTRIES (4*DESIGNS_SUMMITS)
#define DESIGNS_LOOKS (5*DESIGNS_SUMMITS)
#define DESIGNS_QUIET 10
/* Of a step: times that are one. */
#define DESIGNS_SAME_TIME 1e-11

/* A step in which a curve may rise, and to where. */
typedef struct {
  casadi_int step;
  int curve;
  designs_real bound;
} designs_entry;

/* An end step through which a polynomial goes straight on: its value in the middle, and how far off that may be. */
typedef struct {
  casadi_int step;
  int curve;
  designs_real middle, off;
} designs_stretched;

/* What of a panel is to be looked at, and what is left open. */
typedef struct {
  designs_summit summits[DESIGNS_SUMMITS];
  designs_stretched stretches[DESIGNS_SUMMITS];
  designs_entry entries[DESIGNS_ENTRIES];
  int looks, ends, open;
} designs_list;

/* A quantity's largest size becomes this; what is nothing beside others of its unit has no limit that a curve could rise above. */
static void designs_grow(const designs_now* now, int q, designs_real best) {
  designs_peak* peak = now->peaks + q;
  const designs_real scale = now->scale[designs_unit[q]];
  peak->best = best;
  peak->rounding = DESIGNS_ROUNDING*(best + DESIGNS_BESIDE*scale);
  peak->limit = best > DESIGNS_NOTHING*scale && !peak->open ? best + peak->rounding : (designs_real) INFINITY;
}

/* Where friction at rest leaves a curve open at an instant, its row holds a zero with a minus sign, which no other value of it has. */
static int designs_nothing(designs_real x) { return x == 0 && 1/x < 0; }

/* Whether a curve is open at an end of the step between instants in which a time is: there it is not sought. */
static int designs_lacks(const designs_now* now, int curve, double t) {
  const designs_real* row = designs_row(now, curve);
  const double x = (t - now->t[0])/(2*now->half);
  casadi_int i = x > 0 ? (casadi_int) x : 0;
  if (!now->rests || now->n < 2) return 0;
  i = i < now->n - 2 ? i : now->n - 2;
  return designs_nothing(row[i]) || designs_nothing(row[i + 1]);
}

/* Take in what a curve is at a time. */
static void designs_note(designs_now* now, int curve, designs_real value, double t, designs_real place) {
  designs_peak* peak = now->peaks + designs_of[curve];
  const designs_real size = value < 0 ? -value : value;
  if (!(size - size == 0) || designs_lacks(now, curve, t)) return;
  if (size > peak->best) {
    designs_grow(now, designs_of[curve], size);
    if (peak->size >= size - peak->rounding && peak->t < t - now->half) return;
  } else if (!(size >= peak->best - peak->rounding && t < peak->t - now->half)) {
    return;
  }
  peak->size = size;
  peak->t = t;
  peak->place = place;
  peak->sign = value < 0 ? -1 : 1;
}

/* The ratio xi/l of a curve, of the places along links and the lane at which it is. */
static designs_real designs_ratio(int curve, const casadi_real* place, int lane) {
  const int k = designs_placed[curve];
  return k >= 0 ? designs_lane(place + k, lane) : k == DESIGNS_AT_BASE ? 0 : k == DESIGNS_AT_TIP ? 1 : (designs_real) NAN;
}

static designs_real designs_ratio_in(const designs_panel* panel, int curve, casadi_int i) {
  const int k = designs_placed[curve];
  if (k >= 0) return designs_panel_row(panel, DESIGNS_CURVES + k)[i];
  return k == DESIGNS_AT_BASE ? 0 : k == DESIGNS_AT_TIP ? 1 : (designs_real) NAN;
}

/* The instant that is nearest to a time. */
static casadi_int designs_near(const designs_now* now, double t) {
  const double x = (t - now->t[0])/(2*now->half) + 0.5;
  const casadi_int i = x > 0 ? (casadi_int) x : 0;
  return i < now->n ? i : now->n - 1;
}

/* Look at so many times, each for a curve: the values found there. What is proportional has its summits at the same time, but for
   rounding, and takes no further lane of a pack. */
static void designs_look(designs_now* now, double step, const double* times, const int* curves, designs_real* found, int many) {
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_CURVES], place[DESIGNS_SOME(DESIGNS_PLACES)];
  const double same = DESIGNS_SAME_TIME*step;
  double t[DESIGNS_LOOKS + LANES];
  casadi_int near[LANES];
  unsigned long long need;
  int lane[DESIGNS_LOOKS], apart = 0, known, first, j, k;
  for (k = 0; k < many; ++k) {
    known = apart;
    /* No loop that ends early, for compilers make packs of this one. */
    for (j = 0; j < apart; ++j) known = (times[k] - t[j])*(times[k] - t[j]) <= same*same ? j : known;
    lane[k] = known;
    if (known == apart) t[apart++] = times[k];
  }
  for (j = 0; apart && j < LANES; ++j) t[apart + j] = t[apart - 1];
  for (first = 0; first < apart; first += LANES) {
    need = 0;
    for (k = 0; k < many; ++k) {
      j = designs_link_of[curves[k]];
      if (lane[k] >= first && lane[k] < first + LANES && j >= 0) need |= 1ull << (j < 63 ? j : 63);
    }
    for (j = 0; j < LANES; ++j) near[j] = designs_near(now, t[first + j]);
    designs_at(now, t + first, near, y);
    designs_curves(y, now->matter, need, value, place);
    for (k = 0; k < many; ++k) {
      j = lane[k] - first;
      if (j < 0 || j >= LANES) continue;
      found[k] = designs_lane(value + curves[k], j);
      designs_note(now, curves[k], found[k], t[lane[k]], designs_ratio(curves[k], place, j));
    }
  }
}

/* What a curve's values beside a step are off by rounding: where third differences are no smaller than second ones. */
static designs_real designs_noise(const designs_now* now, const designs_panel* panel, int curve, casadi_int step) {
  const designs_real* row = designs_panel_row(panel, curve);
  const designs_peak* peak = now->peaks + designs_of[curve];
  designs_real sorted[2][DESIGNS_QUIET], x, median[2];
  casadi_int first = step - DESIGNS_QUIET/2 + 1;
  int j, k, order, count;
  if (panel->n < DESIGNS_QUIET) return 0;
  first = first < 0 ? 0 : first > panel->n - DESIGNS_QUIET ? panel->n - DESIGNS_QUIET : first;
  row += first;
  for (order = 0; order < 2; ++order) {
    count = DESIGNS_QUIET - 2 - order;
    for (j = 0; j < count; ++j) {
      x = order ? row[j + 3] - 3*row[j + 2] + 3*row[j + 1] - row[j] : row[j + 2] - 2*row[j + 1] + row[j];
      x = x < 0 ? -x : x;
      for (k = j; k > 0 && sorted[order][k - 1] > x; --k) sorted[order][k] = sorted[order][k - 1];
      sorted[order][k] = x;
    }
    median[order] = count % 2 ? sorted[order][count/2] : (sorted[order][count/2 - 1] + sorted[order][count/2])/2;
  }
  if (!(median[1] >= median[0])) return 0;
  if (!(median[1] <= DESIGNS_NOISE*(peak->best + DESIGNS_BESIDE*now->scale[designs_unit[designs_of[curve]]]))) return 0;
  return 3*median[1];
}

/* Whether what was found closes both steps beside a summit; else, if it is worth another look, the summit says where. */
static int designs_closed(const designs_now* now, const designs_panel* panel, designs_summit* summit, designs_real found) {
  const designs_peak* peak = now->peaks + designs_of[summit->curve];
  const designs_real rounding = peak->rounding, missed = found - summit->size;
  const designs_real off = missed < 0 ? -missed : missed;
  designs_real slope, gain;
  if (!(summit->curve_there < 0 && summit->rough <= rounding - DESIGNS_ROUGH*summit->curve_there)) return 0;
  if (!(off <= rounding || off <= -summit->trust*summit->curve_there)) return 0;
  /* What is missed by rounding says nothing of the slope, however near a value is. */
  slope = off <= DESIGNS_CLOSE*peak->best ? summit->slope : summit->slope + missed*summit->steep;
  gain = slope*slope/(-2*summit->curve_there);
  if (!(slope - slope == 0) || gain <= rounding) return 1;
  /* At an end from which it falls there is nothing more to find. */
  if ((summit->at == 0 && slope < 0) || (summit->at == panel->n - 1 && slope > 0)) {
    return found < summit->sign*designs_panel_row(panel, summit->curve)[summit->at];
  }
  summit->again = 1;
  summit->t -= (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1)*(double) (slope/summit->curve_there);
  summit->size = found + gain;
  return 0;
}

/* Whether a curve is nothing but rounding: it zigzags at the instants, though between most of them nothing hides. */
static int designs_rounded(const designs_now* now, int curve) {
  const designs_real* row = designs_row(now, curve);
  designs_real bend, before = 0;
  casadi_int i, turns = 0;
  if (now->n < 2*DESIGNS_QUIET || 2*now->hidden > now->n) return 0;
  for (i = 1; i < now->n - 1; ++i) {
    bend = designs_bend(row + i);
    if (!(designs_magnitude(bend) > DESIGNS_RAGGED*designs_upper(designs_magnitude(row[i]),
                                                               designs_upper(designs_magnitude(row[i - 1]), designs_magnitude(row[i + 1]))))) {
      bend = 0;
    }
    turns += (bend < 0 && before > 0) || (bend > 0 && before < 0);
    before = bend;
  }
  return 2*turns >= now->n;
}

/* Leave a step open in which a curve may rise, unless that is rounding; anywhere, if what was found there was not what was expected. */
static void designs_open(designs_now* now, const designs_panel* panel, designs_list* list, int curve, casadi_int step, int anywhere) {
  designs_entry* entry = list->entries + list->open;
  const designs_real limit = now->peaks[designs_of[curve]].limit, noise = designs_noise(now, panel, curve, step);
  entry->curve = curve;
  entry->step = step;
  entry->bound = designs_furthest(designs_panel_row(panel, curve), step, panel->n);
  if (noise > 0 ? entry->bound <= limit + noise : !anywhere && entry->bound <= limit) return;
  if (now->zigzags[curve] < 0) now->zigzags[curve] = (signed char) designs_rounded(now, curve);
  if (now->zigzags[curve]) return;
  if (anywhere) entry->bound = (designs_real) INFINITY;
  ++list->open;
}

/* Where polynomials through the values around each summit say to look. All are begun, then all solved: what is solved waits for
   divisions, in which the next may begin. */
static void designs_aim(const designs_now* now, const designs_panel* panel, designs_list* list) {
  const double step = (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1);
  designs_fit fits[DESIGNS_SUMMITS/LANES], *fit;
  casadi_int first;
  int j, k, lane;
  for (j = 0; j < list->looks; j += LANES) {
    fit = fits + j/LANES;
    for (lane = 0; lane < LANES; ++lane) {
      const designs_summit* summit = list->summits + (j + lane < list->looks ? j + lane : list->looks - 1);
      const designs_real* row = designs_panel_row(panel, summit->curve);
      first = designs_window(summit->at, panel->n);
      for (k = 0; k < DESIGNS_FIT; ++k) fit->y[k][lane] = summit->sign*row[first + k];
      designs_begin(fit, lane, summit->at, first, panel->n);
    }
  }
  for (j = 0; j < list->looks; j += LANES) designs_solve(fits + j/LANES);
  for (j = 0; j < list->looks; ++j) {
    designs_summit* summit = list->summits + j;
    const designs_peak* peak = now->peaks + designs_of[summit->curve];
    fit = fits + j/LANES;
    lane = j % LANES;
    first = designs_window(summit->at, panel->n);
    summit->t = panel->t[first] + step*(double) (fit->x[lane] + 3);
    summit->size = fit->size[lane];
    summit->slope = fit->slope[lane];
    summit->curve_there = fit->curve[lane];
    summit->steep = fit->steep[lane];
    summit->rough = fit->rough[lane];
    summit->trust = fit->x[lane] > -2 && fit->x[lane] < 2 ? DESIGNS_TRUST : DESIGNS_TRUST_ASIDE;
    summit->kinked = 0;
    if (first == summit->at - 3) designs_kink(designs_panel_row(panel, summit->curve) + summit->at, summit, panel->t[summit->at], step);
    summit->closed = summit->curve_there < 0 && summit->rough <= -DESIGNS_ROUGH*summit->curve_there &&
                     summit->size + summit->rough < peak->best - peak->rounding;
  }
}

/* Look for all summits of a list; what is left open becomes its entries. */
static void designs_settle(designs_now* now, const designs_panel* panel, designs_list* list) {
  double times[DESIGNS_LOOKS];
  designs_real found[DESIGNS_LOOKS], off, most, rounding, missed;
  int curves[DESIGNS_LOOKS], many = 0, j, k;
  const double width = (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1);
  casadi_int step;
  designs_aim(now, panel, list);
  for (j = 0; j < list->ends; ++j) {
    step = list->stretches[j].step;
    times[many] = (panel->t[step] + panel->t[step + 1])/2;
    curves[many++] = list->stretches[j].curve;
  }
  for (j = 0; j < list->looks; ++j) {
    const designs_summit* summit = list->summits + j;
    for (k = 0; !summit->closed && k < 1 + 3*summit->kinked; ++k) {
      times[many] = k == 0 ? summit->t : summit->kink_t[k - 1];
      curves[many++] = summit->curve;
    }
  }
  designs_look(now, width, times, curves, found, many);
  for (many = 0; many < list->ends; ++many) {
    const designs_stretched* end = list->stretches + many;
    if (designs_magnitude(found[many] - end->middle) <= end->off) continue;
    designs_open(now, panel, list, end->curve, end->step, 0);
  }
  for (j = 0; j < list->looks; ++j) {
    designs_summit* summit = list->summits + j;
    if (summit->closed) continue;
    summit->again = 0;
    summit->closed = designs_closed(now, panel, summit, summit->sign*found[many++]);
    if (summit->kinked) {
      most = 0;
      for (k = 0; k < 3; ++k) {
        off = summit->sign*found[many++] - summit->kink_size[k];
        off = off < 0 ? -off : off;
        if (!(off <= most)) most = off;
      }
      if (most <= now->peaks[designs_of[summit->curve]].rounding) summit->closed = 1;
    }
  }
  many = 0;
  for (j = 0; j < list->looks; ++j) {
    const designs_summit* summit = list->summits + j;
    if (summit->closed || !summit->again) continue;
    times[many] = summit->t;
    curves[many++] = summit->curve;
  }
  designs_look(now, width, times, curves, found, many);
  many = 0;
  for (j = 0; j < list->looks; ++j) {
    designs_summit* summit = list->summits + j;
    if (!summit->closed && summit->again) {
      rounding = now->peaks[designs_of[summit->curve]].rounding;
      missed = summit->sign*found[many++] - summit->size;
      missed = missed < 0 ? -missed : missed;
      /* What was missed now bends the slope in turn. */
      summit->closed = missed <= rounding || 10*missed*missed*(1 + summit->steep*summit->steep) <= -summit->curve_there*rounding;
    }
    if (summit->closed) continue;
    for (k = 0; k < 2; ++k) {
      step = summit->at - 1 + k;
      if (step < 0 || step > panel->n - 2) continue;
      designs_open(now, panel, list, summit->curve, step,
                   (summit->t >= panel->t[step] && summit->t < panel->t[step + 1]) ||
                   (summit->kinked && summit->kink_t[1] < panel->t[step + 1] && summit->kink_t[2] >= panel->t[step]));
    }
  }
  list->looks = list->ends = 0;
}

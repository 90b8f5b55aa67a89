/* What is largest of each quantity, at the instants and between them: the same search as in summits.py, which see.

   A panel is a row of equal steps with the values at their ends. In each step every curve is bounded; what could rise above the largest
   size so far is looked at, a pack at once: a polynomial through seven values says where, and what it misses there says whether it is to
   be believed. A step that this leaves open, or in which something may hide, becomes a panel of its own. */
#define DESIGNS_SUMMITS 64
#define DESIGNS_ENTRIES (3*DESIGNS_SUMMITS)
#define DESIGNS_QUIET 10
/* Packs that are screened at once. */
#ifndef DESIGNS_CHUNK
#define DESIGNS_CHUNK 8
#endif
#define DESIGNS_WITHIN (DESIGNS_INNER + 2)

/* A step in which a curve may rise, and to where. */
typedef struct {
  casadi_int step;
  int curve;
  designs_real bound;
} designs_entry;

/* What of a panel is to be looked at, and what is left open. */
typedef struct {
  designs_summit summits[DESIGNS_SUMMITS];
  designs_entry entries[DESIGNS_ENTRIES];
  int looks, open;
} designs_list;

static void designs_search(designs_now* now, const designs_panel* panel, int depth);

/* A quantity's largest size becomes this; what is nothing beside others of its unit has no limit that a curve could rise above. */
static void designs_grow(const designs_now* now, int q, designs_real best) {
  designs_peak* peak = now->peaks + q;
  const designs_real scale = now->scale[designs_unit[q]];
  peak->best = best;
  peak->rounding = DESIGNS_ROUNDING*(best + DESIGNS_BESIDE*scale);
  peak->limit = best > DESIGNS_NOTHING*scale && !peak->open ? best + peak->rounding : (designs_real) INFINITY;
}

/* Take in what a curve is at a time. */
static void designs_note(designs_now* now, int curve, designs_real value, double t, designs_real place) {
  designs_peak* peak = now->peaks + designs_of[curve];
  const designs_real size = value < 0 ? -value : value;
  if (!(size - size == 0)) return;
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

/* Look at so many times, each for a curve: the values found there. */
static void designs_look(designs_now* now, const double* times, const int* curves, designs_real* found, int many) {
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_CURVES], place[DESIGNS_SOME(DESIGNS_PLACES)];
  double t[LANES];
  casadi_int near[LANES];
  unsigned long long need;
  int first, j, k;
  for (first = 0; first < many; first += LANES) {
    need = 0;
    for (j = 0; j < LANES; ++j) {
      k = first + j < many ? first + j : many - 1;
      t[j] = times[k];
      near[j] = designs_near(now, t[j]);
      need |= designs_link_of[curves[k]] < 0 ? 0 : 1ull << (designs_link_of[curves[k]] < 63 ? designs_link_of[curves[k]] : 63);
    }
    designs_at(now, t, near, y);
    designs_curves(y, now->matter, need, value, place);
    for (j = 0; j < LANES && first + j < many; ++j) {
      k = curves[first + j];
      found[first + j] = designs_lane(value + k, j);
      designs_note(now, k, found[first + j], t[j], designs_ratio(k, place, j));
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
  const designs_real rounding = now->peaks[designs_of[summit->curve]].rounding, missed = found - summit->size;
  const designs_real off = missed < 0 ? -missed : missed;
  designs_real slope, gain;
  if (!(summit->curve_there < 0 && summit->rough <= rounding - DESIGNS_ROUGH*summit->curve_there)) return 0;
  if (!(off <= rounding || off <= -summit->trust*summit->curve_there)) return 0;
  slope = summit->slope + missed*summit->steep;
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

/* Where polynomials through the values around each summit say to look. */
static void designs_aim(const designs_now* now, const designs_panel* panel, designs_list* list) {
  const double step = (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1);
  designs_fit fit;
  casadi_int first;
  int j, k, lane;
  for (j = 0; j < list->looks; j += LANES) {
    for (lane = 0; lane < LANES; ++lane) {
      const designs_summit* summit = list->summits + (j + lane < list->looks ? j + lane : list->looks - 1);
      const designs_real* row = designs_panel_row(panel, summit->curve);
      first = designs_window(summit->at, panel->n);
      for (k = 0; k < DESIGNS_FIT; ++k) fit.y[k][lane] = summit->sign*row[first + k];
      designs_begin(&fit, lane, summit->at, first, panel->n);
    }
    designs_solve(&fit);
    for (lane = 0; lane < LANES && j + lane < list->looks; ++lane) {
      designs_summit* summit = list->summits + j + lane;
      const designs_peak* peak = now->peaks + designs_of[summit->curve];
      first = designs_window(summit->at, panel->n);
      summit->t = panel->t[first] + step*(double) (fit.x[lane] + 3);
      summit->size = fit.size[lane];
      summit->slope = fit.slope[lane];
      summit->curve_there = fit.curve[lane];
      summit->steep = fit.steep[lane];
      summit->rough = fit.rough[lane];
      summit->trust = fit.x[lane] > -2 && fit.x[lane] < 2 ? DESIGNS_TRUST : DESIGNS_TRUST_ASIDE;
      summit->kinked = 0;
      if (first == summit->at - 3) designs_kink(designs_panel_row(panel, summit->curve) + summit->at, summit, panel->t[summit->at], step);
      summit->closed = summit->curve_there < 0 && summit->rough <= -DESIGNS_ROUGH*summit->curve_there &&
                       summit->size + summit->rough < peak->best - now->peaks[designs_of[summit->curve]].rounding;
    }
  }
}

/* Look for all summits of a list; what is left open becomes its entries. */
static void designs_settle(designs_now* now, const designs_panel* panel, designs_list* list) {
  double times[4*DESIGNS_SUMMITS];
  designs_real found[4*DESIGNS_SUMMITS], off, most, rounding, missed;
  int curves[4*DESIGNS_SUMMITS], many = 0, j, k;
  casadi_int step;
  designs_aim(now, panel, list);
  for (j = 0; j < list->looks; ++j) {
    const designs_summit* summit = list->summits + j;
    for (k = 0; !summit->closed && k < 1 + 3*summit->kinked; ++k) {
      times[many] = k == 0 ? summit->t : summit->kink_t[k - 1];
      curves[many++] = summit->curve;
    }
  }
  designs_look(now, times, curves, found, many);
  many = 0;
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
  designs_look(now, times, curves, found, many);
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
  list->looks = 0;
}

/* What is left in a step that is as short as can be: a kink, a jump, or what grows on without an end. */
static void designs_end(designs_now* now, const designs_panel* panel, int curve, casadi_int step, int deepest) {
  const designs_real* row = designs_panel_row(panel, curve);
  designs_peak* peak = now->peaks + designs_of[curve];
  designs_real size[3], first, second;
  casadi_int at, endless = -1;
  int side, along, k;
  for (k = 0; k < 4; ++k) {
    side = k % 2;
    along = (k < 2) == side ? 1 : -1;
    at = step + side;
    if (along > 0 ? at + 2 >= panel->n : at < 2) continue;
    size[0] = designs_magnitude(row[at]);
    size[1] = designs_magnitude(row[at + along]);
    size[2] = designs_magnitude(row[at + 2*along]);
    /* Towards a pole both steps grow, of two beside this one or of this one and the next; at a jump at most one does. */
    first = size[0] - size[1];
    second = size[1] - size[2];
    if (!(size[0] >= peak->best/2)) continue;
    if (size[2] > DESIGNS_NOISE*size[0] && first > DESIGNS_ENDLESS*size[0] && second > DESIGNS_ENDLESS*size[1]) endless = at;
    if (k < 2 && deepest && first > DESIGNS_LAST*peak->best && second > DESIGNS_LAST*peak->best) {
      peak->going = designs_upper(peak->going, size[0]);
    }
  }
  if (endless < 0) return;
  designs_grow(now, designs_of[curve], (designs_real) INFINITY);
  peak->size = peak->best;
  peak->t = panel->t[endless];
  peak->place = designs_ratio_in(panel, curve, endless);
  peak->sign = row[endless] < 0 ? -1 : 1;
}

/* Search a step as a panel of its own. */
static void designs_zoom(designs_now* now, const designs_panel* panel, casadi_int step, int depth) {
  const double start = panel->t[step], width = (panel->t[step + 1] - start)/(DESIGNS_INNER + 1);
  double t[DESIGNS_WITHIN], times[DESIGNS_INNER + LANES];
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_CURVES], place[DESIGNS_SOME(DESIGNS_PLACES)];
  casadi_int near[LANES];
  signed char hiding[DESIGNS_WITHIN], kinks[DESIGNS_WITHIN];
  designs_panel within;
  designs_real *row, x;
  int first, j, k;
  within.n = DESIGNS_WITHIN;
  within.stride = DESIGNS_STRIDE;
  within.t = t;
  within.rows = now->inner + depth*(DESIGNS_CURVES + DESIGNS_PLACES + DESIGNS_WATCHES)*DESIGNS_STRIDE;
  within.watched = within.rows + (DESIGNS_CURVES + DESIGNS_PLACES)*DESIGNS_STRIDE;
  within.hiding = hiding;
  within.kinks = kinks;
  memset(hiding, 0, sizeof hiding);
  for (j = 0; j < DESIGNS_WITHIN; ++j) t[j] = j <= DESIGNS_INNER ? start + j*width : panel->t[step + 1];
  for (j = 0; j < DESIGNS_INNER + LANES; ++j) times[j] = t[j < DESIGNS_INNER ? j + 1 : DESIGNS_INNER];
  for (first = 0; first < DESIGNS_INNER; first += LANES) {
    for (j = 0; j < LANES; ++j) near[j] = designs_near(now, times[first + j]);
    designs_at(now, times + first, near, y);
    designs_curves(y, now->matter, ~0ull, value, place);
    for (k = 0; k < DESIGNS_CURVES; ++k) {
      memcpy(designs_panel_row(&within, k) + 1 + first, value + k, sizeof *value);
      if (!lanes_any_less(now->peaks[designs_of[k]].best, designs_size(value[k])) && !lanes_any_nan(value[k])) continue;
      for (j = 1 + first; j <= DESIGNS_INNER && j < 1 + first + LANES; ++j) {
        x = designs_panel_row(&within, k)[j];
        if ((x < 0 ? -x : x) > now->peaks[designs_of[k]].best) designs_note(now, k, x, t[j], designs_ratio(k, place, j - 1 - first));
        /* What has no value is nothing, and hides what is beside it. */
        if (x - x == 0) continue;
        hiding[j - 1] = hiding[j] = DESIGNS_HIDES;
        designs_panel_row(&within, k)[j] = 0;
      }
    }
    for (k = 0; k < DESIGNS_PLACES; ++k) memcpy(designs_panel_row(&within, DESIGNS_CURVES + k) + 1 + first, place + k, sizeof *place);
    for (k = 0; k < DESIGNS_WATCHES; ++k) {
      memcpy(within.watched + k*DESIGNS_STRIDE + LANES + 1 + first, y + DESIGNS_OUTPUTS + k, sizeof *y);
    }
  }
  for (k = 0; k < DESIGNS_CURVES + DESIGNS_PLACES; ++k) {
    row = designs_panel_row(&within, k);
    row[0] = designs_panel_row(panel, k)[step];
    row[DESIGNS_WITHIN - 1] = designs_panel_row(panel, k)[step + 1];
  }
  for (k = 0; k < DESIGNS_WATCHES; ++k) {
    row = within.watched + k*DESIGNS_STRIDE + LANES;
    row[0] = (panel->watched + k*panel->stride + LANES)[step];
    row[DESIGNS_WITHIN - 1] = (panel->watched + k*panel->stride + LANES)[step + 1];
  }
  designs_search(now, &within, depth + 1);
}

/* Search a step that is left open, once. */
static void designs_enter(designs_now* now, const designs_panel* panel, casadi_int step, int depth) {
  const double width = (panel->t[panel->n - 1] - panel->t[0])/(double) (panel->n - 1);
  const double ago = -panel->t[0], late = panel->t[panel->n - 1], far = ago > late ? ago : late;
  int k;
  if (panel->hiding[step] & DESIGNS_DONE || now->untold) return;
  panel->hiding[step] |= DESIGNS_DONE;
  if (depth == DESIGNS_DEEPEST || width <= DESIGNS_SPACING*far) {
    for (k = 0; panel->n >= DESIGNS_FIT && k < DESIGNS_CURVES; ++k) {
      if (!(designs_furthest(designs_panel_row(panel, k), step, panel->n) > now->peaks[designs_of[k]].limit)) continue;
      designs_end(now, panel, k, step, depth == DESIGNS_DEEPEST);
    }
  } else if (now->left > 0) {
    --now->left;
    designs_zoom(now, panel, step, depth);
  } else {
    now->untold = 1;
  }
}

/* Look for the summits that are listed, and search the steps that this leaves open, those first in which a curve may rise furthest. */
static void designs_flush(designs_now* now, const designs_panel* panel, designs_list* list, int depth) {
  designs_real rise, most, best;
  int j, chosen;
  if (list->looks) designs_settle(now, panel, list);
  while (list->open) {
    chosen = 0;
    most = -1;
    for (j = 0; j < list->open; ++j) {
      const designs_entry* entry = list->entries + j;
      best = now->peaks[designs_of[entry->curve]].best;
      rise = (entry->bound - now->peaks[designs_of[entry->curve]].limit)/(best > DESIGNS_LEAST ? best : DESIGNS_LEAST);
      if (rise > most) {
        most = rise;
        chosen = j;
      }
    }
    if (!(most > 0)) break;
    designs_enter(now, panel, list->entries[chosen].step, depth);
    list->entries[chosen] = list->entries[--list->open];
  }
  list->open = 0;
}

/* Whether a curve is, all around a step, what others of its quantity are: as one that turns only beyond its link's end. */
static int designs_told_before(const designs_now* now, const designs_panel* panel, int curve, casadi_int step) {
  const designs_real *row = designs_panel_row(panel, curve), rounding = now->peaks[designs_of[curve]].rounding, *other;
  casadi_int i;
  int k, same = 1;
  for (i = step > 0 ? step - 1 : 0; same && i < panel->n && i < step + 3; ++i) {
    same = 0;
    for (k = curve - 1; k >= 0 && designs_of[k] == designs_of[curve]; --k) {
      other = designs_panel_row(panel, k);
      same |= designs_magnitude(other[i] - row[i]) <= rounding;
    }
  }
  return same;
}

/* List what of a step may rise above what is known: a summit beside it, or the step itself. */
static void designs_list_step(designs_now* now, const designs_panel* panel, int curve, casadi_int step, designs_list* list) {
  const designs_real *row = designs_panel_row(panel, curve);
  designs_real size[4];
  casadi_int i;
  int k, topped = 0;
  if (designs_told_before(now, panel, curve, step)) return;
  for (k = 0; k < 4; ++k) {
    i = step - 1 + k;
    size[k] = i < 0 || i >= panel->n ? -1 : row[i] < 0 ? -row[i] : row[i];
  }
  for (k = 1; k < 3; ++k) {
    i = step - 1 + k;
    if (!(size[k - 1] < size[k] && size[k] >= size[k + 1])) continue;
    topped = 1;
    if (list->looks && list->summits[list->looks - 1].curve == curve && list->summits[list->looks - 1].at == i) continue;
    list->summits[list->looks].curve = curve;
    list->summits[list->looks].at = i;
    list->summits[list->looks++].sign = row[i] < 0 ? -1 : 1;
  }
  if (!topped) designs_open(now, panel, list, curve, step, 0);
}

/* List where a curve may rise above what is known, next to some values of which the reach is told. */
static void designs_list_steps(designs_now* now, const designs_panel* panel, int curve, casadi_int first, const casadi_real* reach,
                               designs_list* list, int depth) {
  const designs_real* row = designs_panel_row(panel, curve);
  const casadi_int n = panel->n;
  designs_real limit = now->peaks[designs_of[curve]].limit, lanes[LANES];
  casadi_int i, step;
  int j;
  memcpy(lanes, reach, sizeof lanes);
  for (j = 0; j < LANES && first + j < n; ++j) {
    if (!(lanes[j] > limit)) continue;
    i = first + j;
    for (step = i > 0 && !(j > 0 && lanes[j - 1] > limit) ? i - 1 : i; step <= i && step < n - 1; ++step) {
      if (!(designs_furthest(row, step, n) > limit)) continue;
      designs_list_step(now, panel, curve, step, list);
      if (list->looks < DESIGNS_SUMMITS - 1 && list->open < DESIGNS_SUMMITS) continue;
      designs_flush(now, panel, list, depth);
      limit = now->peaks[designs_of[curve]].limit;
    }
  }
}

/* List where a curve may rise above what is known, a limit. */
static void designs_screen(designs_now* now, const designs_panel* panel, int curve, designs_real limit, designs_list* list, int depth) {
  const designs_real* row = designs_panel_row(panel, curve);
  const casadi_int n = panel->n;
  casadi_real here, before, next, reach[DESIGNS_CHUNK], most;
  casadi_int i;
  int k, many;
  memcpy(&before, row - LANES, sizeof before);
  memcpy(&here, row, sizeof here);
  for (i = 0; i < n; i += DESIGNS_CHUNK*LANES) {
    many = n - i < DESIGNS_CHUNK*LANES ? (int) ((n - i + LANES - 1)/LANES) : DESIGNS_CHUNK;
    most = 0;
    for (k = 0; k < many; ++k) {
      memcpy(&next, row + i + (k + 1)*LANES, sizeof next);
      reach[k] = designs_size(here) + designs_size(DESIGNS_HALF*(lanes_before(before, here) + lanes_after(here, next)) - here);
      most = designs_larger(most, reach[k]);
      before = here;
      here = next;
    }
    if (!lanes_any_less(limit, most)) continue;
    for (k = 0; k < many; ++k) {
      if (lanes_any_less(limit, reach[k])) designs_list_steps(now, panel, curve, i + k*LANES, reach + k, list, depth);
    }
  }
}

/* Beside a row, what bends it there as much again as at the next value. */
static void designs_edge(const designs_panel* panel) {
  const casadi_int n = panel->n;
  designs_real* row;
  int k;
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    row = designs_panel_row(panel, k);
    row[-1] = 4*row[0] - 5*row[1] + 2*row[2];
    row[n] = 4*row[n - 1] - 5*row[n - 2] + 2*row[n - 3];
  }
}

/* Search a panel. */
static void designs_search(designs_now* now, const designs_panel* panel, int depth) {
  designs_list list;
  designs_real limit;
  casadi_int i;
  int q, k;
  list.looks = list.open = 0;
  if (panel->n < DESIGNS_FIT) {
    for (i = 0; i < panel->n - 1; ++i) panel->hiding[i] = DESIGNS_HIDES;
  } else {
    designs_edge(panel);
    designs_hide(panel, depth > 0);
    for (i = 0; depth == 0 && i < panel->n - 1; ++i) now->hidden += panel->hiding[i] & DESIGNS_HIDES;
    for (q = 0; q < DESIGNS_QUANTITIES; ++q) {
      limit = now->peaks[q].limit;
      for (k = designs_first[q]; limit < DESIGNS_LARGEST && k < designs_first[q + 1]; ++k) {
        /* Nowhere does a curve reach further than three times its size. */
        if (depth == 0 && !lanes_any_less(limit, 3*now->most[k])) continue;
        designs_screen(now, panel, k, limit, &list, depth);
      }
    }
    designs_flush(now, panel, &list, depth);
  }
  for (i = 0; i < panel->n - 1; ++i) {
    if (panel->hiding[i] == DESIGNS_HIDES) designs_enter(now, panel, i, depth);
  }
}

/* The largest size of every quantity over the instants, and of every unit. */
static void designs_largest(designs_now* now) {
  designs_real lanes[LANES];
  int j, k;
  for (k = 0; k < DESIGNS_UNITS; ++k) now->scale[k] = 0;
  memset(now->zigzags, -1, sizeof now->zigzags);
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) {
    now->peaks[k].best = 0;
    now->peaks[k].size = -1;
    now->peaks[k].t = INFINITY;
    now->peaks[k].place = (designs_real) NAN;
    now->peaks[k].sign = 1;
    now->peaks[k].going = 0;
    now->peaks[k].open = 0;
  }
  for (k = 0; k < DESIGNS_DOUBTS; ++k) now->peaks[designs_doubtful[k]].open |= designs_is_open(now, designs_doubted[k]);
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    designs_peak* peak = now->peaks + designs_of[k];
    memcpy(lanes, now->most + k, sizeof lanes);
    for (j = 0; j < LANES; ++j) peak->best = lanes[j] > peak->best ? lanes[j] : peak->best;
    peak->sampled = peak->best;
    if (!peak->open && peak->best > now->scale[designs_unit[designs_of[k]]]) now->scale[designs_unit[designs_of[k]]] = peak->best;
  }
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) designs_grow(now, k, now->peaks[k].best);
}

/* The first instant at which a quantity is as large as its peak, but for rounding, if it is before what was found. */
static void designs_sampled(designs_now* now, const designs_panel* panel, int q) {
  designs_peak* peak = now->peaks + q;
  const designs_real least = peak->best - peak->rounding, under = least - DESIGNS_CLOSE*least;
  const designs_real* row;
  designs_real size = -1, x;
  casadi_real pack, most;
  casadi_int i, first = panel->n;
  int k, j, curve = -1;
  if (peak->sampled < least) return;
  for (k = designs_first[q]; k < designs_first[q + 1]; ++k) {
    if (!lanes_any_less(under, now->most[k])) continue;
    row = designs_panel_row(panel, k);
    for (i = 0; i <= first && i < panel->n; i += DESIGNS_CHUNK*LANES) {
      most = 0;
      for (j = 0; j < DESIGNS_CHUNK && i + j*LANES < panel->n; ++j) {
        memcpy(&pack, row + i + j*LANES, sizeof pack);
        most = designs_larger(most, designs_size(pack));
      }
      if (!lanes_any_less(under, most)) continue;
      for (j = 0; j < DESIGNS_CHUNK*LANES && i + j < panel->n && i + j <= first; ++j) {
        x = designs_magnitude(row[i + j]);
        if (!(x >= least) || (i + j == first && !(x > size))) continue;
        first = i + j;
        size = x;
        curve = k;
      }
    }
  }
  if (curve < 0 || !(peak->size < least || panel->t[first] < peak->t - now->half)) return;
  peak->t = panel->t[first];
  peak->place = designs_ratio_in(panel, curve, first);
  peak->sign = designs_panel_row(panel, curve)[first] < 0 ? -1 : 1;
}

/* The peak of every quantity, its time and its place; whether all are told. */
static int designs_peaks(designs_now* now, double* value, double* t, double* xi) {
  designs_peak peaks[DESIGNS_QUANTITIES];
  designs_real scale[DESIGNS_UNITS];
  designs_panel panel;
  int q, told = 1;
  now->peaks = peaks;
  now->scale = scale;
  now->left = DESIGNS_PANELS + 4*now->n;
  now->untold = now->hidden = 0;
  panel.n = now->n;
  panel.stride = now->stride;
  panel.t = now->t;
  panel.rows = now->rows;
  panel.watched = now->rows + (DESIGNS_CHECKED + DESIGNS_CHECKS + 1)*now->stride;
  panel.hiding = now->hiding;
  panel.kinks = now->hiding + now->stride;
  memcpy(now->hiding, now->bent, (size_t) now->n);
  designs_largest(now);
  if (now->n > 1) designs_search(now, &panel, 0);
  for (q = 0; q < DESIGNS_QUANTITIES; ++q) {
    if (peaks[q].open) {
      value[q] = t[q] = xi[q] = NAN;
      continue;
    }
    if (peaks[q].best - peaks[q].best == 0) {
      told &= !(now->untold || peaks[q].going > peaks[q].best/2);
      designs_sampled(now, &panel, q);
    }
    value[q] = peaks[q].sign*peaks[q].best;
    t[q] = peaks[q].t;
    xi[q] = peaks[q].place;
  }
  return told;
}

/* What is largest of each quantity, at the instants and between them: the same search as in summits/search.py, which is the
   reference: tests hold this to it.

   A panel is a row of equal steps with the values at their ends. In each step every curve is bounded; what could rise above the largest
   size so far is looked at, a pack at once: a polynomial through seven values says where, and what it misses there says whether it is to
   be believed. A step that this leaves open, or in which something may hide, becomes a panel of its own. */
/* Packs that are screened at once. */
#ifndef DESIGNS_CHUNK
#define DESIGNS_CHUNK 8
#endif

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
    designs_inside(now, panel, step, depth);
  } else {
    now->untold = 1;
  }
}

/* Look for the summits that are listed, and search the steps that this leaves open, those first in which a curve may rise furthest. */
static void designs_flush(designs_now* now, const designs_panel* panel, designs_list* list, int depth) {
  designs_real rise, most, best;
  int j, chosen;
  if (list->looks || list->ends) designs_settle(now, panel, list);
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

/* Whether a polynomial goes straight on through an end step; then the middle of that is to be looked at. */
static int designs_list_stretch(const designs_now* now, const designs_panel* panel, int curve, casadi_int step, designs_list* list) {
  const designs_real *row = designs_panel_row(panel, curve), rounding = now->peaks[designs_of[curve]].rounding;
  const int inward = step == 0 ? 1 : -1;
  designs_stretched* end = list->stretches + list->ends;
  designs_real least, rough;
  if ((step > 0 && step < panel->n - 2) || designs_kinked(panel, step)) return 0;
  if (step > 0) row += panel->n - 1;
  least = designs_stretch(row, inward, &end->middle);
  rough = row[0] + row[6*inward] - 6*(row[inward] + row[5*inward]) + 15*(row[2*inward] + row[4*inward]) - 20*row[3*inward];
  if (!(least > 0 && designs_magnitude(rough) <= rounding + DESIGNS_ROUGH*least)) return 0;
  end->curve = curve;
  end->step = step;
  end->off = designs_upper(rounding, DESIGNS_STRETCH*least);
  ++list->ends;
  return 1;
}

/* List what of a step may rise above what is known: a summit beside it, or the step itself. */
static void designs_list_step(designs_now* now, const designs_panel* panel, int curve, casadi_int step, designs_list* list) {
  const designs_real *row = designs_panel_row(panel, curve);
  designs_real size[4];
  casadi_int i;
  int k, topped = 0;
  if (designs_told_before(now, panel, curve, step) || designs_list_stretch(now, panel, curve, step, list)) return;
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

/* List where a curve may rise above what is known, beside the values of a pack that say so. */
static void designs_list_steps(designs_now* now, const designs_panel* panel, int curve, casadi_int first, unsigned where,
                               designs_list* list, int depth) {
  const designs_real* row = designs_panel_row(panel, curve);
  const casadi_int n = panel->n;
  designs_real limit = now->peaks[designs_of[curve]].limit;
  casadi_int i, step;
  int j;
  for (j = 0; j < LANES && first + j < n; ++j) {
    if (!(where >> j & 1)) continue;
    i = first + j;
    for (step = i > 0 && !(j > 0 && where >> (j - 1) & 1) ? i - 1 : i; step <= i && step < n - 1; ++step) {
      if (!(designs_furthest(row, step, n) > limit)) continue;
      designs_list_step(now, panel, curve, step, list);
      if (list->looks < DESIGNS_SUMMITS - 1 && list->ends < DESIGNS_SUMMITS && list->open < DESIGNS_SUMMITS) continue;
      designs_flush(now, panel, list, depth);
      limit = now->peaks[designs_of[curve]].limit;
    }
  }
}

/* List where a curve may rise above what is known, a limit. From a value it reaches no further than half of what bends it there takes
   it; where that is towards zero, its neighbours are larger, and known. */
static void designs_screen(designs_now* now, const designs_panel* panel, int curve, designs_real limit, designs_list* list, int depth) {
  const designs_real* row = designs_panel_row(panel, curve);
  const casadi_int n = panel->n;
  casadi_real here, before, after, twice[DESIGNS_CHUNK], most;
  unsigned where;
  casadi_int i;
  int k, many;
  for (i = 0; i < n; i += DESIGNS_CHUNK*LANES) {
    many = n - i < DESIGNS_CHUNK*LANES ? (int) ((n - i + LANES - 1)/LANES) : DESIGNS_CHUNK;
    most = 0;
    for (k = 0; k < many; ++k) {
      memcpy(&before, row + i + k*LANES - 1, sizeof before);
      memcpy(&here, row + i + k*LANES, sizeof here);
      memcpy(&after, row + i + k*LANES + 1, sizeof after);
      twice[k] = designs_size(4*here - (before + after));
      most = designs_larger(most, twice[k]);
    }
    if (!lanes_where_less(2*limit, most)) continue;
    for (k = 0; k < many; ++k) {
      where = lanes_where_less(2*limit, twice[k]);
      if (where) designs_list_steps(now, panel, curve, i + k*LANES, where, list, depth);
    }
  }
}

/* Beside an end, what bends a row there away from zero, twice as much as it is bent at the next value. */
static designs_real designs_beyond_end(designs_real end, designs_real next, designs_real third) {
  const designs_real bend = 2*designs_magnitude(2*next - end - third);
  return 2*end - next - (end < 0 ? -bend : bend);
}

static void designs_edge(const designs_panel* panel) {
  const casadi_int n = panel->n;
  designs_real* row;
  int k;
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    row = designs_panel_row(panel, k);
    row[-1] = designs_beyond_end(row[0], row[1], row[2]);
    row[n] = designs_beyond_end(row[n - 1], row[n - 2], row[n - 3]);
  }
}

/* Search a panel. */
static void designs_search(designs_now* now, const designs_panel* panel, int depth) {
  const signed char *step, *const steps = panel->hiding + panel->n - 1;
  designs_list list;
  designs_real limit;
  casadi_int i;
  int q, k;
  list.looks = list.ends = list.open = 0;
  if (panel->n < DESIGNS_FIT) {
    for (i = 0; i < panel->n - 1; ++i) panel->hiding[i] = DESIGNS_HIDES;
  } else {
    designs_edge(panel);
    designs_hide(panel, depth);
    if (depth == 0) for (i = 0; i < panel->n - 1; ++i) now->hidden += panel->hiding[i] & DESIGNS_HIDES;
    for (q = 0; q < DESIGNS_QUANTITIES; ++q) {
      limit = now->peaks[q].limit;
      for (k = designs_first[q]; limit < DESIGNS_LARGEST && k < designs_first[q + 1]; ++k) {
        /* Nowhere does a curve reach further than three times its size. */
        if (depth == 0 && !lanes_where_less(limit, 3*now->most[k])) continue;
        designs_screen(now, panel, k, limit, &list, depth);
      }
    }
    designs_flush(now, panel, &list, depth);
  }
  for (step = panel->hiding; (step = (const signed char*) memchr(step, DESIGNS_HIDES, (size_t) (steps - step))) != 0; ++step) {
    designs_enter(now, panel, step - panel->hiding, depth);
  }
}

/* Leave out what friction at rest leaves open; a curve that is open at all instants has no number. */
static void designs_leave_out(designs_now* now, signed char* none) {
  const casadi_int padded = (now->n + LANES - 1)/LANES*LANES;
  designs_real lanes[LANES], most, size;
  designs_real* row;
  casadi_int i;
  int j, k;
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    row = designs_row(now, k);
    most = 0;
    none[k] = 1;
    for (i = 0; i < padded; ++i) {
      none[k] &= row[i] != row[i];
      row[i] = row[i] != row[i] ? -(designs_real) 0 : row[i] == 0 ? 0 : row[i];
      size = designs_magnitude(row[i]);
      most = size > most ? size : most;
    }
    for (j = 0; j < LANES; ++j) lanes[j] = most;
    memcpy(now->most + k, lanes, sizeof lanes);
  }
}

/* The largest size of every quantity over the instants, and of every unit. */
static void designs_largest(designs_now* now) {
  designs_real lanes[LANES];
  signed char none[DESIGNS_CURVES];
  int j, k, q;
  memset(none, 0, sizeof none);
  if (now->rests) designs_leave_out(now, none);
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
  for (q = 0; now->rests && q < DESIGNS_QUANTITIES; ++q) {
    for (j = 1, k = designs_first[q]; k < designs_first[q + 1]; ++k) j &= none[k];
    now->peaks[q].open |= j;
  }
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    designs_peak* peak = now->peaks + designs_of[k];
    memcpy(lanes, now->most + k, sizeof lanes);
    for (j = 0; j < LANES; ++j) peak->best = lanes[j] > peak->best ? lanes[j] : peak->best;
    peak->sampled = peak->best;
    if (!peak->open && peak->best > now->scale[designs_unit[designs_of[k]]]) now->scale[designs_unit[designs_of[k]]] = peak->best;
  }
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) designs_grow(now, k, now->peaks[k].best);
}

/* The first instant at which a quantity has a number, as large as its peak but for rounding, if it is before what was found. */
static void designs_sampled(designs_now* now, const designs_panel* panel, int q) {
  designs_peak* peak = now->peaks + q;
  const designs_real least = peak->best - peak->rounding, under = least - DESIGNS_CLOSE*least - DESIGNS_LEAST;
  const designs_real* row;
  designs_real size = -1, x;
  casadi_real pack, most;
  casadi_int i, first = panel->n;
  int k, j, curve = -1;
  if (peak->sampled < least) return;
  for (k = designs_first[q]; k < designs_first[q + 1]; ++k) {
    if (!lanes_where_less(under, now->most[k])) continue;
    row = designs_panel_row(panel, k);
    for (i = 0; i <= first && i < panel->n; i += DESIGNS_CHUNK*LANES) {
      most = 0;
      for (j = 0; j < DESIGNS_CHUNK && i + j*LANES < panel->n; ++j) {
        memcpy(&pack, row + i + j*LANES, sizeof pack);
        most = designs_larger(most, designs_size(pack));
      }
      if (!lanes_where_less(under, most)) continue;
      for (j = 0; j < DESIGNS_CHUNK*LANES && i + j < panel->n && i + j <= first; ++j) {
        x = designs_magnitude(row[i + j]);
        if (!(x >= least) || (i + j == first && !(x > size)) || (now->rests && designs_nothing(row[i + j]))) continue;
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

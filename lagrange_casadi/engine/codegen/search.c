/* The largest size of each quantity over all times of a span, from its values at equal steps and at more times where these leave it open.

   A panel is a row of equal steps with the values at their ends. In each step every curve is bounded; what could rise above the largest
   size so far is looked at, a pack at once: a polynomial through seven values says where, and what it misses there says whether it is to
   be believed. A step that this leaves open, or in which something may hide, becomes a panel of its own, or two where it is known where
   in the step a kink or a jump is, of steps a ninth as long, and so on, until all are closed, or so short that nothing but a jump, a kink
   or a pole is left in them. Where that takes too many panels, or a quantity keeps growing slowly, its peak is not located. */

/* What is left in a step that is as short as can be: a kink, a jump, or what grows on without an end. */
static void search_end(search_now* now, const search_panel* panel, int curve, long long step, int deepest) {
  const search_real* row = search_row(panel, curve);
  search_peak* peak = now->peaks + now->quantity[curve];
  search_real size[3], first, second;
  long long at, endless = -1;
  int side, along, k;
  for (k = 0; k < 4; ++k) {
    side = k % 2;
    along = (k < 2) == side ? 1 : -1;
    at = step + side;
    if (along > 0 ? at + 2 >= panel->n : at < 2) continue;
    size[0] = search_magnitude(row[at]);
    size[1] = search_magnitude(row[at + along]);
    size[2] = search_magnitude(row[at + 2*along]);
    /* Towards a pole both steps grow, of two beside this one or of this one and the next; at a jump at most one does. */
    first = size[0] - size[1];
    second = size[1] - size[2];
    if (!(size[0] >= peak->best/2)) continue;
    if (size[2] > SEARCH_NOISE*size[0] && first > SEARCH_ENDLESS*size[0] && second > SEARCH_ENDLESS*size[1]) endless = at;
    if (k < 2 && deepest && first > SEARCH_LAST*peak->best && second > SEARCH_LAST*peak->best) {
      peak->going = search_upper(peak->going, size[0]);
    }
  }
  if (endless < 0) return;
  search_grow(now, now->quantity[curve], (search_real) INFINITY);
  peak->size = peak->best;
  peak->t = panel->t[endless];
  peak->place = search_ratio(now, panel, curve, endless);
  peak->sign = row[endless] < 0 ? -1 : 1;
}

/* Search one step of a curve, or of all curves if its number is negative. If no panels are left, its peak is not located. */
static void search_enter(search_now* now, const search_panel* panel, int curve, long long step, int depth) {
  int k;
  if (panel->hiding[step] & SEARCH_DONE || now->stopped || (curve < 0 && search_is_ignored(now, panel, step))) return;
  if (depth == SEARCH_DEEPEST || search_width(panel) <= search_spacing(panel)) {
    panel->hiding[step] |= SEARCH_DONE;
    for (k = 0; panel->n >= SEARCH_FIT && k < now->curves->curves; ++k) {
      if (!(search_furthest(search_row(panel, k), step, panel->n) > search_level(now, panel, k, step))) continue;
      search_end(now, panel, k, step, depth == SEARCH_DEEPEST);
    }
  } else if (now->left > 0) {
    panel->hiding[step] |= SEARCH_DONE;
    --now->left;
    if (depth == 0) search_measure(now, step);
    search_inside(now, panel, step, depth);
    if (depth == 0) now->step = -1;
  } else {
    search_give_up(now, panel, curve, step);
  }
}

/* Look for the summits that are listed, and search the steps that this leaves open, those first in which a curve may rise furthest. */
static void search_flush(search_now* now, const search_panel* panel, search_list* list, int depth) {
  search_real rise, most, best;
  int j, chosen;
  if (list->looks) search_settle(now, panel, list);
  while (list->open) {
    chosen = 0;
    most = -1;
    for (j = 0; j < list->open; ++j) {
      const search_entry* entry = list->entries + j;
      best = now->peaks[now->quantity[entry->curve]].best;
      rise = (entry->bound - now->peaks[now->quantity[entry->curve]].limit)/(best > SEARCH_LEAST ? best : SEARCH_LEAST);
      if (rise > most) {
        most = rise;
        chosen = j;
      }
    }
    if (!(most > 0)) break;
    search_enter(now, panel, list->entries[chosen].curve, list->entries[chosen].step, depth);
    list->entries[chosen] = list->entries[--list->open];
  }
  list->open = 0;
}

/* Whether a curve is, all around a step, what others of its quantity are: as one that turns only beyond its link's end. */
static int search_located_before(const search_now* now, const search_panel* panel, int curve, long long step) {
  const search_real *row = search_row(panel, curve), rounding = now->peaks[now->quantity[curve]].rounding, *other;
  long long i;
  int k, same = 1;
  for (i = step > 0 ? step - 1 : 0; same && i < panel->n && i < step + 3; ++i) {
    same = 0;
    for (k = curve - 1; k >= 0 && now->quantity[k] == now->quantity[curve]; --k) {
      other = search_row(panel, k);
      same |= search_magnitude(other[i] - row[i]) <= rounding;
    }
  }
  return same;
}

/* List what of a step may rise above what is known: a summit beside it, or the step itself. */
static void search_list_step(search_now* now, const search_panel* panel, int curve, long long step, search_list* list) {
  const search_real *row = search_row(panel, curve), rounding = now->peaks[now->quantity[curve]].rounding;
  const long long last = panel->n - 1;
  search_summit* summit = list->summits + list->looks;
  search_real size[4];
  long long i;
  int k, topped = 0;
  if (search_switches(now, panel, curve, step) || search_located_before(now, panel, curve, step)) return;
  summit->curve = curve;
  summit->straight = (step == 0 || step == last - 1) && !search_kinked(now, panel, step) &&
                     search_straight(step == 0 ? row : row + last, step == 0 ? 1 : -1, rounding, summit);
  if (summit->straight) {
    summit->at = step == 0 ? 0 : last;
    summit->t = (panel->t[step] + panel->t[step + 1])/2;
    summit->closed = summit->broken = 0;
    summit->again = 1;
    ++list->looks;
    return;
  }
  for (k = 0; k < 4; ++k) {
    i = step - 1 + k;
    size[k] = i < 0 || i > last ? -1 : search_magnitude(row[i]);
  }
  for (k = 1; k < 3; ++k) {
    i = step - 1 + k;
    if (!(size[k - 1] < size[k] && size[k] >= size[k + 1])) continue;
    topped = 1;
    if (list->looks && summit[-1].curve == curve && summit[-1].at == i && !summit[-1].straight) continue;
    summit->curve = curve;
    summit->straight = 0;
    summit->at = i;
    summit->sign = row[i] < 0 ? -1 : 1;
    ++list->looks;
    ++summit;
  }
  if (!topped) search_open(now, panel, list, curve, step, 0);
}

/* List where a curve may rise above what is known, beside the values of a pack that say so. */
static void search_list_steps(search_now* now, const search_panel* panel, int curve, long long first, unsigned where,
                               search_list* list, int depth) {
  const search_real* row = search_row(panel, curve);
  const long long n = panel->n;
  long long i, step;
  int j;
  for (j = 0; j < LANES && first + j < n; ++j) {
    if (!(where >> j & 1)) continue;
    i = first + j;
    for (step = i > 0 && !(j > 0 && where >> (j - 1) & 1) ? i - 1 : i; step <= i && step < n - 1; ++step) {
      if (!(search_furthest(row, step, n) > search_level(now, panel, curve, step))) continue;
      search_list_step(now, panel, curve, step, list);
      if (list->looks < SEARCH_SUMMITS - 1 && list->open < SEARCH_SUMMITS) continue;
      search_flush(now, panel, list, depth);
    }
  }
}

/* Twice how far a row reaches from a pack of its values by what bends it there. */
LANES_INLINE lanes_pack search_reach(const search_real* row) {
  lanes_pack before, here, after;
  memcpy(&before, row - 1, sizeof before);
  memcpy(&here, row, sizeof here);
  memcpy(&after, row + 1, sizeof after);
  return lanes_size(4*here - (before + after));
}

/* List where a curve may rise above what is known, a limit. From a value it reaches no further than half of what bends it there takes
   it; where that is towards zero, its neighbours are larger, and known. */
LANES_INLINE void search_screen(search_now* now, const search_panel* panel, int curve, search_real limit, search_list* list, int depth) {
  const search_real* row = search_row(panel, curve);
  const long long n = panel->n;
  unsigned where;
  long long i;
  for (i = 0; i < n; i += LANES) {
    where = lanes_where_less(2*limit, search_reach(row + i));
    if (where) search_list_steps(now, panel, curve, i, where, list, depth);
  }
}

/* Beside an end, what bends a row there away from zero, twice as much as it is bent at the next value. */
static search_real search_beyond_end(search_real end, search_real next, search_real third) {
  const search_real bend = 2*search_magnitude(2*next - end - third);
  return 2*end - next - (end < 0 ? -bend : bend);
}

static void search_edge(const search_now* now, const search_panel* panel) {
  const long long n = panel->n;
  search_real* row;
  int k;
  for (k = 0; k < now->curves->curves; ++k) {
    row = search_row(panel, k);
    row[-1] = search_beyond_end(row[0], row[1], row[2]);
    row[n] = search_beyond_end(row[n - 1], row[n - 2], row[n - 3]);
  }
}

/* Search a panel. */
LANES_INLINE void search_panel_of(search_now* now, const search_panel* panel, int depth) {
  const signed char *step, *const steps = panel->hiding + panel->n - 1;
  search_list list;
  search_real limit;
  long long i;
  int q, k;
  list.looks = list.open = 0;
  if (panel->n < SEARCH_FIT) {
    for (i = 0; i < panel->n - 1; ++i) panel->hiding[i] = SEARCH_HIDES;
  } else {
    search_edge(now, panel);
    search_hide(now, panel, depth);
    for (q = 0; q < now->curves->quantities; ++q) {
      limit = now->peaks[q].limit;
      for (k = now->curves->first[q]; limit < SEARCH_LARGEST && k < now->curves->first[q + 1]; ++k) {
        /* Nowhere does a curve reach further than three times its size. */
        if (depth == 0 && !(limit < 3*now->call->most[k])) continue;
        search_screen(now, panel, k, limit, &list, depth);
      }
    }
    search_flush(now, panel, &list, depth);
  }
  for (step = panel->hiding; (step = (const signed char*) memchr(step, SEARCH_HIDES, (size_t) (steps - step))) != 0; ++step) {
    search_enter(now, panel, -1, step - panel->hiding, depth);
  }
}

/* Leave out what friction at rest leaves open, and take the largest sizes of the rest; a curve that is open at all instants has no
   number. */
static void search_leave_out(search_now* now) {
  const long long padded = (now->all.n + LANES - 1)/LANES*LANES;
  search_real most;
  search_real* row;
  long long i;
  int k;
  for (k = 0; k < now->curves->curves; ++k) {
    row = search_row(&now->all, k);
    most = 0;
    now->none[k] = 1;
    for (i = 0; i < padded; ++i) {
      now->none[k] &= row[i] != row[i];
      row[i] = row[i] != row[i] ? -(search_real) 0 : row[i] == 0 ? 0 : row[i];
      most = search_upper(most, search_magnitude(row[i]));
    }
    now->call->most[k] = most;
  }
}

/* Count values from so far below the least at the instants that only what is largest goes far: sizes are values then. */
static void search_one_way(search_now* now) {
  const long long padded = (now->all.n + LANES - 1)/LANES*LANES;
  search_real low, high, x, *row;
  long long i;
  int k, q;
  for (q = 0; q < now->curves->quantities; ++q) {
    low = SEARCH_LARGEST;
    high = -SEARCH_LARGEST;
    for (k = now->curves->first[q]; k < now->curves->first[q + 1]; ++k) {
      for (row = search_row(&now->all, k), i = 0; i < now->all.n; ++i) {
        x = (search_real) now->call->way*row[i];
        if (x < low) low = x;
        if (x > high) high = x;
      }
    }
    now->peaks[q].base = low <= high ? 2*low - high : 0;
    for (k = now->curves->first[q]; k < now->curves->first[q + 1]; ++k) search_count(now, k, search_row(&now->all, k), padded);
  }
}

/* The largest size of every quantity over the instants, and of every unit. */
static void search_largest(search_now* now) {
  const lagrange_casadi_curves* curves = now->curves;
  int j, k, q;
  memset(now->none, 0, (size_t) curves->curves);
  memset(now->ignored, 0, (size_t) curves->watches);
  memset(now->peaks, 0, (size_t) curves->quantities*sizeof *now->peaks);
  if (now->call->way) search_one_way(now);
  if (now->call->way || now->call->rests) search_leave_out(now);
  for (k = 0; k < curves->units; ++k) now->scale[k] = now->call->scales ? now->call->scales[k] : 0;
  memset(now->zigzags, -1, (size_t) curves->curves);
  for (q = 0; q < curves->quantities; ++q) {
    search_peak* peak = now->peaks + q;
    peak->size = -1;
    peak->t = INFINITY;
    peak->place = (search_real) NAN;
    peak->sign = 1;
    peak->open = now->call->open && now->call->open[q];
    for (j = now->call->rests, k = curves->first[q]; k < curves->first[q + 1]; ++k) {
      j &= now->none[k];
      peak->best = search_upper(now->call->most[k], peak->best);
    }
    peak->open |= j;
    if (!peak->open) now->scale[curves->unit[q]] = search_upper(peak->best, now->scale[curves->unit[q]]);
  }
  for (q = 0; q < curves->quantities; ++q) search_grow(now, q, now->peaks[q].best);
}

/* How much larger than at the instants quantities may be between them: as far as what bends their curves takes these, for which a
   panel is screened, and not known where something may hide. */
static void search_errors(search_now* now) {
  const search_panel* all = &now->all;
  const long long n = now->all.n;
  lanes_pack twice, other;
  search_real far, nothing, lane[LANES];
  long long i;
  int hides = n > 1, j, k, q;
  if (n >= SEARCH_FIT) {
    search_edge(now, all);
    search_hide(now, all, 0);
    hides = memchr(all->hiding, SEARCH_HIDES, (size_t) (n - 1)) != 0;
  }
  for (q = 0; q < now->curves->quantities; ++q) {
    search_peak* peak = now->peaks + q;
    nothing = SEARCH_NOTHING*now->scale[now->curves->unit[q]];
    far = peak->best;
    twice = other = 2*far;
    for (k = now->curves->first[q]; n > 1 && !hides && k < now->curves->first[q + 1]; ++k) {
      const search_real* row = search_row(all, k);
      if (!(peak->best < 3*now->call->most[k])) continue;
      for (i = 0; i + 2*LANES <= n; i += 2*LANES) {
        twice = lanes_larger(twice, search_reach(row + i));
        other = lanes_larger(other, search_reach(row + i + LANES));
      }
      for (; i < n; ++i) far = search_upper(far, search_magnitude(4*row[i] - (row[i - 1] + row[i + 1]))/2);
    }
    twice = lanes_larger(twice, other);
    memcpy(lane, &twice, sizeof lane);
    for (j = 0; j < LANES; ++j) far = search_upper(far, lane[j]/2);
    now->call->error[q] = hides ? (search_real) INFINITY : peak->best > nothing ? far - peak->best + peak->rounding : nothing;
    if (peak->open) now->call->error[q] = NAN;
  }
}

/* The first instant at which a quantity has a number, as large as its peak but for rounding, if it is before what was found. */
static void search_sampled(search_now* now, int q) {
  const search_panel* all = &now->all;
  search_peak* peak = now->peaks + q;
  const search_real least = peak->best - peak->rounding, under = least - SEARCH_CLOSE*least - SEARCH_LEAST;
  const search_real* row;
  search_real size = -1, x;
  lanes_pack pack;
  long long i, at, first = all->n;
  unsigned where;
  int k, curve = -1;
  for (k = now->curves->first[q]; k < now->curves->first[q + 1]; ++k) {
    if (!(under < now->call->most[k])) continue;
    row = search_row(all, k);
    for (i = 0; i <= first && i < all->n; i += LANES) {
      memcpy(&pack, row + i, sizeof pack);
      where = lanes_where_less(under, lanes_size(pack));
      for (at = i; where >> (at - i) && at < all->n && at <= first; ++at) {
        x = search_magnitude(row[at]);
        if (!(x >= least) || (at == first && !(x > size)) || (now->call->rests && search_nothing(row[at]))) continue;
        first = at;
        size = x;
        curve = k;
      }
    }
  }
  if (curve < 0 || !(peak->size < least || all->t[first] < peak->t - now->half)) return;
  peak->t = all->t[first];
  peak->place = search_ratio(now, all, curve, first);
  peak->sign = search_row(all, curve)[first] < 0 ? -1 : 1;
}

/* Whether an instant is one that a curve has a local peak at: SEARCH_FLAT where it is level on both sides but for rounding. */
enum { SEARCH_NO_TOP, SEARCH_FLAT, SEARCH_TOP };
static int search_top_at(const search_now* now, int curve, long long i) {
  const search_peak* peak = now->peaks + now->quantity[curve];
  const search_real* row = search_row(&now->all, curve) + i;
  const search_real size = search_magnitude(row[0]), rounding = peak->rounding;
  const search_real before = i > 0 ? search_magnitude(row[-1]) : -1, after = i + 1 < now->all.n ? search_magnitude(row[1]) : -1;
  if (!(size >= peak->least && size >= before - rounding && size >= after - rounding)) return SEARCH_NO_TOP;
  if (now->call->rests && search_nothing(row[0])) return SEARCH_NO_TOP;
  return size - before > rounding || size - after > rounding ? SEARCH_TOP : SEARCH_FLAT;
}

/* List the local peaks at instants too, of what is level some, and leave of all what is a step's largest and far from larger ones. */
static void search_tops(search_now* now) {
  const search_panel* all = &now->all;
  const double way = now->call->way, step = 2*now->half;
  const search_peak* peak;
  const search_real* row;
  search_real size;
  double *rows, *one, *other;
  long long i, flat, every;
  int j, k, q, top;
  for (k = 0; k < now->curves->curves; ++k) {
    peak = now->peaks + now->quantity[k];
    if (peak->open) continue;
    for (flat = i = 0; i < now->all.n; ++i) flat += search_top_at(now, k, i) == SEARCH_FLAT;
    every = peak->limit <= SEARCH_LARGEST ? 1 + 2*flat/SEARCH_TOPS : now->all.n;
    for (flat = i = 0; i < now->all.n; ++i) {
      top = search_top_at(now, k, i);
      if (top == SEARCH_NO_TOP || (top == SEARCH_FLAT && flat++ % every)) continue;
      search_list_top(now, all, k, i);
    }
  }
  for (q = 0; q < now->curves->quantities; ++q) {
    peak = now->peaks + q;
    rows = now->call->tops + 4*SEARCH_TOPS*q;
    for (one = rows; one < rows + 4*SEARCH_TOPS; one += 4) {
      if (one[0] != one[0]) continue;
      row = search_row(all, (int) one[0]);
      i = (long long) ((one[1] - all->t[0])/step);
      i = i < 0 || now->all.n < 2 ? 0 : i < now->all.n - 2 ? i : now->all.n - 2;
      size = (search_real) fabs(one[3]) + peak->rounding;
      if (peak->open || !(size >= peak->least && size >= search_magnitude(row[i]) &&
                         (now->all.n < 2 || size >= search_magnitude(row[i + 1]))) || (way != 0 && one[3] < 0)) one[0] = NAN;
      for (j = 0; j < SEARCH_TOPS; ++j) {
        other = rows + 4*j;
        if (other != one && other[0] == one[0] && fabs(other[1] - one[1]) <= step && fabs(other[3]) >= fabs(one[3])) one[0] = NAN;
      }
    }
    for (one = rows; one < rows + 4*SEARCH_TOPS; one += 4) {
      one[0] -= now->curves->first[q];
      if (way != 0) one[3] = way*(one[3] + (double) peak->base);
    }
  }
}

static char* search_take(char** room, long long count, size_t size) {
  char* here = *room;
  *room += ((size_t) count*size + 63)/64*64;
  return here;
}

/* Lay a search into its room, and say how many bytes that takes. */
static void search_lay(search_now* now, lagrange_casadi_search_call* call) {
  const lagrange_casadi_curves* curves = call->curves;
  const long long rows = curves->curves + curves->places + curves->watches;
  char* room = call->room;
  now->peaks = (search_peak*) search_take(&room, curves->quantities, sizeof *now->peaks);
  now->scale = (search_real*) search_take(&room, curves->units, sizeof *now->scale);
  now->inner = (search_real*) search_take(&room, SEARCH_DEEPEST*rows*SEARCH_STRIDE, sizeof *now->inner);
  now->beside = (search_real*) search_take(&room, SEARCH_DEEPEST*rows*SEARCH_STRIDE, sizeof *now->beside);
  now->found = (search_real*) search_take(&room, rows*SEARCH_STRIDE, sizeof *now->found);
  now->zigzags = (signed char*) search_take(&room, curves->curves, 1);
  now->none = (signed char*) search_take(&room, curves->curves, 1);
  now->ignored = (signed char*) search_take(&room, curves->watches, 1);
  now->noise = (search_real*) search_take(&room, curves->watches, sizeof *now->noise);
  now->sides = (search_real*) search_take(&room, 2*curves->watches, sizeof *now->sides);
  call->size = room - call->room;
}

/* The peak of every quantity of n instants t in equal steps: its value, its time and its place, NaN for what is open, and whether it is
   located. Where way is 1 or -1, the peak of a quantity is the largest of its values times that, else of its size. Where error is not
   NULL, peaks are those at the instants, and it becomes how much larger quantities may be between them. tops, unless it is NULL, is NAN
   and becomes for each quantity SEARCH_TOPS local peaks down to a share of the largest: the number of the curve among the quantity's own,
   which is NAN where there are no more, time, ratio and value. rows are those of curves, of their places and of what is watched, stride
   values apart, filled up to whole packs by the last instant or NaN; what rests is NaN. most are the largest sizes of curves at the
   instants. scales, unless it is NULL, says how large others are of each unit, hiding in which steps something is known to hide; it has
   twice stride values. at evaluates up to so many times together, and may write as many values of each row of its out; unless it returns
   0, the search ends. Where room is NULL, nothing is searched, and size becomes how many bytes of it a search takes. */
LAGRANGE_CASADI_EXPORT void lagrange_casadi_search(lagrange_casadi_search_call* call) {
  const lagrange_casadi_curves* curves = call->curves;
  const search_panel all = {call->n, call->stride, call->t, call->rows, call->hiding, call->hiding + call->stride};
  search_now now;
  search_peak* peak;
  int q;
  search_lay(&now, call);
  if (!call->room) return;
  now.call = call;
  now.curves = curves;
  now.quantity = curves->quantity;
  now.half = call->n > 1 ? (call->t[call->n - 1] - call->t[0])/(double) (2*(call->n - 1)) : 1;
  now.left = now.quota = SEARCH_PANELS + 4*call->n;
  now.ignoring = now.stopped = 0;
  now.step = -1;
  now.all = all;
  search_largest(&now);
  if (call->error) search_errors(&now);
  else if (call->n > 1) search_panel_of(&now, &now.all, 0);
  for (q = 0; q < curves->quantities; ++q) {
    peak = now.peaks + q;
    call->located[q] = 1;
    if (peak->open) {
      call->value[q] = call->peak_t[q] = call->xi[q] = NAN;
      continue;
    }
    if (peak->best - peak->best == 0) {
      call->located[q] = !(peak->unlocated || now.stopped || peak->going > peak->best/2);
      search_sampled(&now, q);
    }
    call->value[q] = call->way ? call->way*(peak->sign*peak->best + peak->base) : peak->sign*peak->best;
    call->peak_t[q] = peak->t;
    call->xi[q] = peak->place;
  }
  if (call->tops) search_tops(&now);
}

/* What is largest of each quantity between instants. A polynomial through seven instants around each summit says where to look: a
   pack looks for several summits at once. Where it does not say well, as at a kink or a jump, what encloses the summit is cut ever
   smaller, by the same means. */
#define DESIGNS_EACH 8
#define DESIGNS_CUTS 8
#define DESIGNS_SAME 1e-6
/* Quantities whose summits are looked at together: as many as a thread has room for. */
#define DESIGNS_BATCH 64

/* A quantity that may be largest between low and high: where it is largest so far, t, and its size there and at both ends. */
typedef struct {
  int quantity, open;
  casadi_int near;
  double t, low, high;
  designs_real sign, size, size_low, size_high, place, expected, rounding;
} designs_summit;

/* What was found at a time: it encloses a summit more closely, or is a higher one. Of two that are all but at the same time neither
   encloses: the summit may be on either side. */
static void designs_note(designs_summit* summit, double t, designs_real size, designs_real place) {
  const double beside = DESIGNS_SAME*(summit->high - summit->low), after = t - summit->t;
  const int higher = size > summit->size;
  if (!(t > summit->low && t < summit->high) || !(size - size == 0)) return;
  if (after > beside) {
    if (higher) {
      summit->low = summit->t;
      summit->size_low = summit->size;
    } else {
      summit->high = t;
      summit->size_high = size;
    }
  } else if (after < -beside) {
    if (higher) {
      summit->high = summit->t;
      summit->size_high = summit->size;
    } else {
      summit->low = t;
      summit->size_low = size;
    }
  }
  if (!higher) return;
  summit->t = t;
  summit->size = size;
  summit->place = place;
}

/* Look at several places, for a summit each; and tell all hints that are open what is there for them. */
static void designs_try(const designs_now* now, designs_summit* summits, designs_summit* hints, int count, designs_look* looks,
                        int many) {
  casadi_real y[DESIGNS_COLUMNS], value[DESIGNS_QUANTITIES], place[DESIGNS_SOME(DESIGNS_PLACES)];
  designs_real at;
  double t[LANES];
  casadi_int near[LANES];
  unsigned long long need;
  int first, j, k, q;
  for (first = 0; first < many; first += LANES) {
    need = 0;
    for (j = 0; j < LANES; ++j) {
      const designs_look* look = looks + (first + j < many ? first + j : many - 1);
      t[j] = look->t;
      near[j] = summits[look->summit].near;
      q = summits[look->summit].quantity - DESIGNS_PLAIN;
      if (q >= 0) need |= 1ull << (q/3 < 63 ? q/3 : 63);
    }
    designs_at(now, t, near, y);
    designs_quantities(y, now->matter, count > 0 ? ~0ull : need, value, place);
    for (j = 0; j < LANES && first + j < many; ++j) {
      designs_look* look = looks + first + j;
      q = summits[look->summit].quantity;
      look->found = summits[look->summit].sign*designs_lane(value + q, j);
      look->place = q < DESIGNS_PLAIN ? 0 : designs_lane(place + q - DESIGNS_PLAIN, j);
      for (k = 0; k < count; ++k) {
        if (!hints[k].open) continue;
        q = hints[k].quantity;
        at = q < DESIGNS_PLAIN ? 0 : designs_lane(place + q - DESIGNS_PLAIN, j);
        designs_note(hints + k, t[j], hints[k].sign*designs_lane(value + q, j), at);
      }
    }
  }
}

/* Take in what was found for a summit, and whether that settles it. If a polynomial said well what is there, but not yet well enough,
   look is where it says to look again. */
static int designs_settled(designs_summit* summit, designs_look* look) {
  const designs_real missed = look->found - look->size, off = missed < 0 ? -missed : missed;
  designs_real slope, gain;
  designs_note(summit, look->t, look->found, look->place);
  if (look->last) {
    /* What was missed now bends the slope in turn. */
    return off <= summit->rounding || 10*off*off*(1 + look->steep*look->steep) <= -look->curve*summit->rounding;
  }
  if (!(look->rough <= summit->rounding - (designs_real) 0.1*look->curve)) return 0;
  if (!(look->curve < 0) || !(off <= summit->rounding || off <= -look->trust*look->curve)) return 0;
  slope = look->slope + missed*look->steep;
  gain = slope*slope/(-2*look->curve);
  if (!(slope - slope == 0) || gain <= summit->rounding) return 1;
  /* At an end of all instants from which it falls there is nothing more to find. */
  if (summit->t == summit->low && slope < 0 && look->found < summit->size) return 1;
  if (summit->t == summit->high && slope > 0 && look->found < summit->size) return 1;
  look->last = 1;
  look->t -= look->step*(double) (slope/look->curve);
  look->size = look->found + gain;
  return 0;
}

/* Enclose a summit by the neighbours of the largest of values at equal steps, or of where it is, if that is larger. */
static void designs_enclose(designs_summit* summit, const designs_look* looks, const designs_real* y) {
  const designs_summit before = *summit;
  int j, best = -1;
  for (j = 0; j < DESIGNS_CUTS; ++j) {
    if (looks[j].found > (best < 0 ? before.size : looks[best].found)) best = j;
  }
  if (best < 0) {
    for (j = 0; j < DESIGNS_CUTS; ++j) designs_note(summit, looks[j].t, looks[j].found, looks[j].place);
    return;
  }
  summit->t = looks[best].t;
  summit->size = looks[best].found;
  summit->place = looks[best].place;
  if (best > 0) summit->low = looks[best - 1].t;
  if (best < DESIGNS_CUTS - 1) summit->high = looks[best + 1].t;
  summit->size_low = y[best];
  summit->size_high = y[best + 2];
  designs_note(summit, before.t, before.size, before.place);
}

/* Cut what encloses a summit ever smaller, until a polynomial or two that meet at a kink say well what is there. Hints are what the
   cuts of one summit tell of others: many jump together. */
static void designs_cut(const designs_now* now, designs_summit* summits, designs_summit* hints, int count, int which) {
  designs_summit *summit = summits + which, *hint = hints + which;
  const double whole = (now->t[now->n - 1] - now->t[0])/(double) (now->n - 1);
  designs_look looks[DESIGNS_CUTS];
  designs_real y[DESIGNS_CUTS + 2], gap, size, kink;
  designs_fit fit;
  double low, step, x;
  casadi_int first;
  int round, j, k, best, many, settled = 0;
  hint->open = 0;
  for (round = 0; round < DESIGNS_CUT_ROUNDS && !settled; ++round) {
    low = summit->low;
    step = (summit->high - low)/(DESIGNS_CUTS + 1);
    x = low < 0 ? -low : low;
    x = x < summit->high ? summit->high : x;
    if (!(step > DESIGNS_CLOSEST*whole && step > DESIGNS_SPACING*x)) break;
    y[0] = summit->size_low;
    y[DESIGNS_CUTS + 1] = summit->size_high;
    for (j = 0; j < DESIGNS_CUTS; ++j) {
      looks[j].summit = which;
      looks[j].t = low + (j + 1)*step;
    }
    designs_try(now, summits, hints, count, looks, DESIGNS_CUTS);
    for (j = 0; j < DESIGNS_CUTS; ++j) y[j + 1] = looks[j].found;
    designs_enclose(summit, looks, y);
    if (round == 0 && hint->size >= summit->size && hint->low >= summit->low && hint->high <= summit->high) *summit = *hint;
    best = 0;
    gap = 0;
    for (j = 1; j < DESIGNS_CUTS + 2; ++j) {
      if (y[j] > y[best]) best = j;
      size = y[j] - y[j - 1];
      if (!((size < 0 ? -size : size) <= gap)) gap = size < 0 ? -size : size;
    }
    settled = gap <= summit->rounding;
    if (settled) break;
    first = designs_window(best, DESIGNS_CUTS + 2);
    for (j = 0; j < LANES; ++j) {
      for (k = 0; k < DESIGNS_FIT; ++k) fit.y[k][j] = y[first + k];
      designs_begin(&fit, j, best, first, DESIGNS_CUTS + 2);
    }
    designs_solve(&fit);
    designs_from_fit(&fit, 0, which, low + (double) first*step, step, looks);
    many = 1;
    if (best >= 3 && best <= DESIGNS_CUTS - 2 && designs_kink(y + best, &kink, &size)) {
      looks[1] = looks[0];
      looks[1].last = 1;
      looks[1].size = size;
      looks[1].t = low + (best + (double) kink)*step;
      looks[1].curve = 0;
      many = 2;
    }
    designs_try(now, summits, hints, count, looks, many);
    if (many == 2) settled = designs_settled(summit, looks + 1);
    if (designs_settled(summit, looks)) settled = 1;
    if (!settled && looks[0].last) {
      designs_try(now, summits, hints, count, looks, 1);
      settled = designs_settled(summit, looks);
    }
  }
  /* At a pole a value goes on growing however near it is. */
  gap = (designs_real) 0.9*summit->size;
  size = summit->sign*designs_row(now, summit->quantity)[summit->near];
  if (!settled && summit->size_low < gap && summit->size_high < gap && summit->size > DESIGNS_POLE*size) {
    summit->size = (designs_real) INFINITY;
  }
}

/* Note an instant at which a quantity may be largest, from the other summits of the same; how many there are then. */
static int designs_summit_at(const designs_now* now, int quantity, casadi_int i, designs_real best, designs_real rounding,
                             designs_summit* summits, int count) {
  const designs_real *row = designs_row(now, quantity), sign = row[i] < 0 ? -1 : 1, size = sign*row[i];
  const casadi_int last = now->n - 1, inner = i < 1 ? 1 : i > last - 1 ? last - 1 : i;
  const casadi_int before = i > 0 ? i - 1 : i, after = i < last ? i + 1 : i;
  designs_real rise = size;
  designs_summit* summit = summits + count;
  int k;
  if (i > 0 && !((row[before] < 0 ? -row[before] : row[before]) < size)) return count;
  if (i < last && !((row[after] < 0 ? -row[after] : row[after]) <= size)) return count;
  if (last == 0) return count;
  /* A parabola rises by a quarter of this above its instants. */
  if (last > 1) rise = sign*(2*row[inner] - row[inner - 1] - row[inner + 1])/2;
  if (!(rise > rounding && size + rise > best)) return count;
  if (count == DESIGNS_EACH) {
    for (k = 0; k < count; ++k) {
      if (summit == summits + count || summits[k].expected < summit->expected) summit = summits + k;
    }
    if (!(summit->expected + rounding < size + rise)) return count;
  } else {
    ++count;
  }
  summit->quantity = quantity;
  summit->open = 0;
  summit->near = i;
  summit->t = now->t[i];
  summit->low = now->t[before];
  summit->high = now->t[after];
  summit->sign = sign;
  summit->size = size;
  summit->size_low = sign*row[before];
  summit->size_high = sign*row[after];
  summit->place = quantity < DESIGNS_PLAIN ? 0 : designs_row(now, DESIGNS_QUANTITIES + quantity - DESIGNS_PLAIN)[i];
  summit->expected = size + rise;
  summit->rounding = rounding;
  return count;
}

/* The summits of a quantity that may be higher than its largest instant, and which is that. */
static int designs_summits_of(const designs_now* now, int quantity, designs_real best, designs_real rounding, designs_summit* summits,
                              casadi_int* largest) {
  const designs_real *row = designs_row(now, quantity), least = best*(1 - DESIGNS_CLOSE);
  const casadi_int last = now->n - 1;
  casadi_real here, around, before, after;
  designs_real above[LANES], x;
  casadi_int i, j;
  int count = designs_summit_at(now, quantity, 0, best, rounding, summits, 0);
  for (*largest = least < best ? last : 0; *largest < last && row[*largest] < best && -row[*largest] < best; ++*largest) {}
  if (row[0] == best || row[0] == -best) *largest = 0;
  /* Beside the row stand values that nothing is larger than. */
  for (i = 0; i < now->n; i += LANES) {
    memcpy(&here, row + i, sizeof here);
    memcpy(&before, row + i - 1, sizeof here);
    memcpy(&after, row + i + 1, sizeof here);
    around = DESIGNS_HALF*(before + after);
    around = lanes_less(here, 0, -around, around);
    here = designs_size(here);
    around = here + (here - around);
    around = lanes_less(designs_size(before), here, lanes_less(here, designs_size(after), 0, around), 0);
    if (!lanes_any_less(least, around)) continue;
    memcpy(above, &around, sizeof above);
    for (j = 0; j < LANES && i + j < last; ++j) {
      if (!(above[j] > least)) continue;
      x = row[i + j] < 0 ? -row[i + j] : row[i + j];
      if (x == best && i + j < *largest) *largest = i + j;
      count = designs_summit_at(now, quantity, i + j, best, rounding, summits, count);
    }
  }
  return last > 0 ? designs_summit_at(now, quantity, last, best, rounding, summits, count) : count;
}

/* The largest size of every quantity over the instants, and of every unit. */
static void designs_largest(const designs_now* now, designs_real* best, designs_real* scale) {
  const designs_real* row;
  designs_real lanes[LANES];
  casadi_real x, most;
  casadi_int i;
  int j, k;
  for (k = 0; k < DESIGNS_UNITS; ++k) scale[k] = 0;
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) {
    row = designs_row(now, k);
    most = 0;
    for (i = 0; i < now->n; i += LANES) {
      memcpy(&x, row + i, sizeof x);
      x = designs_size(x);
      most = lanes_less(most, x, x, most);
    }
    memcpy(lanes, &most, sizeof lanes);
    best[k] = lanes[0];
    for (j = 1; j < LANES; ++j) best[k] = lanes[j] > best[k] ? lanes[j] : best[k];
    if (best[k] > scale[designs_unit[k]]) scale[designs_unit[k]] = best[k];
  }
}

/* Where a polynomial through the instants around each summit says to look. */
static void designs_aim(const designs_now* now, const designs_summit* summits, int count, designs_look* looks) {
  const double step = (now->t[now->n - 1] - now->t[0])/(double) (now->n - 1);
  designs_fit fit;
  casadi_int first;
  int j, k, lane;
  for (j = 0; j < count; j += LANES) {
    for (lane = 0; lane < LANES; ++lane) {
      const designs_summit* summit = summits + (j + lane < count ? j + lane : count - 1);
      const designs_real* row = designs_row(now, summit->quantity);
      first = designs_window(summit->near, now->n);
      for (k = 0; k < DESIGNS_FIT; ++k) fit.y[k][lane] = summit->sign*row[first + k];
      designs_begin(&fit, lane, summit->near, first, now->n);
    }
    designs_solve(&fit);
    for (lane = 0; lane < LANES && j + lane < count; ++lane) {
      first = designs_window(summits[j + lane].near, now->n);
      designs_from_fit(&fit, lane, j + lane, now->t[first], step, looks + j + lane);
    }
  }
}

/* Look between instants for the summits of some quantities, until each is settled. */
static void designs_settle(const designs_now* now, designs_summit* summits, int count) {
  designs_summit hints[DESIGNS_EACH*DESIGNS_BATCH];
  designs_look looks[DESIGNS_EACH*DESIGNS_BATCH];
  int many = 0, j, k;
  memcpy(hints, summits, (size_t) count*sizeof *hints);
  if (now->n < DESIGNS_FIT) {
    for (j = 0; j < count; ++j) hints[j].open = 1;
  } else {
    designs_aim(now, summits, count, looks);
    designs_try(now, summits, hints, 0, looks, count);
    for (j = 0; j < count; ++j) {
      if (designs_settled(summits + j, looks + j)) continue;
      if (looks[j].last) looks[many++] = looks[j];
      else hints[j].open = 1;
    }
    designs_try(now, summits, hints, 0, looks, many);
    for (j = 0; j < many; ++j) {
      k = looks[j].summit;
      if (!designs_settled(summits + k, looks + j)) hints[k].open = 1;
    }
  }
  for (j = 0; j < count; ++j) {
    /* Between the same instants again, for there may be more than one. */
    summits[j].low = hints[j].low;
    summits[j].high = hints[j].high;
    summits[j].size_low = hints[j].size_low;
    summits[j].size_high = hints[j].size_high;
  }
  for (j = 0; j < count; ++j) {
    if (hints[j].open) designs_cut(now, summits, hints, count, j);
  }
}

/* The peak of every quantity, its time and its place: at an instant, or between two. */
static void designs_peaks(const designs_now* now, double* value, double* t, double* xi) {
  designs_summit summits[DESIGNS_EACH*DESIGNS_BATCH];
  designs_real best[DESIGNS_QUANTITIES], scale[DESIGNS_UNITS], rounding, least;
  casadi_int at;
  int first, last, count, j, q;
  designs_largest(now, best, scale);
  for (first = 0; first < DESIGNS_QUANTITIES; first += DESIGNS_BATCH) {
    last = first + DESIGNS_BATCH < DESIGNS_QUANTITIES ? first + DESIGNS_BATCH : DESIGNS_QUANTITIES;
    count = 0;
    for (q = first; q < last; ++q) {
      rounding = DESIGNS_ROUNDING*(best[q] + DESIGNS_BESIDE*scale[designs_unit[q]]);
      j = designs_summits_of(now, q, best[q], rounding, summits + count, &at);
      /* What is only rounding beside others of its unit is not worth a look. */
      if (best[q] > DESIGNS_NOTHING*scale[designs_unit[q]]) count += j;
      value[q] = designs_row(now, q)[at];
      t[q] = now->t[at];
      xi[q] = q < DESIGNS_PLAIN ? (designs_real) NAN : designs_row(now, DESIGNS_QUANTITIES + q - DESIGNS_PLAIN)[at];
    }
    designs_settle(now, summits, count);
    for (j = 0; j < count; ++j) {
      q = summits[j].quantity;
      if (summits[j].size > best[q]) best[q] = summits[j].size;
    }
    for (j = 0; j < count; ++j) {
      const designs_summit* summit = summits + j;
      q = summit->quantity;
      /* Of some that are as large but for rounding, the first: else rounding would choose their sign. */
      least = best[q] - summit->rounding;
      if (!(summit->size >= least)) continue;
      if ((value[q] < 0 ? -value[q] : value[q]) >= least && t[q] <= summit->t) continue;
      value[q] = summit->sign*summit->size;
      t[q] = summit->t;
      if (q >= DESIGNS_PLAIN) xi[q] = summit->place;
    }
  }
}

/* Many designs, one after another: of each its rows over all instants, whether it has a result, its peaks and means.

   Nothing here of one design depends on another. What the scene is made of stands before this text: scene.c, designs_curves, tables,
   and sizes as macros. */
typedef struct {
  const lagrange_casadi_designs_call* call;
  lagrange_casadi_instants instants;
  scene_design scene;
  casadi_int n, stride;
  const double* t;
  lanes_real most[DESIGNS_CURVES];
  double half;
  int rests;
  const signed char* bent;
  double *tops, *error;
  casadi_real matter[DESIGNS_MATTER], terms[SCENE_SOME(DESIGNS_BOUNDS)];
} designs_now;

static lanes_real designs_lane(const casadi_real* pack, int lane) {
  lanes_real x;
  memcpy(&x, (const char*) pack + (size_t) lane*sizeof x, sizeof x);
  return x;
}

/* A row that is kept of a design; those of its times stand before, room for two. */
static lanes_real* designs_row(const designs_now* now, int k) { return now->instants.t + (2 + k)*now->stride + LANES; }

static void designs_split(double t, lanes_real* moment) {
  moment[0] = (lanes_real) t;
  if (SCENE_NT > 1) moment[SCENE_NT - 1] = (lanes_real) (t - moment[0]);
}

/* The columns at LANES times, each near an instant. */
static void designs_at(const designs_now* now, const double* t, const casadi_int* near, casadi_real* y) {
  const lagrange_casadi_instants* instants = &now->instants;
  lanes_real lane[SCENE_NT][LANES], moment[SCENE_NT], place[SCENE_SOME(SCENE_NZ)][LANES], z[SCENE_SOME(SCENE_NZ)];
  casadi_real at[SCENE_PLACE + SCENE_NZ];
  int j, k, status;
  for (j = 0; j < LANES; ++j) {
    designs_split(t[j], moment);
    for (k = 0; k < SCENE_NT; ++k) lane[k][j] = moment[k];
    for (k = 0; k < SCENE_NZ; ++k) z[k] = instants->z[k*now->stride + near[j]];
    status = scene_close(0, moment, instants->p, z);
    for (k = 0; k < SCENE_NZ; ++k) place[k][j] = status == SCENE_NOT_CONVERGED ? (lanes_real) NAN : z[k];
  }
  memcpy(at, lane, sizeof lane);
  if (SCENE_NZ) memcpy(at + SCENE_PLACE, place, sizeof place);
  scene_columns(&now->scene, at, y);
}

/* The instant that is nearest to a time. */
static casadi_int designs_near(const designs_now* now, double t) {
  const double x = (t - now->t[0])/(2*now->half) + 0.5;
  const casadi_int i = x > 0 ? (casadi_int) x : 0;
  return i < now->n ? i : now->n - 1;
}

/* Curves, their places and what is watched at up to LANES times, into rows that are as far apart: what the search asks for. */
static int designs_asked(void* of, long long count, const double* t, unsigned long long need, lanes_real* out, long long apart) {
  const designs_now* now = (const designs_now*) of;
  casadi_real y[SCENE_COLUMNS], value[DESIGNS_CURVES], place[SCENE_SOME(DESIGNS_PLACES)];
  double times[LANES];
  casadi_int near[LANES];
  int j, k;
  for (j = 0; j < LANES; ++j) {
    times[j] = t[j < count ? j : count - 1];
    near[j] = designs_near(now, times[j]);
  }
  designs_at(now, times, near, y);
  designs_curves(y, now->matter, need, value, place);
  for (k = 0; k < DESIGNS_CURVES; ++k) scene_store(out + k*apart, value[k]);
  for (k = 0; k < DESIGNS_PLACES; ++k) scene_store(out + (DESIGNS_CURVES + k)*apart, place[k]);
  for (k = 0; k < DESIGNS_WATCHES; ++k) scene_store(out + (DESIGNS_CHECKED + k)*apart, y[SCENE_OUTPUTS + k]);
  return 0;
}

/* All instants, as rows of curves, of their places along links, of what is checked, and of what is watched; only checks need rows
   where no peaks are sought. */
static void designs_sample(designs_now* now) {
  const lagrange_casadi_instants* instants = &now->instants;
  const int streams = scene_streams(instants, now->n*now->call->designs), peaks = now->call->value != 0;
  casadi_real block[SCENE_PACKS*SCENE_COLUMNS], *y = block;
  casadi_real value[DESIGNS_CURVES], place[SCENE_SOME(DESIGNS_PLACES)], most[DESIGNS_CURVES];
  const casadi_int stride = now->stride;
  lanes_real* row;
  casadi_int i, j;
  int k;
  for (k = 0; k < DESIGNS_CURVES; ++k) most[k] = 0;
  for (i = 0; i < now->n; i += LANES) {
    scene_pack(&now->scene, i, y);
    row = designs_row(now, 0) + i;
    if (peaks) {
      designs_curves(y, now->matter, ~0ull, value, place);
      for (k = 0; k < DESIGNS_CURVES; ++k) {
        scene_store(row + k*stride, value[k]);
        most[k] = designs_larger(most[k], designs_size(value[k]));
      }
      for (k = 0; k < DESIGNS_PLACES; ++k) scene_store(row + (DESIGNS_CURVES + k)*stride, place[k]);
    }
    row += DESIGNS_CHECKED*stride;
    for (k = 0; k < DESIGNS_CHECKS; ++k, row += stride) scene_store(row, y[designs_checked[k]]);
    for (k = 0; peaks && k < DESIGNS_WATCHES; ++k, row += stride) scene_store(row, y[SCENE_OUTPUTS + k]);
    if (!instants->out) {
      scene_check(instants, i, y);
      continue;
    }
    y += SCENE_COLUMNS;
    if ((i + LANES)%SCENE_BLOCK != 0 && i + LANES < now->n) continue;
    y = block;
    j = i/SCENE_BLOCK*SCENE_BLOCK;
    if (streams) scene_write(instants, j, now->n - j, y, 1);
    else scene_write(instants, j, now->n - j, y, 0);
  }
  if (streams) lanes_streamed();
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    now->most[k] = 0;
    for (j = 0; j < LANES; ++j) now->most[k] = designs_lane(most + k, (int) j) > now->most[k] ? designs_lane(most + k, (int) j) : now->most[k];
  }
}

/* Whether a closure comes to zero between an instant and the next, looked for where it is lowest, ever closer. */
static int designs_dead_between(const designs_now* now, int check, casadi_int i) {
  double start = now->t[i], stop = now->t[i + 1], t[DESIGNS_INSIDE + LANES], width;
  casadi_int near[LANES];
  casadi_real y[SCENE_COLUMNS];
  lanes_real lowest = DESIGNS_LARGEST, low, x;
  int round, j, k, best;
  for (j = 0; j < LANES; ++j) near[j] = i;
  for (round = 0; round < DESIGNS_ROUNDS; ++round) {
    width = (stop - start)/(DESIGNS_INSIDE - 1);
    for (j = 0; j < DESIGNS_INSIDE + LANES; ++j) t[j] = j < DESIGNS_INSIDE - 1 ? start + j*width : stop;
    low = DESIGNS_LARGEST;
    best = 0;
    for (k = 0; k < DESIGNS_INSIDE; k += LANES) {
      designs_at(now, t + k, near, y);
      for (j = 0; j < LANES; ++j) {
        x = designs_lane(y + designs_checked[check], j);
        if (k + j < DESIGNS_INSIDE && x < low) {
          low = x;
          best = k + j;
        }
      }
    }
    if (low < lowest) lowest = low;
    start = t[best > 0 ? best - 1 : 0];
    stop = t[best < DESIGNS_INSIDE - 1 ? best + 1 : best];
  }
  return !(lowest > designs_lane(now->matter + DESIGNS_LIMITS + check, 0));
}

/* The largest of what is checked over all instants. */
static lanes_real designs_most(const designs_now* now, int check) {
  const lanes_real* row = designs_row(now, DESIGNS_CHECKED + check);
  lanes_real most = 0;
  casadi_int i;
  for (i = 0; i < now->n; ++i) most = row[i] > most ? row[i] : most;
  return most;
}

/* What the checks of a design are beyond its instants, and the largest terms of rows. Whether what is beside them can break a rule. */
static int designs_bind(designs_now* now) {
  int k, kind, near = 0;
  casadi_int i;
  for (k = 0; k < DESIGNS_BOUNDS; ++k) {
    lanes_real* row = designs_row(now, DESIGNS_CHECKED + k);
    kind = designs_kind[k];
    now->terms[k] = kind == DESIGNS_IS_ROW ? designs_most(now, designs_sized[k]) : (lanes_real) 0;
    row[-1] = row[now->n] = row[now->n + 1] = kind == DESIGNS_IS_TURNED ? row[now->n - 1] : DESIGNS_OUTSIDE;
    near |= kind == DESIGNS_IS_TURNED;
    if (kind != DESIGNS_IS_CLOSURE && kind != DESIGNS_IS_BRANCH) continue;
    for (i = 0; i < now->n; ++i) near |= !(row[i] >= DESIGNS_NEAR*DESIGNS_NEAR);
  }
  return near;
}

/* The first rule that each of a pack of instants breaks, by number, or zero; the pack begins at i, near is what designs_bind sets. */
LANES_INLINE casadi_real designs_broken(const designs_now* now, int near, casadi_int i) {
  casadi_real seen[4][SCENE_SOME(DESIGNS_BOUNDS)], beside[SCENE_SOME(DESIGNS_BOUNDS)], iterated = (lanes_real) 0, rule;
  lanes_real lane[LANES];
  const casadi_real* arg[5];
  casadi_real* res[1];
  int j, k, side;
  for (k = 0; k < DESIGNS_BOUNDS; ++k) {
    seen[1][k] = scene_load(designs_row(now, DESIGNS_CHECKED + k) + i);
    beside[k] = now->terms[k];
  }
  if (near) {
    for (side = 0; side < 4; ++side) {
      for (k = 0; k < DESIGNS_BOUNDS; ++k) seen[side][k] = scene_load(designs_row(now, DESIGNS_CHECKED + k) + i + side - 1);
      arg[side] = seen[side];
    }
    arg[4] = now->terms;
    res[0] = beside;
    beside_of(arg, res);
  }
  /* The closed forms can be asked. */
  for (k = 0; near && SCENE_NZ == 0 && k < DESIGNS_BOUNDS; ++k) {
    if (designs_kind[k] != DESIGNS_IS_CLOSURE) continue;
    scene_store(lane, beside[k]);
    for (j = 0; j < LANES && i + j < now->n; ++j) lane[j] = lane[j] > 0 && designs_dead_between(now, k, i + j);
    beside[k] = scene_load(lane);
  }
  for (j = 0; SCENE_NZ && j < LANES; ++j) lane[j] = i + j < now->n ? (lanes_real) now->instants.status[i + j] : 0;
  if (SCENE_NZ) iterated = scene_load(lane);
  arg[0] = seen[1];
  arg[1] = now->matter + DESIGNS_LIMITS;
  arg[2] = beside;
  arg[3] = &iterated;
  res[0] = &rule;
  status_of(arg, res);
  return rule;
}

/* Why a design has no result: that of its first instant without one. At rest it has one beside what friction reaches. */
static int designs_refused(designs_now* now) {
  const casadi_real none = (lanes_real) 0;
  const int near = designs_bind(now);
  casadi_real rule;
  casadi_int i;
  int j, why, finite = 1;
  now->rests = 0;
  for (i = 0; i < now->n; ++i) finite &= now->instants.status[i] != SCENE_NOT_FINITE;
  for (i = 0; i < now->n; i += LANES) {
    rule = designs_broken(now, near, i);
    if (finite && !lanes_where_less(none, rule)) continue;
    for (j = 0; j < LANES && i + j < now->n; ++j) {
      why = designs_status[(int) designs_lane(&rule, j)];
      if (why == SCENE_OK && now->instants.status[i + j] == SCENE_NOT_FINITE) why = SCENE_NOT_FINITE;
      if (why != SCENE_OK && why != SCENE_AT_REST) return why;
      now->rests |= why == SCENE_AT_REST;
    }
  }
  return SCENE_OK;
}

/* Whether equilibrium leaves open, at any instant, what a check is about. */
static int designs_is_open(const designs_now* now, int check) {
  const lanes_real *row = designs_row(now, DESIGNS_CHECKED + check), limit = designs_lane(now->matter + DESIGNS_LIMITS + check, 0);
  casadi_int i;
  int open = 0;
  for (i = 0; i < now->n; ++i) open |= !(row[i] <= limit);
  return open;
}

/* The mean of a row of which not all values count, or of its square: over the steps whose two ends are numbers, else over values. */
static double designs_mean_of_counted(const designs_now* now, int k, int squared) {
  const lanes_real* row = designs_row(now, k);
  double sum = 0, alone = 0, x, y;
  casadi_int i, steps = 0, many = 0;
  for (i = 0; i < now->n; ++i) {
    if (row[i] != row[i]) continue;
    x = squared ? (double) row[i]*row[i] : row[i];
    alone += x;
    ++many;
    if (i + 1 == now->n || row[i + 1] != row[i + 1]) continue;
    y = squared ? (double) row[i + 1]*row[i + 1] : row[i + 1];
    sum += (x + y)/2;
    ++steps;
  }
  return steps ? sum/(double) steps : alone/(double) many;
}

/* The time mean of a row, or of its square, by trapezia. */
static double designs_mean(const designs_now* now, int k, int squared) {
  const lanes_real* row = designs_row(now, k);
  const casadi_int n = now->n;
  casadi_real part, sum = 0;
  double whole = 0, first = row[0], last = row[n - 1];
  casadi_int i;
  if (now->rests) return designs_mean_of_counted(now, k, squared);
  if (squared) {
    first = first*first;
    last = last*last;
  }
  for (i = 0; i + LANES <= n; i += LANES) {
    part = scene_load(row + i);
    sum = sum + (squared ? part*part : part);
  }
  for (k = 0; k < LANES; ++k) whole += designs_lane(&sum, k);
  for (; i < n; ++i) whole += squared ? (double) row[i]*row[i] : row[i];
  return n > 1 ? (whole - (first + last)/2)/(double) (n - 1) : first;
}

/* The peak of every quantity, its time and its place; whether all are located. */
static int designs_peaks(designs_now* now, double* value, double* t, double* xi) {
  lagrange_casadi_search_call search = *now->call->search;
  signed char open[DESIGNS_QUANTITIES], located[DESIGNS_QUANTITIES];
  int all = 1, k;
  memset(open, 0, sizeof open);
  for (k = 0; k < DESIGNS_DOUBTS; ++k) open[designs_doubtful[k]] |= (signed char) designs_is_open(now, designs_doubted[k]);
  memcpy(now->call->hiding, now->bent, (size_t) now->n);
  search.n = now->n;
  search.stride = now->stride;
  search.t = now->t;
  search.rows = designs_row(now, 0);
  search.watched = search.rows + (DESIGNS_CHECKED + DESIGNS_CHECKS)*now->stride;
  search.most = now->most;
  search.open = open;
  search.rests = now->rests;
  search.together = LANES;
  search.way = now->call->way;
  search.share = now->call->share;
  search.tops = now->tops;
  search.error = now->error;
  search.hiding = now->call->hiding;
  search.at = designs_asked;
  search.of = now;
  search.value = value;
  search.peak_t = t;
  search.xi = xi;
  search.located = located;
  now->call->find(&search);
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) all &= located[k];
  return all;
}

/* Begin a design: its parameters, and whether there are such parts and instants. */
static int designs_begin(designs_now* now, const double* p) {
  lanes_real pair[SCENE_NT], margin;
  const casadi_real* given[1];
  casadi_real* found[1];
  int j, k;
  for (k = 0; k < SCENE_NP; ++k) {
    if (!(p[k] - p[k] == 0)) return SCENE_INVALID;
    designs_split(p[k], pair);
    for (j = 0; j < SCENE_NT; ++j) now->instants.p[j*SCENE_NP + k] = pair[j];
  }
  scene_begin(&now->scene, &now->instants);
  given[0] = now->scene.parameters;
  found[0] = now->matter;
  matter_of(given, found);
  for (k = 0; k < DESIGNS_MARGINS; ++k) {
    margin = designs_lane(now->matter + k, 0);
    if (!(margin >= 0 && margin <= DESIGNS_LARGEST) || (k < DESIGNS_POSITIVE && margin == 0)) return SCENE_IMPOSSIBLE;
  }
  return now->t[now->n - 1] >= now->t[0] ? SCENE_OK : SCENE_NO_INSTANTS;
}

/* Finish a design that was sampled: whether it has a result, and unless value is NULL its peaks and means. */
static int designs_finish(designs_now* now, double* value, double* t, double* xi, double* mean, double* rms) {
  const int why = designs_refused(now);
  int k;
  if (why != SCENE_OK || !value) return why;
  for (k = 0; k < DESIGNS_EFFORTS; ++k) {
    mean[k] = designs_mean(now, designs_effort[k], 0);
    rms[k] = sqrt(designs_mean(now, designs_effort[k], 1));
  }
  if (!designs_peaks(now, value, t, xi)) return SCENE_PEAK_NOT_TOLD;
  for (k = 0; k < DESIGNS_EFFORTS; ++k) {
    if (value[designs_effort[k]] != value[designs_effort[k]]) mean[k] = rms[k] = NAN;
  }
  return SCENE_OK;
}

/* The instants of a design: their times as what evaluates them takes them. */
static void designs_timed(designs_now* now, const double* t) {
  const casadi_int n = now->n;
  lanes_real moment[SCENE_NT];
  casadi_int i;
  int k;
  now->t = t;
  now->half = n > 1 ? (t[n - 1] - t[0])/(double) (2*(n - 1)) : 1;
  for (i = 0; i < n; ++i) {
    designs_split(t[i], moment);
    for (k = 0; k < SCENE_NT; ++k) now->instants.t[k*now->stride + i] = moment[k];
  }
}

/* So many designs, rows of parameters p, over instants t, those of a design t_apart values beyond those of the one before, or the
   same. instants are room for those of one design at a time, its times and parameters too, all zero but the guess, from which
   iterated loops begin; two rows of times are followed by those for curves, their places, what is checked and what is watched. value,
   peak_t and xi become rows of quantities, mean and rms of efforts, all of them or none where value is NULL; these ask for instants in
   equal steps. tops, unless it is NULL, becomes the local peaks of quantities that way and share ask of the search. Where error is not
   NULL, peaks are those at the instants, and error becomes how much larger each may be between them. history, unless it is NULL,
   becomes outputs by instants, iterated likewise iterated coordinates; a design without a result leaves its status, and NaN. hiding
   begins with two rows of zeros, which are room; what follows says after which instants the motion bends more than they show, that of
   a design bent_apart values beyond that of the one before. find searches for peaks, by a search of which tables and room are set. */
LAGRANGE_CASADI_EXPORT void lagrange_casadi_designs(const lagrange_casadi_designs_call* call) {
  const casadi_int n = call->instants->n, stride = call->instants->stride;
  designs_now now;
  casadi_int i, d;
  int k, why;
  now.call = call;
  now.n = n;
  now.stride = stride;
  now.instants = *call->instants;
  now.instants.apart = n;
  for (d = 0; d < call->designs; ++d) {
    double* values = call->value ? call->value + d*DESIGNS_QUANTITIES : 0;
    double *times = values ? call->peak_t + d*DESIGNS_QUANTITIES : 0, *places = values ? call->xi + d*DESIGNS_QUANTITIES : 0;
    double *means = values ? call->mean + d*DESIGNS_EFFORTS : 0, *squares = values ? call->rms + d*DESIGNS_EFFORTS : 0;
    lanes_real *whole = call->history ? call->history + d*SCENE_OUTPUTS*n : 0;
    lanes_real *closed = call->iterated ? call->iterated + d*SCENE_NZ*n : 0;
    if (d == 0 || call->t_apart) designs_timed(&now, call->t + d*call->t_apart);
    now.bent = call->hiding + 2*stride + d*call->bent_apart;
    now.tops = call->tops ? call->tops + d*4*DESIGNS_TOPS*DESIGNS_QUANTITIES : 0;
    now.error = call->error ? call->error + d*DESIGNS_QUANTITIES : 0;
    for (k = 0; now.tops && k < 4*DESIGNS_TOPS*DESIGNS_QUANTITIES; ++k) now.tops[k] = NAN;
    now.instants.out = whole;
    why = designs_begin(&now, call->p + d*SCENE_NP);
    if (why == SCENE_OK) {
      scene_follow(&now.instants, 0, n);
      designs_sample(&now);
      why = designs_finish(&now, values, times, places, means, squares);
    }
    call->status[d] = (signed char) why;
    for (i = 0; closed && i < SCENE_NZ*n; ++i) closed[i] = why == SCENE_OK ? now.instants.z[i/n*stride + i%n] : (lanes_real) NAN;
    if (why == SCENE_OK) continue;
    for (k = 0; values && k < DESIGNS_QUANTITIES; ++k) values[k] = times[k] = places[k] = NAN;
    for (k = 0; now.error && k < DESIGNS_QUANTITIES; ++k) now.error[k] = NAN;
    for (k = 0; values && k < DESIGNS_EFFORTS; ++k) means[k] = squares[k] = NAN;
    for (i = 0; whole && i < SCENE_OUTPUTS*n; ++i) whole[i] = NAN;
  }
}

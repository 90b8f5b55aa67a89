/* Many designs, one after another: of each its rows over all instants, whether it has a result, its peaks and means.

   Nothing here of one design depends on another. What the scene is made of stands before this text: scene.c, designs_curves, tables,
   and sizes as macros. */
typedef struct {
  const lagrange_casadi_designs_call* call;
  lagrange_casadi_instants instants;
  lagrange_casadi_search_call search;
  scene_design scene;
  lanes_real most[DESIGNS_CURVES];
  double half;
  casadi_real matter[DESIGNS_MATTER], terms[SCENE_SOME(DESIGNS_BOUNDS)];
  casadi_int passed[SCENE_SOME(DESIGNS_BOUNDS)];
} designs_now;

static lanes_real designs_lane(const casadi_real* pack, int lane) {
  lanes_real x;
  memcpy(&x, (const char*) pack + (size_t) lane*sizeof x, sizeof x);
  return x;
}

/* A row that is kept of a design; those of its times stand before, room for two. */
static lanes_real* designs_row(const designs_now* now, int k) { return now->instants.t + (2 + k)*now->search.stride + LANES; }

static void designs_split(double t, lanes_real* moment) {
  moment[0] = (lanes_real) t;
  if (SCENE_NT > 1) moment[SCENE_NT - 1] = (lanes_real) (t - moment[0]);
}

/* LANES times, each near an instant, and the iterated coordinates there: NaN where loops do not converge. */
static void designs_place(const designs_now* now, const double* t, const casadi_int* near, casadi_real* at) {
  const lagrange_casadi_instants* instants = &now->instants;
  lanes_real lane[SCENE_NT][LANES], moment[SCENE_NT], place[SCENE_SOME(SCENE_NZ)][LANES], z[SCENE_SOME(SCENE_NZ)];
  int j, k, status;
  for (j = 0; j < LANES; ++j) {
    designs_split(t[j], moment);
    for (k = 0; k < SCENE_NT; ++k) lane[k][j] = moment[k];
    for (k = 0; k < SCENE_NZ; ++k) z[k] = instants->z[k*now->search.stride + near[j]];
    status = scene_close(0, moment, instants->p, z);
    for (k = 0; k < SCENE_NZ; ++k) place[k][j] = status == SCENE_NOT_CONVERGED ? (lanes_real) NAN : z[k];
  }
  memcpy(at, lane, sizeof lane);
  if (SCENE_NZ) memcpy(at + SCENE_PLACE, place, sizeof place);
}

/* Curves, their places and what is watched at up to LANES times, into rows that are as far apart: what the search asks for. */
static int designs_asked(void* of, long long count, const double* t, unsigned long long need, lanes_real* out, long long apart) {
  const designs_now* now = (const designs_now*) of;
  casadi_real at[SCENE_PLACE + SCENE_NZ], y[SCENE_COLUMNS], value[DESIGNS_CURVES], place[SCENE_SOME(DESIGNS_PLACES)];
  double times[LANES], x;
  casadi_int near[LANES];
  int j, k;
  for (j = 0; j < LANES; ++j) {
    times[j] = t[j < count ? j : count - 1];
    /* The instant that is nearest. */
    x = (times[j] - now->search.t[0])/(2*now->half) + 0.5;
    near[j] = !(x > 0) ? 0 : x < (double) now->search.n ? (casadi_int) x : now->search.n - 1;
  }
  designs_place(now, times, near, at);
  scene_columns(&now->scene, at, y);
  designs_curves(y, now->matter, need, value, place);
  for (k = 0; k < DESIGNS_CURVES; ++k) scene_store(out + k*apart, value[k]);
  for (k = 0; k < DESIGNS_PLACES; ++k) scene_store(out + (DESIGNS_CURVES + k)*apart, place[k]);
  for (k = 0; k < DESIGNS_WATCHES; ++k) scene_store(out + (DESIGNS_WATCHED + k)*apart, y[SCENE_OUTPUTS + k]);
  return 0;
}

/* All instants, as rows of curves, of their places along links, of what is watched, and of what is checked; only checks need rows
   where no peaks are sought. */
static void designs_sample(designs_now* now) {
  const lagrange_casadi_instants* instants = &now->instants;
  const int streams = scene_streams(instants, now->search.n*now->call->designs), peaks = now->call->value != 0;
  casadi_real block[SCENE_PACKS*SCENE_COLUMNS], *y;
  casadi_real value[DESIGNS_CURVES], place[SCENE_SOME(DESIGNS_PLACES)], most[DESIGNS_CURVES];
  const casadi_int stride = now->search.stride;
  lanes_real* row;
  casadi_int i, j;
  int k;
  for (k = 0; k < DESIGNS_CURVES; ++k) most[k] = 0;
  for (i = 0; i < now->search.n; i += LANES) {
    y = block + (instants->out ? i%SCENE_BLOCK/LANES*SCENE_COLUMNS : 0);
    scene_pack(&now->scene, i, y);
    row = designs_row(now, 0) + i;
    if (peaks) {
      designs_curves(y, now->matter, ~0ull, value, place);
      for (k = 0; k < DESIGNS_CURVES; ++k) {
        scene_store(row + k*stride, value[k]);
        most[k] = lanes_larger(most[k], lanes_size(value[k]));
      }
      for (k = 0; k < DESIGNS_PLACES; ++k) scene_store(row + (DESIGNS_CURVES + k)*stride, place[k]);
      for (k = 0; k < DESIGNS_WATCHES; ++k) scene_store(row + (DESIGNS_WATCHED + k)*stride, y[SCENE_OUTPUTS + k]);
    }
    row += DESIGNS_CHECKED*stride;
    for (k = 0; k < DESIGNS_CHECKS; ++k, row += stride) scene_store(row, y[designs_checked[k]]);
    for (k = 0; now->call->near && k < DESIGNS_MARKS; ++k) scene_store(row + k*stride, y[SCENE_OUTPUTS + DESIGNS_WATCHES + k]);
    j = i/SCENE_BLOCK*SCENE_BLOCK;
    if (!instants->out) scene_check(instants, i, y);
    else if (i + LANES == j + SCENE_BLOCK || i + LANES >= now->search.n) scene_write(instants, j, now->search.n - j, block, streams);
  }
  if (streams) lanes_streamed();
  for (k = 0; k < DESIGNS_CURVES; ++k) {
    now->most[k] = 0;
    for (j = 0; j < LANES; ++j) now->most[k] = designs_lane(most + k, (int) j) > now->most[k] ? designs_lane(most + k, (int) j) : now->most[k];
  }
}

#if DESIGNS_CLOSINGS
/* The step that begins at instant i. */
typedef struct {
  const designs_now* now;
  casadi_int i;
} centre_step;

typedef lanes_real centre_real;

static void centre_path(const centre_step* step, int which, const centre_real* x, centre_real* square, centre_real* rate,
                        centre_real* slope) {
  const designs_now* now = step->now;
  const double start = now->search.t[step->i], width = now->search.t[step->i + 1] - start;
  casadi_real at[SCENE_PLACE + SCENE_NZ], squares[DESIGNS_CLOSINGS], rates[DESIGNS_CLOSINGS];
  casadi_real slopes[DESIGNS_CLOSINGS*DESIGNS_SLOPES];
  const casadi_real* arg[6];
  casadi_real* res[3];
  double t[LANES];
  casadi_int near[LANES];
  int first, j, k;
  res[0] = squares;
  res[1] = rates;
  res[2] = slopes;
  for (first = 0; first < DESIGNS_POINTS; first += LANES) {
    for (j = 0; j < LANES; ++j) {
      k = first + j < DESIGNS_POINTS ? first + j : DESIGNS_POINTS - 1;
      t[j] = start + x[k]*width;
      near[j] = step->i + !(x[k] < (centre_real) 0.5);
    }
    designs_place(now, t, near, at);
    scene_driven(&now->scene, at, arg);
    arg[4] = now->scene.parameters;
    closing(arg, res);
    for (j = 0; j < LANES && first + j < DESIGNS_POINTS; ++j) {
      square[first + j] = designs_lane(squares + which, j);
      rate[first + j] = designs_lane(rates + which, j)*(centre_real) width;
      for (k = 0; k < DESIGNS_SLOPES; ++k) {
        slope[DESIGNS_SLOPES*(first + j) + k] = designs_lane(slopes + DESIGNS_SLOPES*which + k, j);
      }
    }
  }
}

DESIGNS_CENTRE
/* Whether the square of a sine may come to zero in a step: see steps_near of engine/dead_centres.py. */
static int designs_near_zero(const designs_now* now, const lanes_real* row, int sine, casadi_int i, lanes_real limit) {
  const double* t = now->search.t + i;
  const int* status = now->instants.status + i;
  lanes_real square[4], least, before = DESIGNS_LARGEST, after = DESIGNS_LARGEST;
  int first = i > 0 ? 0 : 1, last = i + 2 < now->search.n ? 3 : 2, k;
  for (k = first; k <= last; ++k) square[k] = sine ? row[i + k - 1]*row[i + k - 1] : row[i + k - 1];
  least = square[1] < square[2] ? square[1] : square[2];
  if (status[0] == SCENE_NOT_CONVERGED || status[1] == SCENE_NOT_CONVERGED || !(least > limit)) return 0;
  if (first == 0) before = square[1] + (square[1] - square[0])*(lanes_real) ((t[1] - t[0])/(t[0] - t[-1]));
  if (last == 3) after = square[2] - (square[3] - square[2])*(lanes_real) ((t[1] - t[0])/(t[2] - t[1]));
  if (first == 1 && last == 2) return 1;
  return !(before >= least/2 && after >= least/2);
}
#endif

/* The first instant after which a check passes a dead centre, or n: in steps that have no neighbour below their lower end. */
static casadi_int designs_passed(const designs_now* now, int check) {
#if DESIGNS_CLOSINGS
  const lanes_real *row = designs_row(now, DESIGNS_CHECKED + check), limit = designs_lane(now->matter + DESIGNS_LIMITS + check, 0);
  const int sine = designs_kind[check] == DESIGNS_IS_BRANCH;
  const lanes_real zero = sine ? limit*limit : limit;
  centre_step step;
  lanes_real least;
  step.now = now;
  for (step.i = 0; step.i + 1 < now->search.n; ++step.i) {
    least = row[step.i] < row[step.i + 1] ? row[step.i] : row[step.i + 1];
    if ((step.i > 0 && row[step.i - 1] < least) || (step.i + 2 < now->search.n && row[step.i + 2] < least)) continue;
    if (!(row[step.i] > limit && row[step.i + 1] > limit) || !designs_near_zero(now, row, sine, step.i, zero)) continue;
    if (centre_passes(&step, designs_closed[check], zero)) return step.i;
  }
#endif
  (void) check;
  return now->search.n;
}

/* What is beside the checks of a design: the largest terms of rows, and after which instant a dead centre is passed. */
static void designs_bind(designs_now* now) {
  casadi_int i;
  int k;
  for (k = 0; k < DESIGNS_BOUNDS; ++k) {
    const int kind = designs_kind[k];
    const lanes_real* terms = designs_row(now, DESIGNS_CHECKED + designs_sized[k]);
    lanes_real *row = designs_row(now, DESIGNS_CHECKED + k), most = 0;
    for (i = 0; kind == DESIGNS_IS_ROW && i < now->search.n; ++i) most = terms[i] > most ? terms[i] : most;
    now->terms[k] = most;
    if (kind == DESIGNS_IS_TURNED) row[now->search.n] = row[now->search.n - 1];
    now->passed[k] = kind == DESIGNS_IS_CLOSURE || kind == DESIGNS_IS_BRANCH ? designs_passed(now, k) : now->search.n;
  }
}

/* The first rule that each of a pack of instants breaks, by number, or zero; the pack begins at i. */
LANES_INLINE casadi_real designs_broken(const designs_now* now, casadi_int i) {
  casadi_real seen[SCENE_SOME(DESIGNS_BOUNDS)], beside[SCENE_SOME(DESIGNS_BOUNDS)], iterated = (lanes_real) 0, rule;
  lanes_real lane[LANES];
  const casadi_real* arg[4];
  casadi_real* res[1];
  int j, k;
  for (k = 0; k < DESIGNS_BOUNDS; ++k) {
    const lanes_real* row = designs_row(now, DESIGNS_CHECKED + k) + i;
    seen[k] = scene_load(row);
    beside[k] = designs_kind[k] == DESIGNS_IS_TURNED ? scene_load(row + 1) - seen[k] : now->terms[k];
    if (now->passed[k] == now->search.n || now->passed[k] < i || now->passed[k] >= i + LANES) continue;
    for (j = 0; j < LANES; ++j) lane[j] = (lanes_real) (now->passed[k] == i + j);
    beside[k] = scene_load(lane);
  }
  for (j = 0; SCENE_NZ && j < LANES; ++j) lane[j] = i + j < now->search.n ? (lanes_real) now->instants.status[i + j] : 0;
  if (SCENE_NZ) iterated = scene_load(lane);
  arg[0] = seen;
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
  casadi_real rule;
  casadi_int i;
  int j, why, finite = 1;
  designs_bind(now);
  now->search.rests = 0;
  for (i = 0; i < now->search.n; ++i) finite &= now->instants.status[i] != SCENE_NOT_FINITE;
  for (i = 0; i < now->search.n; i += LANES) {
    rule = designs_broken(now, i);
    if (finite && !lanes_where_less(none, rule)) continue;
    for (j = 0; j < LANES && i + j < now->search.n; ++j) {
      why = designs_status[(int) designs_lane(&rule, j)];
      if (why == SCENE_OK && now->instants.status[i + j] == SCENE_NOT_FINITE) why = SCENE_NOT_FINITE;
      if (why != SCENE_OK && why != SCENE_AT_REST) return why;
      now->search.rests |= why == SCENE_AT_REST;
    }
  }
  return SCENE_OK;
}

/* The time mean of a row, or of its square, by trapezia: over the steps whose two ends are numbers, where there are none over values. */
static double designs_mean(const designs_now* now, int k, int squared) {
  lanes_real* row = designs_row(now, k);
  casadi_real next, pair, counted, sum = 0, steps = 0;
  double whole = 0, many = 0;
  casadi_int i;
  int apart, j;
  for (j = 0; j <= LANES; ++j) row[now->search.n + j] = (lanes_real) NAN;
  for (apart = 1; apart >= 0 && many == 0; --apart) {
    for (i = 0; i < now->search.n; i += LANES) {
      pair = scene_load(row + i);
      next = scene_load(row + i + apart);
      pair = squared ? pair*pair + next*next : pair + next;
      counted = lanes_less(pair, INFINITY, 1, 0);
      sum = sum + lanes_less(0, counted, pair, 0);
      steps = steps + counted;
    }
    for (j = 0; j < LANES; ++j) {
      whole += designs_lane(&sum, j);
      many += designs_lane(&steps, j);
    }
  }
  return whole/(2*many);
}

/* The peak of every quantity, its time and its place; whether all are located. */
static int designs_peaks(designs_now* now) {
  signed char open[DESIGNS_QUANTITIES], located[DESIGNS_QUANTITIES];
  casadi_int i;
  int all = 1, k;
  memset(open, 0, sizeof open);
  /* What a check is about is open where equilibrium leaves it so at any instant. */
  for (k = 0; k < DESIGNS_DOUBTS; ++k) {
    const int check = designs_doubted[k];
    const lanes_real *row = designs_row(now, DESIGNS_CHECKED + check), limit = designs_lane(now->matter + DESIGNS_LIMITS + check, 0);
    for (i = 0; i < now->search.n; ++i) open[designs_doubtful[k]] |= (signed char) !(row[i] <= limit);
  }
  now->search.open = open;
  now->search.located = located;
  now->call->find(&now->search);
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
  return now->search.t[now->search.n - 1] >= now->search.t[0] ? SCENE_OK : SCENE_NO_INSTANTS;
}

/* Whether a mark of a motion or a constraint may come to where it counts between instants: it is no further from there at one of them
   than it moves in a step. */
static int designs_near_mark(const designs_now* now) {
  lanes_real least, most, off, step;
  casadi_int i;
  int k;
  for (k = 0; k < DESIGNS_MARKS; ++k) {
    const lanes_real* row = designs_row(now, DESIGNS_CHECKED + DESIGNS_CHECKS + k);
    least = DESIGNS_LARGEST;
    most = 0;
    for (i = 0; i < now->search.n; ++i) {
      off = designs_whole[k] ? row[i] - (lanes_real) floor((double) row[i] + 0.5) : row[i];
      step = i > 0 ? row[i] - row[i - 1] : 0;
      off = off < 0 ? -off : off;
      step = step < 0 ? -step : step;
      if (!(off - off == 0 && step - step == 0)) return 1;
      least = off < least ? off : least;
      most = step > most ? step : most;
    }
    if (now->search.n < 3 || least <= most) return 1;
  }
  return 0;
}

/* Finish a design that was sampled: whether it has a result, and unless value is NULL its peaks and means. */
static int designs_finish(designs_now* now, double* mean, double* rms) {
  const double* value = now->search.value;
  const int why = designs_refused(now);
  int k;
  if (why != SCENE_OK || !value) return why;
  for (k = 0; k < DESIGNS_EFFORTS; ++k) {
    mean[k] = designs_mean(now, designs_effort[k], 0);
    rms[k] = sqrt(designs_mean(now, designs_effort[k], 1));
  }
  if (!designs_peaks(now)) return SCENE_PEAK_NOT_TOLD;
  for (k = 0; k < DESIGNS_EFFORTS; ++k) {
    if (value[designs_effort[k]] != value[designs_effort[k]]) mean[k] = rms[k] = NAN;
  }
  return SCENE_OK;
}

/* The instants of a design: their times as what evaluates them takes them. */
static void designs_timed(designs_now* now, const double* t) {
  const casadi_int n = now->search.n;
  lanes_real moment[SCENE_NT];
  casadi_int i;
  int k;
  now->search.t = t;
  now->half = n > 1 ? (t[n - 1] - t[0])/(double) (2*(n - 1)) : 1;
  for (i = 0; i < n; ++i) {
    designs_split(t[i], moment);
    for (k = 0; k < SCENE_NT; ++k) now->instants.t[k*now->search.stride + i] = moment[k];
  }
}

/* So many designs, rows of parameters p, over instants t, those of a design t_apart values beyond those of the one before, or the
   same. instants are room for those of one design at a time, its times and parameters too, all zero but the guess, from which
   iterated loops begin; two rows of times are followed by those for curves, their places, what is watched and what is checked. value,
   peak_t and xi become rows of quantities, mean and rms of efforts, all of them or none where value is NULL; these ask for instants in
   equal steps. tops, unless it is NULL, is NAN and becomes the local peaks of quantities that the search is asked for. Where error is not
   NULL, peaks are those at the instants, and error becomes how much larger each may be between them. history, unless it is NULL,
   becomes outputs by instants, iterated likewise iterated coordinates; near, unless it is NULL, says whether a mark of a motion or a
   constraint is near to where it may make a kink; a design without a result leaves its status, and NaN. hiding
   begins with two rows of zeros, which are room; what follows says after which instants the motion bends more than they show, that of
   a design bent_apart values beyond that of the one before. find searches for peaks, by a search of which tables and room are set. */
LAGRANGE_CASADI_EXPORT void lagrange_casadi_designs(const lagrange_casadi_designs_call* call) {
  const casadi_int n = call->instants->n, stride = call->instants->stride;
  designs_now now;
  lagrange_casadi_search_call* search = &now.search;
  casadi_int i, d;
  int k, why;
  now.call = call;
  now.instants = *call->instants;
  now.instants.apart = n;
  now.search = *call->search;
  search->n = n;
  search->stride = stride;
  search->rows = designs_row(&now, 0);
  search->most = now.most;
  search->together = LANES;
  search->hiding = call->hiding;
  search->at = designs_asked;
  search->of = &now;
  for (d = 0; d < call->designs; ++d) {
    double *means = call->value ? call->mean + d*DESIGNS_EFFORTS : 0, *squares = call->value ? call->rms + d*DESIGNS_EFFORTS : 0;
    lanes_real *whole = call->history ? call->history + d*SCENE_OUTPUTS*n : 0;
    lanes_real *closed = call->iterated ? call->iterated + d*SCENE_NZ*n : 0;
    if (d == 0 || call->t_apart) designs_timed(&now, call->t + d*call->t_apart);
    memcpy(call->hiding, call->hiding + 2*stride + d*call->bent_apart, (size_t) n);
    search->value = call->value ? call->value + d*DESIGNS_QUANTITIES : 0;
    search->peak_t = call->value ? call->peak_t + d*DESIGNS_QUANTITIES : 0;
    search->xi = call->value ? call->xi + d*DESIGNS_QUANTITIES : 0;
    search->tops = call->tops ? call->tops + d*4*DESIGNS_TOPS*DESIGNS_QUANTITIES : 0;
    search->error = call->error ? call->error + d*DESIGNS_QUANTITIES : 0;
    now.instants.out = whole;
    why = designs_begin(&now, call->p + d*SCENE_NP);
    if (why == SCENE_OK) {
      scene_follow(&now.instants, 0, n);
      designs_sample(&now);
      why = designs_finish(&now, means, squares);
    }
    call->status[d] = (signed char) why;
    if (call->near) call->near[d] = (signed char) (why == SCENE_OK && designs_near_mark(&now));
    for (i = 0; closed && i < SCENE_NZ*n; ++i) closed[i] = why == SCENE_OK ? now.instants.z[i/n*stride + i%n] : (lanes_real) NAN;
    if (why == SCENE_OK) continue;
    for (k = 0; search->value && k < DESIGNS_QUANTITIES; ++k) search->value[k] = search->peak_t[k] = search->xi[k] = NAN;
    for (k = 0; search->error && k < DESIGNS_QUANTITIES; ++k) search->error[k] = NAN;
    for (k = 0; search->value && k < DESIGNS_EFFORTS; ++k) means[k] = squares[k] = NAN;
    for (i = 0; whole && i < SCENE_OUTPUTS*n; ++i) whole[i] = NAN;
  }
}

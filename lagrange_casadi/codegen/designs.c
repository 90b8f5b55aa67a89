/* Many designs, one after another. */
/* The peak of every quantity, its time and its place; whether all are told. */
static int designs_peaks(designs_now* now, double* value, double* t, double* xi) {
  lagrange_casadi_search_call search = *now->call->search;
  signed char open[DESIGNS_QUANTITIES], told[DESIGNS_QUANTITIES];
  int all = 1, k;
  memset(open, 0, sizeof open);
  for (k = 0; k < DESIGNS_DOUBTS; ++k) open[designs_doubtful[k]] |= (signed char) designs_is_open(now, designs_doubted[k]);
  memcpy(now->call->hiding, now->bent, (size_t) now->n);
  search.n = now->n;
  search.stride = now->stride;
  search.t = now->t;
  search.rows = now->rows + LANES;
  search.watched = search.rows + (DESIGNS_CHECKED + DESIGNS_CHECKS)*now->stride;
  search.most = now->most;
  search.open = open;
  search.rests = now->rests;
  search.together = LANES;
  search.way = now->call->way;
  search.share = now->call->share;
  search.tops = now->tops;
  search.hiding = now->call->hiding;
  search.at = designs_asked;
  search.of = now;
  search.value = value;
  search.peak_t = t;
  search.xi = xi;
  search.told = told;
  now->call->find(&search);
  for (k = 0; k < DESIGNS_QUANTITIES; ++k) all &= told[k];
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
    for (j = 0; j < SCENE_NT; ++j) now->p[j*SCENE_NP + k] = pair[j];
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
    for (k = 0; k < SCENE_NT; ++k) now->call->room[k*now->stride + i] = moment[k];
  }
}

/* So many designs, rows of parameters p, over n instants t, those of a design t_apart values beyond those of the one before, or the
   same; iterated loops begin from the guess. value, peak_t and xi become rows of quantities, mean and rms of efforts, all of them or
   none where value is NULL; these ask for instants in equal steps. tops, unless it is NULL, becomes the local peaks of quantities that
   way and share ask of the search. history, unless it is NULL, becomes outputs by instants, iterated likewise iterated coordinates; a
   design without a result leaves its status, and NaN. bent tells after which instants the motion bends more than they show, its rows
   are bent_apart values apart. The room is rows of stride values, of times, iterated coordinates, curves, their places, what is
   checked and what is watched, all zero; of the status stride integers that are zero, and of hiding twice as many. find searches for
   peaks, by a search of which tables and room are set. */
LAGRANGE_CASADI_EXPORT void lagrange_casadi_designs(const lagrange_casadi_designs_call* call) {
  const casadi_int n = call->n, stride = call->stride;
  lagrange_casadi_instants* instants;
  lanes_real guess[SCENE_SOME(SCENE_NZ)];
  designs_now now;
  casadi_int i, d;
  int k, why;
  for (k = 0; k < SCENE_NZ; ++k) guess[k] = (lanes_real) call->guess[k];
  now.call = call;
  now.n = n;
  now.stride = stride;
  now.rows = call->room + (SCENE_NT + SCENE_NZ)*stride;
  instants = &now.instants;
  instants->n = n;
  instants->stride = stride;
  instants->t = call->room;
  instants->p = now.p;
  instants->guess = guess;
  instants->z = call->room + SCENE_NT*stride;
  instants->apart = n;
  instants->status = call->statuses;
  for (d = 0; d < call->designs; ++d) {
    double* values = call->value ? call->value + d*DESIGNS_QUANTITIES : 0;
    double *times = values ? call->peak_t + d*DESIGNS_QUANTITIES : 0, *places = values ? call->xi + d*DESIGNS_QUANTITIES : 0;
    double *means = values ? call->mean + d*DESIGNS_EFFORTS : 0, *squares = values ? call->rms + d*DESIGNS_EFFORTS : 0;
    lanes_real *whole = call->history ? call->history + d*SCENE_OUTPUTS*n : 0;
    lanes_real *closed = call->iterated ? call->iterated + d*SCENE_NZ*n : 0;
    if (d == 0 || call->t_apart) designs_timed(&now, call->t + d*call->t_apart);
    now.bent = call->bent + d*call->bent_apart;
    now.tops = call->tops ? call->tops + d*4*DESIGNS_TOPS*DESIGNS_QUANTITIES : 0;
    for (k = 0; now.tops && k < 4*DESIGNS_TOPS*DESIGNS_QUANTITIES; ++k) now.tops[k] = NAN;
    instants->out = whole;
    why = designs_begin(&now, call->p + d*SCENE_NP);
    if (why == SCENE_OK) {
      scene_follow(instants, 0, n);
      designs_sample(&now);
      why = designs_finish(&now, values, times, places, means, squares);
    }
    call->status[d] = (signed char) why;
    for (i = 0; closed && i < SCENE_NZ*n; ++i) closed[i] = why == SCENE_OK ? instants->z[i/n*stride + i%n] : (lanes_real) NAN;
    if (why == SCENE_OK) continue;
    for (k = 0; values && k < DESIGNS_QUANTITIES; ++k) values[k] = times[k] = places[k] = NAN;
    for (k = 0; values && k < DESIGNS_EFFORTS; ++k) means[k] = squares[k] = NAN;
    for (i = 0; whole && i < SCENE_OUTPUTS*n; ++i) whole[i] = NAN;
  }
}

/* The instants of one design of a scene: its loops, followed from one instant to the next, and its columns, evaluated in packs.

   The functions of the scene stand before this text: lead and loops for one instant, drive, constants_of and instant for a pack;
   and sizes as macros. Where a file has one precision, so has all that is here. */
#define SCENE_SOME(count) ((count) > 0 ? (count) : 1)

/* Packs of columns that wait in cache for lines of their rows to be whole: 32 instants, of many columns a line's. */
#define SCENE_BLOCK (SCENE_COLUMNS > 256 ? SCENE_LINE/(int) sizeof(lanes_real) : 32)
#define SCENE_PACKS (SCENE_BLOCK/LANES)
#define SCENE_LINE 64

/* Bytes from which on columns are streamed past the caches. */
#define SCENE_STREAMED (1u << 22)

/* A rule of Newton's method: so many steps, or until a correction is below done. Above lost nothing is known; above rounding, and
   above rate times the correction before, it converges slowly. */
typedef struct {
  int steps;
  lanes_real done, lost, rate, rounding;
} scene_newton;

/* A design: its instants and parameters, the parameters as packs, and what they alone decide. */
typedef struct {
  const lagrange_casadi_instants* call;
  casadi_real parameters[SCENE_SOME(SCENE_NT*SCENE_NP)], constants[SCENE_SOME(SCENE_CONSTANTS)];
} scene_design;

/* A pack that lies in rows; compilers copy memory in halves, and read what they wrote at once. */
LANES_INLINE casadi_real scene_load(const lanes_real* from) {
  casadi_real pack;
  memcpy(&pack, from, sizeof pack);
  return pack;
}

LANES_INLINE void scene_store(lanes_real* to, casadi_real pack) { memcpy(to, &pack, sizeof pack); }

/* Begin a design. */
static void scene_begin(scene_design* now, const lagrange_casadi_instants* call) {
  const casadi_real* arg[1];
  casadi_real* res[1];
  casadi_int k;
  now->call = call;
  for (k = 0; k < SCENE_NT*SCENE_NP; ++k) now->parameters[k] = call->p[k];
  arg[0] = now->parameters;
  res[0] = now->constants;
  constants_of(arg, res);
}

/* Close the iterated loops at a moment, from at, by one of the rules: their status. Where they do not converge, at stays. */
static int scene_close(int rule, const lanes_real* moment, const lanes_real* p, lanes_real* at) {
#if SCENE_NZ
  static const scene_newton rules[] = SCENE_RULES;
  static const int turning[] = SCENE_TURNING;
  const scene_newton newton = rules[rule];
  lanes_real correction[SCENE_NZ], z[SCENE_NZ], counted[SCENE_NC + 2*SCENE_ND], size = 1, before = 1;
  const lanes_real* arg[3];
  lanes_real* res[3];
  int k, step;
  arg[0] = moment;
  arg[1] = p;
  res[0] = counted;
  res[1] = counted + SCENE_NC;
  res[2] = counted + SCENE_NC + SCENE_ND;
  lead(arg, res);
  memcpy(z, at, sizeof z);
  arg[0] = z;
  arg[1] = counted;
  arg[2] = p;
  res[0] = correction;
  res[1] = &size;
  for (step = 0; step < newton.steps && !(size < newton.done); ++step) {
    before = size;
    loops(arg, res);
    if (!(size - size == 0)) break;
    for (k = 0; k < SCENE_NZ; ++k) z[k] += correction[k];
  }
  if (!(size < newton.lost)) return SCENE_NOT_CONVERGED;
  for (k = 0; k < SCENE_NZ; ++k) at[k] = turning[k] ? z[k] - SCENE_TURN*SCENE_FLOOR(z[k]*SCENE_INVERSE + SCENE_HALF) : z[k];
  if (size > newton.rate*before && size > newton.rounding) return SCENE_SLOW;
#endif
  return SCENE_OK;
}

/* Follow iterated loops over instants first to last: z[k*stride + i] becomes coordinate k at instant i, from the one before or the
   guess; status[i] what came of it. */
static void scene_follow(const lagrange_casadi_instants* call, casadi_int first, casadi_int last) {
  const casadi_int stride = call->stride;
  lanes_real moment[SCENE_NT], at[SCENE_SOME(SCENE_NZ)];
  casadi_int i, k;
  for (k = 0; k < SCENE_NZ; ++k) at[k] = first ? call->z[k*stride + first - 1] : call->guess[k];
  for (i = first; i < last; ++i) {
    for (k = 0; k < SCENE_NT; ++k) moment[k] = call->t[k*stride + i];
    if (SCENE_BEGINS && i == 0) scene_close(1, moment, call->p, at);
    call->status[i] = scene_close(0, moment, call->p, at);
    for (k = 0; k < SCENE_NZ; ++k) call->z[k*stride + i] = at[k];
  }
}

/* What the drive gives for a pack of instants: at begins with its times, before its iterated coordinates; the arguments of what
   follows from all of them, but for the last. */
LANES_INLINE void scene_driven(const scene_design* now, casadi_real* at, const casadi_real** arg) {
  casadi_real *counted = at + SCENE_NT, *rates = counted + SCENE_NC;
  casadi_real* res[3];
#if SCENE_NC + SCENE_ND
  arg[0] = at;
  arg[1] = now->parameters;
  res[0] = counted;
  res[1] = rates;
  res[2] = rates + SCENE_ND;
  drive(arg, res);
#endif
  arg[0] = counted;
  arg[1] = rates;
  arg[2] = rates + SCENE_ND;
  arg[3] = rates + 2*SCENE_ND;
}

/* The columns y of a pack of instants. */
static void scene_columns(const scene_design* now, casadi_real* at, casadi_real* y) {
  const casadi_real* arg[5];
  casadi_real* res[1];
  scene_driven(now, at, arg);
  arg[4] = now->constants;
  res[0] = y;
  instant(arg, res);
}

/* A sum that is finite if all so many columns are; four sums, for each addition waits for the one before. */
LANES_INLINE casadi_real scene_sum(const casadi_real* y, casadi_int columns) {
  casadi_real sum[4];
  casadi_int j, k;
  for (j = 0; j < 4; ++j) sum[j] = 0;
  for (k = 0; k < columns/4*4; k += 4) {
    for (j = 0; j < 4; ++j) sum[j] = sum[j] + y[k + j];
  }
  for (k = columns/4*4; k < columns; ++k) sum[0] = sum[0] + y[k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* So many rows of a pack of instants that begins at i; the last pack is filled up with the last instant. */
LANES_INLINE void scene_taken(const lagrange_casadi_instants* call, const lanes_real* from, casadi_int rows, casadi_int i,
                              casadi_real* pack) {
  const casadi_int many = call->n - i, stride = call->stride;
  lanes_real lanes[LANES];
  casadi_int j, k;
  for (k = 0; k < rows; ++k, from += stride) {
    if (many >= LANES) {
      pack[k] = scene_load(from + i);
    } else {
      for (j = 0; j < LANES; ++j) lanes[j] = from[i + (j < many ? j : many - 1)];
      pack[k] = scene_load(lanes);
    }
  }
}

/* The columns y of the pack of instants that begins at i, where iterated coordinates are z. */
LANES_INLINE void scene_pack(const scene_design* now, casadi_int i, casadi_real* y) {
  casadi_real at[SCENE_PLACE + SCENE_NZ];
  scene_taken(now->call, now->call->t, SCENE_NT, i, at);
  scene_taken(now->call, now->call->z, SCENE_NZ, i, at + SCENE_PLACE);
  scene_columns(now, at, y);
}

/* Check the columns y of a pack that begins at i: where a value is not finite, and nothing else was to be said, status[i] becomes
   SCENE_NOT_FINITE. */
LANES_INLINE void scene_check(const lagrange_casadi_instants* call, casadi_int i, const casadi_real* y) {
  const casadi_int many = call->n - i < LANES ? call->n - i : LANES;
  casadi_real sum = scene_sum(y, SCENE_OUTPUTS);
  lanes_real lanes[LANES];
  casadi_int j;
  sum = sum - sum;
  if (!lanes_any_nan(sum)) return;
  scene_store(lanes, sum);
  for (j = 0; j < many; ++j)
    if (lanes[j] != lanes[j] && call->status[i + j] == SCENE_OK) call->status[i + j] = SCENE_NOT_FINITE;
}

/* Whether the columns of so many instants are larger than caches, and lie so that whole lines of their rows can be streamed. */
static int scene_streams(const lagrange_casadi_instants* call, casadi_int many) {
  const size_t size = sizeof *call->out;
  return SCENE_OUTPUTS*size*(size_t) many >= SCENE_STREAMED && ((size_t) call->out | (size_t) call->apart*size) % SCENE_LINE == 0;
}

/* Write the columns y of packs, one pack after another, and check them: out[k*apart + i] and on become column k at so many instants
   from i on. If streams is set, lines are streamed past the caches. Packs are summed as they are written, while stores wait for memory;
   numbers are not, for compilers make packs of those that lie side by side. */
static void scene_write(const lagrange_casadi_instants* call, casadi_int i, casadi_int many, const casadi_real* y, int streams) {
  const casadi_real* from = y;
  lanes_real* to = call->out + i;
  casadi_real sum[SCENE_PACKS], all;
  casadi_int j, k;
  all = 0;
  for (j = 0; j < SCENE_PACKS; ++j) sum[j] = all;
  for (k = 0; k < SCENE_OUTPUTS; ++k, ++from, to += call->apart) {
    if (many < SCENE_BLOCK) {
      for (j = 0; j < many; j += LANES) {
        memcpy(to + j, from + j/LANES*SCENE_COLUMNS, (size_t) (many - j < LANES ? many - j : LANES)*sizeof *to);
      }
    } else {
      for (j = 0; j < SCENE_PACKS; ++j) {
        if (LANES > 1) sum[j] = sum[j] + from[j*SCENE_COLUMNS];
        if (streams) lanes_stream(to + j*LANES, from[j*SCENE_COLUMNS]);
        else scene_store(to + j*LANES, from[j*SCENE_COLUMNS]);
      }
    }
  }
  for (j = 0; j < SCENE_PACKS; ++j) all = all + sum[j];
  if (LANES > 1 && many >= SCENE_BLOCK && !lanes_any_nan(all - all)) return;
  for (j = 0; j < many && j < SCENE_BLOCK; j += LANES) scene_check(call, i + j, y + j/LANES*SCENE_COLUMNS);
}

#ifndef SCENE_REDUCED
/* The same two over some instants of one design: all that such a file is called for. In single precision times and parameters are
   pairs, a value rounded to single and what that leaves of it: t[stride + i] is the rest of t[i], p[SCENE_NP + k] that of p[k]. */
LAGRANGE_CASADI_EXPORT void lagrange_casadi_follow(const lagrange_casadi_instants* call, long long first, long long last) {
  scene_follow(call, first, last);
}

LAGRANGE_CASADI_EXPORT void lagrange_casadi_evaluate(const lagrange_casadi_instants* call, long long first, long long last) {
  const int streams = scene_streams(call, call->n);
  casadi_real y[SCENE_PACKS*SCENE_SOME(SCENE_COLUMNS)];
  scene_design now;
  casadi_int i, j;
  scene_begin(&now, call);
  for (i = first; i < last; i += SCENE_BLOCK) {
    for (j = 0; j < SCENE_PACKS && i + j*LANES < last; ++j) scene_pack(&now, i + j*LANES, y + j*SCENE_COLUMNS);
    scene_write(call, i, last - i, y, streams);
  }
  if (streams) lanes_streamed();
}
#endif

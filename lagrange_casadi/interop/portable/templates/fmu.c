/* $name as a unit of FMI 2.0, for Model Exchange and for Co-Simulation. Written by lagrange_casadi $version, scene $scene.

   Nothing is integrated: outputs follow from inputs, parameters and the time. What goes on from one instant to the next are the
   whole turns of angles that loops set, where iterated loops stand, and the inputs, for a dead centre between two instants to be
   seen. What fails leaves them as they were.

   In a library that is linked statically all names have the prefix FMI2_FUNCTION_PREFIX, which is to be defined then. */
#include "fmi2Functions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "${p}.h"

#ifdef FMI2_FUNCTION_PREFIX
#undef fmi2FullName
#define PASTED(a, b) a##b
#define JOINED(a, b) PASTED(a, b)
#define fmi2FullName(name) JOINED(FMI2_FUNCTION_PREFIX, name)
#endif

#define GUID "$guid"
#define PARAMETERS ${parameters}u
#define VALUES ${values}u /* parameters, then inputs: value references from 0 on */
#define OUTPUTS ${outputs}u /* those that follow */
#define TIMED $timed /* whether anything depends on the time itself, whose value reference is then the last */
#define TURN 6.283185307179586

#define INSTANTIATED 1u
#define INITIALIZING 2u
#define RUNNING 4u
#define TERMINATED 8u

typedef struct {
  ${p}_model model;
$if closing
  ${p}_inputs last; /* those of the last instant that has outputs */
  double last_time;
$end closing
  double values[VALUES];
  double outputs[OUTPUTS]; /* of the last instant that has some */
  double time, reached;
  unsigned mode;
  int prepared; /* whether the model is that of the parameters */
  int begun; /* whether loops and angles go on from the last instant */
  int current; /* whether the outputs, or their failure, are of now */
  fmi2Status status;
} State;

typedef struct {
  State state;
  fmi2CallbackLogger logger;
  fmi2CallbackAllocateMemory allocate;
  fmi2CallbackFreeMemory release;
  fmi2ComponentEnvironment environment;
  int discards; /* whether to log them */
  char name[];
} Unit;

static const double start[VALUES] = {
$start
};

static const char turning[OUTPUTS] = {
$turning
};

static fmi2Status report(const Unit* unit, fmi2Status status, const char* what, const char* more) {
  const int discard = status == fmi2Discard;
  char message[512];
  if (unit->logger && (unit->discards || !discard)) {
    snprintf(message, sizeof message, "%s%s", what, more);
    unit->logger(unit->environment, unit->name, status, discard ? "logStatusDiscard" : "logStatusError", message);
  }
  return status;
}

/* Another instant may be better than this one; other parameters must be given. */
static fmi2Status judged(const Unit* unit, ${p}_status status) {
  const int hopeless = status == ${P}_BAD_PARAMETER || status == ${P}_NOT_PREPARED;
  char at[64];
  if (status == ${P}_OK) return fmi2OK;
  snprintf(at, sizeof at, "t = %.9g s: ", unit->state.time);
  return report(unit, hopeless ? fmi2Error : fmi2Discard, at, ${p}_message(status));
}

static int out_of_order(const Unit* unit, unsigned modes, const char* function) {
  if (unit->state.mode & modes) return 0;
  report(unit, fmi2Error, function, " is called out of order");
  return 1;
}

static fmi2Status unsupported(fmi2Component c, const char* function) {
  return report((const Unit*) c, fmi2Error, function, " is not supported");
}

static void reset(State* state) {
  memset(state, 0, sizeof *state);
  memcpy(state->values, start, sizeof start);
  state->time = state->reached = $start_time;
  state->mode = INSTANTIATED;
}

static void set_time(State* state, double time) {
  if (TIMED && !(time == state->time)) state->current = 0;
  state->time = time;
}

$if setting
static const struct {
  const char* name;
  double low, high;
} limits[PARAMETERS] = {
$limits
};

static int refused(const Unit* unit, unsigned k, double value) {
  char which[128];
  if (value - value == 0 && value >= limits[k].low && value <= limits[k].high) return 0;
  snprintf(which, sizeof which, "%.64s = %.9g: ", limits[k].name, value);
  report(unit, fmi2Error, which, ${p}_message(${P}_BAD_PARAMETER));
  return 1;
}

$end setting
/* A model of the present parameters; loops stay where they are. */
static fmi2Status prepare(Unit* unit) {
  State* state = &unit->state;
  ${p}_model model;
  ${p}_status status;
$if setting
  ${p}_parameters parameters;
$end setting
  if (state->prepared && state->begun) return fmi2OK;
$if setting
$set
  status = ${p}_prepare(&model, &parameters);
$end setting
$if not setting
  status = ${p}_prepare(&model);
$end setting
  if (status != ${P}_OK) return judged(unit, status);
$carried  state->model = model;
  state->prepared = 1;
  return fmi2OK;
}

$if inside

/* The scene's motion at a time. */
static ${p}_status motion(const ${p}_model* model, double time, ${p}_inputs* inputs) {
  return ${p}_motion(model, $time, inputs);
}
$end inside
$if place

static ${p}_status ahead(const ${p}_model* model, double time, double place, ${p}_inputs* inputs, double* gap) {
  const ${p}_status status = motion(model, time, inputs);
  *gap = $sign($value - place);
  return status;
}

/* The scene's motion where ${sought} is at a place. It always goes one way: from the scene's times the search widens until the
   place is between two times, and halves them as long as doubles are between. */
static ${p}_status reach(const ${p}_model* model, double place, ${p}_inputs* inputs) {
  double low = $low, high = $high, width = high - low, middle, gap, beyond;
  ${p}_status status;
  for (;; width *= 2) {
    status = ahead(model, low, place, inputs, &gap);
    if (status == ${P}_OK) status = ahead(model, high, place, inputs, &beyond);
    if (status != ${P}_OK) return status;
    if (!(gap > 0 || beyond < 0)) break;
    if (gap > 0 ? low <= $least : high >= $most) return ${P}_BAD_TIME;
    if (gap > 0) low = low - width > $least ? low - width : $least;
    else high = high + width < $most ? high + width : $most;
  }
  for (middle = low + (high - low)/2; low < middle && middle < high; middle = low + (high - low)/2) {
    status = ahead(model, middle, place, inputs, &gap);
    if (status != ${P}_OK) return status;
    if (gap < 0) low = middle; else high = middle;
  }
  status = motion(model, high, inputs);
$put
  return status;
}
$end place

static ${p}_status give(const State* state, ${p}_inputs* inputs) {
$give
}

static void take(const ${p}_outputs* outputs, double* found) {
$take
}

static fmi2Status update(Unit* unit) {
  State* state = &unit->state;
  ${p}_model before;
  ${p}_inputs inputs;
  ${p}_outputs outputs;
  ${p}_status status;
  double found[OUTPUTS];
  unsigned k;
  if (state->current) return state->status;
  state->current = 1;
  state->status = prepare(unit);
  if (state->status != fmi2OK) return state->status;
  before = state->model;
  status = give(state, &inputs);
  if (status == ${P}_OK) status = ${p}_evaluate(&state->model, &inputs, &outputs);
$if closing
  if (status == ${P}_OK && state->begun) {
    status = ${p}_between(&state->model, &state->last, &inputs, (${p}_real) (state->time - state->last_time));
  }
$end closing
  state->status = judged(unit, status);
  if (status != ${P}_OK) {
    state->model = before;
    return state->status;
  }
$if closing
  state->last = inputs;
  state->last_time = state->time;
$end closing
  take(&outputs, found);
  for (k = 0; k < OUTPUTS; ++k) {
    if (turning[k] && state->begun) found[k] += TURN*floor((state->outputs[k] - found[k])/TURN + 0.5);
    state->outputs[k] = found[k];
  }
  state->begun = state->mode == RUNNING;
  return fmi2OK;
}

$functions
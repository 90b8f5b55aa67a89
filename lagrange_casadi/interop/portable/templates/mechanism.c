/* $name: see ${p}.h. Written by lagrange_casadi $version, scene $scene. */
#include "${p}.h"

#include <math.h>$includes

#if defined __FAST_MATH__ || (defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0) || defined __ASSOCIATIVE_MATH__ || defined _M_FP_FAST
#error "compile without -ffast-math and the flags it implies: they remove NaN, which marks failures, and digits of phases"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

typedef ${p}_real casadi_real;

/* ---- The graph, one statement an instruction ---- */

$graph
/* ---- What calls it ---- */

#define SEAL $seal

static const casadi_real nothing = (casadi_real) NAN;

static int is_finite(casadi_real x) {
  return x - x == 0;
}

/* One value that is not finite makes their sum so; four sums, for each addition waits for the one before. */
static int all_finite(const casadi_real* x, int many) {
  casadi_real a = 0, b = 0, c = 0, d = 0;
  const int most = many - many%4;
  int k;
  for (k = 0; k < most; k += 4) {
    a = a + x[k];
    b = b + x[k + 1];
    c = c + x[k + 2];
    d = d + x[k + 3];
  }
  for (k = most; k < many; ++k) a = a + x[k];
  return is_finite((a + b) + (c + d));
}
$if turning

/* An angle without its whole turns, in (-pi, pi]. */
static casadi_real direction(casadi_real angle) {
  return angle - $turn*$ceil(angle/$turn - $half);
}
$end turning
$if iterated

$loops
$end iterated
$if rules

/* What a broken rule says, by its number. */
static const ${p}_status broken[] = {$broken};
$end rules
$tables
/* Within another function its values are read ahead of all that is written, and kept on the stack. */
#ifdef __GNUC__
__attribute__((noinline))
#endif
static void put(const casadi_real* y, ${p}_outputs* outputs) {
$put
}
$if setting

const ${p}_parameters ${p}_defaults = {
$defaults
};
$end setting

${p}_status ${p}_prepare(${p}_model* model$and_parameters) {
$if setting
  const ${p}_parameters* values = parameters ? parameters : &${p}_defaults;
$end setting
$if sound
  casadi_real sound_of[$sound];
  int k;
$end sound
$if prepared
  const casadi_real* arg[1];
  casadi_real* res[1];
$end prepared
  model->seal = 0;
$if prepare
$prepare
$end prepare
  model->seal = SEAL;
  return ${P}_OK;
}

${p}_status ${p}_motion(const ${p}_model* model, ${p}_real time$and_rest, ${p}_inputs* inputs) {
  casadi_real at[$at], d[$d], rate[$drives], acceleration[$drives];
  const casadi_real* arg[2];
  casadi_real* res[3];
$if far
  casadi_real far[$far];
$end far
$motion
  return ${P}_OK;
}

/* The columns of an instant, all of them finite unless what is returned is not ${P}_OK. */
static ${p}_status columns_of(${p}_model* model, const ${p}_inputs* inputs, casadi_real* y) {
$if moment
  casadi_real moment[$moment], counted[$counted];
$end moment
  casadi_real rate[$drives], acceleration[$drives];
$if drive
  casadi_real drive[$drive];
$end drive
  const casadi_real* arg[5];
  casadi_real* res[1];
$if rules
  casadi_real iterated = 0, rule;
$end rules
$if iterated
  ${p}_status closed;
$end iterated
  if (model->seal != SEAL) return ${P}_NOT_PREPARED;
$instant
  if (!all_finite(y, $rows)) return ${P}_NOT_FINITE;
  return ${P}_OK;
}

${p}_status ${p}_evaluate(${p}_model* model, const ${p}_inputs* inputs, ${p}_outputs* outputs) {
  casadi_real y[$rows];
  int k;
  const ${p}_status status = columns_of(model, inputs, y);
  if (status != ${P}_OK) {
    for (k = 0; k < $rows; ++k) y[k] = nothing;
  }
  put(y, outputs);
  return status;
}

${p}_status ${p}_batch(${p}_model* model, long many, const ${p}_inputs* inputs, ${p}_outputs* outputs, ${p}_status* statuses) {
  ${p}_status first = ${P}_OK, status;
  long i;
  for (i = 0; i < many; ++i) {
    status = ${p}_evaluate(model, inputs + i, outputs + i);
    if (first == ${P}_OK) first = status;
    if (statuses) statuses[i] = status;
  }
  return first;
}
$between$sections
const char* ${p}_message(${p}_status status) {
  switch (status) {
$messages
  }
  return "unknown status";
}

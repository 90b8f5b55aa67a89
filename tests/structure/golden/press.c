/* press: see press.h. Written by lagrange_casadi <version>, scene <scene>. */
#include "press.h"

#include <math.h>

#if defined __FAST_MATH__ || (defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0) || defined __ASSOCIATIVE_MATH__ || defined _M_FP_FAST
#error "compile without -ffast-math and the flags it implies: they remove NaN, which marks failures, and digits of phases"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

typedef press_real casadi_real;

/* ---- The graph, one statement an instruction ---- */

static void law(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2;
  a0 = 0.015707963267948967;
  a1 = arg[0][0];
  a0 = a0 * a1;
  a2 = 78.539816339744831;
  a2 = a0 + a2;
  a1 = a2 * a1;
  res[0][0] = a1;
  a0 = a0 + a2;
  res[1][0] = a0;
  a0 = 0.031415926535897934;
  res[2][0] = a0;
}

static void count(const casadi_real** arg, casadi_real** res) {
  casadi_real a0;
  a0 = arg[0][0];
  res[0][0] = a0;
  a0 = arg[0][1];
  res[0][1] = a0;
}

static void constants_of(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0 = arg[0][0];
  res[0][0] = a0;
  a1 = arg[0][1];
  res[0][1] = a1;
  a2 = a1 * a1;
  a3 = 1.0 / a2;
  a3 = copysign(a3, a2);
  res[0][2] = a3;
  a3 = -0.16666666666666669;
  a2 = arg[0][2];
  a4 = a3 * a2;
  a4 = a4 * a0;
  a4 = a4 * a0;
  a5 = 0.5;
  a6 = a5 * a2;
  a0 = a0 * a0;
  a6 = a6 * a0;
  a4 = a4 + a6;
  res[0][3] = a4;
  a4 = 4.9050000000000002;
  a6 = arg[0][3];
  a0 = a4 * a6;
  res[0][4] = a0;
  a3 = a3 * a6;
  a3 = a3 * a1;
  a0 = a3 * a1;
  res[0][5] = a0;
  a0 = arg[0][4];
  res[0][6] = a0;
  a5 = a5 * a6;
  res[0][7] = a5;
  a4 = a4 * a2;
  res[0][8] = a4;
  a4 = 1.0 / a1;
  a4 = copysign(a4, a1);
  res[0][9] = a4;
  a5 = a5 * a1;
  a5 = a5 + a3;
  res[0][10] = a5;
}

static void matter(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1;
  a0 = arg[0][0];
  a1 = arg[0][1];
  a0 = a0 + a1;
  res[0][0] = a0;
  res[0][1] = a1;
  a1 = arg[0][3];
  res[0][2] = a1;
}

static void section_of_0(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  a0 = arg[0][0];
  a1 = arg[0][1];
  a2 = arg[2][1];
  a3 = 1.0;
  a4 = arg[3][0];
  a3 = a3 - a4;
  a5 = a2 * a3;
  a1 = a1 * a5;
  a0 = a0 + a1;
  a1 = arg[0][2];
  a6 = arg[2][0];
  a7 = a4 * a5;
  a8 = a3 * a3;
  a9 = 2.0;
  a9 = a8 / a9;
  a9 = a2 * a9;
  a7 = a7 + a9;
  a7 = a6 * a7;
  a1 = a1 * a7;
  a0 = a0 + a1;
  res[0][0] = a0;
  a0 = arg[0][3];
  a1 = arg[0][4];
  a5 = a1 * a5;
  a5 = a0 + a5;
  a10 = arg[0][5];
  a7 = a10 * a7;
  a5 = a5 + a7;
  res[0][1] = a5;
  a5 = arg[0][6];
  a7 = a6 * a3;
  a0 = a0 * a7;
  a5 = a5 + a0;
  a0 = a6 * a9;
  a1 = a1 * a0;
  a5 = a5 + a1;
  a6 = a6 * a6;
  a4 = a4 * a9;
  a3 = a3 * a8;
  a8 = 3.0;
  a3 = a3 / a8;
  a2 = a2 * a3;
  a4 = a4 + a2;
  a6 = a6 * a4;
  a10 = a10 * a6;
  a5 = a5 + a10;
  res[0][2] = a5;
}

static void sound(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3;
  a0 = arg[0][0];
  res[0][0] = a0;
  a0 = arg[0][1];
  res[0][1] = a0;
  a0 = arg[0][2];
  a1 = arg[0][3];
  a2 = a0 + a1;
  a3 = arg[0][4];
  a2 = a2 + a3;
  res[0][2] = a2;
  res[0][3] = a0;
  res[0][4] = a1;
  res[0][5] = a3;
}

static void instant(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11;
  casadi_real a12, a13, a14, a15;
  a0 = arg[4][1];
  a1 = arg[0][1];
  a2 = sin(a1);
  a3 = arg[4][0];
  a2 = a2 * a3;
  a4 = a0 - a2;
  a0 = a0 + a2;
  a4 = a4 * a0;
  a0 = arg[4][2];
  a0 = a4 * a0;
  res[0][0] = a0;
  a0 = 0.0;
  res[0][1] = a0;
  a5 = arg[4][3];
  a6 = arg[2][0];
  a5 = a5 * a6;
  a1 = cos(a1);
  a1 = a1 * a3;
  a3 = arg[4][4];
  a4 = sqrt(a4);
  a7 = a4 * a3;
  a8 = arg[4][5];
  a9 = a6 * a1;
  a10 = arg[1][0];
  a11 = a10 * a10;
  a12 = a11 * a2;
  a9 = a9 - a12;
  a10 = a10 * a1;
  a12 = 1.0 / a4;
  a12 = copysign(a12, a4);
  a10 = a10 * a12;
  a10 = a10 * a10;
  a13 = a10 * a2;
  a13 = a9 + a13;
  a13 = a13 * a12;
  a8 = a8 * a13;
  a7 = a7 - a8;
  a8 = arg[4][6];
  a11 = a11 * a1;
  a6 = a6 * a2;
  a11 = a11 + a6;
  a6 = a10 * a4;
  a14 = a13 * a2;
  a6 = a6 + a14;
  a6 = a11 + a6;
  a8 = a8 * a6;
  a14 = arg[4][7];
  a6 = a14 * a6;
  a6 = a8 + a6;
  a15 = a2 * a6;
  a7 = a7 - a15;
  a7 = a7 * a12;
  a3 = a3 - a7;
  a12 = 9.8100000000000005;
  a12 = a12 + a9;
  a9 = a14 * a12;
  a3 = a3 + a9;
  a9 = arg[4][8];
  a3 = a3 + a9;
  a1 = a1 * a3;
  a5 = a5 + a1;
  a1 = a14 * a11;
  a6 = a6 + a1;
  a6 = a2 * a6;
  a5 = a5 + a6;
  res[0][2] = a5;
  a5 = arg[4][9];
  a4 = a4 * a5;
  a8 = a4 * a8;
  a2 = a2 * a5;
  a7 = a2 * a7;
  a8 = a8 - a7;
  res[0][3] = a8;
  a8 = a2 * a12;
  a7 = a4 * a11;
  a8 = a8 + a7;
  res[0][4] = a8;
  res[0][5] = a10;
  a4 = a4 * a12;
  a2 = a2 * a11;
  a11 = a4 - a2;
  a11 = a11 * a14;
  a14 = arg[4][10];
  a14 = a13 * a14;
  a11 = a11 - a14;
  res[0][6] = a11;
  a2 = a2 - a4;
  res[0][7] = a2;
  res[0][8] = a13;
  res[0][9] = a0;
}

static void status(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3, a4, a5;
  a0 = arg[0][0];
  a1 = -7.1054273576010019e-15;
  a1 = a0 < a1;
  a2 = 1.0;
  a2 = a1 != 0 ? a2 : 0;
  a1 = a1 == 0;
  a3 = 7.1054273576010019e-15;
  a3 = a3 < a0;
  a0 = a3 == 0;
  a4 = 2.0;
  a0 = a0 != 0 ? a4 : 0;
  a4 = 1e-08;
  a5 = arg[1][0];
  a4 = a4 * a5;
  a5 = arg[0][1];
  a5 = fabs(a5);
  a4 = a4 < a5;
  a5 = 4.0;
  a4 = a4 != 0 ? a5 : 0;
  a3 = a3 != 0 ? a4 : 0;
  a0 = a0 + a3;
  a1 = a1 != 0 ? a0 : 0;
  a2 = a2 + a1;
  res[0][0] = a2;
}

static void closing(const casadi_real** arg, casadi_real** res) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0 = arg[4][1];
  a1 = arg[0][1];
  a2 = sin(a1);
  a3 = arg[4][0];
  a2 = a2 * a3;
  a4 = a0 - a2;
  a2 = a0 + a2;
  a5 = a4 * a2;
  a0 = a0 * a0;
  a6 = 1.0 / a0;
  a6 = copysign(a6, a0);
  a5 = a5 * a6;
  res[0][0] = a5;
  a1 = cos(a1);
  a3 = a3 * a1;
  a4 = a4 * a3;
  a2 = a2 * a3;
  a4 = a4 - a2;
  a6 = a6 * a4;
  a4 = arg[1][0];
  a4 = a6 * a4;
  res[1][0] = a4;
  a4 = 0.0;
  res[2][0] = a4;
  res[2][1] = a6;
}

/* ---- What calls it ---- */

#define SEAL <seal>

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

/* What a broken rule says, by its number. */
static const press_status broken[] = {PRESS_OK, PRESS_NOT_ASSEMBLED, PRESS_DEAD_CENTRE, PRESS_PASSES_DEAD_CENTRE, PRESS_NOT_CLOSED};

/* Within another function its values are read ahead of all that is written, and kept on the stack. */
#ifdef __GNUC__
__attribute__((noinline))
#endif
static void put(const casadi_real* y, press_outputs* outputs) {
  outputs->effort_O = y[2];
  outputs->section_rod_n0 = y[3];
  outputs->section_rod_n1 = y[4];
  outputs->section_rod_n2 = y[5];
  outputs->section_rod_f0 = y[6];
  outputs->section_rod_f1 = y[7];
  outputs->section_rod_f2 = y[8];
  outputs->section_rod_m0 = y[9];
}

const press_parameters press_defaults = {
  0.10000000000000001 /* r */,
  0.20000000000000001 /* l */,
  0.10000000000000001 /* m1 */,
  0.10000000000000001 /* m2 */,
  0.10000000000000001 /* m3 */
};

press_status press_prepare(press_model* model, const press_parameters* parameters) {
  const press_parameters* values = parameters ? parameters : &press_defaults;
  casadi_real sound_of[6];
  int k;
  const casadi_real* arg[1];
  casadi_real* res[1];
  model->seal = 0;
  if (!(is_finite(values->r))) return PRESS_BAD_PARAMETER;
  model->parameters[0] = values->r;
  if (!(is_finite(values->l))) return PRESS_BAD_PARAMETER;
  model->parameters[1] = values->l;
  if (!(is_finite(values->m1))) return PRESS_BAD_PARAMETER;
  model->parameters[2] = values->m1;
  if (!(is_finite(values->m2))) return PRESS_BAD_PARAMETER;
  model->parameters[3] = values->m2;
  if (!(is_finite(values->m3))) return PRESS_BAD_PARAMETER;
  model->parameters[4] = values->m3;
  arg[0] = model->parameters;
  res[0] = sound_of;
  sound(arg, res);
  for (k = 0; k < 3; ++k) {
    if (!(sound_of[k] > 0 && is_finite(sound_of[k]))) return PRESS_BAD_PARAMETER;
  }
  for (k = 3; k < 6; ++k) {
    if (!(sound_of[k] >= 0 && is_finite(sound_of[k]))) return PRESS_BAD_PARAMETER;
  }
  arg[0] = model->parameters;
  res[0] = model->constants;
  constants_of(arg, res);
  arg[0] = model->parameters;
  res[0] = model->matter;
  matter(arg, res);
  model->seal = SEAL;
  return PRESS_OK;
}

press_status press_motion(const press_model* model, press_real time, press_inputs* inputs) {
  casadi_real at[1], d[1], rate[1], acceleration[1];
  const casadi_real* arg[2];
  casadi_real* res[3];
  if (model->seal != SEAL) {
    inputs->O = nothing;
    inputs->O_rate = nothing;
    inputs->O_acceleration = nothing;
    return PRESS_NOT_PREPARED;
  }
  if (!is_finite(time)) {
    inputs->O = nothing;
    inputs->O_rate = nothing;
    inputs->O_acceleration = nothing;
    return PRESS_BAD_TIME;
  }
  at[0] = time;
  arg[0] = at;
  arg[1] = model->parameters;
  res[0] = d;
  res[1] = rate;
  res[2] = acceleration;
  law(arg, res);
  inputs->O = d[0];
  inputs->O_rate = rate[0];
  inputs->O_acceleration = acceleration[0];
  return PRESS_OK;
}

/* The columns of an instant, all of them finite unless what is returned is not PRESS_OK. */
static press_status columns_of(press_model* model, const press_inputs* inputs, casadi_real* y) {
  casadi_real moment[2], counted[2];
  casadi_real rate[1], acceleration[1];
  const casadi_real* arg[5];
  casadi_real* res[1];
  casadi_real iterated = 0, rule;
  if (model->seal != SEAL) return PRESS_NOT_PREPARED;
  moment[0] = 0;
  moment[1] = inputs->O;
  rate[0] = inputs->O_rate;
  acceleration[0] = inputs->O_acceleration;
  if (!is_finite(inputs->O + inputs->O_rate + inputs->O_acceleration)) return PRESS_BAD_INPUT;
  arg[0] = moment;
  arg[1] = model->parameters;
  res[0] = counted;
  count(arg, res);
  arg[0] = counted;
  arg[1] = rate;
  arg[2] = acceleration;
  arg[3] = 0;
  arg[4] = model->constants;
  res[0] = y;
  instant(arg, res);
  arg[0] = y;
  arg[1] = model->matter;
  arg[2] = &iterated;
  res[0] = &rule;
  status(arg, res);
  if (rule > 0) return broken[(int) rule];
  if (!all_finite(y, 10)) return PRESS_NOT_FINITE;
  return PRESS_OK;
}

press_status press_evaluate(press_model* model, const press_inputs* inputs, press_outputs* outputs) {
  casadi_real y[10];
  int k;
  const press_status status = columns_of(model, inputs, y);
  if (status != PRESS_OK) {
    for (k = 0; k < 10; ++k) y[k] = nothing;
  }
  put(y, outputs);
  return status;
}

press_status press_batch(press_model* model, long many, const press_inputs* inputs, press_outputs* outputs, press_status* statuses) {
  press_status first = PRESS_OK, status;
  long i;
  for (i = 0; i < many; ++i) {
    status = press_evaluate(model, inputs + i, outputs + i);
    if (first == PRESS_OK) first = status;
    if (statuses) statuses[i] = status;
  }
  return first;
}

/* A step between two instants, so many seconds apart. */
typedef struct {
  press_model* model;
  const press_inputs* before;
  const press_inputs* after;
  casadi_real width;
} centre_step;

typedef casadi_real centre_real;

static const casadi_real zero[1] = {7.1054273576010019e-15};

/* How far a coordinate that changes by so much has come at a fraction x of a step of h seconds, with its rates and accelerations
   at both ends; where h is 0, on the straight way. Its rate and acceleration there, for a unit of x, are what is
   returned by way of rate and acceleration. */
static casadi_real come(casadi_real x, casadi_real h, casadi_real change, casadi_real from_v, casadi_real to_v, casadi_real from_a,
                        casadi_real to_a, casadi_real* rate, casadi_real* acceleration) {
  const casadi_real v0 = h != 0 ? h*from_v : change, v1 = h != 0 ? h*to_v : change, a0 = h*h*from_a, a1 = h*h*to_a;
  const casadi_real left = change - v0 - a0/2, gain = v1 - v0 - a0, bend = a1 - a0;
  const casadi_real c3 = 10*left - 4*gain + bend/2, c4 = 7*gain - 15*left - bend, c5 = 6*left - 3*gain + bend/2;
  *rate = v0 + x*(a0 + x*(3*c3 + x*(4*c4 + x*5*c5)));
  *acceleration = a0 + x*(6*c3 + x*(12*c4 + x*20*c5));
  return x*(v0 + x*(a0/2 + x*(c3 + x*(c4 + x*c5))));
}

/* Squares of sines of all loops at a fraction x of a step, their rates for a unit of x, and their slopes; NaN where loops do not
   converge. */
static void centre_at(const centre_step* step, casadi_real x, casadi_real* squares, casadi_real* rates, casadi_real* slopes) {
  const press_inputs *before = step->before, *after = step->after;
  const casadi_real h = step->width;
  casadi_real moment[2], counted[2], rate[1], acceleration[1], gone;
  const casadi_real* arg[5];
  casadi_real* res[3];
  int k;
  gone = x*h;
  moment[0] = 0;
  gone = come(x, h, (after->O - before->O), before->O_rate, after->O_rate, before->O_acceleration, after->O_acceleration, rate + 0, acceleration + 0);
  moment[1] = before->O + gone;
  arg[0] = moment;
  arg[1] = step->model->parameters;
  res[0] = counted;
  count(arg, res);
  arg[0] = counted;
  arg[1] = rate;
  arg[2] = acceleration;
  arg[3] = 0;
  arg[4] = step->model->parameters;
  res[0] = squares;
  res[1] = rates;
  res[2] = slopes;
  closing(arg, res);
  for (k = 0; k < 1; ++k) rates[k] = rates[k] + (h - 1)*slopes[2*k];
}

static void centre_path(const centre_step* step, int which, const centre_real* x, centre_real* square, centre_real* rate,
                        centre_real* slope) {
  casadi_real squares[1], rates[1], slopes[2];
  int j, k;
  for (j = 0; j < 8; ++j) {
    centre_at(step, x[j], squares, rates, slopes);
    square[j] = squares[which];
    rate[j] = rates[which];
    for (k = 0; k < 2; ++k) slope[2*j + k] = slopes[2*which + k];
  }
}

/* Whether the determinant of loop number which changes its sign in a step, or its links do not reach there: by the order of the zero
   of its square. centre_path gives at 8 fractions x of the step the square, its rate for a unit of x, and 2 slopes for each
   fraction; below limit squares are zero within rounding. */
static int centre_passes(const centre_step* step, int which, centre_real limit) {
  centre_real x[8], square[8], rate[8], slope[8*2], low = 0, high = 1, order = 0, same = 0;
  int touches = 0, round, least, a, b, k;
  for (round = 0; round < 20; ++round) {
    for (k = 0; k < 8; ++k) x[k] = k < 8 - 1 ? low + (high - low)*(centre_real) k/(8 - 1) : high;
    centre_path(step, which, x, square, rate, slope);
    least = 0;
    for (k = 0; k < 8; ++k) {
      if (square[k] < -limit) return 1;
      if (!(square[k] == square[k])) square[k] = 0;
      if (square[k] < square[least]) least = k;
    }
    touches |= square[least] <= limit;
    a = rate[least] < 0 ? least : least - 1;
    b = a + 1;
    while (a > 0 && square[a] <= 16*limit) --a;
    while (b < 8 - 1 && square[b] <= 16*limit) ++b;
    if (a < 0 || b == 8 || !(rate[a] < 0 && rate[b] > 0)) return 0;
    order = (x[b] - x[a])/(square[b]/rate[b] - square[a]/rate[a]);
    if (order < 1) return 0;
    same = 0;
    for (k = 0; k < 2; ++k) same = same + slope[2*a + k]*slope[2*b + k];
    if (b - a == 8 - 1) break;
    low = x[a];
    high = x[b];
  }
  return touches && !(order >= 3 && order <= 10 && same >= 0);
}

press_status press_between(press_model* model, const press_inputs* before, const press_inputs* after, press_real step) {
  casadi_real squares[2][1], rates[2][1], slopes[2];
  centre_step whole;
  int k;
  if (model->seal != SEAL) return PRESS_NOT_PREPARED;
  if (!is_finite(before->O + before->O_rate + before->O_acceleration + after->O + after->O_rate + after->O_acceleration + step)) return PRESS_BAD_INPUT;
  whole.model = model;
  whole.before = before;
  whole.after = after;
  whole.width = step;
  centre_at(&whole, 0, squares[0], rates[0], slopes);
  centre_at(&whole, 1, squares[1], rates[1], slopes);
  for (k = 0; k < 1; ++k) {
    if (rates[0][k] > 0 && !(rates[1][k] > 0 && squares[1][k] <= squares[0][k])) continue;
    if (rates[1][k] < 0 && !(rates[0][k] < 0 && squares[0][k] <= squares[1][k])) continue;
    if (centre_passes(&whole, k, zero[k])) return PRESS_PASSES_DEAD_CENTRE;
  }
  return PRESS_OK;
}
press_status press_section(const press_model* model, const press_outputs* outputs, press_link link, press_real xi, press_forces* forces) {
  casadi_real law[7], found[3];
  const casadi_real* arg[4];
  casadi_real* res[1];
  forces->axial = forces->shear = forces->bending = nothing;
  if (model->seal != SEAL) return PRESS_NOT_PREPARED;
  if (!(xi >= 0 && xi <= 1)) return PRESS_BAD_RATIO;
  arg[0] = law;
  arg[1] = 0;
  arg[3] = &xi;
  res[0] = found;
  switch (link) {
  case PRESS_LINK_ROD:
    law[0] = outputs->section_rod_n0;
    law[1] = outputs->section_rod_n1;
    law[2] = outputs->section_rod_n2;
    law[3] = outputs->section_rod_f0;
    law[4] = outputs->section_rod_f1;
    law[5] = outputs->section_rod_f2;
    law[6] = outputs->section_rod_m0;
    arg[2] = model->matter + 1;
    section_of_0(arg, res);
    break;
  default:
    return PRESS_NO_LINK;
  }
  if (!all_finite(found, 3)) return PRESS_NOT_FINITE;
  forces->axial = found[0];
  forces->shear = found[1];
  forces->bending = found[2];
  return PRESS_OK;
}

press_status press_sections(const press_model* model, const press_outputs* outputs, press_link link, long many, const press_real* xi,
                           press_forces* forces) {
  press_status first = PRESS_OK, status;
  long i;
  for (i = 0; i < many; ++i) {
    status = press_section(model, outputs, link, xi[i], forces + i);
    if (first == PRESS_OK) first = status;
  }
  return first;
}

const char* press_message(press_status status) {
  switch (status) {
  case PRESS_OK:
    return "there is a result";
  case PRESS_NOT_PREPARED:
    return "the model was not prepared";
  case PRESS_BAD_PARAMETER:
    return "a parameter is not finite, or out of its range, or gives a link no length or a negative mass";
  case PRESS_BAD_INPUT:
    return "an input is not finite";
  case PRESS_BAD_TIME:
    return "the time is not finite, or outside the samples or beyond the curves of the motion";
  case PRESS_BAD_RATIO:
    return "a ratio xi/l is outside 0 to 1";
  case PRESS_NO_LINK:
    return "there is no such link";
  case PRESS_NOT_ASSEMBLED:
    return "a loop cannot be closed: its links do not reach";
  case PRESS_DEAD_CENTRE:
    return "a loop is at a dead centre, a joint is in gimbal lock, a two-force link lies along its beside= direction, or the drives cannot produce the motion: forces are indeterminate";
  case PRESS_NOT_CONVERGED:
    return "the iterated loops did not converge";
  case PRESS_JUMPED:
    return "an iterated loop has jumped to another branch: take more instants";
  case PRESS_SLOW:
    return "the iterated loops converge slowly: they are near a dead centre";
  case PRESS_INCONSISTENT:
    return "the loops are over-constrained and do not fit, or the motion violates a non-holonomic constraint";
  case PRESS_NOT_CLOSED:
    return "the solution of a loop does not satisfy its equations";
  case PRESS_UNDETERMINED:
    return "equilibrium does not determine all outputs: the mechanism is over-constrained";
  case PRESS_NOT_FINITE:
    return "a result is not finite: the mechanism is singular, or its numbers overflow";
  case PRESS_TURNED:
    return "a load depends on the number of revolutions of an angle, which cannot be determined";
  case PRESS_BEYOND_ENDS:
    return "the argument of a curve is outside the curve's range";
  case PRESS_JAMS:
    return "the mechanism jams: its friction forces have no unique solution";
  case PRESS_AT_REST:
    return "a joint with friction is at rest, so its friction is indeterminate: take instants of motion, or give the friction smooth=";
  case PRESS_PASSES_DEAD_CENTRE:
    return "between two instants a loop passes through a dead centre, a joint through gimbal lock, a two-force link through its beside= direction, or the drives through a position in which they cannot produce the motion";
  case PRESS_STROKE:
    return "a cylinder or a strut is longer than open, or shorter than closed";
  case PRESS_LOST_CONTACT:
    return "a contact pulls or slides";
  }
  return "unknown status";
}

/* Compares $name, as your compiler and your machine make it, with what its author computed in doubles. */
#include "$p.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define INSTANTS $instants
#define STEPS $steps
#define INPUTS $n_inputs
#define OUTPUTS $n_outputs
#define LINKS $n_links
#define RATIOS $n_ratios

/* Each time, and what rounding it to single precision left. */
static const double times[INSTANTS][2] = {
$times
};
static const double inputs_at[INSTANTS][INPUTS] = {
$inputs
};
static const double inputs_off[INPUTS] = {$inputs_off};
static const double outputs_at[INSTANTS][OUTPUTS] = {
$outputs
};
static const double outputs_off[OUTPUTS] = {$outputs_off};
$if link

/* $forces, of each link, at each ratio. */
static const double forces_at[INSTANTS][LINKS*RATIOS*$n_forces] = {
$forces_at
};
static const double forces_off[LINKS*$n_forces] = {$forces_off};
static const double ratios[RATIOS] = {$ratios};
$end link
$if by

/* How the outputs change with each parameter. */
static const double slopes_at[INSTANTS][$n_slopes] = {
$slopes_at
};
static const double slopes_off[$n_slopes] = {$slopes_off};
$end by

static int complaints = 0, compared = 0;
static double worst = 0;

static void complain(const char* what) {
  ++complaints;
  printf("wrong: %s\n", what);
}

static void expect(${p}_status found, ${p}_status expected) {
  if (found == expected) return;
  ++complaints;
  printf("wrong: status \"%s\", where \"%s\" was expected\n", ${p}_message(found), ${p}_message(expected));
}

static void compare(const char* what, double expected, double found, double allowed, int angle) {
  double off = found - expected;
  if (angle) off = remainder(off, 6.2831853071795862);
  off = fabs(off);
  ++compared;
  if (off > worst*allowed) worst = off/allowed;
  if (off <= allowed) return;
  ++complaints;
  printf("wrong: %s is %.9g, where %.9g was expected, within %.2g\n", what, found, expected, allowed);
}

static void give(const double* row, ${p}_inputs* inputs) {
$given
}

static void check_outputs(const ${p}_outputs* outputs, const double* row) {
$taken_outputs
}
$if link

static void check_sections(const ${p}_model* model, const ${p}_outputs* outputs, int k) {
  static const ${p}_link links[LINKS] = {
$links
  };
  int i, j;
  for (i = 0; i < LINKS; ++i) {
    for (j = 0; j < RATIOS; ++j) {
      const double* row = forces_at[k] + $n_forces*(RATIOS*i + j);
      ${p}_forces forces;
      expect(${p}_section(model, outputs, links[i], (${p}_real) ratios[j], &forces), ${P}_OK);
$taken_forces
    }
  }
}
$end link
$if by

static void check_sensitivity(${p}_model* model, int k) {
  ${p}_inputs inputs;
  ${p}_outputs outputs;
  ${p}_sensitivities found;
  give(inputs_at[k], &inputs);
  expect(${p}_sensitivity(model, (${p}_real) times[k][0], &inputs, &outputs, &found), ${P}_OK);
  check_outputs(&outputs, outputs_at[k]);
$taken_slopes
  expect(${p}_sensitivity(model, (${p}_real) NAN, &inputs, &outputs, &found), ${P}_BAD_TIME);
  if (found.$first_output.$by == found.$first_output.$by) complain("sensitivities are left as they were where the time is no number");
}
$end by

static void check_motion(const ${p}_model* model, int k) {
  ${p}_inputs inputs;
  expect(${p}_motion(model, (${p}_real) times[k][0]$time_rest, &inputs), ${P}_OK);
$taken_inputs
}

/* Iterated loops must be led from one golden instant to the next. */
static void lead(${p}_model* model, int k) {
  int step;
  for (step = 1; k > 0 && step < STEPS; ++step) {
    const double time = times[k - 1][0] + (times[k][0] - times[k - 1][0])*step/STEPS;
    ${p}_inputs inputs;
    ${p}_outputs outputs;
    expect(${p}_motion(model, (${p}_real) time$and_zero, &inputs), ${P}_OK);
    expect(${p}_evaluate(model, &inputs, &outputs), ${P}_OK);
  }
}

static void check_misuse(void) {
  ${p}_model model;
  ${p}_inputs inputs;
  ${p}_outputs outputs;
  memset(&model, 0, sizeof model);
  give(inputs_at[0], &inputs);
  expect(${p}_evaluate(&model, &inputs, &outputs), ${P}_NOT_PREPARED);
  expect(${p}_prepare(&model$and_defaults), ${P}_OK);
  inputs.$coordinate = (${p}_real) NAN;
  expect(${p}_evaluate(&model, &inputs, &outputs), ${P}_BAD_INPUT);
  if (outputs.$first_output == outputs.$first_output) complain("outputs are left as they were where an input is no number");
$if link
  {
    ${p}_forces forces;
    expect(${p}_section(&model, &outputs, $constant, (${p}_real) 1.5, &forces), ${P}_BAD_RATIO);
    expect(${p}_section(&model, &outputs, $constant, (${p}_real) NAN, &forces), ${P}_BAD_RATIO);
    expect(${p}_section(&model, &outputs, (${p}_link) $n_links, (${p}_real) 0.5, &forces), ${P}_NO_LINK);
    if (forces.axial == forces.axial) complain("forces are left as they were where there is no link");
  }
$end link
$if setting
  {
    ${p}_parameters parameters = ${p}_defaults;
    parameters.$setting = (${p}_real) NAN;
    expect(${p}_prepare(&model, &parameters), ${P}_BAD_PARAMETER);
    expect(${p}_evaluate(&model, &inputs, &outputs), ${P}_NOT_PREPARED);
  }
$end setting
}

int main(void) {
  ${p}_model model;
  ${p}_inputs inputs;
  ${p}_outputs outputs;
  int k;
  expect(${p}_prepare(&model$and_defaults), ${P}_OK);
  for (k = 0; k < INSTANTS; ++k) {
    check_motion(&model, k);
    lead(&model, k);
    give(inputs_at[k], &inputs);
    expect(${p}_evaluate(&model, &inputs, &outputs), ${P}_OK);
    check_outputs(&outputs, outputs_at[k]);
$if link
  check_sections(&model, &outputs, k);
$end link
$if by
  check_sensitivity(&model, k);
$end by
  }
  check_misuse();
  printf("$called: %d numbers at %d instants, the worst off by %.2g of what is allowed; %d wrong\n", compared, INSTANTS, worst, complaints);
  return complaints != 0;
}

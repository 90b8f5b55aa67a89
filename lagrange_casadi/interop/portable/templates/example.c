/* The mechanism over its scene's motion. Build: cc example.c $p.c -lm */
#include "$p.h"

#include <stdio.h>

static int failed(${p}_status status) {
  fprintf(stderr, "$called: %s\n", ${p}_message(status));
  return 1;
}

int main(void) {
  ${p}_model model;
  ${p}_inputs inputs;
  ${p}_outputs outputs;
$if link
  ${p}_forces forces;
$end link
  ${p}_status status;
  int k;
  status = ${p}_prepare(&model$and_defaults);
  if (status != ${P}_OK) return failed(status);
  printf("%13s  %13s  %13s%s\n", "time [s]", "$coordinate [$coordinate_unit]", "$output [$output_unit]", $heading);
  for (k = 0; k < $count; ++k) {
    const ${p}_real time = $start + (${p}_real) k*$step;
    status = ${p}_motion(&model, time$rest, &inputs);
    if (status == ${P}_OK) status = ${p}_evaluate(&model, &inputs, &outputs);
    if (status != ${P}_OK) return failed(status);
$if skip
    if (k%$steps != 0) continue; /* the loops are followed in small steps */
$end skip
    printf("%13.6g  %13.6g  %13.6g", (double) time, (double) inputs.$coordinate, (double) outputs.$output);
$if link
    status = ${p}_section(&model, &outputs, $constant, $half, &forces);
    if (status != ${P}_OK) return failed(status);
    printf("   %13.6g", (double) forces.bending);
$end link
    printf("\n");
  }
  return 0;
}

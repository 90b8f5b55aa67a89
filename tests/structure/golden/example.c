/* The mechanism over its scene's motion. Build: cc example.c press.c -lm */
#include "press.h"

#include <stdio.h>

static int failed(press_status status) {
  fprintf(stderr, "press: %s\n", press_message(status));
  return 1;
}

int main(void) {
  press_model model;
  press_inputs inputs;
  press_outputs outputs;
  press_forces forces;
  press_status status;
  int k;
  status = press_prepare(&model, 0);
  if (status != PRESS_OK) return failed(status);
  printf("%13s  %13s  %13s%s\n", "time [s]", "O [rad]", "effort_O [N m]", "   rod, bending at 0.5 [N m]");
  for (k = 0; k < 12; ++k) {
    const press_real time = 0.0 + (press_real) k*0.0066666666666666671;
    status = press_motion(&model, time, &inputs);
    if (status == PRESS_OK) status = press_evaluate(&model, &inputs, &outputs);
    if (status != PRESS_OK) return failed(status);
    printf("%13.6g  %13.6g  %13.6g", (double) time, (double) inputs.O, (double) outputs.effort_O);
    status = press_section(&model, &outputs, PRESS_LINK_ROD, 0.5, &forces);
    if (status != PRESS_OK) return failed(status);
    printf("   %13.6g", (double) forces.bending);
    printf("\n");
  }
  return 0;
}

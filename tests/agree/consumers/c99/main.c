/* Reads instants from standard input, as two numbers each of which the second is what rounding the first left; prints the inputs that
   the scene's motion gives there and all outputs, and after each instant the forces of every link at the ratios of the arguments.
   MECHANISM is the header; NAMES defines P (the prefix), INPUTS(X), OUTPUTS(X), LINKS(X) and TIME(t, rest). */
#include MECHANISM
#include NAMES

#include <stdio.h>
#include <stdlib.h>

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(word) JOIN(P, word)

static int stop(NAME(status) status) {
  fprintf(stderr, "%s\n", NAME(message)(status));
  return (int) status;
}

int main(int count, char** words) {
  NAME(model) model;
  NAME(inputs) inputs;
  NAME(outputs) outputs;
  NAME(status) status = PREPARE(&model);
  double t, rest;
  if (status != 0) return stop(status);
  while (scanf("%lf %lf", &t, &rest) == 2) {
    status = NAME(motion)(&model, TIME(t, rest), &inputs);
    if (status == 0) status = NAME(evaluate)(&model, &inputs, &outputs);
    if (status != 0) return stop(status);
#define X(member) printf("%a ", (double) outputs.member);
    OUTPUTS(X)
#undef X
#define X(link) \
    for (int k = 1; k < count; ++k) { \
      NAME(forces) forces; \
      status = NAME(section)(&model, &outputs, link, (NAME(real)) atof(words[k]), &forces); \
      if (status != 0) return stop(status); \
      printf("%a %a %a ", (double) forces.axial, (double) forces.shear, (double) forces.bending); \
    }
    LINKS(X)
#undef X
    printf("\n");
  }
  (void) count;
  (void) words;
  return 0;
}

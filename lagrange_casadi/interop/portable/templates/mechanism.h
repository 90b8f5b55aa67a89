/* $name: efforts, reactions and section forces of a mechanism, at any instant of any motion of its drives.

   Written by lagrange_casadi $version, scene $scene. C99 or C++ and the C library's mathematics,
   nothing else: no memory is asked for, no state is kept but in the model that you hand over, nothing recurs.

     ${p}_model model;
     ${p}_inputs inputs = {0};
     ${p}_outputs outputs;
     ${p}_status status = ${p}_prepare(&model$and_defaults);
     $begin
     status = ${p}_evaluate(&model, &inputs, &outputs);
     if (status != ${P}_OK) puts(${p}_message(status));

   A function that fails returns why, and fills what it should have filled with NaN. Calls that share a model must not run at the
   same time; calls with a model each may, and those that take a const model. Do not compile with -ffast-math or what it stands
   for: there NaN is not distinguished from a number. Ranges "over the scene's motion" are what its author saw, no limits.

   $story

   $conventions$notes */
#ifndef ${P}_H
#define ${P}_H

#ifdef __cplusplus
extern "C" {
#endif

#define ${P}_VERSION "$version"
#define ${P}_CASADI_VERSION "$casadi"
#define ${P}_SCENE "$scene"
#define ${P}_PRECISION "$precision"

/* Bytes of stack that any call of these functions takes at most, without what the C library takes for a sine, on machines whose
   pointers are of 8 bytes or less. */
#define ${P}_STACK $stack

typedef $real ${p}_real;

typedef enum {
$statuses
} ${p}_status;
$parameters
/* The motion of the drives at an instant. */
typedef struct {
$inputs
} ${p}_inputs;

/* What follows from it.$outputs_note$law */
typedef struct {
$outputs
} ${p}_outputs;
$links
/* A mechanism ready to be evaluated. You own it; what is in it is the affair of the functions below. It may be copied. */
typedef struct {
$model
} ${p}_model;

/* Makes a model ready${for_parameters}.$anew */
${p}_status ${p}_prepare(${p}_model* model$and_parameters);

/* The motion that the scene prescribes at a time [s]$span: fills inputs.$pair_note */
${p}_status ${p}_motion(const ${p}_model* model, ${p}_real time$and_rest, ${p}_inputs* inputs);

/* The outputs at an instant.$follows */
${p}_status ${p}_evaluate(${p}_model* model, const ${p}_inputs* inputs,
$space         ${p}_outputs* outputs);

/* The same for many instants, in order; the status of each in statuses, unless that is 0. Returns the first that is not
   ${P}_OK, if any. */
${p}_status ${p}_batch(${p}_model* model, long many, const ${p}_inputs* inputs,
$space      ${p}_outputs* outputs, ${p}_status* statuses);
$sections
/* What a status means, as a sentence; of a number that is none as well. */
const char* ${p}_message(${p}_status status);

#ifdef __cplusplus
}
#endif

#endif

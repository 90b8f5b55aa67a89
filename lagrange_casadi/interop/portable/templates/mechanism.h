/* $name: efforts, reactions and section forces of a mechanism, at any instant of any motion of its drives.

   Written by lagrange_casadi $version, scene $scene. C99 or C++ and the C library's mathematics,
   nothing else: no memory is asked for, no state is kept but in the model that you hand over, nothing recurs.

     ${p}_model model;
     ${p}_inputs inputs = {0};
     ${p}_outputs outputs;
     ${p}_status status = ${p}_prepare(&model$and_defaults);
$if iterated
     status = ${p}_motion(&model, $start$and_zero, &inputs);
$end iterated
$if not iterated
     inputs.$coordinate = 0.3$single;
$end iterated
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
$if setting

/* Numbers that may change without generating anything again.
   $corners */
typedef struct {
$parameters
} ${p}_parameters;

extern const ${p}_parameters ${p}_defaults;
$end setting

/* The motion of the drives at an instant. */
typedef struct {
$inputs
} ${p}_inputs;

/* What follows from it.$outputs_note$law */
typedef struct {
$outputs
} ${p}_outputs;
$if link

typedef enum {
$links
} ${p}_link;

/* What the part towards the tip does to the part towards the base. */
typedef struct {
$forces
} ${p}_forces;
$end link
$if by

/* How an output changes with parameters. */
typedef struct {
$changes
} ${p}_changes;

/* How the outputs change, each by its own name. */
typedef struct {
$sensitivities
} ${p}_sensitivities;
$end by

/* A mechanism ready to be evaluated. You own it; what is in it is the affair of the functions below. It may be copied. */
typedef struct {
$model
} ${p}_model;

/* Makes a model ready${for_parameters}.$anew */
${p}_status ${p}_prepare(${p}_model* model$and_parameters);

/* The motion that the scene prescribes at a time [s]$span: fills inputs.$pair_note */
${p}_status ${p}_motion(const ${p}_model* model, ${p}_real time$and_rest, ${p}_inputs* inputs);

$if iterated
/* The outputs at an instant. Iterated loops are followed from the instant before, which must be near$near;
   where a call fails they stay where they stood. To begin elsewhere than the scene does, go there in small steps. */
$end iterated
$if not iterated
/* The outputs at an instant. */
$end iterated
${p}_status ${p}_evaluate(${p}_model* model, const ${p}_inputs* inputs,
$space         ${p}_outputs* outputs);

/* The same for many instants, in order; the status of each in statuses, unless that is 0. Returns the first that is not
   ${P}_OK, if any. */
${p}_status ${p}_batch(${p}_model* model, long many, const ${p}_inputs* inputs,
$space      ${p}_outputs* outputs, ${p}_status* statuses);
$if closing

/* The status between two instants, step seconds apart, by their inputs: whether a loop passes a dead centre there, where it can go
   on in either assembly. Both instants must be ${P}_OK, after the last that was evaluated. Drives move as smoothly from one to the
   other as their coordinates, rates and accelerations allow; if step is 0, straight. */
${p}_status ${p}_between(${p}_model* model, const ${p}_inputs* before, const ${p}_inputs* after, ${p}_real step);
$end closing
$if link

/* The forces inside a link at the ratio xi = distance from the base / length, from 0 to 1, for outputs of this
   model; at a station, where they jump, those on its side towards the tip. */
${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link,
$space        ${p}_real xi, ${p}_forces* forces);

/* The same at many ratios. Returns the first status that is not ${P}_OK, if any. */
${p}_status ${p}_sections(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link,
$space         long many, const ${p}_real* xi, ${p}_forces* forces);
$end link
$if by

/* The outputs at an instant, and their exact derivatives by parameters. The time [s] is that of the instant:
   where the scene's motion depends on parameters, drives change with them as its laws do at that time. */
${p}_status ${p}_sensitivity(${p}_model* model, ${p}_real time, const ${p}_inputs* inputs,
$space            ${p}_outputs* outputs, ${p}_sensitivities* sensitivities);
$end by

/* What a status means, as a sentence; of a number that is none as well. */
const char* ${p}_message(${p}_status status);

#ifdef __cplusplus
}
#endif

#endif

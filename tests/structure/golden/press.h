/* press: efforts, reactions and section forces of a mechanism, at any instant of any motion of its drives.

   Written by lagrange_casadi <version>, scene <scene>. C99 or C++ and the C library's mathematics,
   nothing else: no memory is asked for, no state is kept but in the model that you hand over, nothing recurs.

     press_model model;
     press_inputs inputs = {0};
     press_outputs outputs;
     press_status status = press_prepare(&model, 0);
     inputs.O = 0.3;
     status = press_evaluate(&model, &inputs, &outputs);
     if (status != PRESS_OK) puts(press_message(status));

   A function that fails returns why, and fills what it should have filled with NaN. Calls that share a model must not run at the
   same time; calls with a model each may, and those that take a const model. Do not compile with -ffast-math or what it stands
   for: there NaN is not distinguished from a number. Ranges "over the scene's motion" are what its author saw, no limits.

   In double precision; options of the export: (default). Its outputs are off by about 2e-15 of their largest values over the
   scene's motion at most (effort_O).

   Conventions: SI units; plane x-y; angles in rad, counter-clockwise; a link's axis e runs from its base (xi = 0) to its tip
   (xi = 1), n is 90 deg counter-clockwise of e; section forces are the action of the part towards the tip on the part towards
   the base, resolved on (e, n, z), so axial > 0 is tension and d(bending)/d(xi l) = -shear; a reaction is the action of the
   joint's parent on its child, in ground axes, its moment about the joint's point on the child; an effort is positive along its
   coordinate. A joint's angle is the direction of the child's axis less that of the parent's, which of the ground is x; a slide
   is how far the child's point is from the parent's, along the joint's axis. Gravity is (0, -9.81) m/s^2. */
#ifndef PRESS_H
#define PRESS_H

#ifdef __cplusplus
extern "C" {
#endif

#define PRESS_VERSION "<version>"
#define PRESS_CASADI_VERSION "<casadi>"
#define PRESS_SCENE "<scene>"
#define PRESS_PRECISION "double"

/* Bytes of stack that any call of these functions takes at most, without what the C library takes for a sine, on machines whose
   pointers are of 8 bytes or less. */
#define PRESS_STACK 1680

typedef double press_real;

typedef enum {
  PRESS_OK = 0 /* there is a result */,
  PRESS_NOT_PREPARED = 1 /* the model was not prepared */,
  PRESS_BAD_PARAMETER = 2 /* a parameter is not finite, or out of its range, or gives a link no length or a negative mass */,
  PRESS_BAD_INPUT = 3 /* an input is not finite */,
  PRESS_BAD_TIME = 4 /* the time is not finite, or outside the samples or beyond the curves of the motion */,
  PRESS_BAD_RATIO = 5 /* a ratio xi/l is outside 0 to 1 */,
  PRESS_NO_LINK = 6 /* there is no such link */,
  PRESS_NOT_ASSEMBLED = 7 /* a loop cannot be closed: its links do not reach */,
  PRESS_DEAD_CENTRE = 8 /* a loop is at a dead centre, a joint is in gimbal lock, a two-force link lies along its beside= direction, or the drives cannot produce the motion: forces are indeterminate */,
  PRESS_NOT_CONVERGED = 9 /* the iterated loops did not converge */,
  PRESS_JUMPED = 10 /* an iterated loop has jumped to another branch: take more instants */,
  PRESS_SLOW = 11 /* the iterated loops converge slowly: they are near a dead centre */,
  PRESS_INCONSISTENT = 12 /* the loops are over-constrained and do not fit, or the motion violates a non-holonomic constraint */,
  PRESS_NOT_CLOSED = 13 /* the solution of a loop does not satisfy its equations */,
  PRESS_UNDETERMINED = 14 /* equilibrium does not determine all outputs: the mechanism is over-constrained */,
  PRESS_NOT_FINITE = 15 /* a result is not finite: the mechanism is singular, or its numbers overflow */,
  PRESS_TURNED = 16 /* a load depends on the number of revolutions of an angle, which cannot be determined */,
  PRESS_BEYOND_ENDS = 17 /* the argument of a curve is outside the curve's range */,
  PRESS_JAMS = 18 /* the mechanism jams: its friction forces have no unique solution */,
  PRESS_AT_REST = 19 /* a joint with friction is at rest, so its friction is indeterminate: take instants of motion, or give the friction smooth= */,
  PRESS_PASSES_DEAD_CENTRE = 20 /* between two instants a loop passes through a dead centre, a joint through gimbal lock, a two-force link through its beside= direction, or the drives through a position in which they cannot produce the motion */,
  PRESS_STROKE = 21 /* a cylinder or a strut is longer than open, or shorter than closed */,
  PRESS_LOST_CONTACT = 22 /* a contact pulls or slides */
} press_status;

/* Numbers that may change without generating anything again.
   Corners of motions, constraints and lifts were checked with the default parameters only. */
typedef struct {
  press_real r; /* parameter r [m]; in (-inf, inf); default 0.1 */
  press_real l; /* parameter l [m]; in (-inf, inf); default 0.2 */
  press_real m1; /* parameter m1 [kg]; in (-inf, inf); default 0.1 */
  press_real m2; /* parameter m2 [kg]; in (-inf, inf); default 0.1 */
  press_real m3; /* parameter m3 [kg]; in (-inf, inf); default 0.1 */
} press_parameters;

extern const press_parameters press_defaults;

/* The motion of the drives at an instant. */
typedef struct {
  press_real O; /* joint O: coordinate: child against parent [rad]; counter-clockwise; any finite number */
  press_real O_rate; /* joint O: rate [rad/s]; any finite number */
  press_real O_acceleration; /* joint O: acceleration [rad/s^2]; any finite number */
} press_inputs;

/* What follows from it. Those of a section law are for _section, which is all you need.
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear = f0 + f1 mu0 + f2 mu1, bending = m0 + f0 (l - xi)
   + f1 (mu1 - xi mu0) + f2 (mu2 - xi mu1) at xi from the base, where mu0 is the mass from there to
   the tip, mu1 and mu2 its first and second moment about the base; and then what acts on the link
   at stations, where something joins or loads it between its ends, beyond xi. */
typedef struct {
  press_real effort_O; /* joint O: effort [N m]; positive along the joint's coordinate; from -8.12 to 8.28 over the scene's motion */
  press_real section_rod_n0; /* link rod: axial force at the tip [N]; from -53.3 to 92.5 over the scene's motion */
  press_real section_rod_n1; /* link rod: axial force for a unit of the mass mu0 from the section to the tip [m/s^2]; from -617 to 617 over the scene's motion */
  press_real section_rod_n2; /* link rod: axial force for a unit of the first moment mu1 from the section to the tip [1/s^2]; from 0 to 1.54e+03 over the scene's motion */
  press_real section_rod_f0; /* link rod: shear force at the tip [N]; from -14.3 to 15.2 over the scene's motion */
  press_real section_rod_f1; /* link rod: shear force for a unit of the mass mu0 from the section to the tip [m/s^2]; from -626 to 608 over the scene's motion */
  press_real section_rod_f2; /* link rod: shear force for a unit of the first moment mu1 from the section to the tip [1/s^2]; from -3.56e+03 to 3.56e+03 over the scene's motion */
  press_real section_rod_m0; /* link rod: bending moment at the tip [N m]; 0 over the scene's motion */
} press_outputs;

typedef enum {
  PRESS_LINK_ROD = 0
} press_link;

/* What the part towards the tip does to the part towards the base. */
typedef struct {
  press_real axial; /* axial force [N]; tension is positive; any number */
  press_real shear; /* shear force [N]; 90 deg counter-clockwise of the axis; any number */
  press_real bending; /* bending moment [N m]; counter-clockwise; any number */
} press_forces;

/* A mechanism ready to be evaluated. You own it; what is in it is the affair of the functions below. It may be copied. */
typedef struct {
  unsigned seal;
  press_real parameters[5];
  press_real constants[11];
  press_real matter[3];
} press_model;

/* Makes a model ready, for parameters, or 0 for the defaults. */
press_status press_prepare(press_model* model, const press_parameters* parameters);

/* The motion that the scene prescribes at a time [s]: fills inputs. */
press_status press_motion(const press_model* model, press_real time, press_inputs* inputs);

/* The outputs at an instant. */
press_status press_evaluate(press_model* model, const press_inputs* inputs,
                            press_outputs* outputs);

/* The same for many instants, in order; the status of each in statuses, unless that is 0. Returns the first that is not
   PRESS_OK, if any. */
press_status press_batch(press_model* model, long many, const press_inputs* inputs,
                         press_outputs* outputs, press_status* statuses);

/* The status between two instants, step seconds apart, by their inputs: whether a loop passes a dead centre there, where it can go
   on in either assembly. Both instants must be PRESS_OK, after the last that was evaluated. Drives move as smoothly from one to the
   other as their coordinates, rates and accelerations allow; if step is 0, straight. */
press_status press_between(press_model* model, const press_inputs* before, const press_inputs* after, press_real step);

/* The forces inside a link at the ratio xi = distance from the base / length, from 0 to 1, for outputs of this
   model; at a station, where they jump, those on its side towards the tip. */
press_status press_section(const press_model* model, const press_outputs* outputs, press_link link,
                           press_real xi, press_forces* forces);

/* The same at many ratios. Returns the first status that is not PRESS_OK, if any. */
press_status press_sections(const press_model* model, const press_outputs* outputs, press_link link,
                            long many, const press_real* xi, press_forces* forces);

/* What a status means, as a sentence; of a number that is none as well. */
const char* press_message(press_status status);

#ifdef __cplusplus
}
#endif

#endif

/* Numbers of the search for peaks: of either precision, then of both. engine/codegen/peak_search.py defines what other modules share. */
#include <float.h>
typedef lanes_real search_real;
#ifdef LANES_SINGLE
#define SEARCH_LARGEST FLT_MAX
#define SEARCH_LEAST FLT_MIN
/* Rounding of a value, relative to its largest size. */
#define SEARCH_CLOSE (8*FLT_EPSILON)
/* Relative error of a peak that is worth no further refinement. */
#define SEARCH_ROUNDING ((search_real) 1e-6)
/* Largest relative error of a quantity by rounding, as near a dead centre. */
#define SEARCH_NOISE ((search_real) 1e-2)
/* Largest error of a polynomial in the middle of an end step, relative to its least slope there, which is then off by nine times that. */
#define SEARCH_STRETCH ((search_real) 1e-2)
/* Growth of a quantity over the last step towards a pole, relative to its peak, at which it has come to its end. */
#define SEARCH_LAST ((search_real) 1e-5)
/* Panels within each other; and the level in whose steps nothing hides. */
#define SEARCH_DEEPEST 8
#define SEARCH_FINEST 5
#else
#define SEARCH_LARGEST DBL_MAX
#define SEARCH_LEAST DBL_MIN
#define SEARCH_CLOSE (8*DBL_EPSILON)
#define SEARCH_ROUNDING 1e-13
#define SEARCH_NOISE 1e-6
#define SEARCH_STRETCH 1e-4
#define SEARCH_LAST 1e-11
/* The last panel's steps are 4e-14 of those between the instants, the finest level's 3e-10. */
#define SEARCH_DEEPEST 14
#define SEARCH_FINEST 10
#endif
#define SEARCH_HALF ((search_real) 0.5)
#define SEARCH_TURN ((search_real) 6.2831853071795864769)
/* Panels within each other beside an instant at which friction at rest leaves a curve open. */
#define SEARCH_BESIDE_REST 3
/* Panels of a search, and four more for each instant. */
#define SEARCH_PANELS 2048
/* Times inside a step that becomes a panel. */
#define SEARCH_INNER 8
/* Fraction of a unit's largest size that counts as a quantity's own size for its rounding. */
#define SEARCH_BESIDE ((search_real) 1e-2)
/* Relative growth of a quantity over a step towards a pole. */
#define SEARCH_ENDLESS ((search_real) 0.1)
/* Relative second differences of values that are nothing but rounding. */
#define SEARCH_RAGGED ((search_real) 0.3)
/* An angle [rad] that a step may turn: less than a twentieth of a turn, so that harmonics show. */
#define SEARCH_RATE 0.3
/* Largest change, in a step, of an argument near which a function is steep. */
#define SEARCH_CHANGE ((search_real) 0.75)
/* Relative distance from zero to which a divisor may seem to come between two steps. */
#define SEARCH_DIP ((search_real) 0.5)
/* Rise of an exponent above both ends of a step, and distance of an exponent below the largest from which the power is negligible. */
#define SEARCH_RISE ((search_real) 0.5)
#define SEARCH_NEGLIGIBLE ((search_real) 40)
/* Factor by which an argument goes further beyond its ends than it may seem to, in a step through which it goes straight on. */
#define SEARCH_STRAIGHT ((search_real) 4)
/* Least change in a step, of that in it and the steps beside, of an argument that passes a number once. */
#define SEARCH_EVEN ((search_real) 0.3)

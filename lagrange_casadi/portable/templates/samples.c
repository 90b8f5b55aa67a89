
/* A motion by samples: cubics between knots, of each its value, rate, acceleration and jerk at the knot where it begins. */
static int piece_of(casadi_real t, int pieces, const casadi_real* knots) {
  int low = 0, high = pieces, middle;
  while (high - low > 1) {
    middle = low + (high - low)/2;
    if (t < knots[middle]) {
      high = middle;
    } else {
      low = middle;
    }
  }
  return low;
}

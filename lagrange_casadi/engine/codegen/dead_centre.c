/* Whether the determinant of loop number which changes its sign in a step, or its links do not reach there: by the order of the zero
   of its square. centre_path gives at $points fractions x of the step the square, its rate for a unit of x, and $slopes slopes for each
   fraction; below limit squares are zero within rounding. */
static int centre_passes(const centre_step* step, int which, centre_real limit) {
  centre_real x[$points], square[$points], rate[$points], slope[$points*$slopes], low = 0, high = 1, order = 0, same = 0;
  int touches = 0, round, least, a, b, k;
  for (round = 0; round < $rounds; ++round) {
    for (k = 0; k < $points; ++k) x[k] = k < $points - 1 ? low + (high - low)*(centre_real) k/($points - 1) : high;
    centre_path(step, which, x, square, rate, slope);
    least = 0;
    for (k = 0; k < $points; ++k) {
      if (square[k] < -limit) return 1;
      if (!(square[k] == square[k])) square[k] = 0;
      if (square[k] < square[least]) least = k;
    }
    touches |= square[least] <= limit;
    a = rate[least] < 0 ? least : least - 1;
    b = a + 1;
    while (a > 0 && square[a] <= $far*limit) --a;
    while (b < $points - 1 && square[b] <= $far*limit) ++b;
    if (a < 0 || b == $points || !(rate[a] < 0 && rate[b] > 0)) return 0;
    order = (x[b] - x[a])/(square[b]/rate[b] - square[a]/rate[a]);
    if (order < 1) return 0;
    same = 0;
    for (k = 0; k < $slopes; ++k) same = same + slope[$slopes*a + k]*slope[$slopes*b + k];
    if (b - a == $points - 1) break;
    low = x[a];
    high = x[b];
  }
  return touches && !(order >= $least_order && order <= $most_order && same >= 0);
}

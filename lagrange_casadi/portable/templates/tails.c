
/* How the density of each link is given: how many cells, and where in these lists their breaks and numbers of coefficients begin. */
static const casadi_real breaks[] = {$breaks};
static const int sizes[] = {$sizes};
static const struct {
  int cells, first_break, first_size;
} shapes[] = {
$shapes
};

/* Moments of the material from a ratio u to the tip: T[k] is the integral of the density times the distance to the power k, per
   unit of the ratio. density holds, of each cell between breaks, so many coefficients of a polynomial. */
static void tails(casadi_real u, int link, const casadi_real* density, casadi_real* T) {
  const casadi_real* at = breaks + shapes[link].first_break;
  const int* many = sizes + shapes[link].first_size;
  casadi_real parts[$most + 2], high, low, width, total, power, shifted, term;
  int i, j, k, n, choose;
  for (k = 0; k < 3; ++k) T[k] = 0;
  for (i = 0; i < shapes[link].cells; ++i) {
    high = at[i + 1] - u > 0 ? at[i + 1] - u : 0;
    low = at[i] - u > 0 ? at[i] - u : 0;
    width = high - low;
    total = 1;
    power = low;
    for (n = 0; n < many[i] + 2; ++n) {
      parts[n] = width*total;
      total = total*high + power;
      power = power*low;
    }
    for (j = 0; j < many[i]; ++j) {
      shifted = 0;
      for (n = j; n < many[i]; ++n) {
        choose = 1;
        for (k = 0; k < j; ++k) choose = choose*(n - k)/(k + 1);
        term = density[n]*(casadi_real) choose;
        power = 1;
        for (k = 0; k < n - j; ++k) power = power*u;
        shifted = shifted + term*power;
      }
      for (k = 0; k < 3; ++k) T[k] = T[k] + shifted*parts[j + k]/(casadi_real) (j + k + 1);
    }
    density += many[i];
  }
}

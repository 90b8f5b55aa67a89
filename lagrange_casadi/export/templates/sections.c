
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

static void no_forces(${p}_forces* forces) {
  forces->axial = forces->shear = forces->bending = nothing;
}

${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, ${p}_real xi, ${p}_forces* forces) {
  casadi_real law[7], acting[$loads], T[3], l, first, axial, shear, bending;
  const casadi_real* matter_of;
  int k, stations = 0;
  no_forces(forces);
  if (model->seal != SEAL) return ${P}_NOT_PREPARED;
  if (!(xi >= 0 && xi <= 1)) return ${P}_BAD_RATIO;
  switch (link) {
$laws
  default:
    return ${P}_NO_LINK;
  }
  l = matter_of[0];
  tails(xi, (int) link, matter_of + 1, T);
  first = l*(xi*T[0] + T[1]);
  axial = law[0] + law[1]*T[0] + law[2]*first;
  shear = law[3] + law[4]*T[0] + law[5]*first;
  bending = law[6] + law[3]*(l*(1 - xi)) + law[4]*(l*T[1]) + law[5]*(l*l*(xi*T[1] + T[2]));
  /* What acts at a station is seen by the sections on its base side, and at the very tip always. */
  for (k = 0; k < 4*stations; k += 4) {
    if (xi < acting[k] || (xi >= 1 && acting[k] >= 1)) {
      axial = axial + acting[k + 1];
      shear = shear + acting[k + 2];
      bending = bending + (acting[k + 3] + acting[k + 2]*l*(acting[k] - xi));
    }
  }
  if (!is_finite(axial + shear + bending)) return ${P}_NOT_FINITE;
  forces->axial = axial;
  forces->shear = shear;
  forces->bending = bending;
  return ${P}_OK;
}

${p}_status ${p}_sections(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, long many, const ${p}_real* xi,
$indent ${p}_forces* forces) {
  ${p}_status first = ${P}_OK, status;
  long i;
  for (i = 0; i < many; ++i) {
    status = ${p}_section(model, outputs, link, xi[i], forces + i);
    if (first == ${P}_OK) first = status;
  }
  return first;
}

static void no_forces(${p}_forces* forces) {
  forces->axial = forces->shear = forces->bending = nothing;
}

${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, ${p}_real xi, ${p}_forces* forces) {
  casadi_real law[7], acting[$loads], T[3], l, first, near, axial, shear, bending;$declared
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
  /* What acts at a station is seen by the sections on its base side; at the tip all see it, at the base none, though it may miss these
     by rounding. */
  near = xi + $slack < 1 - $slack ? xi + $slack : 1 - $slack;
  for (k = 0; k < 4*stations; k += 4) {
    if (near < acting[k]) {
      axial = axial + acting[k + 1];
      shear = shear + acting[k + 2];
      bending = bending + (acting[k + 3] + acting[k + 2]*l*(acting[k] - xi));
    }
  }
$spread  if (!is_finite(axial + shear + bending)) return ${P}_NOT_FINITE;
  forces->axial = axial;
  forces->shear = shear;
  forces->bending = bending;
  return ${P}_OK;
}

static void no_forces(${p}_forces* forces) {
  forces->axial = forces->shear_y = forces->shear_z = forces->torsion = nothing;
  forces->bending_y = forces->bending_z = forces->shear = forces->bending = nothing;
}

${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, ${p}_real xi, ${p}_forces* forces) {
  casadi_real law[12], acting[$loads], T[3], l, first, near, arm, axial, shear_y, shear_z, torsion, bending_y, bending_z, shear, bending;$declared
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
  shear_y = law[3] + law[4]*T[0] + law[5]*first;
  shear_z = law[7] + law[8]*T[0] + law[9]*first;
  torsion = law[11];
  bending_z = law[6] + law[3]*(l*(1 - xi)) + law[4]*(l*T[1]) + law[5]*(l*l*(xi*T[1] + T[2]));
  bending_y = law[10] - law[7]*(l*(1 - xi)) - law[8]*(l*T[1]) - law[9]*(l*l*(xi*T[1] + T[2]));
  /* What acts at a station is seen by the sections on its base side; at the tip all see it, at the base none, though it may miss these
     by rounding. */
  near = xi + $slack < 1 - $slack ? xi + $slack : 1 - $slack;
  for (k = 0; k < 7*stations; k += 7) {
    if (near < acting[k]) {
      arm = acting[k] - xi;
      axial = axial + acting[k + 1];
      shear_y = shear_y + acting[k + 2];
      shear_z = shear_z + acting[k + 3];
      torsion = torsion + acting[k + 4];
      bending_y = bending_y + (acting[k + 5] - acting[k + 3]*l*arm);
      bending_z = bending_z + (acting[k + 6] + acting[k + 2]*l*arm);
    }
  }
$spread  shear = $root(shear_y*shear_y + shear_z*shear_z);
  bending = $root(bending_y*bending_y + bending_z*bending_z);
  if (!is_finite(axial + torsion + shear + bending)) return ${P}_NOT_FINITE;
  forces->axial = axial;
  forces->shear_y = shear_y;
  forces->shear_z = shear_z;
  forces->torsion = torsion;
  forces->bending_y = bending_y;
  forces->bending_z = bending_z;
  forces->shear = shear;
  forces->bending = bending;
  return ${P}_OK;
}

/* Newton's method, from where the loops stood; there they are left where it fails. */
static ${p}_status close_loops(${p}_model* model, const casadi_real* counted, int most, casadi_real done, casadi_real lost) {
  static const int turning[$nz] = {$turning};
  casadi_real z[$nz], correction[$nz], size = 1, before = 1;
  const casadi_real* arg[3];
  casadi_real* res[2];
  int k, step;
  for (k = 0; k < $nz; ++k) z[k] = model->loops[k];
$given
  for (step = 0; step < most && !(size < done); ++step) {
    before = size;
    loops(arg, res);
    if (!is_finite(size)) return ${P}_NOT_CONVERGED;
    for (k = 0; k < $nz; ++k) z[k] = z[k] + correction[k];
  }
  if (!(size < lost)) return ${P}_NOT_CONVERGED;
  for (k = 0; k < $nz; ++k) {
    model->loops[k] = turning[k] ? z[k] - $turn*$floor(z[k]*$inverse + $half) : z[k];
  }
  return size > $rate*before && size > $rounding ? ${P}_SLOW : ${P}_OK;
}

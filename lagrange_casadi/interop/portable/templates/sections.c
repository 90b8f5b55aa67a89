${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, ${p}_real xi, ${p}_forces* forces) {
  casadi_real law[$law], found[$many]$acting;
  const casadi_real* arg[4];
  casadi_real* res[1];
  $none = nothing;
  if (model->seal != SEAL) return ${P}_NOT_PREPARED;
  if (!(xi >= 0 && xi <= 1)) return ${P}_BAD_RATIO;
  arg[0] = law;
  arg[1] = $given;
  arg[3] = &xi;
  res[0] = found;
  switch (link) {
$links
  default:
    return ${P}_NO_LINK;
  }
  if (!all_finite(found, $many)) return ${P}_NOT_FINITE;
$put
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

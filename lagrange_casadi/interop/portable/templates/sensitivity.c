
static void put_slopes(const casadi_real* s, ${p}_sensitivities* sensitivities) {
$put
}

${p}_status ${p}_sensitivity(${p}_model* model, ${p}_real time, const ${p}_inputs* inputs, ${p}_outputs* outputs,
                             ${p}_sensitivities* sensitivities) {
  casadi_real s[$many], d[$drives], rate[$drives], acceleration[$drives];
  const casadi_real* arg[6];
  casadi_real* res[1];
  int k;
  ${p}_status status = ${p}_evaluate(model, inputs, outputs);
  if (status == ${P}_OK && !is_finite(time)) status = ${P}_BAD_TIME;
  if (status == ${P}_OK) {
$given
    if (!all_finite(s, $many)) status = ${P}_NOT_FINITE;
  }
  if (status != ${P}_OK) {
    for (k = 0; k < $many; ++k) s[k] = nothing;
  }
  put_slopes(s, sensitivities);
  return status;
}


static void check_sensitivity(${p}_model* model, int k) {
  ${p}_inputs inputs;
  ${p}_outputs outputs;
  ${p}_sensitivities found;
  give(inputs_at[k], &inputs);
  expect(${p}_sensitivity(model, (${p}_real) times[k][0], &inputs, &outputs, &found), ${P}_OK);
  check_outputs(&outputs, outputs_at[k]);
$compared
  expect(${p}_sensitivity(model, (${p}_real) NAN, &inputs, &outputs, &found), ${P}_BAD_TIME);
  if (found.$first == found.$first) complain("sensitivities are left as they were where the time is no number");
}

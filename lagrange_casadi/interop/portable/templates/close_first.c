if (!model->closed && close_loops(model, counted, $limits) == ${P}_NOT_CONVERGED) {
  return ${P}_NOT_CONVERGED;
}
model->closed = 1;

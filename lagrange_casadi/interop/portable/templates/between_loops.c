for (k = 0; k < $nz; ++k) kept[k] = step->model->loops[k];
if (close_loops(step->model, counted, $limits) == ${P}_NOT_CONVERGED) {
  for (k = 0; k < $nz; ++k) step->model->loops[k] = nothing;
}

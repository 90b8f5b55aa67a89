  /* What sections feel of loads along the link: a power of the place for each coefficient. */
  for (k = 0, along = spread; k < spreads; ++k) {
    reach = l*along[0];
    x = (along[1] - xi)/along[0];
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    lever = along[1] - along[0] - xi;
    lever = lever < 0 ? 0 : l*lever;
    along += 2;
    power = x;
    for (j = 0; j < powers[k]; ++j) {
      share = reach*power/(casadi_real) (j + 1);
      turning = share*(reach*x/(casadi_real) (j + 2) + lever);
$added
      along += $directions;
      power = power*x;
    }
  }

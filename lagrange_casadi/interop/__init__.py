"""Models of other programs in; C, units of simulation and controllers out."""

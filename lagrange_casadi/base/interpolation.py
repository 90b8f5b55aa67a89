"""Interpolation at Chebyshev's nodes."""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial import chebyshev

from .arrays import Array


@functools.cache
def interpolation(degree: int) -> tuple[Array, Array]:
    """Return Chebyshev's nodes in [-1, 1], (degree + 1,), and the matrix, (degree + 1, degree + 1),
    for which ``values @ matrix`` are the coefficients of Chebyshev's polynomials T_0, T_1, ... of
    the polynomial through ``values`` at these nodes.
    """
    nodes = chebyshev.chebpts1(degree + 1)
    weights = chebyshev.chebvander(nodes, degree) * (2.0 / (degree + 1))
    weights[:, 0] /= 2.0
    return nodes, np.asarray(weights, float)

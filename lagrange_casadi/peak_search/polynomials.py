"""Polynomials by their values at Chebyshev's nodes."""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial import chebyshev

from ..base.arrays import Array


@functools.cache
def interpolation(degree: int) -> tuple[Array, Array]:
    """Nodes from -1 to 1, and what makes coefficients of Chebyshev's polynomials of the values
    there: values @ weights.
    """
    nodes = chebyshev.chebpts1(degree + 1)
    weights = chebyshev.chebvander(nodes, degree) * (2.0 / (degree + 1))
    weights[:, 0] /= 2.0
    return nodes, np.asarray(weights, float)

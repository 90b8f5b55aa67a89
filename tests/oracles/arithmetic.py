"""Precisions and their roundings, and the tolerance and the quadrature of the oracles."""

from __future__ import annotations

import numpy as np

TOLERANCE = 1e-14
"""Where Newton's method ends."""

GAUSS = np.polynomial.legendre.leggauss(12)
"""Nodes and weights on [-1, 1] that integrate polynomials up to degree 23."""

DTYPES = {"double": np.dtype(float), "single": np.dtype(np.float32)}
ROUNDING = {"double": 2.0**-53, "single": 2.0**-24}
"""Kinds of numbers of each precision, and the relative size of a rounding of theirs."""

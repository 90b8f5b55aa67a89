"""What the oracle calculates with: doubles, or numbers of as many digits as one likes.

Both have the same names: ``number`` takes a number in as it is, ``array`` is NumPy's of such
numbers, ``tolerance`` is where Newton's method ends, ``gauss`` are the twelve nodes and weights on
[-1, 1] that integrate polynomials up to degree 23.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import mpmath
import numpy as np
from mpmath.calculus.quadrature import GaussLegendre

_GUARD = 10

DTYPES = {"double": np.dtype(float), "single": np.dtype(np.float32)}
ROUNDING = {"double": 2.0**-53, "single": 2.0**-24}
"""Kinds of numbers of each precision, and the relative size of a rounding of theirs."""


class _Arrays:
    """Arrays of an arithmetic's numbers."""

    dtype: type

    def array(self, values):
        return np.array(values, dtype=self.dtype)

    def zeros(self, *shape):
        return np.zeros(shape, dtype=self.dtype)


@dataclass(frozen=True)
class Double(_Arrays):
    """IEEE doubles."""

    dtype = float
    tolerance = 1e-14
    number = staticmethod(float)
    cos = staticmethod(math.cos)
    sin = staticmethod(math.sin)
    sqrt = staticmethod(math.sqrt)

    @cached_property
    def gauss(self):
        return np.polynomial.legendre.leggauss(12)

    def solve(self, matrix, right, least):
        """Least squares, and of many solutions the shortest; singular values below ``least`` of the
        largest are none.
        """
        return np.linalg.lstsq(matrix, right, rcond=least)[0]


DOUBLE = Double()


@dataclass(frozen=True)
class Digits(_Arrays):
    """Numbers of a context of their own, with guard digits beyond the ``digits`` that a result
    should have.
    """

    digits: int

    dtype = object

    @cached_property
    def context(self):
        context = mpmath.MPContext()
        context.dps = self.digits + _GUARD
        return context

    @property
    def tolerance(self):
        return self.number(10) ** -self.digits

    def number(self, x):
        return self.context.mpf(x)

    def cos(self, x):
        return self.context.cos(x)

    def sin(self, x):
        return self.context.sin(x)

    def sqrt(self, x):
        return self.context.sqrt(x)

    @cached_property
    def gauss(self):
        pairs = GaussLegendre(self.context).calc_nodes(3, self.context.prec)
        return tuple(self.array(column) for column in zip(*pairs, strict=True))

    def solve(self, matrix, right, least):
        """Elimination of equations that agree: those that repeat others are let go, unknowns that
        all leave open are zero.

        Pivots are the largest entries left; one below ``least`` of the first is none.
        """
        rows = [[*row, value] for row, value in zip(matrix.tolist(), right.tolist(), strict=True)]
        columns, pivots = list(range(matrix.shape[1])), []
        while columns and len(pivots) < len(rows):
            k = len(pivots)
            size, i, j = max((abs(rows[i][j]), i, j) for i in range(k, len(rows)) for j in columns)
            if size <= least * (abs(rows[0][pivots[0]]) if pivots else 0):
                break
            rows[k], rows[i] = rows[i], rows[k]
            columns.remove(j)
            pivots.append(j)
            filled = [n for n in (*columns, -1) if rows[k][n]]
            for row in rows[:k] + rows[k + 1 :]:
                if row[j]:
                    factor = row[j] / rows[k][j]
                    for n in filled:
                        row[n] -= factor * rows[k][n]
        found = self.zeros(matrix.shape[1])
        for row, j in zip(rows, pivots, strict=False):
            found[j] = row[-1] / row[j]
        return found

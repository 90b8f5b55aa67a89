"""Small linear systems as graphs: one factorization serves rates, accelerations and, transposed,
multipliers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import column


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """A matrix of m rows and n <= m columns: the adjugate for square ones up to 2 x 2, else
    Householder's reflections.

    With more rows than columns, what it solves are consistent systems; the transposed one then has
    m - n free unknowns. ``volume`` is the determinant over the product of the columns' lengths,
    between -1 and 1, or for more rows than columns the ratio of volumes: zero where the system is
    singular. Rows that are multiplied by ``units`` are of one unit, as columns need not be.
    """

    matrix: Any
    inverse: Any
    reflections: tuple[tuple[Any, Any], ...]
    triangle: Any
    volume: Any
    units: Any = 1

    @classmethod
    def of(cls, matrix: Expression, units: Expression = 1) -> LinearSystem:
        """Factorize a matrix, whose rows have factors ``units`` [a column, or one for all]."""
        m, n = matrix.shape
        matrix = matrix if isinstance(units, int) else ca.diag(units) @ matrix
        lengths = ca.SX(1)
        for j in range(n):
            lengths *= ca.sqrt(ca.sumsqr(matrix[:, j]))
        if m == n and 0 < n <= 2:
            det = ca.det(matrix)
            return cls(matrix, ca.adj(matrix) * (1 / det), (), None, det / lengths, units)
        reflections, volume = [], 1 / lengths
        rest = ca.densify(matrix)
        for j in range(min(n, m - 1)):
            x = rest[j:, j]
            length = ca.sqrt(ca.sumsqr(x))
            signed = ca.copysign(length, x[0])
            v = ca.vertcat(x[0] + signed, x[1:])
            # 2 / v'v, for x and what it is reflected into, -signed, are of one length.
            reflections.append((v, 1 / (signed * v[0])))
            rest[j:, j] = ca.vertcat(-signed, ca.SX.zeros(m - j - 1))
            rest[j:, j + 1 :] = _reflect(reflections[-1], rest[j:, j + 1 :])
            volume *= signed
        if m == n:
            volume *= rest[n - 1, n - 1]
        return cls(matrix, None, tuple(reflections), ca.triu(rest[:n, :]), volume, units)

    @property
    def free(self) -> int:
        """Number of free unknowns of the transposed system."""
        return int(self.matrix.shape[0] - self.matrix.shape[1])

    def solve(self, right: ca.SX) -> Expression:
        """Return x of ``matrix x = right``."""
        right = self.units * right
        if self.inverse is not None:
            return self.inverse @ right
        turned = right
        for j, reflection in enumerate(self.reflections):
            turned = ca.vertcat(turned[:j], _reflect(reflection, turned[j:]))
        n = self.matrix.shape[1]
        x = [ca.SX(0)] * n
        for i in reversed(range(n)):
            x[i] = (
                turned[i] - sum(self.triangle[i, j] * x[j] for j in range(i + 1, n))
            ) / self.triangle[i, i]
        return column(x)

    def solve_transposed(self, right: ca.SX, free: ca.SX) -> Expression:
        """Return x of ``matrix' x = right``, for values of the free unknowns,
        a column of ``self.free``.
        """
        if self.inverse is not None:
            return self.units * (self.inverse.T @ right)
        turned = ca.vertcat(ca.solve(self.triangle.T, right), free)
        for j, reflection in reversed(list(enumerate(self.reflections))):
            turned = ca.vertcat(turned[:j], _reflect(reflection, turned[j:]))
        return self.units * turned


def _reflect(reflection: tuple[ca.SX, ca.SX], x: ca.SX) -> ca.SX:
    """(1 - factor v v') x."""
    v, factor = reflection
    return x - v @ (factor * (v.T @ x))

"""Small linear systems as graphs: one factorization serves rates, accelerations and, transposed, multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """A matrix of m rows and n <= m columns: the adjugate for square ones up to 2 x 2, else Householder's reflections.

    With more rows than columns, what it solves are consistent systems; the transposed one then has m - n free unknowns.
    ``volume`` is the determinant over the product of the columns' lengths, between -1 and 1, or for more rows than columns the
    ratio of volumes: zero where the system is singular.
    """

    matrix: Any
    inverse: Any
    reflections: tuple[Any, ...]
    triangle: Any
    volume: Any

    @classmethod
    def of(cls, matrix: Any) -> LinearSystem:
        """Factorize a matrix."""
        m, n = matrix.shape
        lengths = ca.SX(1)
        for j in range(n):
            lengths *= ca.sqrt(ca.sumsqr(matrix[:, j]))
        if m == n and 0 < n <= 2:
            if n == 1:
                return cls(matrix, 1 / matrix, (), None, matrix / lengths)
            a, b, c, d = matrix[0, 0], matrix[0, 1], matrix[1, 0], matrix[1, 1]
            det = a * d - b * c
            adjugate = ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-c, a))
            return cls(matrix, adjugate * (1 / det), (), None, det / lengths)
        reflections, volume = [], 1 / lengths
        rest = ca.densify(matrix)
        for j in range(min(n, m - 1)):
            x = rest[j:, j]
            length = ca.sqrt(ca.sumsqr(x))
            signed = ca.if_else(x[0] < 0, -length, length)
            v = ca.vertcat(x[0] + signed, x[1:])
            v = v / ca.sqrt(ca.sumsqr(v))
            below = rest[j:, j:]
            rest[j:, j:] = below - 2 * v @ (v.T @ below)
            reflections.append(v)
            volume *= -rest[j, j]
        if m == n:
            volume *= rest[n - 1, n - 1]
        return cls(matrix, None, tuple(reflections), rest[:n, :], volume)

    @property
    def free(self) -> int:
        """How many unknowns of the transposed system are free."""
        return int(self.matrix.shape[0] - self.matrix.shape[1])

    def solve(self, right: Any) -> Any:
        """x of ``matrix x = right``."""
        if self.inverse is not None:
            return self.inverse @ right
        turned = right
        for j, v in enumerate(self.reflections):
            turned = ca.vertcat(turned[:j], _reflect(v, turned[j:]))
        n = self.matrix.shape[1]
        x = [ca.SX(0)] * n
        for i in reversed(range(n)):
            x[i] = (turned[i] - sum(self.triangle[i, j] * x[j] for j in range(i + 1, n))) / self.triangle[i, i]
        return ca.vertcat(ca.SX(0, 1), *x)

    def solve_transposed(self, right: Any, free: Any) -> Any:
        """x of ``matrix' x = right``, for values of the free unknowns, a column of ``self.free``."""
        if self.inverse is not None:
            return self.inverse.T @ right
        x: list[Any] = []
        for i in range(self.matrix.shape[1]):
            x.append((right[i] - sum(self.triangle[j, i] * x[j] for j in range(i))) / self.triangle[i, i])
        turned = ca.vertcat(ca.SX(0, 1), *x, free)
        for j, v in reversed(list(enumerate(self.reflections))):
            turned = ca.vertcat(turned[:j], _reflect(v, turned[j:]))
        return turned


def _reflect(v: Any, x: Any) -> Any:
    return x - 2 * v * ca.dot(v, x)

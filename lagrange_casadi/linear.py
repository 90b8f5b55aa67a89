"""Small linear systems as graphs: one factorization serves rates, accelerations and, transposed, multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """A square matrix of expressions: the adjugate up to 2 x 2, beyond it a QR factorization, which needs no pivots."""

    matrix: Any
    inverse: Any
    q: Any
    r: Any

    @classmethod
    def of(cls, matrix: Any) -> LinearSystem:
        """Factorize a matrix."""
        n = matrix.shape[0]
        if n > 2:
            q, r = ca.qr(ca.densify(matrix))
            return cls(matrix, None, q, r)
        if n == 1:
            return cls(matrix, 1 / matrix, None, None)
        a, b, c, d = matrix[0, 0], matrix[0, 1], matrix[1, 0], matrix[1, 1]
        scale = 1 / (a * d - b * c)
        adjugate = ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-c, a))
        return cls(matrix, adjugate * scale, None, None)

    def solve(self, right: Any) -> Any:
        """x of ``matrix x = right``."""
        if self.inverse is not None:
            return self.inverse @ right
        return _back_substitute(self.r, self.q.T @ right)

    def solve_transposed(self, right: Any) -> Any:
        """x of ``matrix' x = right``."""
        if self.inverse is not None:
            return self.inverse.T @ right
        return self.q @ _forward_substitute(self.r.T, right)


def _back_substitute(upper: Any, right: Any) -> Any:
    n = right.numel()
    x = [ca.SX(0)] * n
    for i in reversed(range(n)):
        x[i] = (right[i] - sum(upper[i, j] * x[j] for j in range(i + 1, n))) / upper[i, i]
    return ca.vertcat(*x)


def _forward_substitute(lower: Any, right: Any) -> Any:
    x: list[Any] = []
    for i in range(right.numel()):
        x.append((right[i] - sum(lower[i, j] * x[j] for j in range(i))) / lower[i, i])
    return ca.vertcat(*x)

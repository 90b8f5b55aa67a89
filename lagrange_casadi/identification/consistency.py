"""Physical consistency: masses that are positive, and inertias that some body can have.

A body's inertia J about its centre is realizable if tr(J)/2 - J is positive definite (Wensing, Kim,
Slotine, *Linear matrix inequalities for physically consistent inertial parameter identification*,
IEEE RA-L 3, 2018). The logarithms of masses and of the determinants of these matrices are concave
in masses, first moments and inertias about a point, so Newton's method with them as a barrier finds
the least squares among parameters that a body can have.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..arithmetic.scalars import column
from ..base.arrays import Array, Expression
from ..base.symbolic import Graphs, symbolic
from ..equations.program import Program
from ..errors import DeclarationError

_PULL, _OPEN = 0.2, 1e-9
"""Weight of first values of combinations that the measurements leave open, as if those were known
with an error of five usual sizes; and the share of the largest singular value below which they are
left open.
"""

_WEIGHTS = tuple(10.0**-k for k in range(-2, 10))
"""Weights of the barrier one after another, in squares of residuals over their noise."""

_NEAR, _STEPS, _SETTLED = 1e-3, 60, 1e-6
"""Distance from its bounds at which a parameter begins, over its usual size; steps at most for a
weight; and the decrement, over the weight, that ends them.
"""

_KEPT, _SHORTEST = 0.1, 1e-6
"""Share of the way to a bound that no step goes, and the least share of a step."""


@dataclass(frozen=True, eq=False)
class Consistency(Graphs):
    """Conditions on the unknown parameters, of usual sizes ``scales`` (k,) and bounds (k,).

    ``positive(theta)`` has the masses of bodies, so many ``masses``, and then the matrices that
    must be positive definite, of these ``orders``, each by its entries on and below the diagonal.
    ``barrier(theta)`` has the sum of their logarithms times -1, its gradient and its second
    derivatives. ``bodies`` are the names of those of each mass, and of each matrix.
    """

    positive: ca.Function
    barrier: ca.Function
    masses: int
    orders: tuple[int, ...]
    first: Array
    scales: Array
    low: Array
    high: Array
    bodies: tuple[str, ...]

    @classmethod
    @symbolic
    def of(
        cls, program: Program, defaults: Array, numbers: Sequence[int], scales: Array
    ) -> Consistency:
        """Make the conditions of the bodies whose mass properties depend on unknown parameters."""
        theta, p = ca.SX.sym("theta", len(numbers)), ca.SX(ca.DM(defaults))
        p[list(numbers)] = theta
        masses: dict[str, Expression] = {}
        matrices: dict[str, Any] = {}
        content = program.data.template.content["bodies"]
        every = ca.vertsplit(program.data.masses(p))
        for name, mass in zip(content, every, strict=False):
            if _depends(mass, theta):
                masses[name] = mass
            inertia = (program.data.template.placed(content[name], p).get("centre") or {}).get(
                "inertia"
            )
            if inertia is not None and _depends(matrix := _second_moments(inertia), theta):
                matrices[name] = matrix
        rows = [*masses.values(), *(x for matrix in matrices.values() for x in _lower(matrix))]
        function = ca.Function("positive", [theta], [ca.densify(column(rows))])
        logs = sum((ca.log(mass) for mass in masses.values()), ca.SX(0))
        logs += sum((ca.log(ca.det(matrix)) for matrix in matrices.values()), ca.SX(0))
        curvature, slope = ca.hessian(-logs, theta)
        barrier = ca.Function("barrier", [theta], [-logs, slope, ca.densify(curvature)])
        parameters = [list(program.data.parameters.values())[k] for k in numbers]
        return cls(
            function,
            barrier,
            len(masses),
            tuple(matrix.size1() for matrix in matrices.values()),
            defaults[list(numbers)],
            scales,
            np.array([one.low for one in parameters]),
            np.array([one.high for one in parameters]),
            (*masses, *matrices),
        )

    def impossible(self, theta: Array) -> tuple[str, ...]:
        """Return the bodies whose mass is not positive, or whose inertia no body can have."""
        values = np.asarray(self.positive(theta)).ravel()
        values[~np.isfinite(values)] = -1.0  # an inertia about the centre of no mass
        least = [*values[: self.masses], *self._least_eigenvalues(values)]
        wrong = [name for name, low in zip(self.bodies, least, strict=True) if not low > 0.0]
        return tuple(dict.fromkeys(wrong))

    def _least_eigenvalues(self, values: Array) -> Iterator[float]:
        """Yield the least eigenvalue of each matrix of the conditions."""
        start = self.masses
        for order in self.orders:
            matrix = np.zeros((order, order))
            places = np.tril_indices(order)
            matrix[places] = values[start : start + places[0].size]
            start += places[0].size
            yield float(np.linalg.eigvalsh(matrix)[0])  # reads the lower half; ascending

    @symbolic
    def step(self, triangle: Array, right: Array, theta: Array) -> Array:
        """Return the consistent change of ``theta`` that makes |triangle change - right| least.

        Raises :class:`.DeclarationError` for first values that no body can have.
        """
        columns = triangle * self.scales
        size = np.linalg.norm(columns, axis=0).max(initial=0.0) or 1.0
        roots, axes = np.linalg.svd(columns, full_matrices=True)[1:]
        left = _PULL * axes[int((roots > _OPEN * size).sum()) :]
        rows = np.vstack([columns, left])
        aim = np.concatenate([right + triangle @ (theta - self.first), np.zeros(len(left))])
        x = self._begin(theta)
        for weight in _WEIGHTS:
            x = self._descended(rows, aim, x, weight)
        return self.first + self.scales * x - theta

    def _begin(self, theta: Array) -> Array:
        """Return scaled values inside all conditions: those of ``theta``, or the first ones."""
        low, high = self._bounds
        for start in ((theta - self.first) / self.scales, np.zeros(theta.size)):
            x = np.clip(start, low + _NEAR, np.maximum(high - _NEAR, low + _NEAR))
            if not (wrong := self.impossible(self.first + self.scales * x)):
                return x
        raise DeclarationError(
            f"no body has the initial mass and inertia of '{wrong[0]}'; give initial values that"
            " a body can have"
        )

    @property
    def _bounds(self) -> tuple[Array, Array]:
        return (self.low - self.first) / self.scales, (self.high - self.first) / self.scales

    def _inside(self, x: Array) -> bool:
        low, high = self._bounds
        theta = self.first + self.scales * x
        return bool(((low < x) & (x < high)).all()) and not self.impossible(theta)

    def _descended(self, rows: Array, aim: Array, x: Array, weight: float) -> Array:
        """Return the least of |rows x - aim|^2 / 2 and the barrier times its weight, near x."""
        value, slope, curvature = self._judged(rows, aim, x, weight)
        for _ in range(_STEPS):
            scale = 1.0 / np.sqrt(np.diag(curvature))
            step = -scale * np.linalg.solve(curvature * np.outer(scale, scale), scale * slope)
            fall = float(-slope @ step)
            if not fall > _SETTLED * weight:
                return x
            share = 1.0
            while share > _SHORTEST:
                found = self._judged(rows, aim, x + share * step, weight)
                kept = self._inside(x + share / (1.0 - _KEPT) * step)
                if kept and found[0] <= value - 1e-4 * share * fall:
                    break
                share /= 2.0
            else:
                return x  # rounding leaves no better place
            x, (value, slope, curvature) = x + share * step, found
        return x

    def _judged(
        self, rows: Array, aim: Array, x: Array, weight: float
    ) -> tuple[float, Array, Array]:
        """Return what is made least, its gradient and second derivatives; infinite outside."""
        if not self._inside(x):
            return math.inf, x, rows
        (low, high), theta = self._bounds, self.first + self.scales * x
        value, slope, curvature = (np.asarray(part) for part in self.barrier(theta))
        below, above = 1.0 / (x - low), 1.0 / (high - x)
        logs = np.log(np.concatenate([below[below > 0.0], above[above > 0.0]])).sum()
        slope = self.scales * slope.ravel() - below + above
        bends, axes = np.linalg.eigh(curvature * np.outer(self.scales, self.scales))
        curvature = (axes * np.maximum(bends, 0.0)) @ axes.T + np.diag(below**2 + above**2)
        left = rows @ x - aim
        return (
            float(left @ left / 2.0 + weight * (value.item() + logs)),
            rows.T @ left + weight * slope,
            rows.T @ rows + weight * curvature,
        )


def _depends(expression: Expression, theta: ca.SX) -> bool:
    return any(ca.which_depends(ca.SX(expression), theta, 1))


def _second_moments(inertia: Expression) -> ca.SX:
    """Return tr(J)/2 - J, positive definite for a realizable inertia J; in the plane J itself."""
    if not isinstance(inertia, list | tuple):
        return ca.SX(inertia)
    matrix = ca.vertcat(*(ca.horzcat(*map(ca.SX, row)) for row in inertia))
    return ca.SX(ca.trace(matrix) / 2 * ca.SX.eye(3) - matrix)


def _lower(matrix: Expression) -> list[Expression]:
    """Return the entries of a symmetric matrix on and below its diagonal, row by row."""
    return [matrix[i, j] for i in range(matrix.size1()) for j in range(i + 1)]

"""Physical consistency: masses that are positive, and inertias that some body can have.

A body's inertia J about its centre is realizable if tr(J)/2 - J is positive definite (Wensing, Kim,
Slotine, *Linear matrix inequalities for physically consistent inertial parameter identification*,
IEEE RA-L 3, 2018). Masses are exponentials, and these matrices products L L^T with exponentials on
the diagonal of L (Rucker, Wensing, *Smooth parameterization of rigid-body inertia*, RA-L 7, 2022),
so each step stays consistent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..arithmetic.scalars import column
from ..base.arrays import Array, Expression
from ..base.symbolic import Graphs, symbolic
from ..equations.program import Program
from ..errors import AccuracyError

_PULL, _OPEN = 0.1, 1e-9
"""Weight by which what the measurements leave open stays near its first value, relative to the
largest measured column; singular values below that share of the largest are left open.
"""

_LOW, _HIGH = 7.0, 10.0
"""Farthest a logarithm goes from where a step begins: masses and axes to a thousandth."""

_LEAST = 1e-6
"""Least mass, and least part of an inertia, over its first value or the largest one."""

_OPTIONS = {
    "print_time": False,
    "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-9, "max_iter": 500},
}


@dataclass(frozen=True, eq=False)
class Consistency(Graphs):
    """Conditions on the unknown parameters, of usual sizes ``scales`` (k,) and bounds (k,).

    ``positive(theta)`` has the masses of bodies and the principal minors' matrices, entry by entry;
    ``masses`` is how many masses come first, ``orders`` the orders of the matrices behind them.
    ``bodies`` are the names of those of each mass, and of each matrix.
    """

    positive: ca.Function
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
        parameters = [list(program.data.parameters.values())[k] for k in numbers]
        return cls(
            function,
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
        least = [*values[: self.masses], *(roots.min() for roots, _ in self._matrices(values))]
        wrong = [name for name, low in zip(self.bodies, least, strict=True) if not low > 0.0]
        return tuple(dict.fromkeys(wrong))

    def _matrices(self, values: Array) -> Iterator[tuple[Array, Array]]:
        """Yield eigenvalues and eigenvectors of each matrix of the conditions."""
        start = self.masses
        for order in self.orders:
            matrix = np.zeros((order, order))
            places = np.tril_indices(order)
            matrix[places] = values[start : start + places[0].size]
            start += places[0].size
            yield np.linalg.eigh(matrix)  # reads the lower half

    @symbolic
    def step(self, triangle: Array, right: Array, theta: Array) -> Array:
        """Return the consistent change of ``theta`` that makes |triangle change - right| least.

        Raises :class:`.AccuracyError` where there is none, or none is found.
        """
        unknown, free = ca.SX.sym("x", theta.size), ca.SX.sym("l", self._free)
        change = ca.DM(self.scales) * unknown - ca.DM(theta - self.first)
        size = np.linalg.norm(triangle * self.scales, axis=0).max(initial=0.0) or 1.0
        gap = ca.DM(triangle / size) @ change - ca.DM(right / size)
        roots, axes = np.linalg.svd(triangle * self.scales, full_matrices=True)[1:]
        left = ca.DM(axes[int((roots > _OPEN * size).sum()) :]) @ unknown
        cost = ca.dot(gap, gap) + _PULL**2 * ca.dot(left, left)
        values = self.positive(ca.DM(self.first) + ca.DM(self.scales) * unknown)
        begin, sizes, logarithms = self._begin(theta)
        bound = (values - self._positive(free)) / ca.DM(sizes)
        solver = ca.nlpsol(
            "consistent",
            "ipopt",
            {"x": ca.vertcat(unknown, free), "f": cost, "g": bound},
            _OPTIONS,
        )
        below, above = (np.where(logarithms, reach, math.inf) for reach in (_LOW, _HIGH))
        low, high = (self.low - self.first) / self.scales, (self.high - self.first) / self.scales
        found = solver(
            x0=np.concatenate([np.clip((theta - self.first) / self.scales, low, high), begin]),
            lbx=np.concatenate([low, begin - below]),
            ubx=np.concatenate([high, begin + above]),
            lbg=0.0,
            ubg=0.0,
        )
        if not solver.stats()["success"]:
            raise AccuracyError(
                "no parameters with positive masses and realizable inertias are found near the"
                " measurements; give other initial values, or bounds"
            )
        return np.asarray(found["x"]).ravel()[: theta.size] * self.scales + self.first - theta

    @property
    def _free(self) -> int:
        return self.masses + sum(order * (order + 1) // 2 for order in self.orders)

    def _positive(self, free: ca.SX) -> Expression:
        """Return masses and matrices, as :attr:`positive` has them, of free numbers."""
        rows, start = [ca.exp(free[k]) for k in range(self.masses)], self.masses
        for order in self.orders:
            lower = ca.SX(order, order)
            for i in range(order):
                for j in range(i + 1):
                    lower[i, j] = ca.exp(free[start]) if i == j else free[start]
                    start += 1
            rows += _lower(lower @ lower.T)
        return column(rows)

    def _begin(self, theta: Array) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
        """Return free numbers near values of the parameters, the sizes of the conditions, and which
        of the numbers are logarithms.
        """
        values = np.asarray(self.positive(theta)).ravel()
        free, sizes = np.zeros(self._free), np.ones(values.size)
        logarithms = np.arange(self._free) < self.masses
        largest = np.abs(values[: self.masses]).max(initial=0.0) or 1.0
        sizes[: self.masses] = largest
        free[: self.masses] = np.log(np.maximum(values[: self.masses], _LEAST * largest))
        start = self.masses
        for order, (roots, axes) in zip(self.orders, self._matrices(values), strict=True):
            places = np.tril_indices(order)
            stop = start + places[0].size
            largest = np.abs(roots).max() or 1.0
            near = (axes * np.maximum(roots, _LEAST * largest)) @ axes.T
            lower = np.linalg.cholesky(near)
            lower[np.diag_indices(order)] = np.log(np.diag(lower))
            free[start:stop], sizes[start:stop] = lower[places], largest
            logarithms[start:stop] = places[0] == places[1]
            start = stop
        return free, sizes, logarithms


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

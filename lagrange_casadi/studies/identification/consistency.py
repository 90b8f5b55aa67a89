"""Physical consistency: masses that are positive, and inertias that some body can have.

A body's pseudo-inertia, of its mass, first moments and second moments, is positive definite
(Wensing, Kim, Slotine, *Linear matrix inequalities for physically consistent inertial parameter
identification*, IEEE RA-L 3, 2018). IPOPT finds the least squares with each of them as a product
L L^T, relative to that of the initial values, and positive numbers on the diagonal of L: the
constraints are quadratic, and every start is inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ...base.arrays import Array, Expression
from ...base.ipopt import ipopt
from ...base.scalars import column
from ...base.symbolic import Graphs, symbolic, symbolic_property
from ...errors import AccuracyError, DeclarationError
from ...model.description import BodyNumbers
from .base import triangle
from .regressor import Regressor

_PULL, _OPEN = 0.2, 1e-9
"""Weight of first values of combinations that the measurements leave open, as if those were known
with an error of five usual sizes; and the share of the largest singular value below which they are
left open.
"""

_LEAST = 1e-3
"""Least number on the diagonal of L: for a mass, the root of its least share of the initial one."""

_EMPTY = 1e-12
"""Largest share of a matrix in a row that is none, as that of a rod's moment about its own axis."""


@dataclass(frozen=True, eq=False)
class Consistency(Graphs):
    """Conditions on the unknown parameters, of usual sizes ``scales`` (k,) and bounds (k,).

    ``matrices(theta)`` are those that must be positive definite, of these ``bodies``.
    """

    matrices: ca.Function
    bodies: tuple[str, ...]
    first: Array
    scales: Array
    low: Array
    high: Array

    @classmethod
    @symbolic
    def of(cls, regressor: Regressor, defaults: Array) -> Consistency:
        """Make the conditions of the bodies whose mass properties depend on unknown parameters."""
        program, numbers = regressor.program, regressor.numbers
        theta, p = ca.SX.sym("theta", len(numbers)), ca.SX(ca.DM(defaults))
        p[numbers] = theta
        first, found = defaults[numbers], {}
        template, space = program.data.template, program.data.space
        for name, body in template.placed(template.content.bodies, p).items():
            mass = ca.SX(body.mass)
            matrix = mass if body.centre is None else _pseudo_inertia(body, space, theta, first)
            if _depends(matrix, theta):
                found[name] = ca.densify(matrix)
        parameters = [program.data.parameters[name] for name in regressor.unknown]
        return cls(
            ca.Function("matrices", [theta], list(found.values())),
            tuple(found),
            first,
            regressor.ranking(defaults).scales,
            np.array([one.low for one in parameters]),
            np.array([one.high for one in parameters]),
        )

    def impossible(self, theta: Array) -> tuple[str, ...]:
        """Return the bodies whose mass is not positive, or whose inertia no body can have."""
        wrong = []
        for name, matrix in zip(self.bodies, self._at(theta), strict=True):
            try:
                np.linalg.cholesky(matrix)
            except np.linalg.LinAlgError:
                wrong.append(name)
        return tuple(wrong)

    def _at(self, theta: Array) -> list[Array]:
        """Return the matrices; -1 for one that is not finite, as that of no mass."""
        found = [np.asarray(matrix) for matrix in self.matrices.call([theta])]
        return [one if np.isfinite(one).all() else -np.eye(len(one)) for one in found]

    @symbolic_property
    def _solver(self) -> tuple[ca.Function, Array]:
        """IPOPT for the distance y (k,) from the least squares, in standard deviations, and the
        entries of L, those of the first values second; its parameter is the inverse (k, k + 1) of a
        triangle and its right side.
        """
        k = self.first.size
        y, rows = ca.MX.sym("y", k), ca.MX.sym("rows", k, k + 1)
        x = rows[:, :k] @ y + rows[:, k]
        matrices = self.matrices.call([ca.DM(self.first) + ca.DM(self.scales) * x])
        entries, apart, begin = [], [], [np.zeros(0)]
        for name, matrix, first in zip(self.bodies, matrices, self._at(self.first), strict=True):
            root = ca.DM(np.linalg.inv(np.linalg.cholesky(first)))
            shape = ca.Sparsity.lower(len(first))
            entries.append(ca.MX.sym(name, shape.nnz()))
            lower = ca.MX(shape, entries[-1])
            apart.append(ca.project(root @ matrix @ root.T - lower @ lower.T, shape).nz[:])
            begin.append(np.equal(*shape.get_triplet()).astype(float))
        program = {"x": ca.veccat(y, *entries), "p": rows, "f": ca.sumsqr(y) / 2.0}
        program["g"] = ca.veccat(x, *apart)
        return ipopt("consistent", program, nlp_scaling_method="none"), np.concatenate(begin)

    @symbolic
    def step(self, columns: Array, right: Array, theta: Array) -> Array:
        """Return the consistent change of ``theta`` that makes |columns change - right| least.

        Raises :class:`.DeclarationError` for first values that no body can have, and
        :class:`.AccuracyError` if no consistent values are found.
        """
        if wrong := self.impossible(self.first):
            raise DeclarationError(
                f"no body has the initial mass and inertia of '{wrong[0]}'; give initial values"
                " that a body can have"
            )
        scaled, k = columns * self.scales, theta.size
        size = np.linalg.norm(scaled, axis=0).max(initial=0.0) or 1.0
        roots, axes = np.linalg.svd(scaled, full_matrices=True)[1:]
        left = _PULL * axes[int((roots > _OPEN * size).sum()) :]
        aim = np.concatenate([right + columns @ (theta - self.first), np.zeros(len(left))])
        both = triangle(np.column_stack([np.vstack([scaled, left]), aim]))[:k]
        rows = np.linalg.solve(both[:, :k], np.column_stack([np.eye(k), both[:, k]]))
        solver, begin = self._solver
        low, high = ((bound - self.first) / self.scales for bound in (self.low, self.high))
        equal = np.zeros(begin.size)
        found = solver(
            x0=np.concatenate([-both[:, k], begin]),
            p=rows,
            lbx=np.concatenate([np.full(k, -np.inf), np.where(begin > 0.0, _LEAST, -np.inf)]),
            lbg=np.concatenate([low, equal]),
            ubg=np.concatenate([high, equal]),
        )
        if not solver.stats()["success"]:
            raise AccuracyError(
                "no consistent values of the unknown parameters are found; give other initial"
                " values, or prior values"
            )
        x = rows[:, :k] @ np.asarray(found["x"]).ravel()[:k] + rows[:, k]
        return np.asarray(np.clip(self.first + self.scales * x, self.low, self.high) - theta)


def _depends(expression: Expression, theta: ca.SX) -> bool:
    return any(ca.which_depends(ca.SX(expression), theta, 1))


def _pseudo_inertia(body: BodyNumbers, space: bool, theta: ca.SX, first: Array) -> Expression:
    """Return the matrix of a body's second moments, first moments and mass, about its base; in the
    plane with the polar moment, and of the mass alone if no moment depends on the parameters.

    Directions in which the body has no extent are left out.
    """
    mass, place = ca.SX(body.mass), column(body.centre or ())
    matrix = ca.vertcat(*(column(row).T for row in body.inertia or ()))
    if not space:
        inertia, place = matrix[2, 2], place[:2]
        moments = mass * place
        about = inertia + mass * ca.dot(place, place)
        found = ca.blockcat([[about, moments.T], [moments, mass * ca.SX.eye(2)]])
        return found if _depends(inertia, theta) else mass
    second = ca.trace(matrix) / 2 * ca.SX.eye(3) - matrix
    if not _depends(second, theta):
        return mass
    probe = ca.Function("second", [theta], [ca.densify(second)])
    sizes = sum(np.abs(np.asarray(probe(share * first))) for share in (1.0, 0.9, 1.2))
    some = np.flatnonzero(~(sizes.max(axis=0) <= _EMPTY * sizes.max())).tolist()
    place, second = place[some], second[some, some]
    return ca.blockcat([[second + mass * place @ place.T, mass * place], [mass * place.T, mass]])

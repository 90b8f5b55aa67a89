"""The loops of a mechanism whose coordinates are all free to give way, drives too: their slopes and
rank in numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import column
from .iteration import place_roughly
from .multibody import Coordinate, Multibody
from .sizes import extent, units
from .spherical import axes_of, turn
from .substitution import Numbers

_STEPS, _LARGEST = 200, 0.5
_CLOSED = 1e-11
_SINGULAR = 1e-10
_DEPENDENT = 1e-9
_NO_SLOPE = 10.0 * _CLOSED
"""A coordinate's slopes that are smaller are rounding, though they be all that it has: a guide that
is there twice, or a turntable, which turns a loop with the gap that it may have.
"""


@dataclass(frozen=True, eq=False)
class ReleasedLoops:
    """The loops' equations over coordinates u and quaternions q of balls: slides are beside the
    mechanism's extent, and so are gaps; a constraint is beside its slopes in the rough posture.

    ``gaps(u, q, *inputs)`` gives the equations and their derivatives by u; ``turned(u, q)`` the
    quaternions after the small rotations u of balls, which ``resting`` marks. ``first`` are u and q
    in the rough posture, ``values`` those of the inputs. What is below ``slack`` may be the
    rounding of axes and places.
    """

    gaps: Any
    turned: Any
    first: tuple[Array, Array]
    values: Sequence[Expression]
    resting: Array
    slack: float

    @classmethod
    def of(
        cls,
        multibody: Multibody,
        posture: Mapping[Coordinate, float],
        inputs: Sequence[Expression],
        values: Sequence[Expression],
    ) -> ReleasedLoops:
        """Coordinates near the given ones; ``values`` are the initial numbers of the symbols
        ``inputs``.
        """
        coordinates, numbers = multibody.coordinates, Numbers()
        for symbols, value in zip(inputs, values, strict=True):
            numbers.note(symbols, np.atleast_1d(value).tolist())
        quaternions = (
            place_roughly(multibody, posture, numbers, {})
            if any(c.spherical for c in coordinates)
            else {}
        )
        turned = {spherical: ca.SX.sym("quaternion", 4) for spherical in quaternions}
        free = ca.SX.sym("u", len(coordinates))
        symbols = column(c.value for c in coordinates)
        counted = column(c.by_values for c in coordinates if c.spherical is None)
        (size,) = numbers.of(extent(multibody.mechanism))
        sizes = np.array([size if c.kind == "slide" else 1.0 for c in coordinates])
        placed = [ca.substitute(counted, symbols, free * ca.DM(sizes))]
        # Of balls a step is a small rotation of where they are.
        local = {
            spherical: ca.vertcat(
                *(free[k] for k, c in enumerate(coordinates) if c.spherical is spherical)
            )
            for spherical in turned
        }
        placed += [axes_of(turn(turned[spherical], local[spherical])) for spherical in turned]
        variables = [
            *(c.variables for c in coordinates if c.spherical is None),
            *(spherical.axes for spherical in turned),
        ]
        residuals = ca.substitute(
            column(c.residual for c in multibody.loop_equations), column(variables), column(placed)
        )
        quaternion = column(turned.values())
        first = (
            np.array([0.0 if c.spherical else posture.get(c, 0.0) for c in coordinates]) / sizes,
            np.array([*quaternions.values()]).ravel(),
        )
        given = [free, quaternion, *inputs]
        slope = ca.Function("slope", given, [ca.jacobian(residuals, free)])
        rows = np.linalg.norm(slope(*first, *values).full(), axis=1)
        start = 0
        for loop in multibody.loop_equations:
            stop = start + loop.residual.numel()
            if not loop.declared:
                rows[start:stop] = units(loop, size)
            start = stop
        residuals /= ca.DM(np.where(rows > 0.0, rows, 1.0))
        return cls(
            ca.Function("gaps", given, [residuals, ca.jacobian(residuals, free)]),
            ca.Function(
                "turned",
                [free, quaternion],
                [column(turn(turned[spherical], local[spherical]) for spherical in turned)],
            ),
            first,
            values,
            np.array([c.spherical is not None for c in coordinates], bool),
            multibody.slack,
        )

    def slopes(self) -> Array | None:
        """The derivatives by all coordinates where the loops close near the rough posture, or miss
        by rounding and come no nearer; None where they do not.
        """
        (u, q), singular = self.first, max(_SINGULAR, self.slack)
        for _ in range(_STEPS):
            residual, slope = (x.full() for x in self.gaps(u, q, *self.values))
            step = np.linalg.lstsq(slope, -residual.ravel(), rcond=singular)[0] if u.size else u
            missed, moves = (np.max(np.abs(x), initial=0.0) for x in (residual, step))
            if missed < _CLOSED or (missed < self.slack and moves < _CLOSED):
                return np.asarray(slope)
            u = u + step * min(1.0, _LARGEST / (moves + 1e-300))
            q, u = self.turned(u, q).full().ravel(), np.where(self.resting, 0.0, u)
        return None

    def rank(self, slope: Array) -> int:
        """Number of independent equations among the derivatives of some loops."""
        lengths = np.linalg.norm(slope, axis=0)
        scaled = slope / np.where(lengths > max(_NO_SLOPE, self.slack), lengths, 1.0)
        least = max(_DEPENDENT, self.slack)
        return int(np.linalg.matrix_rank(scaled, tol=least)) if scaled.size else 0

"""The loops of a mechanism whose coordinates are all free to give way, drives too: their slopes and
rank in numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.scalars import column
from .multibody import Multibody
from .sizes import directs, extent
from .spherical import axes_of, quaternion_of, turn
from .substitution import Numbers

_LARGEST = 0.5
_CLOSED = 1e-11
_SINGULAR = 1e-10
_DEPENDENT = 1e-9
_NO_SLOPE = 10.0 * _CLOSED
"""A coordinate's slopes that are smaller are rounding, though they be all that it has: a guide that
is there twice, or a turntable, which turns a loop with the gap that it may have.
"""


State = tuple[Any, ...]
"""Coordinates u, slides beside the mechanism's extent; quaternions q of balls; the time; and the
parameters.
"""


@dataclass(frozen=True, eq=False)
class ReleasedLoops:
    """The loops' equations over coordinates u and quaternions q of balls: slides are beside the
    mechanism's extent, and so are gaps; a constraint is beside its slopes where it starts.

    ``gaps(u, q, *inputs)`` gives the equations and their derivatives by u; ``turned(u, q)`` the
    quaternions after the small rotations u of balls, which ``resting`` marks;
    ``placed(u, q, *inputs)`` the coordinates' ``variables``. ``residuals`` are the equations over
    ``given``, the symbols of u and q and the inputs, and ``loops`` their rows by loop. ``first`` is
    the state at the start, and ``sizes`` are the units of u. What is below ``slack`` may be the
    rounding of axes and places.
    """

    gaps: Any
    turned: Any
    placed: Any
    variables: Any
    residuals: Any
    loops: Sequence[slice]
    given: Sequence[Any]
    first: State
    sizes: Array
    resting: Array
    slack: float

    @classmethod
    def of(cls, multibody: Multibody, numbers: Numbers) -> ReleasedLoops:
        """Coordinates near their ``numbers``, where time and parameters have theirs too."""
        coordinates, mechanism = multibody.coordinates, multibody.mechanism
        inputs = [mechanism.time, mechanism.symbols]
        turned = {spherical: ca.SX.sym("quaternion", 4) for spherical in multibody.sphericals}
        free = ca.SX.sym("u", len(coordinates))
        single = [c for c in coordinates if c.spherical is None]
        symbols = column(c.value for c in coordinates)
        counted = column(c.by_values for c in single)
        (size,) = numbers.of(extent(mechanism))
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
            *(c.variables for c in single),
            *(spherical.axes for spherical in turned),
        ]
        residuals = ca.substitute(
            column(c.residual for c in multibody.loop_equations), column(variables), column(placed)
        )
        quaternion = column(turned.values())
        # Zero for the coordinates of balls.
        u = column(ca.SX(0) if c.spherical is not None else c.value for c in coordinates)
        axes = (np.reshape(numbers.of(one.axes), (3, 3)) for one in turned)
        first = (
            np.array(numbers.of(u)) / sizes,
            np.array([quaternion_of(each) for each in axes]).ravel(),
            *numbers.of(mechanism.time),
            numbers.of(mechanism.symbols),
        )
        given = [free, quaternion, *inputs]
        slope = ca.Function("slope", given, [ca.jacobian(residuals, free)])
        rows = np.linalg.norm(slope(*first).full(), axis=1)
        ends = itertools.accumulate(
            (e.residual.numel() for e in multibody.loop_equations), initial=0
        )
        loops = [slice(*pair) for pair in itertools.pairwise(ends)]
        for loop, own in zip(multibody.loop_equations, loops, strict=True):
            if not loop.declared:
                rows[own] = np.where(directs(loop), 1.0, size)
        residuals /= ca.DM(np.where(rows > 0.0, rows, 1.0))
        return cls(
            ca.Function("gaps", given, [residuals, ca.jacobian(residuals, free)]),
            ca.Function(
                "turned",
                [free, quaternion],
                [column(turn(turned[spherical], local[spherical]) for spherical in turned)],
            ),
            ca.Function("placed", given, [column(placed)]),
            column(variables),
            residuals,
            loops,
            given,
            first,
            sizes,
            np.array([c.spherical is not None for c in coordinates], bool),
            multibody.slack,
        )

    def at(self, state: State) -> tuple[Array, Array]:
        """The equations and their derivatives by all coordinates."""
        residual, slope = (x.full() for x in self.gaps(*state))
        return residual.ravel(), slope

    def closed(
        self, state: State, free: Flags | None = None, rows: Flags | None = None, steps: int = 200
    ) -> State | None:
        """The state in which equations hold, or miss by rounding and come no nearer, from a
        ``state`` near it; None where it is not found.

        Coordinates move that are ``free``, by default all, for the equations ``rows`` that are
        marked, by default all.
        """
        singular = max(_SINGULAR, self.slack)
        free = np.ones(self.sizes.size, bool) if free is None else free
        for _ in range(steps):
            residual, slope = self.at(state)
            residual, slope = (residual, slope) if rows is None else (residual[rows], slope[rows])
            if not np.isfinite(slope).all() or not np.isfinite(residual).all():
                return None
            step = np.zeros(self.sizes.size)
            if free.any():
                step[free] = np.linalg.lstsq(slope[:, free], -residual, rcond=singular)[0]
            missed, moves = (np.max(np.abs(x), initial=0.0) for x in (residual, step))
            if missed < _CLOSED or (missed < self.slack and moves < _CLOSED):
                return state
            if moves < _CLOSED:
                return None
            state = self.moved(state, step * min(1.0, _LARGEST / moves))
        return None

    def moved(self, state: State, step: Array) -> State:
        """The state after a step of all coordinates."""
        u, q, *given = state
        u = u + step
        return np.where(self.resting, 0.0, u), self.turned(u, q).full().ravel(), *given

    def rank(self, slope: Array) -> int:
        """Number of independent equations among the derivatives of some loops."""
        lengths = np.linalg.norm(slope, axis=0)
        scaled = slope / np.where(lengths > max(_NO_SLOPE, self.slack), lengths, 1.0)
        least = max(_DEPENDENT, self.slack)
        return int(np.linalg.matrix_rank(scaled, tol=least)) if scaled.size else 0

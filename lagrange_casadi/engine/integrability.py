"""Check that velocities are rates of places: total time derivatives of functions of the coordinates
and of time.

They are just where d/dt(dw/dq') = dw/dq holds, whatever the coordinates, rates and accelerations.
It holds for velocities of points in axes at rest, and for rates of angles in a plane. It does not
hold for the components of a body's angular velocity in space, which are the rates of nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import column, entries
from ..base.symbolic import symbolic_property
from ..errors import DeclarationError

_POINTS, _TRIALS, _WAYS = 3, 1000, 3
_SAME, _NOTHING = 1e-8, 1e-13


@dataclass(frozen=True, eq=False)
class Course:
    """Motion of a system: symbols of coordinates p, rates q', accelerations q'' and time t, and
    ``coordinate_rates`` p' over all but the accelerations, linear in q'.
    """

    coordinates: Any
    rates: Any
    accelerations: Any
    time: Any
    coordinate_rates: Any

    def derivative(self, graphs: ca.SX) -> ca.SX:
        """The total time derivative of graphs over coordinates, rates and time."""
        state = ca.vertcat(self.coordinates, self.rates, self.time)
        change = ca.vertcat(
            self.coordinate_rates, self.accelerations, ca.SX.ones(self.time.numel())
        )
        return ca.jtimes(graphs, state, change)

    def along_rates(self, slopes: ca.SX) -> ca.SX:
        """Slopes along the rates q', from those along the coordinates p."""
        along: ca.SX = ca.jtimes(self.coordinate_rates, self.rates, slopes, True)
        return along

    @symbolic_property
    def circles(self) -> list[tuple[int, int]]:
        """Pairs of coordinates that stay on a circle, such as a cosine and a sine: graphs may rely
        on its radius of one.
        """
        generator, size = np.random.default_rng(1), self.coordinates.numel()
        # A few ways to move show as much as every rate by itself.
        directions = ca.DM(generator.normal(size=(self.rates.numel(), _WAYS)))
        moved = ca.densify(ca.jtimes(ca.SX(self.coordinate_rates), self.rates, directions))
        others = _others(moved, self.coordinates)
        at = generator.uniform(0.2, 2.0, size)
        speeds = ca.Function("moved", [self.coordinates, others], [moved])(
            at, generator.uniform(0.2, 2.0, others.numel())
        ).full()
        radial = at[:, None] * speeds
        found: list[tuple[int, int]] = []
        free = np.flatnonzero(np.abs(radial).max(axis=1, initial=0.0))
        while free.size:
            i, free = int(free[0]), free[1:]
            meets = np.flatnonzero(
                np.abs(radial[free] + radial[i]).max(axis=1, initial=0.0)
                < _SAME * np.abs(radial[i]).max()
            )
            if meets.size:
                found.append((i, int(free[meets[0]])))
                free = np.delete(free, meets[0])
        return found


def no_rates(
    graphs: Expression, course: Course, mobilities: Expression, mobility_rates: Expression
) -> list[int]:
    """The numbers of those ``graphs``, over coordinates, rates and time, that are no rates of
    places: found at random points.

    Mobilities rest; along one of them, only graphs that depend on it are looked at. Raises
    :class:`DeclarationError` where the graphs have no value at any of many points.
    """
    graphs = ca.densify(ca.SX(graphs))
    n, p, k = course.rates.numel(), course.coordinates.numel(), graphs.numel()
    if not k or not n + mobilities.numel():
        return []
    # All of them at once, each with a weight: one sweep shows whether any is wrong.
    weights = ca.SX.sym("weights", k)
    slopes = ca.gradient(ca.dot(weights, graphs), ca.vertcat(course.coordinates, course.rates))
    by_place, by_rate = ca.vertsplit(slopes, [0, p, p + n])
    along = [course.derivative(by_rate), course.along_rates(by_place)]
    across = [ca.SX(k, 0), ca.SX(k, 0)]
    for e, e_rate in zip(entries(mobilities), entries(mobility_rates), strict=False):
        by_mobility = ca.jacobian(graphs, e)
        rows_here = ca.SX(by_mobility.sparsity(), 1)
        across[0] = ca.horzcat(
            across[0], course.derivative(ca.densify(ca.jacobian(graphs, e_rate))) * rows_here
        )
        across[1] = ca.horzcat(across[1], by_mobility)
    moving = ca.vertcat(course.coordinates, course.rates, course.time, course.accelerations)
    resting = ca.vertcat(mobilities, mobility_rates)
    outputs = [*map(ca.densify, [*along, *across]), graphs]
    others = _others(ca.veccat(*outputs), ca.vertcat(weights, moving, resting))
    identity = ca.Function("identity", [weights, moving, others, resting], outputs)

    def broken(at: Array, fixed: Array, weighted: Array) -> list[bool]:
        """Return whether the sum is broken along the coordinates, and which graphs are along the
        mobilities.
        """
        *sides, _ = (x.full() for x in identity(weighted, at, fixed, np.zeros(resting.numel())))
        residual, across_residual = (
            np.abs(a - b).max(axis=1, initial=0.0) for a, b in (sides[:2], sides[2:])
        )
        largest, across_largest = (
            np.maximum(np.abs(a), np.abs(b)).max(initial=0.0) for a, b in (sides[:2], sides[2:])
        )
        return [
            bool(residual.max(initial=0.0) > _SAME * (1.0 + largest)),
            *(across_residual > _SAME * (1.0 + across_largest)),
        ]

    generator, circles = np.random.default_rng(0), course.circles
    found: set[int] = set()
    points = 0
    for trial in range(_TRIALS):
        reach = 1.0 if trial < _TRIALS // 3 else 10.0 ** generator.uniform(-3.0, 3.0)
        at, fixed = (
            reach * generator.uniform(0.2, 2.0, size) for size in (moving.numel(), others.numel())
        )
        at *= generator.choice([-1.0, 1.0], at.size) if trial % 2 else 1.0
        for pair in circles:
            angle = generator.uniform(-np.pi, np.pi)
            at[list(pair)] = np.cos(angle), np.sin(angle)
        values = [x.full() for x in identity(np.ones(k), at, fixed, np.zeros(resting.numel()))]
        if not all(np.isfinite(x).all() for x in values):
            continue
        sizes = np.abs(values[-1].ravel())
        # What is nothing but rounding beside the others must not be made as large as they are.
        sizes = np.where(sizes > _NOTHING * sizes.max(), sizes, sizes.max() or 1.0)
        weighted = generator.uniform(0.5, 1.5, k) / sizes
        together, *alone = broken(at, fixed, weighted)
        found |= {i for i in range(k) if alone[i]}
        if together:
            found |= {
                i
                for i in range(k)
                if broken(at, fixed, np.where(np.arange(k) == i, weighted, 0.0))[0]
            }
        points += 1
        if points == _POINTS:
            break
    if not points:
        raise DeclarationError(
            f"velocities or tangent are not finite at any of {_TRIALS} random points, so they"
            " cannot be checked; expected expressions that are finite for most coordinates"
        )
    return sorted(found)


def _others(graphs: ca.SX, known: ca.SX) -> ca.SX:
    """The symbols of graphs that are not among those that are known, one column."""
    rows_here = {symbol.element_hash() for symbol in entries(known)}
    return column(symbol for symbol in ca.symvar(graphs) if symbol.element_hash() not in rows_here)

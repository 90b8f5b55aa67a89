"""Gaps of joints, of reported poses and of the users' equations: how far the bodies are from where
they are said to be.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial, reduce

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.stated import Equation
from .contacts import idle
from .instant_vectors import cross, dot, most, resolve, size
from .placing import Placed
from .reported import NEARBY
from .unplaced import stacked

Residuals = tuple[Array, float]
"""Gaps (t,), and what they are to be compared with."""


def closure(placed: Placed) -> list[Residuals]:
    """The largest gap of places and angles, beside the length of all links; and those of rates and
    of accelerations, beside the largest there are. An angle is taken at that length.
    """
    length, (_, *fastest) = placed.declared.size, placed.rates
    gaps: list[list[Array]] = [[], [], []]
    for name in placed.closing:
        points, axes, spins = placed.missed(name)
        turns = most(axes), *size(spins)
        for of_order, point, turned in zip(gaps, size(points), turns, strict=True):
            of_order += [point, turned * length]
    for rotations, off in _of_motions(placed):
        for of_order, residual in zip(gaps, off, strict=True):
            of_order.append(residual * length if rotations else residual)
    for residuals in (_of_angles, _of_poses, _of_equations):
        gaps[0] += residuals(placed)
    nothing = np.zeros_like(placed.reported.t)
    return [
        (reduce(np.maximum, of_order, nothing), float(np.max(largest)))
        for of_order, largest in zip(gaps, (nothing + length, *fastest), strict=True)
    ]


def _of_motions(placed: Placed) -> Iterator[tuple[bool, Array]]:
    """Residual of driven coordinates against their laws, with rate and acceleration, (3, t); and
    whether it is an angle.

    Where a law jumps, rounding decides on which side of that an instant is.
    """
    t, length, (_, *fastest) = placed.reported.t, placed.declared.size, placed.rates
    for motion in placed.stated.motions:
        (entry,) = motion.entries
        if entry.part in placed.reported.unmeasured:
            continue
        moving, rotations = stacked(placed, motion), placed.is_angle(entry)
        found = motion.at(moving, t)
        off = np.abs(found)
        if entry.kind == "direction":
            off[0] = np.abs(2.0 * np.sin(found[0] / 2.0))
        off[0] = np.maximum(off[0] - placed.reported.rounded(moving[0][0]), 0.0)
        largest = [length, *(float(np.max(one)) for one in fastest)]
        if any(
            np.max(residual) * (length if rotations else 1.0) > placed.reported.doubted * one
            for residual, one in zip(off, largest, strict=True)
        ):
            blur = NEARBY * placed.reported.rounding * np.max(np.abs(t))
            blurred = np.nansum(
                [np.abs(motion.at(moving, t + direction) - found) for direction in (-blur, blur)],
                axis=0,
            )
            off = np.maximum(off - blurred, 0.0)
        yield rotations, off


def _of_angles(placed: Placed) -> Iterator[Array]:
    """Residual of reported angles against phases that are known more closely; an angle of many
    turns has fewer digits.
    """
    for output, phase in placed.reported.phases.items():
        if output.part not in placed.reported.unmeasured:
            angle = placed.reported.outputs[output]
            known = placed.reported.rounded(angle)
            yield (np.abs(2.0 * np.sin((angle - phase) / 2.0)) - known) * placed.declared.size


def _of_poses(placed: Placed) -> Iterator[Array]:
    """Residual of bodies against their reported poses, whose axes must be at right angles.

    The y axis of a bar must be in the plane of the bar and the direction that was declared for it.
    """
    declared, reported = placed.declared, placed.reported
    for name in declared.bodies:
        body = placed.bodies[name]
        yield size(reported.place(name) - body.at)
        if not declared.oriented(name):
            continue
        axes = reported.axes(name)
        off = most(axes - body.axes)
        if not declared.space:
            known = reported.rounded(reported.outputs[Output("pose", name, "angle")])
            yield (off - known) * declared.size
            continue
        x, y, z = axes
        yield off * declared.size
        yield most(resolve(axes, axes) - reported.ground) * declared.size
        yield size(cross(x, y) - z) * declared.size
        if name in declared.bars and name in declared.beside:
            beside = reported.straight(declared.beside[name])
            yield np.where(dot(beside, y) >= 0.0, np.abs(dot(beside, z)), 1.0) * declared.size


def _of_equations(placed: Placed) -> Iterator[Array]:
    """Residuals of users' equations, over their slopes; and of the work of transmissions."""
    for equation in placed.stated.equations:
        yield _missed(placed, equation) * placed.declared.size
        for touch in equation.touching(partial(stacked, placed, equation)):
            yield idle(touch, placed) * placed.declared.size


def _missed(placed: Placed, equation: Equation) -> Array:
    length, t = placed.declared.size, placed.reported.t
    moving = stacked(placed, equation)
    units = [
        1.0 if entry.kind in ("coordinate", "direction") else length for entry in equation.entries
    ]
    sizes = np.reshape(units, (-1, 1)) + np.abs(moving[1 if equation.row else 0])
    scale = np.sum(np.abs(equation.slopes_at(moving, t)) * sizes, axis=0)
    missed = np.abs(equation.at(moving, t)[0])
    return np.asarray(np.divide(missed, scale, out=missed.copy(), where=scale > 0.0))

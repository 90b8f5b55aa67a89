"""Gaps of joints, of reported poses and of the users' equations: how far the bodies are from where
they are said to be.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.stated import Equation
from .contacts import idle
from .instant_vectors import Scalar, Vector, most
from .placing import Placed
from .reported import NEARBY
from .unplaced import joint_residuals, stacked

Residuals = tuple[Array, float]
"""Gaps (t,), and what they are to be compared with."""


def closure(placed: Placed) -> list[Residuals]:
    """The largest gap of places and angles, beside the length of all links; and those of rates,
    beside the largest there are.
    """
    worst = np.zeros_like(placed.reported.t)
    for residuals in (_of_joints, _of_angles, _of_poses, _of_equations):
        for residual in residuals(placed):
            worst = np.maximum(worst, residual)
    motions = list(_of_motions(placed))
    for rotations, (residual, _, _) in motions:
        worst = np.maximum(worst, residual * placed.declared.size if rotations else residual)
    return [(worst, placed.declared.size), *_of_rates(placed, motions)]


def _of_joints(placed: Placed) -> Iterator[Scalar]:
    """Residual of a joint: the child's position and direction against the joint's reported
    motion.
    """
    for name, joint in placed.declared.joints.items():
        (near, far), motion = placed.ends(name), placed.relatives[name]
        there = near.at + near.axes.turn(Vector(*joint.parent.at) + motion.slide[0])
        yield (placed.pins[name][0] - there).size
        if motion.whole:
            yield near.axes.under(far.axes).off(motion.turned) * placed.declared.size


def _of_rates(placed: Placed, motions: Sequence[tuple[bool, Array]]) -> list[Residuals]:
    """Residuals of velocities, angular velocities, and the changes of both, by joints and
    motions.
    """
    size = placed.declared.size
    _, fastest, changes = placed.rates
    residuals = [
        joint_residuals(placed, name, placed.pins[name]) for name in placed.declared.joints
    ]
    largest = (fastest, fastest / size, changes, changes / size)
    found: list[Residuals] = []
    for k, one in enumerate(largest):
        moved = (off[1 + k // 2] for rotations, off in motions if rotations == bool(k % 2))
        off = most([*(each[k].size for each in residuals), *moved])
        found.append((np.zeros_like(placed.reported.t) + off, float(np.max(one))))
    return found


def _of_motions(placed: Placed) -> Iterator[tuple[bool, Array]]:
    """Residual of driven coordinates against their laws, with rate and acceleration, (3, t); and
    whether it is an angle.

    Where a law jumps, rounding decides on which side of that an instant is.
    """
    t, size, (_, *fastest) = placed.reported.t, placed.declared.size, placed.rates
    for motion in placed.stated.motions:
        (entry,) = motion.entries
        if entry.part in placed.reported.unmeasured:
            continue
        moving, rotations = stacked(placed, motion), placed.is_angle(entry)
        found = motion.at(*moving, t)
        off = np.abs(found)
        if entry.kind == "direction":
            off[0] = np.abs(2.0 * np.sin(found[0] / 2.0))
        off[0] = np.maximum(off[0] - placed.reported.rounded(moving[0][0]), 0.0)
        largest = [size, *(float(np.max(one)) for one in fastest)]
        if any(
            np.max(residual) * (size if rotations else 1.0) > placed.reported.doubted * one
            for residual, one in zip(off, largest, strict=True)
        ):
            blur = NEARBY * placed.reported.rounding * np.max(np.abs(t))
            blurred = np.nansum(
                [np.abs(motion.at(*moving, t + direction) - found) for direction in (-blur, blur)],
                axis=0,
            )
            off = np.maximum(off - blurred, 0.0)
        yield rotations, off


def _of_angles(placed: Placed) -> Iterator[Scalar]:
    """Residual of reported angles against phases that are known more closely; an angle of many
    turns has fewer digits.
    """
    for output, phase in placed.reported.phases.items():
        if output.part not in placed.reported.unmeasured:
            angle = placed.reported.outputs[output]
            known = placed.reported.rounded(angle)
            yield (np.abs(2.0 * np.sin((angle - phase) / 2.0)) - known) * placed.declared.size


def _of_poses(placed: Placed) -> Iterator[Scalar]:
    """Residual of bodies against their reported poses, whose axes must be at right angles.

    The y axis of a bar must be in the plane of the bar and the direction that was declared for it.
    """
    declared, reported = placed.declared, placed.reported
    for name in declared.bodies:
        body = placed.bodies[name]
        yield (reported.place(name) - body.at).size
        if not declared.oriented(name):
            continue
        axes = reported.axes(name)
        if not reported.space:
            known = reported.rounded(reported.outputs[Output("pose", name, "angle")])
            yield (axes.off(body.axes) - known) * declared.size
            continue
        x, y, z = axes.x, axes.y, axes.z
        yield axes.off(body.axes) * declared.size
        yield (
            most(
                [
                    *(direction.dot(direction) - 1.0 for direction in (x, y, z)),
                    x.dot(y),
                    y.dot(z),
                    z.dot(x),
                ]
            )
            * declared.size
        )
        yield (x.cross(y) - z).size * declared.size
        if name in reported.two_force_links and name in declared.beside:
            beside = Vector(*declared.beside[name])
            yield np.where(beside.dot(y) >= 0.0, np.abs(beside.dot(z)), 1.0) * declared.size


def _of_equations(placed: Placed) -> Iterator[Scalar]:
    """Residuals of users' equations, over their slopes; and of the work of transmissions."""
    for equation in placed.stated.equations:
        yield _missed(placed, equation) * placed.declared.size
        for touch in equation.touching(partial(stacked, placed, equation)):
            yield idle(touch, placed.bodies, *placed.rates[:2]) * placed.declared.size


def _missed(placed: Placed, equation: Equation) -> Array:
    size, t = placed.declared.size, placed.reported.t
    places, moving, changes = stacked(placed, equation)
    units = [
        1.0 if entry.kind in ("coordinate", "direction") else size for entry in equation.entries
    ]
    sizes = np.reshape(units, (-1, 1)) + np.abs(moving if equation.row else places)
    scale = np.sum(np.abs(equation.slopes_at(places, moving, t)) * sizes, axis=0)
    missed = np.abs(equation.at(places, moving, changes, t)[0])
    return np.asarray(np.divide(missed, scale, out=missed.copy(), where=scale > 0.0))

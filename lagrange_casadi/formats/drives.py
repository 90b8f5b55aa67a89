"""Drives of a model whose file gives too few motions: coordinates, and their values at rest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.arrays import Array
from .checks import spinning
from .posture import at_reference, closing, extent, outward
from .record import GROUND, MOVES, Joint, Law, Model

RANK = 1e-6
"""Smaller singular values, of the largest, come of axes that a drawing has rounded."""

REST = "The file gives no motion of {}: here it rests. Write how it moves among the laws."


def driven(model: Model) -> Model:
    """Return a model in which as many coordinates have a motion as it has degrees of freedom.

    Those of the file have theirs; others are taken in the order of joints, and rest where they are.
    """
    names = [name for joint in model.joints.values() for name, _ in _twists(model, joint)]
    rates = _rates(model, names)
    rank = int(np.linalg.matrix_rank(rates, RANK)) if rates.size else 0
    idle = sum(model.bodies[one].rod is not None for one in spinning(model))
    idle += 3 * sum(body.point for body in model.bodies.values())
    needed = len(names) - rank - idle
    chosen = [k for k, name in enumerate(names) if name in model.motions]
    drivable = {name for joint in model.joints.values() for name in joint.coordinates}
    able = [k for k, name in enumerate(names) if name in drivable]
    single = {k: len(model.joints[names[k].partition(":")[0]].coordinates) for k in able}
    later = {k: names[k].partition(":")[0] not in model.preferred for k in able}
    for k in sorted(able, key=lambda k: (later[k], single[k] > 2, k)):
        if len(chosen) >= needed:
            break
        rest = [j for j in range(len(names)) if j not in (*chosen, k)]
        if k not in chosen and int(np.linalg.matrix_rank(rates[:, rest], RANK)) == rank:
            chosen.append(k)
    resting = [names[k] for k in chosen if names[k] not in model.motions]
    if resting:
        model.notes.append(REST.format(", ".join(resting)))
    for name in resting:
        start = model.posture.get(name, at_reference(model, name))
        model.motions[name] = Law(repr(float(start) + 0.0))
    return model


def _rates(model: Model, names: list[str]) -> Array:
    """Return what closes: rows of loops, couplings and ties by the rates of coordinates, in the
    reference posture.
    """
    column = {name: k for k, name in enumerate(names)}
    velocity = {GROUND: np.zeros((6, len(names)))}
    rows = [np.zeros((0, len(names)))]
    for joint in outward(model, {GROUND}):
        relative = np.zeros((6, len(names)))
        for name, twist in _twists(model, joint):
            relative[:, column[name]] = twist
        if joint.child not in velocity:
            velocity[joint.child] = velocity[joint.parent] + relative
        elif joint.parent not in velocity:
            velocity[joint.parent] = velocity[joint.child] - relative
        else:
            rows.append(velocity[joint.parent] + relative - velocity[joint.child])
    for one in model.couplings.values():
        rows.append(np.zeros((1, len(names))))
        rows[-1][0, column[one.second]], rows[-1][0, column[one.first]] = 1.0, -one.ratio
    for tie in model.ties.values():
        slopes = closing(model, tie, tie.rows)[1]
        rows.append(slopes @ (velocity[tie.child] - velocity[tie.parent]))
    return np.vstack(rows)


def _twists(model: Model, joint: Joint) -> Iterator[tuple[str, Array]]:
    """Yield the velocity of the child against the parent for each coordinate: that of the point at
    the ground's origin over the mechanism's size, and the angular one.

    A point mass has no direction, so a joint holds none there: in place of the joint's turns are
    three of the mass itself, which are no coordinates.
    """
    near, far = model.frames(joint)
    ends = (model.bodies[one] for one in (joint.parent, joint.child) if one != GROUND)
    point = next((body.frame.place for body in ends if body.point), None)
    for name, (_, move, axis) in zip(joint.coordinates, MOVES[joint.kind], strict=True):
        if point is not None and move != "slide":
            continue
        along = far.axes[:, 2] if axis == "w" else near.axes[:, "xyz".index(axis)]
        speed, spin = along, np.zeros(3)
        if move != "slide":
            slide = joint.lead / (2.0 * np.pi) * along if move == "screw" else 0.0
            speed, spin = np.cross(near.place, along) + slide, along
        yield name, np.concatenate([speed / extent(model), spin])
    if point is not None:
        for k, along in enumerate(np.eye(3)):
            yield (
                f"{joint.name} {k}",
                np.concatenate([np.cross(point, along) / extent(model), along]),
            )

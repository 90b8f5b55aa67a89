"""Drives of a model whose file gives too few motions: coordinates, and their values at rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..base.arrays import Array
from .checks import spinning
from .record import GROUND, MOVES, Frame, Joint, Law, Model, Tie

RANK = 1e-8
"""Singular values that are smaller, of the largest, are none."""

STEP = 1e-100
"""A step of which nothing is left in what is real."""

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
        start = model.posture.get(name, model.at_reference(name))
        model.motions[name] = Law(repr(float(start) + 0.0))
    return model


def _rates(model: Model, names: list[str]) -> Array:
    """Return what closes: rows of loops, couplings and ties by the rates of coordinates, in the
    reference posture.
    """
    column = {name: k for k, name in enumerate(names)}
    velocity = {GROUND: np.zeros((6, len(names)))}
    rows = [np.zeros((0, len(names)))]
    waiting = list(model.joints.values())
    while waiting:
        joint = next(one for one in waiting if one.parent in velocity or one.child in velocity)
        waiting.remove(joint)
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
        rows.append(_tied(model, tie) @ (velocity[tie.child] - velocity[tie.parent]))
    return np.vstack(rows)


def _tied(model: Model, tie: Tie) -> Array:
    """Return the rows of a tie by the velocity of its child against its parent: complex steps."""
    near, far = model.frames(tie)
    size, found = model.size(), np.zeros((len(tie.rows), 6))
    names: dict[str, Any] = {"ca": np, "p": near.place} | dict(zip("xyz", near.axes.T, strict=True))
    for k, moved in enumerate(1j * STEP * np.eye(6)):
        speed, spin = moved[:3] * size, moved[3:]
        q = far.place + speed + np.cross(spin, far.place)
        axes = far.axes.T + np.cross(spin, far.axes.T)
        names |= {"q": q, "turn": spin @ near.axes[:, 2]} | dict(zip("uvw", axes, strict=True))
        for j, row in enumerate(tie.rows):
            if row.kind == "wheels":
                names["first"] = _angle((q - near.place) @ near.axes)
                names["second"] = _angle(axes @ (near.place - q))
            found[j, k] = eval(row.text, names).imag / STEP  # of our own table of rows
    return found


def _angle(direction: Array) -> complex:
    """Return the small part of a direction's angle about z, as an imaginary number."""
    x, y, _ = direction
    return complex(0.0, float((x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)))


def _twists(model: Model, joint: Joint) -> list[tuple[str, Array]]:
    """Return the velocity of the child against the parent for each coordinate: that of the point at
    the ground's origin over the mechanism's size, and the angular one.

    A point mass has no direction, so a joint holds none there: in place of the joint's turns are
    three of the mass itself, which are no coordinates.
    """
    near, far = model.frames(joint)
    ends = (model.bodies[one] for one in (joint.parent, joint.child) if one != GROUND)
    point = next((body.frame.place for body in ends if body.point), None)
    found = [
        (name, _twist(move, axis, near, far, joint.lead))
        for name, (_, move, axis) in zip(joint.coordinates, MOVES[joint.kind], strict=True)
        if point is None or move == "slide"
    ]
    if point is not None:
        found += [
            (f"{joint.name} {k}", np.concatenate([np.cross(point, along), along]))
            for k, along in enumerate(np.eye(3))
        ]
    return [(name, twist * _scale(model)) for name, twist in found]


def _scale(model: Model) -> Array:
    return np.array([1.0 / model.size()] * 3 + [1.0] * 3)


def _twist(move: str, axis: str, near: Frame, far: Frame, lead: float) -> Array:
    along = far.axes[:, 2] if axis == "w" else near.axes[:, "xyz".index(axis)]
    if move == "slide":
        return np.concatenate([along, np.zeros(3)])
    slide = lead / (2.0 * np.pi) * along if move == "screw" else np.zeros(3)
    return np.concatenate([np.cross(near.place, along) + slide, along])

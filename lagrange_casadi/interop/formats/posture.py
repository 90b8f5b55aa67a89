"""The reference posture of a record: coordinates of joints in it, by how much joints are open, and
how bodies are moved to close them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from heapq import heappop, heappush
from types import SimpleNamespace
from typing import Any, TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from ...base.arrays import Array
from .file_frames import Frame, turned
from .record import GROUND, MOVES, Joint, Model, Row
from .separate_systems import Rows, blocks

Closure = TypeVar("Closure", Joint, SimpleNamespace)

SLACK = 1e-6
"""Frames of a joint that are apart by less, of the mechanism's size and in rad, are one."""

EXACT = 1e-12
"""Difference that is rounding of sums, and is not worth a note."""

_SLIDES = {kind: [one for _, move, one in of if move == "slide"] for kind, of in MOVES.items()}
_TURNS = {kind: [one for _, move, one in of if move != "slide"] for kind, of in MOVES.items()}
"""The axes along which a kind of joint slides, and those about which it turns."""

_HELD = {
    kind: [
        k
        for k, axis in enumerate("xyz")
        if all(axis != one or move == "turn" for _, move, one in of)
    ]
    for kind, of in MOVES.items()
}
"""The axes along which a kind of joint holds its place."""

_COSINES = {0: ((0, 1), (0, 2), (1, 2)), 1: ((0, 2), (1, 2)), 2: ((2, 2),), 3: ()}
"""Axes of the parent's and of the child's frame that so many turns leave at right angles."""

_LENGTHS = {"slide": float, "distance": math.sqrt, "distance across": math.sqrt}
"""The lengths of values of rows; others are cosines of angles."""

_STEP = 1e-100
"""A step of which nothing is left in what is real."""

_RANK = 1e-9
"""Smaller singular values, of the largest, are those of equations that hold the same twice."""

_MOST, _LEAST, _WORK = 100, 1e-13, 2e10
"""Steps to assemble a drawing, motions of bodies that are none, and products of numbers that all
steps take, at most.
"""


def extent(model: Model) -> float:
    """Return the extent of what joints and centres of mass span [m]."""
    places = [one.place for joint in model.closures for one in model.frames(joint)]
    places += [body.frame.at(body.centre) for body in model.bodies.values()]
    return float(np.max(np.ptp(np.array(places), axis=0))) or 1.0 if places else 1.0


def outward(
    closures: Sequence[Closure], reached: set[str], *, down: bool = False
) -> Iterator[Closure]:
    """Yield the joints and ties that hang on bodies, each after one that reaches it, the first one
    of those that can follow; add what is reached. ``down`` leads to children alone.
    """
    on: dict[str, list[int]] = {}
    for k, one in enumerate(closures):
        for body in (one.parent,) if down else (one.parent, one.child):
            on.setdefault(body, []).append(k)
    left = dict(enumerate(closures))
    waiting = sorted(k for body in reached for k in on.pop(body, ()))
    while waiting:
        if (k := heappop(waiting)) not in left:
            continue
        yield (one := left.pop(k))
        for body in (one.parent, one.child):
            reached.add(body)
            for other in on.pop(body, ()):
                heappush(waiting, other)


def _tree(model: Model, reached: set[str]) -> Iterator[Joint]:
    """Yield the joints that lead from bodies that are reached to others, before these are added."""
    joints = outward([*model.joints.values()], reached)
    return (one for one in joints if not reached.issuperset(one.ends))


def posed(model: Model, posture: Mapping[str, float]) -> Model:
    """Return a model whose bodies are where coordinates of its tree of joints, zero in the
    reference posture, put them.
    """
    found, reached = replace(model, bodies=dict(model.bodies)), {GROUND}
    for joint in _tree(model, reached):
        across = Frame()
        for name, (_, move, axis) in zip(joint.coordinates, MOVES[joint.kind], strict=True):
            if axis == "w":
                across, axis = across.then(_relative(model, joint)), "z"
            along, q = np.eye(3)["xyz".index(axis)], posture.get(name, 0.0)
            slide, turn = (q, 0.0) if move == "slide" else (joint.lead * q / math.tau, q)
            across = across.then(Frame(slide * along, turned(turn * along)))
        _put(found, joint, across, reached)
    return found


def _put(model: Model, joint: Joint, across: Frame, reached: Collection[str]) -> str:
    """Move the body of a joint that is not reached where the child's frame is ``across`` the
    parent's; return the body's name.
    """
    across = joint.on_parent.then(across).then(joint.on_child.inverse())
    near, far = joint.ends
    if far in reached:
        near, far, across = far, near, across.inverse()
    model.bodies[far] = replace(model.bodies[far], frame=model.frame_of(near).then(across))
    return far


def at_reference(model: Model, name: str, size: float) -> float:
    """Return a coordinate in the reference posture of a mechanism of a size [m], zero where it is
    but for rounding.
    """
    joint = model.joints[name.partition(":")[0]]
    known, turns = _relative(model, joint), [0.0, 0.0]  # of a universal joint
    if len(axes := _TURNS[joint.kind]) == 1:
        turns = [about_z(known)]
    elif len(axes) == 3:
        order = ["xyz".index(axis) for axis in axes]
        turns = _three_turns(known.axes[np.ix_(order, order)])
    slides = [known.place["xyz".index(axis)] for axis in _SLIDES[joint.kind]]
    found = float([*slides, *turns][joint.coordinates.index(name)])
    return 0.0 if abs(found) < EXACT * max(size, 1.0) else found


def _relative(model: Model, joint: Joint) -> Frame:
    """Return where the child's frame is on the parent's."""
    near, far = model.frames(joint)
    return near.relative(far)


def about_z(known: Frame) -> float:
    """Return the angle by which a frame is turned about z."""
    return math.atan2(known.axes[1, 0], known.axes[0, 0])


def _three_turns(axes: Array) -> list[float]:
    """Return the angles about x, y and z in sequence, each axis carried by those before."""
    y = math.asin(min(1.0, max(-1.0, float(axes[0, 2]))))
    return [math.atan2(-axes[1, 2], axes[2, 2]), y, math.atan2(-axes[0, 1], axes[0, 0])]


def _closest(model: Model, joint: Joint) -> Frame:
    """Return where the child's frame is on the parent's if the joint, open in the reference
    posture, is closed with the coordinates that it has there.
    """
    known = _relative(model, joint)
    place = np.where([axis in _SLIDES[joint.kind] for axis in "xyz"], known.place, 0.0)
    match len(_TURNS[joint.kind]):
        case 3:
            return Frame(place, known.axes)
        case 2:  # of a universal joint: the child's z is across the parent's
            across = np.array([known.axes[0, 2], known.axes[1, 2], 0.0])
            return Frame.about(across if np.any(across) else np.eye(3)[0], place)
    angle = about_z(known) if _TURNS[joint.kind] else 0.0
    if joint.kind == "screw":
        place[2] = joint.lead * angle / math.tau
    return Frame(place, turned([0.0, 0.0, angle]))


def apart(model: Model, joint: Joint) -> tuple[float, float]:
    """Return by how much the frames of a joint miss what it holds: in m, and in rad."""
    if joint.rows:
        return _untied(model, joint)
    known, turns = _relative(model, joint), len(_TURNS[joint.kind])
    gap = math.hypot(*known.place[_HELD[joint.kind]].tolist())
    if any(one != GROUND and model.bodies[one].point for one in joint.ends):
        return gap, 0.0
    if joint.kind == "universal":
        return gap, abs(float(known.axes[2, 2]))
    if joint.kind == "screw" and joint.lead:
        off = float(known.place[2]) - joint.lead * about_z(known) / math.tau
        gap = math.hypot(gap, math.remainder(off, joint.lead))
    if not turns:
        return gap, float(Rotation.from_matrix(known.axes).magnitude())
    tilt = math.hypot(float(known.axes[0, 2]), float(known.axes[1, 2]))
    return gap, math.atan2(tilt, float(known.axes[2, 2])) if turns == 1 else 0.0


def _untied(model: Model, tie: Joint) -> tuple[float, float]:
    """Return by how much the frames of a tie miss its rows: in m, and in rad."""
    rows, lengths, angles = _rows(tie), [0.0], [0.0]
    for row, value in zip(rows, closing(model, tie, rows, 1.0)[0].tolist(), strict=True):
        if measure := _LENGTHS.get(row.kind):
            lengths.append(measure(value) - measure(row.value))
        else:
            angles.append(math.acos(max(-1.0, min(1.0, value))) - math.acos(row.value))
    return math.hypot(*lengths), math.hypot(*angles)


def opened(model: Model) -> dict[str, tuple[float, float]]:
    """Return the joints whose frames are apart in the reference posture, by how much; the most open
    one is the first.
    """
    size = extent(model)
    gaps = {one.name: apart(model, one) for one in model.closures}
    off = {name: max(gap / size, angle) for name, (gap, angle) in gaps.items()}
    most = sorted(off, key=off.__getitem__, reverse=True)
    return {name: gaps[name] for name in most if off[name] > SLACK}


def hang(model: Model) -> None:
    """Move bodies all of whose joints are open, so that one of these is closed, its coordinates as
    they are.
    """
    open_joints = opened(model)
    closed = (one for one in model.joints.values() if one.name not in open_joints)
    placed = {GROUND} | {end for one in closed for end in one.ends}
    for joint in _tree(model, placed):
        gap, angle = open_joints[joint.name]
        moved = _put(model, joint, _closest(model, joint), placed)
        model.notes.append(
            f"body '{moved}' is moved so that joint '{joint.name}' is closed, which is open by"
            f" {gap:.3g} m and {angle:.3g} rad in the file"
        )


def closing(model: Model, joint: Joint, rows: Sequence[Row], size: float) -> tuple[Array, Array]:
    """Return the values of rows, and their slopes by the velocity of the child against the parent,
    by complex steps: that of the point at the ground's origin over a size [m], and the angular one.
    """
    near, far = model.frames(joint)
    values, slopes = np.zeros(len(rows)), np.zeros((len(rows), 6))
    names: dict[str, Any] = {"ca": np, "p": near.place} | dict(zip("xyz", near.axes.T, strict=True))
    for k, moved in enumerate(1j * _STEP * np.eye(6)):
        speed, spin = moved[:3] * size, moved[3:]
        q = far.place + speed + np.cross(spin, far.place)
        axes = far.axes.T + np.cross(spin, far.axes.T)
        names |= {"q": q, "turn": spin @ near.axes[:, 2]} | dict(zip("uvw", axes, strict=True))
        for j, row in enumerate(rows):
            if row.kind == "wheels":
                names["first"] = _angle((q - near.place) @ near.axes)
                names["second"] = _angle(axes @ (near.place - q))
            found = eval(row.text, names)  # of our own table of rows
            values[j], slopes[j, k] = found.real, found.imag / _STEP
    return values, slopes


def _angle(direction: Array) -> complex:
    """Return the small part of a direction's angle about z, as an imaginary number."""
    x, y, _ = direction
    return complex(0.0, float((x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)))


def _rows(joint: Joint) -> list[Row]:
    """Return the rows that a joint holds; those that count turns hold in any posture."""
    if joint.rows:
        return [row for row in joint.rows if row.kind not in ("slide and turn", "wheels")]
    held = [Row("slide", i) for i in _HELD[joint.kind]]
    return held + [Row("cosine", i, j) for i, j in _COSINES[len(_TURNS[joint.kind])]]


def assemble(model: Model) -> None:
    """Move the bodies of a drawing by as little as closes its joints: steps of Gauss and Newton.

    Raises :class:`.ModelFileError` for the joint that remains open the most.
    """
    words = "joint '{}' is open by {:.3g} m and {:.3g} rad in the drawing"
    drawn, nudged, steps, work = opened(model), False, 0, 0.0
    while drawn and steps < _MOST and work < _WORK:
        size, steps = extent(model), steps + 1
        step, products = _step(model, size)
        work += products
        if (largest := float(np.abs(step).max())) < _LEAST:
            if nudged or not opened(model):
                break
            # No motion brings a joint nearer, as of parallel axes that are to meet at an angle.
            step, largest, nudged = 0.01 * np.cos(np.arange(step.size)), 0.01, True
        moved = (step * min(1.0, 0.5 / largest)).reshape(-1, 6)
        for body, motion in zip(list(model.bodies.values()), moved, strict=True):
            by = Frame(size * motion[:3], turned(motion[3:]))
            model.bodies[body.name] = replace(body, frame=by.then(body.frame))
    if left := opened(model):
        name = next((name for name in drawn if name in left), next(iter(left)))
        words = words.format(name, *drawn.get(name, (0.0, 0.0)))
        raise model.refuse(
            next(one.where for one in model.closures if one.name == name),
            f"{words}, and by {left[name][0]:.3g} m and {left[name][1]:.3g} rad if parts are moved"
            " to close all joints: assemble them first, as FreeCAD's assembly solver does",
        )
    if drawn:
        words = words.format(name := next(iter(drawn)), *drawn[name])
        model.notes.append(f"{words}: parts are moved by as little as closes all joints.")


def _step(model: Model, size: float) -> tuple[Array, float]:
    """Return the least motions of bodies that close all joints to first order, and about how many
    products of numbers these take.
    """
    misses, equations, products = [], list[Rows](), 0.0
    for joint in model.closures:
        if rows := _rows(joint):
            values, slope = closing(model, joint, rows, size)
            ends = {joint.child: slope, joint.parent: -slope}
            equations.append({name: one for name, one in ends.items() if name != GROUND})
            misses.append([row.value for row in rows] - values)
    number, found = (
        {name: k for k, name in enumerate(model.bodies)},
        np.zeros((len(model.bodies), 6)),
    )
    for matrix, names, group in blocks(model, equations, list(number)):
        products += matrix.size * min(matrix.shape)
        missed = np.concatenate([misses[k] for k in group])
        step = np.linalg.lstsq(matrix, missed, rcond=_RANK)[0]
        found[[number[name] for name in names]] = step.reshape(-1, 6)
    return found.reshape(-1), products

"""The mechanism itself on the sheet: bodies, joints, springs, what stands still, ways of points,
names.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...base.arrays import Array
from ...model.description import JointNumbers, Place, Triple
from ..shapes.places import placed
from ..shapes.shapes import (
    Shape,
    named_spots,
    shapes,
)
from ..shapes.solid import COLOURS, PATH
from .drawn import INK, Dot, Line, Thing, Words, across, along
from .motion import Motion
from .stage import Stage

_SLIDES = ("prismatic", "cylindrical", "screw", "slot")
_TURNS = ("revolute", "cylindrical", "screw", "universal")
_PINS = ("revolute", "slot", "universal", "spherical")

_BLOCK, _POINT = (24.0, 15.0), (36.0, 24.0)
"""The blocks of what slides, and of a point mass [points]."""

_NEAR = 8.0
"""Joints that are never farther apart on the sheet have their names together [points]."""

_LETTER = 8.0
"""The width of a letter, or little more [points]."""

_ROUND = np.exp(2j * np.pi * np.arange(40) / 40)
_COILS = 8


def mechanism(motion: Motion, stage: Stage, *, names: bool) -> Iterator[Thing]:
    """Everything but forces, what is behind first."""
    description = motion.solution.description
    for spot in description.paths.values():
        yield Line(stage.on_sheet(placed(motion.solution, spot))[None], PATH, 1.4)
    colours = {shape.name: COLOURS[k % len(COLOURS)] for k, shape in enumerate(shapes(description))}
    joints = list(description.joints.values())
    for joint in joints:
        if joint.kind in _SLIDES:
            yield _guide(motion, stage, joint)
        yield from _stand(motion, stage, joint)
    for ends in description.springs.values():
        start, stop = (stage.on_sheet(motion.place(end)) for end in ends)
        yield _coil(start, stop, stage.unit)
    for shape in sorted(shapes(description), key=lambda shape: _depth(motion, stage, shape)):
        yield from _body(motion, stage, shape, joints, colours[shape.name])
    masses = {shape.name for shape in shapes(description) if shape.kind == "point"}
    for joint in joints:
        if joint.kind in _SLIDES:
            yield _block(motion, stage, joint, masses, colours)
    for joint in joints:
        if joint.kind in _PINS:
            sphere = joint.kind == "spherical"
            yield Dot(
                stage.on_sheet(motion.place(joint.child)),
                (4.0 if sphere else 4.8) * stage.unit,
                INK if sphere else "#ffffff",
            )
    for spot in description.paths.values():
        yield Dot(stage.on_sheet(motion.place(spot)), 3.6 * stage.unit, PATH)
    if names:
        named = named_spots(motion.solution.description)
        yield from _names(motion, stage, [joint for joint in joints if joint.name in named])


def _depth(motion: Motion, stage: Stage, shape: Shape) -> float:
    return stage.depth(
        motion.place(
            Place(shape.name, shape.axis[1] if shape.axis else shape.centre or (0.0, 0.0, 0.0))
        )
    )


def _body(
    motion: Motion, stage: Stage, shape: Shape, joints: list[JointNumbers], colour: str
) -> Iterator[Thing]:
    def on_sheet(places: Sequence[Triple]) -> Array:
        return np.stack(
            [stage.on_sheet(motion.place(Place(shape.name, at))) for at in places], axis=1
        )

    unit = stage.unit
    for plate in shape.plates:
        yield Line(on_sheet(plate), colour, 2.0 * unit, closed=True, fill=colour, opacity=0.25)
    if shape.disc:
        yield from _disc(motion, stage, shape, colour)
    if shape.axis:
        yield Line(on_sheet(shape.axis), colour, 8.0 * unit)
    for arm in shape.arms:
        yield Line(on_sheet(arm), colour, 5.0 * unit)
    slides = any(
        joint.kind in _SLIDES and shape.name in (joint.parent.body, joint.child.body)
        for joint in joints
    )
    if shape.kind == "point" and not slides:
        half = 9.0 * unit * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        yield Line(on_sheet([(0.0, 0.0, 0.0)]) + half, INK, 1.2 * unit, closed=True, fill=colour)


def _disc(motion: Motion, stage: Stage, shape: Shape, colour: str) -> Iterator[Thing]:
    """A circle about the axis that holds the body, and a spoke, which shows that it turns."""
    around = rim(motion, shape)
    if around is not None:
        edge, middle = stage.on_sheet(around), stage.on_sheet(np.mean(around, axis=1))
        yield Line(edge, colour, 2.4 * stage.unit, closed=True, fill=colour, opacity=0.2)
        yield Line(np.stack([middle, edge[:, 0]], axis=1), colour, 2.4 * stage.unit)


def rim(motion: Motion, shape: Shape) -> Array | None:
    """The edge of a body that is a disc (frames, n, 3) [m], about the joint by which it turns; None
    of any other.
    """
    joints = [
        one
        for one in motion.solution.description.joints.values()
        if shape.name in (one.parent.body, one.child.body)
    ]
    turning = next((one for one in joints if one.kind in _TURNS), None)
    if not shape.disc or (turning is None and any(one.kind in _SLIDES for one in joints)):
        return None
    axis = np.array([0.0, 0.0, 1.0])
    body_axes = np.stack(
        [
            motion.direction(shape.name, direction)
            for direction in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        ],
        axis=1,
    )
    if not np.isfinite(body_axes).all():
        return None
    if turning is not None and motion.solution.description.space:
        axis = body_axes[0] @ motion.direction(turning.parent.body, turning.axes[0].direction)[0]
    least = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, least) / np.linalg.norm(np.cross(axis, least))
    second = np.cross(axis, first) / np.linalg.norm(axis)
    around = shape.disc * (_ROUND.real[:, None] * first + _ROUND.imag[:, None] * second)
    middle = motion.place(Place(shape.name, shape.centre or (0.0, 0.0, 0.0)))[:, None]
    found: Array = middle + np.einsum("nk,fkc->fnc", around, body_axes)
    return found


def _slide(motion: Motion, stage: Stage, joint: JointNumbers) -> Array:
    """The directions along which a joint slides, on the sheet (frames, 2) and of length 1."""
    return along(
        stage.projected(
            motion.direction(joint.parent.body, joint.axes[0].direction, joint.parent.at)
        )
    )


def _guide(motion: Motion, stage: Stage, joint: JointNumbers) -> Line:
    """A line along which a joint slides, as far as it ever does."""
    start, direction = (
        motion.place(joint.parent),
        motion.direction(joint.parent.body, joint.axes[0].direction, joint.parent.at),
    )
    reach = np.einsum("fc,fc->f", motion.place(joint.child) - start, direction)
    pad = 26.0 * stage.unit / stage.scale
    ends = [start + direction * (reach.min() - pad), start + direction * (reach.max() + pad)]
    return Line(
        np.stack([stage.on_sheet(end) for end in ends], axis=1),
        "#888888",
        1.2 * stage.unit,
        dashed=True,
    )


def _block(
    motion: Motion, stage: Stage, joint: JointNumbers, masses: set[str], colours: dict[str, str]
) -> Line:
    """Draw a sliding part: in the colour of its body, larger if it is the point mass itself."""
    body = joint.parent.body if joint.child.body == "ground" else joint.child.body
    mass = body in masses
    length, height = np.array(_POINT if mass else _BLOCK) * stage.unit / 2
    direction = _slide(motion, stage, joint)[:, None]
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    offsets = corners[:, :1] * length * direction + corners[:, 1:] * height * across(direction)
    fill = colours[body] if mass or joint.kind != "slot" else "#ffffff"
    spot = Place(body, (0.0, 0.0, 0.0)) if mass else joint.child
    points = stage.on_sheet(motion.place(spot))[:, None] + offsets
    return Line(points, INK, 1.4 * stage.unit, closed=True, fill=fill)


def _stand(motion: Motion, stage: Stage, joint: JointNumbers) -> Iterator[Line]:
    """The mark of what stands still, under a joint that turns."""
    held = [spot for spot in (joint.parent, joint.child) if spot.body == "ground"]
    if not held or joint.kind not in _PINS or joint.kind == "slot":
        return
    at, unit = stage.on_sheet(motion.place(held[0]))[:1, None], stage.unit
    triangle = np.array([[0.0, 0.0], [10.0, 17.0], [-10.0, 17.0]])
    yield Line(at + unit * triangle, "#777777", 1.3 * unit, closed=True, fill="#eeeeee")
    yield Line(at + unit * np.array([[-16.0, 17.0], [16.0, 17.0]]), "#777777", 1.6 * unit)
    for x in (-12.0, -5.0, 2.0, 9.0):
        yield Line(at + unit * np.array([[x, 17.0], [x - 5.0, 23.0]]), "#777777", 1.1 * unit)


def _coil(start: Array, stop: Array, unit: float) -> Line:
    """A spring between places on the sheet (frames, 2): straight at its ends, a zigzag between."""
    direction = stop - start
    side = 6.0 * unit * across(along(direction))
    shares = [
        0.0,
        0.15,
        *(0.15 + 0.7 * (k + 0.5) / (2 * _COILS) for k in range(2 * _COILS)),
        0.85,
        1.0,
    ]
    sides = [0.0, 0.0, *((-1.0) ** k for k in range(2 * _COILS)), 0.0, 0.0]
    points = np.stack(
        [start + u * direction + s * side for u, s in zip(shares, sides, strict=True)], axis=1
    )
    return Line(points, "#666666", 1.5 * unit)


def _names(motion: Motion, stage: Stage, joints: list[JointNumbers]) -> Iterator[Words]:
    """The joints' names beside them; those of joints at one place together."""
    raised = {joint.name for joint in joints if joint.kind in _SLIDES}
    found: list[tuple[Array, list[str]]] = []
    for joint in joints:
        points = stage.on_sheet(motion.place(joint.child))
        near = [
            names for other, names in found if np.max(np.abs(other - points)) < _NEAR * stage.unit
        ]
        if near:
            near[0].append(joint.name)
        else:
            found.append((points, [joint.name]))
    for points, names in found:
        text = ", ".join(names)
        room = stage.width - (9.0 + _LETTER * len(text)) * stage.unit
        before = bool(np.max(points[:, 0]) > room and np.min(points[:, 0]) > stage.width - room)
        offset = stage.unit * np.array(
            [-9.0 if before else 9.0, -15.0 if raised & set(names) else -9.0]
        )
        yield Words(points + offset, text, before)

"""Picture of a mechanism in space at an instant: lines and marks, from a solution's poses and its
description.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.arrays import Array
from ...model.description import Place
from ...results.solution import Solution
from .shapes import shapes

COLOURS = (
    *("#1f4e79", "#b3541e", "#2e7d4f", "#7a3b8f", "#8a6d1a", "#3c6e71", "#9c2f4a", "#555555"),
    *("#6fa3d8", "#eba277", "#7cc79a", "#b98acb", "#d4b95c", "#86bcc0", "#dd8aa0", "#a9a9a9"),
)
PATH, SPRING = "#c0392b", "0.4"

MARKS = {
    "revolute": ("o", "white", 6.0),
    "prismatic": ("s", "white", 6.0),
    "cylindrical": ("h", "white", 7.5),
    "screw": ("8", "0.6", 7.0),
    "universal": ("X", "white", 7.5),
    "spherical": ("o", "black", 5.0),
    "planar": ("p", "white", 7.5),
    "slot": ("d", "black", 6.5),
    "weld": ("x", "black", 5.0),
    "free": ("+", "black", 6.0),
}
"""The mark of each kind of joint: its shape, colour and size [pt]."""

BLOCK = 11.0
"""The size of the mark of a body that is drawn by nothing else [pt]."""

_AXIS = 0.045
"""Half the length of the line along a joint's axis, over the mechanism's size."""


@dataclass(frozen=True, eq=False)
class Line:
    """A polyline (n, 3) in ground axes [m]; ``body`` is that of which it is a part, where it is
    one's.
    """

    points: Array
    colour: str
    width: float
    style: Any = "-"
    body: str = ""
    order: int = 3


@dataclass(frozen=True, eq=False)
class Mark:
    """A mark at a place (3,) in ground axes [m]; ``body`` is that whose place it shows, where it
    shows one's.
    """

    place: Array
    shape: str
    fill: str
    size: float
    edge: str = "black"
    body: str = ""
    order: int = 5


@dataclass(frozen=True)
class _Segment:
    """A line between two places, of a body or of a spring, whose ``body`` is empty."""

    body: str
    ends: tuple[Place, Place]
    axis: bool = False


def place_of(solution: Solution, point: Place) -> Array:
    """Place of a point of a body, (t, 3) in ground axes [m]."""
    if point.body == "ground":
        return np.tile(np.array(point.at, float), (solution.t.size, 1))
    pose = solution.pose(point.body)
    assert pose.z is not None
    place = np.column_stack([pose.x, pose.y, pose.z])
    return place + _on_ground_axes(pose.axes, point.at) if any(point.at) else place


def direction_of(solution: Solution, body: str, local: Sequence[float]) -> Array:
    """A direction that a body carries, (t, 3) in ground axes."""
    if body == "ground":
        return np.tile(np.array(local, float), (solution.t.size, 1))
    return _on_ground_axes(solution.pose(body).axes, local)


def _on_ground_axes(axes: Array | None, local: Sequence[float]) -> Array:
    """Components on a body's axes, in ground axes; what it has no axes for is not asked of it."""
    assert axes is not None
    found: Array = np.sum(
        [component * axes[:, k] for k, component in enumerate(local) if component], axis=0
    )
    return found


def paths_of(solution: Solution) -> dict[str, Array]:
    """The ways of the joints' points, and of declared points, over all instants: (t, 3) by name."""
    description = solution.description
    points = {name: joint.child for name, joint in description.joints.items()}
    return {name: place_of(solution, at) for name, at in {**points, **description.paths}.items()}


def cloud_of(solution: Solution) -> Array:
    """All points between which lines are drawn, over all instants: (n, 3)."""
    found = [*paths_of(solution).values()]
    for segment in _segments(solution):
        found += [place_of(solution, end) for end in segment.ends]
    for joint in solution.description.joints.values():
        found.append(place_of(solution, joint.parent))
    return np.concatenate(found)


def lines_of(solution: Solution) -> Iterator[Line]:
    """The bodies and springs at a solution's first instant."""
    for segment in _segments(solution):
        ends = np.array([place_of(solution, end)[0] for end in segment.ends])
        if not segment.body:
            yield Line(ends, SPRING, 1.3, ":", order=2)
        else:
            colour = colour_of(solution, segment.body)
            yield Line(ends, colour, 3.2 if segment.axis else 1.6, body=segment.body)


def axes_of(solution: Solution, all_instants: Solution, size: float) -> Iterator[Line]:
    """Short lines along the axes about which joints turn, and the lines on which they slide as far
    as they ever do.
    """
    for joint in solution.description.joints.values():
        if joint.kind in ("spherical", "free", "planar"):
            continue
        parent, child = joint.parent, joint.child
        if joint.axes and joint.axes[0].kind == "slide":
            strokes = (
                np.einsum(
                    "tk,tk->t",
                    place_of(s, child) - place_of(s, parent),
                    direction_of(s, parent.body, joint.triad[0]),
                )
                for s in (all_instants, solution)
            )
            reach = np.concatenate([*strokes, [0.0]])
            ends = np.array([reach.min() - _AXIS * size, reach.max() + _AXIS * size])
            along = direction_of(solution, parent.body, joint.triad[0])[0]
            yield Line(
                place_of(solution, parent)[0] + ends[:, None] * along,
                "0.5",
                0.9,
                (0, (6, 4)),
                order=1,
            )
            continue
        for axis in joint.axes:
            second = joint.carried if axis is not joint.axes[0] else None
            carrier, local = (child, second) if second else (parent, axis.direction)
            along = _AXIS * size * direction_of(solution, carrier.body, local)[0]
            yield Line(
                place_of(solution, child)[0] + np.outer([-1.0, 1.0], along), "black", 1.2, order=4
            )


def marks_of(solution: Solution) -> Iterator[Mark]:
    """Joints, point masses, centres of rigid bodies and declared points at a solution's first
    instant.
    """
    description = solution.description
    for name, body in description.bodies.items():
        colour = colour_of(solution, name)
        if body.length is None or body.centre is not None:
            armed = any(segment.body == name for segment in _segments(solution))
            yield Mark(
                place_of(solution, Place(name, body.centre or (0.0, 0.0, 0.0)))[0],
                "s",
                colour,
                4.0 if armed else BLOCK,
                colour,
                name,
                order=4,
            )
    for joint in description.joints.values():
        shape, fill, width = MARKS[joint.kind]
        yield Mark(place_of(solution, joint.child)[0], shape, fill, width)
    for point in description.paths.values():
        yield Mark(place_of(solution, point)[0], "D", PATH, 4.5, PATH)


def grounds_of(solution: Solution) -> Iterator[Array]:
    """The points of the ground to which joints hold something, each (3,)."""
    for joint in solution.description.joints.values():
        ends = [end for end in joint.ends if end.body == "ground"]
        if ends and joint.kind != "free":
            yield place_of(solution, ends[0])[0]


def colour_of(solution: Solution, body: str) -> str:
    """The colour of a body, by its number."""
    return COLOURS[list(solution.description.bodies).index(body) % len(COLOURS)]


def plates_of(solution: Solution) -> Iterator[tuple[str, Array]]:
    """The plates of bodies at a solution's first instant: the body, and the corners (n, 3) in
    ground axes [m].
    """
    for shape in shapes(solution.description):
        for plate in shape.plates:
            yield (
                shape.name,
                np.array([place_of(solution, Place(shape.name, corner))[0] for corner in plate]),
            )


def _segments(solution: Solution) -> Iterator[_Segment]:
    """The lines of all bodies, axes, arms, and edges of plates, and of springs."""
    for shape in shapes(solution.description):
        axis = [shape.axis] if shape.axis else []
        edges = [(plate[k - 1], plate[k]) for plate in shape.plates for k in range(len(plate))]
        for ends in (*axis, *shape.arms, *edges):
            first, last = (Place(shape.name, end) for end in ends)
            yield _Segment(shape.name, (first, last), bool(axis) and ends is axis[0])
    for first, last in solution.description.springs.values():
        yield _Segment("", (first, last))

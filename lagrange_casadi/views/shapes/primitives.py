"""The one list of what a picture of a mechanism shows, in ground axes, and the list seen from one
direction.

The list is made of a description and poses, so that a mechanism at one posture has a list as well
as a solution at all instants. The arrays have a frame for each instant, or one frame if nothing
moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from ...base.arrays import Array
from ...model.declared_parts import PitchCircles, Track
from ...model.description import JointNumbers, Place
from .curves import ROUND, SPIRAL, around, belt, between, rack
from .orthographic import View
from .poses import Poses
from .shapes import Shape, named_spots, shapes, spots_of
from .symbols import (
    AXES,
    BLOCKS,
    BODIES,
    GROUND,
    PATH,
    PINS,
    POINTS,
    SPRINGS,
    WAYS,
    Arrow,
    Line,
    Name,
    Primitive,
    Symbol,
)

_SLIDES = ("prismatic", "cylindrical", "screw", "slot")
_UNSUPPORTED = ("free", "prismatic", "slot", "cylindrical", "screw", "planar")
"""Joints below which the ground has no symbol."""

_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))

_PAD, _AXIS, _COIL, _PLANE = 0.06, 0.045, 0.018, 0.12
"""Over the mechanism's size: a guide beyond its use, half a joint's axis, the radius of a spring,
half a side of a plane.
"""

_PITCH, _METAL = "#777777", "#666666"


def drawing(
    poses: Poses, whole: Poses | None = None, named: Mapping[str, Place] | None = None
) -> tuple[Primitive, ...]:
    """All that a picture of a mechanism shows at some poses, without forces.

    ``whole`` are the poses over all time, by which guides and the ways of declared points are as
    long as they are; ``named`` are the places whose names are written, by default all.
    """
    whole = whole or poses
    description = poses.description
    found = [one for shape in shapes(description) for one in _body(poses, shape)]
    size = size_of([*found, *(Line(whole.place(at), PATH, 0.0) for at in spots_of(description))])

    def symbol(kind: str, spot: Place, level: int) -> Symbol:
        return Symbol(kind, poses.place(spot)[:, None], level=level)

    for spot in description.paths.values():
        found += [
            Line(whole.place(spot)[None], PATH, 1.4, level=WAYS),
            symbol("point", spot, POINTS),
        ]
    for load in description.loads.values():
        if load.kind == "spring":
            start, stop = (poses.place(end) for end in load.points)
            found += [
                Line(line, _METAL, 1.5, level=SPRINGS)
                for line in between(start, stop, _COIL * size, load)
            ]
    found += [line for _, line in carried(poses, whole, size)]
    for joint in description.joints.values():
        ground = [end for end in joint.ends if end.body == "ground"]
        if ground and joint.kind not in _UNSUPPORTED:
            found.append(symbol("stand", ground[0], GROUND))
        if joint.kind in _SLIDES:
            found += [_guide(poses, whole, joint, size), _block(poses, joint)]
        else:
            found.append(symbol(joint.kind, joint.child, PINS))
            if description.space:
                found += _axes(poses, joint, size)
    named = named_spots(description) if named is None else named
    found += [Name(poses.place(spot)[:, None], name) for name, spot in named.items()]
    # Of a mechanism without bodies, the origin of the ground.
    return tuple(found) or (Symbol("stand", np.zeros((1, 1, 3)), level=GROUND),)


def carried(poses: Poses, whole: Poses, size: float) -> Iterator[tuple[str, Line]]:
    """The lines beside the bodies' own that move with a body or stand on the ground, and its name:
    coils, pitch circles, belts, racks, and drums.
    """
    description = poses.description
    joints = description.joints.values()
    for load in description.loads.values():
        if load.kind == "torque" and load.symbols:
            turned = next(joint for joint in joints if joint.ends == load.points[::-1])
            about = poses.direction(turned.parent.body, turned.axes[0].direction)
            coil = around(poses.place(load.points[0]), about, 2.5 * _COIL * size * SPIRAL)
            yield turned.parent.body, Line(coil, _METAL, 1.5, level=SPRINGS)
    pitches = description.pitch_circles.values()
    circles = {
        (one.carrier, at, axis, radius): one.belt
        for one in pitches
        for at, axis, radius in zip(one.centres, one.axes, one.radii, strict=True)
        if radius
    }
    for (carrier, at, axis, radius), belted in circles.items():
        way = poses.direction(carrier, axis)
        ring = around(poses.place(Place(carrier, at)), way, radius * ROUND)
        yield carrier, Line(ring, _PITCH, 1.2, closed=True, dashed=not belted, level=AXES)
    for pitch in pitches:
        yield from _meshing(poses, whole, pitch)
    for track in description.tracks.values():
        yield from _drum(poses, track)


def cloud(primitives: Iterable[Primitive]) -> Array:
    """All points (n, 3) of primitives over all frames: their extent is that of the picture."""
    found = [one.points.reshape(-1, one.points.shape[-1]) for one in primitives]
    return np.concatenate(found) if found else np.zeros((1, 3))


def size_of(primitives: Iterable[Primitive]) -> float:
    """The largest extent along an axis of the ground [m]; 1 where there is none."""
    return float(np.ptp(cloud(primitives), axis=0).max()) or 1.0


def seen(primitives: Iterable[Primitive], view: View) -> list[Line | Symbol | Name]:
    """The primitives on a page: the last axis of their arrays has two components, to the right and
    up, and what is behind comes first. Arrows are lines and their heads.
    """
    toward = np.cross(view.right, view.up)

    def behind(one: Primitive) -> tuple[int, float]:
        return one.level, float(np.mean(one.points @ toward)) if one.level == BODIES else 0.0

    found: list[Line | Symbol | Name] = []
    for one in sorted(primitives, key=behind):
        flat = replace(one, points=view.on_page(one.points))
        if isinstance(flat, Symbol) and flat.along is not None:
            flat = replace(flat, along=view.on_page(flat.along))
        found += _arrow(flat) if isinstance(flat, Arrow) else [flat]
    return found


def _body(poses: Poses, shape: Shape) -> Iterator[Primitive]:
    """A body: its plates, disc with a spoke by which one sees it turn, axis and arms."""
    colour, name = poses.colours[shape.name], shape.name

    along = partial(poses.along, name)
    for plate in shape.plates:
        yield Line(along(plate), colour, 2.0, closed=True, opacity=0.25, body=name)
    middle, axis = Place(name, shape.centre or (0.0, 0.0, 0.0)), disc_axis(poses, shape)
    if axis is not None:
        rim = around(poses.place(middle), axis @ poses.axes[name], shape.disc * ROUND)
        yield Line(rim, colour, 2.4, closed=True, opacity=0.2, body=name)
        yield Line(np.stack([np.mean(rim, axis=1), rim[:, 0]], axis=1), colour, 2.4, body=name)
    if shape.axis:
        yield Line(along(shape.axis), colour, 8.0, body=name)
    for arm in shape.arms:
        yield Line(along(arm), colour, 5.0, body=name)
    joints = poses.description.joints.values()
    slides = any(
        joint.kind in _SLIDES and name in (joint.parent.body, joint.child.body) for joint in joints
    )
    if not slides and axis is None and not (shape.plates or shape.axis or shape.arms):
        yield Symbol("mass", poses.place(middle)[:, None], None, colour, BODIES)


def disc_axis(poses: Poses, shape: Shape) -> Array | None:
    """The axis (3,) of a body that is a disc, on the body's axes: the one about which all joints
    let the body turn; None of any other body.
    """
    joints = [
        joint
        for joint in poses.description.joints.values()
        if shape.name in (joint.parent.body, joint.child.body) and joint.kind != "weld"
    ]
    if not shape.disc or any(joint.kind != "revolute" for joint in joints):
        return None
    if not poses.description.space:
        return np.array([0.0, 0.0, 1.0])
    ways = [poses.direction(joint.parent.body, joint.triad[0])[0] for joint in joints]
    if not ways or any(np.abs(np.cross(ways[0], way)).max() > 1e-6 for way in ways):
        return None
    return np.asarray(poses.axes[shape.name][0] @ ways[0])


def _guide(poses: Poses, whole: Poses, joint: JointNumbers, size: float) -> Line:
    """The line along which a joint slides, as far as it ever does."""
    ways = whole.place(joint.child) - whole.place(joint.parent)
    reach = np.sum(ways * whole.direction(joint.parent.body, joint.triad[0]), axis=1)
    start = poses.place(joint.parent)
    along = poses.direction(joint.parent.body, joint.triad[0])
    ends = [start + (at * along) for at in (reach.min() - _PAD * size, reach.max() + _PAD * size)]
    return Line(np.stack(ends, axis=1), "#888888", 1.2, dashed=True, level=GROUND)


def _block(poses: Poses, joint: JointNumbers) -> Symbol:
    """The part that slides: in the colour of its body, larger if the part is a point mass."""
    body = joint.parent.body if joint.child.body == "ground" else joint.child.body
    mass = poses.description.bodies[body].length is None
    spot = Place(body, (0.0, 0.0, 0.0)) if mass else joint.child
    along = poses.direction(joint.parent.body, joint.triad[0])
    kind = "sliding mass" if mass else joint.kind
    return Symbol(
        kind, poses.place(spot)[:, None], along, poses.colours.get(body, "#ffffff"), BLOCKS
    )


def _axes(poses: Poses, joint: JointNumbers, size: float) -> Iterator[Line]:
    """The plane in which a joint in space slides, or short lines along the axes about which it
    turns.
    """
    if joint.kind == "planar":
        sides = _PLANE * size * np.array([(0, x, y) for x, y in _SQUARE])
        corners = np.array(joint.parent.at) + sides @ np.array(joint.triad)
        plane = poses.along(joint.parent.body, corners.tolist())
        yield Line(plane, _PITCH, 0.8, closed=True, opacity=0.12, level=GROUND)
    carried = [(joint.child.body, joint.carried)] if joint.carried else []
    turned = [(joint.parent.body, joint.triad[0]), *carried]
    for body, axis in turned if joint.kind in ("revolute", "universal") else ():
        middle, half = poses.place(joint.child), _AXIS * size * poses.direction(body, axis)
        yield Line(np.stack([middle - half, middle + half], axis=1), "#222222", 2.0, level=AXES)


def _meshing(poses: Poses, whole: Poses, pitch: PitchCircles) -> Iterator[tuple[str, Line]]:
    """The belt around two pitch circles, or a rack as long as its gear ever needs."""
    carrier, radius = pitch.carrier, pitch.radii[0]
    middles = [poses.place(Place(carrier, at)) for at in pitch.centres]
    ways = [poses.direction(carrier, axis) for axis in pitch.axes]
    if pitch.belt:
        strands = belt(middles[0], middles[1], ways[0], pitch.radii, crossed=pitch.crossed)
        yield carrier, Line(strands, _METAL, 2.4, closed=True, level=AXES)
    if pitch.rack is not None:
        spot, gone = poses.place(pitch.rack), Place(carrier, pitch.centres[0])
        away = whole.place(gone) - whole.place(pitch.rack)
        reach = np.sum(away * whole.direction(carrier, pitch.axes[1]), axis=1)
        ends = float(reach.min()) - 1.2 * radius, float(reach.max()) + 1.2 * radius
        points = rack(spot, ways[1], middles[0], radius, ends)
        colour, body = poses.colours.get(pitch.rack.body, _METAL), pitch.rack.body
        yield body, Line(points, colour, 2.0, closed=True, opacity=0.25, body=body)


def _drum(poses: Poses, track: Track) -> Iterator[tuple[str, Line]]:
    """A drum with the flanks of its groove, and the roller in that."""
    body, radius = track.centre.body, track.radius
    way: Array = np.array(track.way)
    axis, centre = np.array(track.axis), np.array(track.centre.at)
    high = (way - centre) @ axis
    outward = way - centre - high[:, None] * axis
    size = np.linalg.norm(outward, axis=1)
    across = np.cross(outward, np.roll(way, -1, axis=0) - np.roll(way, 1, axis=0))
    across *= radius / np.linalg.norm(across, axis=1, keepdims=True)
    colour, edge_of = poses.colours[body], 2.0 * radius or 0.2 * size.max()
    for end in (high.min() - edge_of, high.max() + edge_of):
        ring = around((centre + end * axis)[None], axis[None], size.max() * ROUND)[0]
        points = poses.along(body, ring.tolist())
        yield body, Line(points, colour, 2.0, closed=True, opacity=0.15, body=body)
    for side in (-1.0, 1.0) if radius else (0.0,):
        flank = poses.along(body, (way + side * across).tolist())
        yield body, Line(flank, colour, 1.6, closed=True, body=body)
    middle, about = poses.place(track.held), poses.direction(body, track.axis)
    seat = middle - poses.place(track.centre)
    seat = seat - np.sum(seat * about, axis=1, keepdims=True) * about
    held = track.held.body
    ring, colour = around(middle, seat, radius * ROUND), poses.colours[held]
    yield held, Line(ring, colour, 2.0, closed=True, opacity=0.25, level=POINTS, body=held)


def _arrow(arrow: Arrow) -> Iterator[Line]:
    """The shaft of an arrow on a page and its head, which is smaller where the arrow is short."""
    points = arrow.points
    steps = np.diff(points, axis=1)
    length = np.sum(np.hypot(steps[..., 0], steps[..., 1]), axis=1)
    head = np.minimum(arrow.head, length)[:, None]
    ahead = steps[:, -1]
    size = np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    ahead = ahead / np.where(size > 0.0, size, 1.0)
    tip, side = points[:, -1], 0.36 * head * np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    shaft, back = points.copy(), tip - head * ahead
    if points.shape[1] == 2:
        shaft[:, -1] = tip - 0.8 * head * ahead
    yield Line(shaft, arrow.colour, arrow.width, level=arrow.level)
    corners = np.stack([tip, back + side, back - side], axis=1)
    yield Line(corners, arrow.colour, 0.8, closed=True, opacity=1.0, level=arrow.level)

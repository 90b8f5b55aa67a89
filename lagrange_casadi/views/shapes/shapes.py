"""Shapes of a mechanism, from its description: bodies with their axes, arms and plates, joints,
springs, points.

Places and directions are three numbers, in a body's axes [m]; in the plane z is 0. How bodies move
is not said here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...model.description import Description, bends_of, drives_of, in_space

Place = tuple[float, float, float]

_ROUND = np.exp(2j * np.pi * np.arange(48) / 48)

_FLAT = 1e-6
"""Over a body's size: points that are no farther from a plane, or from a line, lie in it."""


@dataclass(frozen=True)
class Spot:
    """A place on a body, or on the ground."""

    body: str
    at: Place


@dataclass(frozen=True)
class Shape:
    """Shape of a body: lines between places, and plates, each a polygon.

    ``kind`` is "link" where it has an axis that is drawn, "rigid" where only its centre is known,
    "point" for a point mass. Of a rigid body that is held at its centre alone, as a gear or a
    rotor, there is a ``disc``, whose radius is the link's length.
    """

    name: str
    kind: str
    length: float | None
    mass: float
    axis: tuple[Place, ...]
    arms: tuple[tuple[Place, Place], ...]
    plates: tuple[tuple[Place, ...], ...]
    centre: Place | None
    disc: float

    @property
    def spoke(self) -> Place | None:
        """The end of the spoke of a disc; nothing where there is none."""
        if not self.disc or self.centre is None:
            return None
        return self.centre[0] + self.disc, *self.centre[1:]


@dataclass(frozen=True)
class JointShape:
    """Shape of a joint: its kind, the places that it joins, and its axes as directions that its
    parent carries.

    ``second`` is the second axis of a universal joint, which its child carries. ``coordinates`` are
    the full names of its coordinates, with their kinds, one for each axis; of a planar slot, of
    which the turn is no coordinate, there is one.
    """

    name: str
    kind: str
    parent: Spot
    child: Spot
    axes: tuple[Place, ...]
    second: Place | None
    coordinates: tuple[tuple[str, str], ...]
    driven: tuple[str, ...]


@dataclass(frozen=True)
class LoadShape:
    """Places of a load: first the place that it is for, then those from which it acts."""

    name: str
    kind: str
    spots: tuple[Spot, ...]


def shapes(description: Description) -> Iterator[Shape]:
    """The bodies, in the order in which they are declared."""
    for name, body in description["bodies"].items():
        outlines, rollers = _outlines(description, name), _rollers(description, name)
        spots = list(dict.fromkeys(spot.at for spot in _spots(description) if spot.body == name))
        length, mass = body["length"], body["mass"]
        if length is None:
            yield Shape(name, "point", None, mass, (), (), (), (0.0, 0.0, 0.0), 0.0)
        elif "centre" in body:
            centre = _place(body["centre"])
            plates = outlines or _plates(spots)
            # Two joints hold a bar between them; arms from the centre hold any others that lie in
            # no plane.
            ends = (
                [(spots[0], spots[1])]
                if len(spots) == 2
                else [(centre, at) for at in spots if at != centre]
            )
            arms = () if plates else tuple(ends)
            yield Shape(
                name,
                "rigid",
                length,
                mass,
                (),
                arms,
                plates + rollers,
                centre,
                0.0 if arms or plates else max(length, 0.0),
            )
        else:
            axis = ((0.0, 0.0, 0.0), (length, 0.0, 0.0))
            beside = [
                at
                for at in spots
                if np.hypot(at[1], at[2]) > _FLAT * (abs(length) or 1.0)
                or not 0.0 <= at[0] <= length
            ]
            plates = _plates([*axis, *beside]) if beside else ()
            arms = (
                ()
                if plates
                else tuple(((min(max(at[0], 0.0), length), 0.0, 0.0), at) for at in beside)
            )
            drawn = outlines + plates + rollers
            yield Shape(name, "link", length, mass, axis, arms, drawn, None, 0.0)


def joint_shapes(description: Description) -> Iterator[JointShape]:
    """The joints."""
    drives = set(drives_of(description))
    for name, joint in description["joints"].items():
        parent, child = (_spot(joint[end]) for end in ("parent", "child"))
        if in_space(description):
            axes = tuple(_vector(axis) for axis in joint["axes"])
            # The child carries the second axis of a universal joint.
            second = (
                _vector(np.array(joint["turned"]) @ joint["axes"][1])
                if joint["kind"] == "universal" and len(axes) > 1
                else None
            )
            coordinates = tuple(joint["coordinates"].items())
        else:
            slides = joint["kind"] in ("prismatic", "slot")
            axes, second = (_vector([*joint["axis"], 0.0]) if slides else (0.0, 0.0, 1.0),), None
            coordinates = ((name, joint["coordinate"]),) if joint["coordinate"] else ()
        driven = tuple(coordinate for coordinate, _ in coordinates if coordinate in drives)
        yield JointShape(name, joint["kind"], parent, child, axes, second, coordinates, driven)


def load_shapes(description: Description) -> Iterator[LoadShape]:
    """The loads."""
    for name, load in description["loads"].items():
        yield LoadShape(name, load["kind"], tuple(_spot(point) for point in load["points"]))


def path_spots(description: Description) -> dict[str, Spot]:
    """The declared points by name."""
    return {name: _spot(point) for name, point in description.get("paths", {}).items()}


def named_spots(description: Description) -> dict[str, Spot]:
    """The places beside which pictures write names: of joints, except the welds inside bent bars,
    and of declared points.
    """
    inner = bends_of(description)
    joints = {name: _spot(joint["child"]) for name, joint in description["joints"].items()}
    named = {name: spot for name, spot in joints.items() if name not in inner}
    return named | path_spots(description)


def _spots(description: Description) -> Iterator[Spot]:
    """Every place of a body at which something holds or pulls it, or that is declared."""
    for joint in description["joints"].values():
        yield from (_spot(joint[end]) for end in ("parent", "child"))
    for load in description["loads"].values():
        if load["kind"] == "spring":
            yield from map(_spot, load["points"])
    yield from path_spots(description).values()
    yield from map(_spot, description.get("rollers", {}).values())


def _outlines(description: Description, body: str) -> tuple[tuple[Place, ...], ...]:
    """Outlines that are declared for a body, without corners of a cam that its follower cannot
    touch.
    """
    return tuple(
        tuple((float(x), float(y), 0.0) for x, y in outline if np.isfinite(x + y))
        for outline in description.get("outlines", {}).get(body, ())
    )


def _rollers(description: Description, body: str) -> tuple[tuple[Place, ...], ...]:
    """The rollers on a body, each as a polygon."""
    return tuple(
        tuple(
            (roller["x"] + roller["radius"] * x, roller["y"] + roller["radius"] * y, 0.0)
            for x, y in zip(_ROUND.real.tolist(), _ROUND.imag.tolist(), strict=True)
        )
        for roller in description.get("rollers", {}).values()
        if roller["body"] == body
    )


def _spot(point: Description) -> Spot:
    return Spot(point["body"], _place(point))


def _place(point: Description) -> Place:
    return float(point["x"]), float(point["y"]), float(point.get("z", 0.0))


def _vector(components: Iterable[float]) -> Place:
    x, y, z = (float(component) + 0.0 for component in components)
    return x, y, z


def _plates(places: Sequence[Place]) -> tuple[tuple[Place, ...], ...]:
    """The convex polygon of three places or more that lie in one plane and not in a line; else
    nothing.
    """
    if len(places) < 3:
        return ()
    points = np.array(places)
    middle = points - points.mean(axis=0)
    size = float(np.abs(middle).max())
    _, distributed, directions = np.linalg.svd(middle / (size or 1.0))
    if distributed[1] < 1e3 * _FLAT or (distributed.size > 2 and distributed[2] > 1e3 * _FLAT):
        return ()
    return (tuple(places[k] for k in _hull(middle @ directions[:2].T / size)),)


def _hull(points: Array) -> list[int]:
    """The corners of a convex polygon around points (n, 2), in
    sequence (Andrew's monotone chain).
    """
    order = sorted(range(len(points)), key=lambda k: (points[k][0], points[k][1]))

    def chain(numbers: Sequence[int]) -> list[int]:
        found: list[int] = []
        for k in numbers:
            while (
                len(found) > 1 and _turn(points[found[-2]], points[found[-1]], points[k]) <= _FLAT
            ):
                found.pop()
            found.append(k)
        return found[:-1]

    return chain(order) + chain(order[::-1])


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

"""A mechanism as its certificate reads it: straight from the declaration, as numbers in space; a
plane is z = 0.

Nothing here comes from the derivation, so a wrong derivation cannot hide. What was stated as
expressions, constraints, motions and laws of loads, stands beside the numbers as functions
(:mod:`.stated`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from ..base.arrays import Expression
from .description import Description, density_of, drives_of, in_space, motions_of, slices_of
from .stated import Stated, Triple

Rows = tuple[Triple, Triple, Triple]
"""Three directions, or a matrix by its rows."""

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Place:
    """A place on a body, in the body's axes [m]."""

    body: str
    at: Triple


@dataclass(frozen=True)
class BodyNumbers:
    """A body's length [m], None for a point mass; its mass, and its centre and inertia about the
    centre, in its axes.
    """

    length: float | None
    mass: float
    centre: Triple = (0.0, 0.0, 0.0)
    inertia: Rows = ((0.0, 0.0, 0.0),) * 3


@dataclass(frozen=True)
class AxisNumbers:
    """A coordinate of a joint by its full name, and its direction in the parent's axes where all
    coordinates are zero.
    """

    coordinate: str
    kind: Literal["angle", "slide"]
    direction: Triple


@dataclass(frozen=True)
class JointNumbers:
    """A joint between two places; see :class:`.Joint`.

    ``axes`` are in sequence. The first direction of the ``triad`` is that of the joint's axis.
    ``turned`` are the child's axes in the parent's where all coordinates are zero. ``free`` says
    whether it turns about an axis that no coordinate describes.
    """

    kind: str
    parent: Place
    child: Place
    axes: tuple[AxisNumbers, ...]
    triad: Rows
    turned: Rows
    pitch: float = 0.0
    free: bool = False


@dataclass(frozen=True)
class LoadNumbers:
    """The places of a load, the second one bearing the opposite; of a friction its coordinate and
    its numbers by their words.
    """

    points: tuple[Place, ...]
    coordinate: str = ""
    friction: Mapping[str, float] | None = None


@dataclass(frozen=True, eq=False)
class Declared:
    """A mechanism in plain numbers, and what was stated of it as functions of what they measure.

    ``drives`` are the coordinates whose efforts make the motion, ``driven`` those whose motion is
    given. ``beside`` are the directions in ground axes that were declared for y axes of links.
    ``multipliers`` are the names of all constraints and rows. ``stated`` has these, the motions of
    ``driven`` and the laws of loads; nothing where they are not known, as of a file.
    """

    gravity: Triple
    bodies: Mapping[str, BodyNumbers]
    joints: Mapping[str, JointNumbers]
    loads: Mapping[str, LoadNumbers]
    drives: tuple[str, ...]
    driven: tuple[str, ...]
    beside: Mapping[str, Triple]
    multipliers: tuple[str, ...]
    stated: Stated = field(default_factory=Stated)

    @classmethod
    def of(cls, description: Description, stated: Stated | None = None) -> Declared:
        """The numbers of a description, which a file holds too; and what was ``stated``."""
        space = in_space(description)
        return cls(
            gravity=_triple(description["gravity"]),
            bodies={name: _body(body, space) for name, body in description["bodies"].items()},
            joints={
                name: _joint(name, joint, space) for name, joint in description["joints"].items()
            },
            loads={name: _load(load) for name, load in description["loads"].items()},
            drives=tuple(drives_of(description)),
            driven=tuple(motions_of(description)),
            beside={
                name: _triple(direction)
                for name, direction in description.get("beside", {}).items()
            },
            multipliers=(*description["constraints"], *description["rows"]),
            stated=stated or Stated(),
        )

    @cached_property
    def size(self) -> float:
        """The length of all links [m]."""
        return sum(body.length or 0.0 for body in self.bodies.values()) or 1.0

    @cached_property
    def extent(self) -> float:
        """The size of the mechanism, and how far from the origin it
        stands: the largest of places.
        """
        points = [place for joint in self.joints.values() for place in (joint.parent, joint.child)]
        points += [place for load in self.loads.values() for place in load.points]
        return self.size + max(
            (abs(x) for place in points if place.body == "ground" for x in place.at), default=0.0
        )

    @cached_property
    def kinds(self) -> dict[str, Literal["angle", "slide"]]:
        """The kinds of all coordinates."""
        return {axis.coordinate: axis.kind for joint in self.joints.values() for axis in joint.axes}

    def oriented(self, body: str) -> bool:
        """Return whether a body has a direction; a point mass has none."""
        return body == "ground" or self.bodies[body].length is not None


def _triple(vector: Expression) -> Triple:
    """A vector of two or three numbers in space."""
    x, y, *z = vector
    return x, y, *(z or (0.0,))


def _rows(matrix: Expression) -> Rows:
    """Three rows of three numbers."""
    x, y, z = map(tuple, matrix)
    return x, y, z


def _place(entry: Description) -> Place:
    return Place(entry["body"], (entry["x"], entry["y"], entry.get("z", 0.0)))


def _body(entry: Description, space: bool) -> BodyNumbers:
    length = entry["length"]
    if "centre" in entry:
        centre = entry["centre"]
        inertia = (
            _rows(centre["inertia"])
            if space
            else ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, centre["inertia"]))
        )
        place = centre["x"], centre["y"], centre.get("z", 0.0)
        return BodyNumbers(length, entry["mass"], place, inertia)
    if length is None:
        return BodyNumbers(length, entry["mass"])
    # Not the mass of the description, which was computed as the derivation does it.
    mass, first, second = (float(tail[0]) for tail in density_of(entry).tails(np.zeros(1)))
    if mass == 0.0:
        return BodyNumbers(length, mass)
    middle = first / mass
    across = (second - first * middle) * length**2
    yy, zz, yz = slices_of(entry)
    inertia = (yy + zz, 0.0, 0.0), (0.0, across + zz, -yz), (0.0, -yz, across + yy)
    return BodyNumbers(length, mass, (middle * length, 0.0, 0.0), inertia)


def _joint(name: str, entry: Description, space: bool) -> JointNumbers:
    """A joint; of the plane, one whose child turns about z."""
    slides, axes = entry["kind"] in ("prismatic", "slot"), []
    if space:
        coordinates = zip(entry["coordinates"].items(), entry["axes"], strict=True)
        axes = [AxisNumbers(name, kind, tuple(one)) for (name, kind), one in coordinates]
        triad, turned = _rows(entry["triad"]), _rows(entry["turned"])
    else:
        (x, y), c, s = entry["axis"], math.cos(entry["angle"]), math.sin(entry["angle"])
        triad = ((x, y, 0.0), (-y, x, 0.0), _Z) if slides else (_Z, _X, _Y)
        turned = (c, s, 0.0), (-s, c, 0.0), _Z
        if entry["coordinate"]:
            axes = [AxisNumbers(name, entry["coordinate"], triad[0])]
    return JointNumbers(
        entry["kind"],
        _place(entry["parent"]),
        _place(entry["child"]),
        tuple(axes),
        triad,
        turned,
        pitch=entry.get("pitch", 0.0),
        free=not space and entry["kind"] == "slot",
    )


def _load(entry: Description) -> LoadNumbers:
    friction, points = entry.get("friction", {}), tuple(map(_place, entry["points"]))
    return LoadNumbers(points, friction.get("coordinate", ""), friction.get("numbers"))

"""What the spatial oracle is told of a mechanism: plain data of its own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from arithmetic import GAUSS
from spatial_algebra import cross, orthonormal, unit, vector

Vector = Sequence[Any]
Law = Callable[[Any], Any] | Sequence[Any]
GROUND = "ground"
NIL = (0, 0, 0)
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
_KINDS = {
    "revolute": ("u turns",),
    "prismatic": ("u slides",),
    "cylindrical": ("u turns", "u slides"),
    "universal": ("u turns", "v turns"),
    "spherical": ("1 turns", "2 turns", "3 turns"),
    "screw": ("u winds",),
    "planar": ("u slides", "v slides", "w turns"),
    "slot": ("u slides", "1 turns", "2 turns", "3 turns"),
    "weld": (),
    "free": ("1 slides", "2 slides", "3 slides", "1 turns", "2 turns", "3 turns"),
}
"""What a joint lets its child do in sequence: about or along its axis u, its second axis v, the
third one w, or the directions of its frame.
"""

KINDS = tuple(_KINDS)


@dataclass(frozen=True)
class Rigid:
    """A rigid body: ``inertia`` (3x3) is about the ``centre``, both in its axes."""

    name: str
    mass: Any
    centre: Vector = NIL
    inertia: Sequence[Vector] = (NIL, NIL, NIL)

    def inertias(self):
        """Mass, centre, and inertia about it."""
        return (
            float(self.mass),
            vector(self.centre),
            vector(self.inertia),
        )


@dataclass(frozen=True)
class Rod:
    """A straight body from its origin along its x.

    ``density`` is mass per length (kg/m) over the ratio xi; ``polar``, ``lateral_y``, ``lateral_z``
    are a slice's moments of inertia per length about x, y and z through its centre, ``product`` its
    yz entry (kg m). Each is a function of xi, or the coefficients of a polynomial in it; smooth
    between ``breaks``.
    """

    name: str
    length: Any
    density: Law
    polar: Law = ()
    lateral_y: Law = ()
    lateral_z: Law = ()
    product: Law = ()
    breaks: Vector = (0, 1)

    def slices(self, start=0, end=1):
        """Slices between two ratios: places along the rod, masses, and moments of inertia (3x3), by
        Gauss' rule.
        """
        length = float(self.length)
        for a, b in itertools.pairwise(vector(self.breaks)):
            a, b = max(a, start), min(b, end)
            if b <= a:
                continue
            for node, weight in zip(*GAUSS, strict=True):
                xi, w = a + (node + 1) / 2 * (b - a), weight * (b - a) / 2 * length
                j, y, z, p = (
                    _value(law, xi) * w
                    for law in (self.polar, self.lateral_y, self.lateral_z, self.product)
                )
                inertia = np.array([[j, 0.0, 0.0], [0.0, y, p], [0.0, p, z]])
                yield xi * length, _value(self.density, xi) * w, inertia

    def inertias(self):
        """Mass, centre, and inertia about it."""
        slices = [*self.slices()]
        mass = sum(m for _, m, _ in slices)
        place = sum(m * x for x, m, _ in slices) / mass if mass else 0.0
        across = sum(m * (x - place) ** 2 for x, m, _ in slices)
        inertia = sum(i for *_, i in slices) + np.diag([0.0, across, across])
        return mass, np.array([place, 0.0, 0.0]), inertia


def _value(law, xi):
    if callable(law):
        return float(law(xi))
    found = 0.0
    for coefficient in reversed(law):
        found = found * xi + float(coefficient)
    return found


def uniform(name, length, mass) -> Rod:
    """A slender uniform rod of so much mass."""
    return Rod(name, length, lambda xi: (mass + 0 * xi) / length)


def second_moments(yy: Law, zz: Law, yz: Law = ()) -> dict[str, Law]:
    """The slices' laws of a rod from its second moments of mass per length: sums of y y, z z and y
    z over the section.
    """

    def at(law, xi):
        return law(xi) if callable(law) else sum(c * xi**k for k, c in enumerate(law))

    return {
        "polar": lambda xi: at(yy, xi) + at(zz, xi),
        "lateral_y": zz,
        "lateral_z": yy,
        "product": lambda xi: -at(yz, xi),
    }


@dataclass(frozen=True)
class Axis:
    """One coordinate of a joint: a turn about ``direction``, or a slide along it; ``slide`` is the
    way a unit of it makes.
    """

    direction: np.ndarray
    turns: bool
    slide: Any


@dataclass(frozen=True)
class Joint:
    """A joint: axes in sequence, each carried by the turns before it.

    ``at_parent`` and ``at_child`` are its point in both bodies' axes; ``axis`` (and ``axis2``, at
    coordinates zero) are in the parent's axes; ``frame`` lists the three directions of a spherical
    joint's turns, a slot's, and a free one's slides and turns; ``orientation`` is the child's
    against the parent at coordinates zero. The ``lead`` is a screw's slide for a whole turn.
    """

    name: str
    kind: str
    parent: str
    child: str
    at_parent: Vector = NIL
    at_child: Vector = NIL
    axis: Vector = (0, 0, 1)
    axis2: Vector | None = None
    lead: Any = 0
    frame: Sequence[Vector] = AXES
    orientation: Sequence[Vector] = AXES

    def __post_init__(self) -> None:
        assert self.kind in KINDS, f"'{self.kind}' is no joint; there are {KINDS}"

    @property
    def count(self) -> int:
        """How many coordinates it has."""
        return len(_KINDS[self.kind])

    @property
    def turning(self) -> list[int]:
        """The indices of its turns."""
        return [k for k, told in enumerate(_KINDS[self.kind]) if not told.endswith("slides")]

    def axes(self) -> list[Axis]:
        """Its axes, in the parent's axes at coordinates zero."""
        frame = orthonormal([*zip(*self.frame, strict=True)]).T
        ways = {"u": unit(vector(self.axis))}
        ways |= dict(zip("123", frame, strict=True))
        if self.axis2 is not None:
            given, u = unit(vector(self.axis2)), ways["u"]
            assert abs(given @ u) < 1e-9, f"the axes of '{self.name}' are not at right angles"
            ways["v"] = unit(given - u * (given @ u))
            ways["w"] = cross(u, ways["v"])
        lead = float(self.lead) / math.tau
        kinds = {"turns": (True, 0.0), "slides": (False, 1.0), "winds": (True, lead)}
        told = (words.split() for words in _KINDS[self.kind])
        return [Axis(ways[way], *kinds[kind]) for way, kind in told]


@dataclass(frozen=True)
class Load:
    """A constant force and torque on a body's point, in ground axes, or in the body's where it is
    ``turning`` with it.
    """

    body: str
    point: Vector = NIL
    force: Vector = NIL
    torque: Vector = NIL
    turning: bool = False


@dataclass(frozen=True)
class Spread:
    """A force per length along a rod from ``start`` to ``end`` [m]: a row of powers of the distance
    for each component.
    """

    body: str
    start: float
    end: float
    powers: Sequence[Sequence[float]]
    turning: bool = False

    def at(self, x):
        """The force per length at a distance."""
        return [sum(c * x**k for k, c in enumerate(row)) for row in self.powers]


@dataclass(frozen=True)
class Spring:
    """A spring and damper between two points, each (body, point): tension = stiffness (length -
    free) + damping length'.
    """

    ends: tuple[tuple[str, Vector], tuple[str, Vector]]
    stiffness: Any = 0
    free: Any = 0
    damping: Any = 0


@dataclass(frozen=True)
class Rotor:
    """What turns about the axis of a ``joint`` in a housing on its parent, ``ratio`` times as far
    as the joint goes: its ``inertia`` is among that of the parent. An ``armature`` is two of them
    that turn to either side, as far as the joint goes, and have half of that each.
    """

    joint: str
    inertia: float
    ratio: float
    armature: float = 0.0

    @property
    def spinning(self) -> list[tuple[float, float]]:
        """Inertias and ratios of bodies that turn."""
        return [(self.inertia, self.ratio), (self.armature / 2, 1.0), (self.armature / 2, -1.0)]


@dataclass(frozen=True)
class Coupling:
    """Gears, points on planes and the like: the sum of coefficients times coordinates, by (joint,
    index), and of directions times places, by (body, point), is the ``offset``.
    """

    name: str
    terms: dict
    offset: Any = 0
    points: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Row:
    """A non-holonomic constraint: coefficients times rates of coordinates, and directions times
    velocities of points, are nothing.

    ``of(functions, q)`` tells coefficients by (joint, index), and directions in ground axes by
    (body, point); ``q`` are the coordinates of ``keys``, all that it is written in. No effort is at
    the coordinate that it ``replaces``.
    """

    name: str
    keys: Sequence
    of: Callable[[Any, dict], tuple[dict, dict]]
    replaces: tuple


@dataclass(frozen=True)
class Mechanism:
    """Bodies, joints, gravity (m/s^2, ground axes), what acts, and what couples coordinates and
    rates.
    """

    bodies: Sequence[Rigid | Rod]
    joints: Sequence[Joint]
    gravity: Vector = (0, 0, "-9.81")
    loads: Sequence[Load] = field(default_factory=tuple)
    springs: Sequence[Spring] = field(default_factory=tuple)
    couplings: Sequence[Coupling] = field(default_factory=tuple)
    spreads: Sequence[Spread] = field(default_factory=tuple)
    rows: Sequence[Row] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        names = [b.name for b in self.bodies] + [GROUND]
        assert len({*names}) == len(names), "two bodies have one name"
        for joint in self.joints:
            assert {joint.parent, joint.child} <= {*names}, (
                f"'{joint.name}' joins {joint.parent} and {joint.child}: not both are there"
            )

    def joint(self, name: str) -> Joint:
        return next(j for j in self.joints if j.name == name)

    @cached_property
    def size(self) -> float:
        """A length by which places and angles, forces and moments are compared."""
        points = [j.at_parent for j in self.joints] + [j.at_child for j in self.joints]
        found = [float(b.length) for b in self.bodies if isinstance(b, Rod)]
        return max([*found, *(max(abs(float(x)) for x in p) for p in points)], default=1.0) or 1.0

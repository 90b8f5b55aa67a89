"""The record between formats and a case: bodies, joints with a frame on each body, couplings,
motions and gravity, as plain numbers in SI units.

A format's module makes a :class:`Model` of a file; :mod:`.as_case` makes a case of it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..declare.joints import IN_SPACE
from ..errors import ModelFileError, shown

GROUND = "ground"
"""The name of the fixed frame, as of a body."""

LARGEST = 1e12
"""A larger number in a file is no length, mass or angle of a machine."""

ROWS: dict[str, str] = {
    "slide": "ca.dot(q - p, {e})",
    "cosine": "ca.dot({e}, {f})",
    "sides": "ca.dot(x, v) + ca.dot(y, u)",
    "distance": "ca.dot(q - p, q - p)",
    "distance across": "ca.dot(q - p, x) ** 2 + ca.dot(q - p, y) ** 2",
    "slide and turn": "ca.dot(q - p, {e}) + {factor} * turn",
    "wheels": "second + {factor} * first",
}
"""Rows of ties, whose expressions in a case are a value. The parent's frame is at p and
has the axes x, y, z; the child's is at q and has u, v, w; e and f are one of each.
"""

_AXES = {"spherical": "xyz", "free": "xyz", "universal": "zw"}

MOVES: dict[str, tuple[tuple[str, str, str], ...]] = {
    kind: tuple(
        (name or "", move, _AXES.get(kind, "zxy")[direction]) for name, move, direction in freedoms
    )
    for kind, freedoms in IN_SPACE.items()
}
"""The name of each coordinate of a kind of joint, empty for one alone, how it moves, and along or
about which axis of the parent's frame; w is z of the child's.
"""


@dataclass(frozen=True, eq=False)
class Frame:
    """A place [m] and three axes, the columns of a rotation, on some other frame."""

    place: Array = field(default_factory=lambda: np.zeros(3))
    axes: Array = field(default_factory=lambda: np.eye(3))

    @classmethod
    def about(cls, axis: Array, place: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> Frame:
        """Return a frame whose z is along a direction."""
        z = axis / np.linalg.norm(axis)
        other = np.eye(3)[int(np.argmin(np.round(np.abs(z), 9)))]
        x = other - (other @ z) * z
        x /= np.linalg.norm(x)
        return cls(np.array(place), np.column_stack([x, np.cross(z, x), z]) + 0.0)

    @classmethod
    def posed(cls, place: Array, angles: Array) -> Frame:
        """Return a frame turned by roll, pitch and yaw about fixed x, y and z [rad]."""
        (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
        axes = np.array(
            [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ]
        )
        return cls(place, _right_angled(axes))

    def then(self, inner: Frame) -> Frame:
        """Return a frame given relative to this one, relative to the reference of this one."""
        return Frame(self.place + self.axes @ inner.place, self.axes @ inner.axes)

    def inverse(self) -> Frame:
        """Return the reference of this one, relative to this one."""
        return self.relative(Frame())

    def relative(self, other: Frame) -> Frame:
        """Return a frame given relative to the reference of this one, relative to this one."""
        return Frame(self.axes.T @ (other.place - self.place), self.axes.T @ other.axes)

    def at(self, place: Array) -> Array:
        """Return the place of a point of this frame."""
        return np.asarray(self.place + self.axes @ place)


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body: its mass [kg], and on its own axes the centre of mass [m] and the inertia about
    it [kg m^2].

    ``frame`` is where it is in the reference posture. ``places`` are points of it that have a name.
    A uniform slender ``rod`` lies between two places, and has sections; a ``point`` mass has no
    axes. ``where`` is what messages call it: the line and the element of the file.
    """

    name: str
    mass: float
    centre: Array
    inertia: Array | None
    frame: Frame = field(default_factory=Frame)
    places: Mapping[str, Array] = field(default_factory=dict)
    rod: tuple[Array, Array] | None = None
    point: bool = False
    where: str = ""

    @classmethod
    def slender(cls, name: str, mass: float, rod: tuple[Array, Array], where: str = "") -> Body:
        """Return a uniform rod between two places."""
        along = rod[1] - rod[0]
        inertia = mass / 12.0 * (along @ along * np.eye(3) - np.outer(along, along))
        return cls(name, mass, (rod[0] + rod[1]) / 2.0, inertia, rod=rod, where=where)


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between a frame of its parent and a frame of its child, on the bodies' own axes.

    The frames coincide where its coordinates are zero. It turns about z and slides along z of the
    parent's frame; a planar joint's normal is z and its slides are along x and y; of a free and a
    spherical joint slides and turns are along and about x, y, z; of a universal joint the axes are
    z of the parent's frame and z of the child's. ``lead`` [m] is a screw's.
    """

    name: str
    kind: str
    parent: str
    child: str
    on_parent: Frame
    on_child: Frame
    lead: float = 0.0
    where: str = ""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The full names of its coordinates."""
        names = (name for name, _, _ in MOVES[self.kind])
        return tuple(f"{self.name}:{name}" if name else self.name for name in names)


@dataclass(frozen=True, eq=False)
class Coupling:
    """A transmission between two joints of one coordinate: second = ratio first + offset."""

    name: str
    first: str
    second: str
    ratio: float
    offset: float = 0.0
    where: str = ""


@dataclass(frozen=True, eq=False)
class Row:
    """An equation between two frames: ``kind`` is one of :data:`ROWS`, with its numbers.

    ``i`` and ``j`` number axes of the parent's and of the child's frame. Where it has an angle,
    that of the child's frame about z of the parent's, ``angle`` is its value in the reference
    posture; of two wheels it is the direction of one's centre in the other's axes, and ``other``
    the direction the other way.
    """

    kind: str
    i: int = 2
    j: int = 2
    value: float = 0.0
    factor: float = 0.0
    angle: float = 0.0
    other: float = 0.0

    @property
    def text(self) -> str:
        """The expression of its value, as Python."""
        e, f, factor = "xyz"[self.i], "uvw"[self.j], repr(float(self.factor) + 0.0)
        return ROWS[self.kind].format(e=e, f=f, factor=factor)


@dataclass(frozen=True, eq=False)
class Tie:
    """A closure that no joint of the table is: rows between two frames."""

    name: str
    parent: str
    child: str
    on_parent: Frame
    on_child: Frame
    rows: tuple[Row, ...]
    where: str = ""


@dataclass(frozen=True, eq=False)
class Law:
    """The motion of a coordinate as the text of an expression of ``t`` [s], or samples."""

    text: str = ""
    samples: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    where: str = ""


Part = Body | Joint | Coupling | Tie


@dataclass(eq=False)
class Model:
    """A mechanism as a file describes it. ``notes`` say what was ignored, and what was cleaned.

    ``file`` is the name of the file, ``span`` the instants: start [s], stop [s], count. ``posture``
    are rough values of coordinates at the start, from which loops that are open in the reference
    posture are assembled. ``drives`` are the joints whose efforts make the motion, where these are
    not those that have one; ``preferred`` are joints that are driven first. ``called`` are the
    file's names of parts that have another one here; ``named`` are names here by the kind of a part
    and its name of the file. ``rounded`` is by how much axes are off right angles, and where.
    """

    name: str
    file: str
    bodies: dict[str, Body] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    couplings: dict[str, Coupling] = field(default_factory=dict)
    ties: dict[str, Tie] = field(default_factory=dict)
    motions: dict[str, Law] = field(default_factory=dict)
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    span: tuple[float, float, int] = (0.0, 1.0, 101)
    posture: dict[str, float] = field(default_factory=dict)
    drives: list[str] | None = None
    preferred: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    called: dict[str, str] = field(default_factory=dict)
    named: dict[tuple[str, str], str] = field(default_factory=dict)
    rounded: tuple[float, str] = (0.0, "")

    def refuse(self, where: str, words: str) -> ModelFileError:
        """Return the error of an element of the file."""
        return ModelFileError(f"{self.file}: {where + ': ' if where else ''}{words}")

    def number(self, where: str, given: object, what: str) -> float:
        """Return a number of the file. Raises :class:`.ModelFileError` for what is none, and for
        one that no machine has.
        """
        try:
            found = float(given)  # type: ignore[arg-type]
        except (TypeError, ValueError, OverflowError):
            raise self.refuse(where, f"{what}: expected a number, got {shown(given)}") from None
        if isinstance(given, bool) or "_" in str(given) or not abs(found) <= LARGEST:
            expected = f"expected a finite number of at most {LARGEST:g}"
            raise self.refuse(where, f"{what}: {expected}, got {shown(given)}")
        return found

    def numbers(self, where: str, given: object, what: str, count: int = 3) -> Array:
        """Return so many numbers of the file, from a list or from a text with blanks."""
        parts = given.split() if isinstance(given, str) else given
        if not isinstance(parts, Sequence) or len(parts) != count:
            raise self.refuse(where, f"{what}: expected {count} numbers, got {shown(given)}")
        return np.array([self.number(where, part, what) for part in parts])

    def rotation(self, where: str, axes: Array) -> Array:
        """Return axes at right angles that are nearest to those of the file, without its rounding.

        Raises :class:`.ModelFileError` for axes that are off by more than 1e-4.
        """
        exact = _right_angled(axes)
        off = float(np.abs(exact - axes).max())
        if off > 1e-4 or np.linalg.det(exact) < 0:
            words = "axes: expected three directions at right angles, right-handed"
            raise self.refuse(where, words)
        if off > max(1e-9, self.rounded[0]):
            self.rounded = off, where
        return exact

    def name_of(self, kind: str, stated: str, where: str, taken: Collection[str]) -> str:
        """Return a name of the file as one that parts may have, and keep what it was."""
        name = re.sub(r"\W", "_", stated.strip(), flags=re.ASCII)
        name = name if name[:1].isalpha() else f"{kind[0]}_{name}"
        if name in taken or (name == GROUND and kind == "body"):
            raise self.refuse(where, f"{kind} {shown(stated)}: the name is taken")
        while name in {GROUND, *self.bodies, *self.joints, *self.couplings, *self.ties}:
            name = f"{name}_{kind}"
        if name != stated:
            self.called[name] = stated
        self.named[kind, stated] = name
        return name

    def add(self, part: type[Part], stated: str, where: str, *given: Any) -> str:
        """Add a body, joint, coupling or tie under its name of the file; return its name here."""
        parts: dict[type[Part], dict[str, Any]] = {Body: self.bodies, Coupling: self.couplings}
        parts |= {Joint: self.joints, Tie: self.ties}
        kind = "joint" if part is Tie else part.__name__.lower()
        taken = {**self.joints, **self.ties} if kind == "joint" else parts[part]
        name = self.name_of(kind, stated, where, taken)
        parts[part][name] = replace(part(name, *given), where=where)
        return name

    def find(self, kind: str, stated: str, where: str) -> str:
        """Return the name here of a part that the file names."""
        if (kind, stated) in self.named:
            return self.named[kind, stated]
        valid = ", ".join(name for of, name in self.named if of == kind)
        raise self.refuse(where, f"unknown {kind} {shown(stated)}; valid: {valid}")

    def frame_of(self, body: str) -> Frame:
        """Return where a body is in the reference posture."""
        return Frame() if body == GROUND else self.bodies[body].frame

    def frames(self, joint: Joint | Tie) -> tuple[Frame, Frame]:
        """Return the two frames of a joint in the reference posture, on the ground."""
        parent, child = self.frame_of(joint.parent), self.frame_of(joint.child)
        return parent.then(joint.on_parent), child.then(joint.on_child)

    def at_reference(self, coordinate: str) -> float:
        """Return a coordinate in the reference posture."""
        joint = self.joints[coordinate.partition(":")[0]]
        near, far = self.frames(joint)
        known, moves = near.relative(far), MOVES[joint.kind]
        order = ["xyzw".index(axis) for _, move, axis in moves if move != "slide"]
        turns = [0.0, 0.0]
        if len(order) == 1:
            turns = [math.atan2(known.axes[1, 0], known.axes[0, 0])]
        elif len(order) == 3:
            turns = _three_turns(known.axes[np.ix_(order, order)])
        slides = [known.place["xyz".index(axis)] for _, move, axis in moves if move == "slide"]
        return float([*slides, *turns][joint.coordinates.index(coordinate)])

    def closest(self, joint: Joint) -> Frame:
        """Return where the child's frame is on the parent's if the joint, open in the reference
        posture, is closed with the coordinates that it has there.
        """
        near, far = self.frames(joint)
        known, moves = near.relative(far), MOVES[joint.kind]
        slides = [axis for _, move, axis in moves if move == "slide"]
        place = np.where([axis in slides for axis in "xyz"], known.place, 0.0)
        turns = [axis for _, move, axis in moves if move != "slide"]
        if len(turns) == 3:
            return Frame(place, known.axes)
        if len(turns) == 2:  # of a universal joint: the child's z is across the parent's
            across = np.array([known.axes[0, 2], known.axes[1, 2], 0.0])
            return Frame.about(across if np.any(across) else np.eye(3)[0], place)
        if not turns:
            return Frame(place)
        angle = math.atan2(known.axes[1, 0], known.axes[0, 0])
        if joint.kind == "screw":
            place[2] = joint.lead * angle / math.tau
        return Frame(place, turned(np.array([0.0, 0.0, 1.0]), angle))

    def size(self) -> float:
        """Return the extent of what joints and centres of mass span [m]."""
        places = [one.place for joint in self.joints.values() for one in self.frames(joint)]
        places += [body.frame.at(body.centre) for body in self.bodies.values()]
        return float(np.max(np.ptp(np.array(places), axis=0))) or 1.0 if places else 1.0

    def apart(self, joint: Joint) -> tuple[float, float]:
        """Return by how much the frames of a joint miss what it holds: in m, and in rad."""
        near, far = self.frames(joint)
        known = near.relative(far)
        free = {(move, axis) for _, move, axis in MOVES[joint.kind]}
        held = [k for k, axis in enumerate("xyz") if not {("slide", axis), ("screw", axis)} & free]
        gap = math.hypot(*known.place[held].tolist())
        turns = sum(move != "slide" for move, _ in free)
        if any(one != GROUND and self.bodies[one].point for one in (joint.parent, joint.child)):
            return gap, 0.0
        if joint.kind == "universal":
            return gap, abs(float(known.axes[2, 2]))
        if joint.kind == "screw":
            turn = math.atan2(known.axes[1, 0], known.axes[0, 0])
            away = (float(known.place[2]) - joint.lead * turn / math.tau) / (joint.lead or 1.0)
            gap = math.hypot(gap, joint.lead * (away - round(away)))
        if not turns:
            sine = math.hypot(*(known.axes - known.axes.T)[[0, 0, 1], [1, 2, 2]].tolist()) / 2.0
            return gap, math.atan2(sine, (float(np.trace(known.axes)) - 1.0) / 2.0)
        tilt = math.hypot(float(known.axes[0, 2]), float(known.axes[1, 2]))
        return gap, math.atan2(tilt, float(known.axes[2, 2])) if turns == 1 else 0.0


def _three_turns(axes: Array) -> list[float]:
    """Return the angles about x, y and z in sequence, each axis carried by those before."""
    y = math.asin(min(1.0, max(-1.0, float(axes[0, 2]))))
    return [math.atan2(-axes[1, 2], axes[2, 2]), y, math.atan2(-axes[0, 1], axes[0, 0])]


def _right_angled(axes: Array) -> Array:
    """Return the axes at right angles that are nearest to others; components that are nothing or
    one but for rounding are so.
    """
    left, _, right = np.linalg.svd(np.where(np.abs(axes) < 1e-9, 0.0, axes))
    exact = left @ right
    exact = np.where(np.abs(exact) < 1e-9, 0.0, exact)
    return np.asarray(np.where(np.abs(np.abs(exact) - 1.0) < 1e-15, np.sign(exact), exact))


MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
"""Names of the moments of inertia in URDF and SDF."""


def inertia_of(moments: Sequence[float], axes: Array) -> Array:
    """Return the inertia of six :data:`MOMENTS` about axes, on the reference axes of these."""
    xx, xy, xz, yy, yz, zz = moments
    return np.asarray(axes @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ axes.T)


def turned(axis: Array, angle: float) -> Array:
    """Return the rotation about a direction of length 1 by an angle [rad]."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * skew + (1 - math.cos(angle)) * skew @ skew)

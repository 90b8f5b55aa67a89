"""The record between formats and a case: bodies, joints with a frame on each body, couplings,
motions and gravity, as plain numbers in SI units.

A format's module makes a :class:`Model` of a file; :mod:`.as_case` makes a case of it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Array
from ...base.numerals import real
from ...base.units import quantity
from ...errors import DeclarationError, ModelFileError, shown
from ...model.joints import IN_SPACE
from .file_frames import Frame, right_angled

GROUND = "ground"
"""The name of the fixed frame, as of a body."""

LARGEST, SHORTEST = 1e12, 1e-100
"""A larger number in a file is no length, mass or angle of a machine; a smaller one is zero."""

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


def number(given: Any) -> float:
    """Return a number that a machine may have, finite and at most 1e12; one below 1e-100, whose
    powers are no numbers, is zero.

    Raises :class:`ValueError`, :class:`TypeError` or :class:`OverflowError` for what is none.
    """
    found = float(given)
    if isinstance(given, bool) or "_" in str(given) or not abs(found) <= LARGEST:
        raise ValueError
    return found if abs(found) > SHORTEST else 0.0


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body: its mass [kg], and on its own axes the centre of mass [m] and the inertia about
    it [kg m^2].

    ``frame`` is where it is in the reference posture. ``places`` are points of it that have a name.
    A uniform slender ``rod`` lies between two places, and has sections; a ``point`` mass has no
    axes. ``weight`` is how much of gravity acts on it. ``strange`` moments of inertia, which no
    body has, are taken as they are. ``where`` is what messages call it: the line and the element
    of the file.
    """

    name: str
    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))
    frame: Frame = field(default_factory=Frame)
    places: Mapping[str, Array] = field(default_factory=dict)
    rod: tuple[Array, Array] | None = None
    point: bool = False
    weight: float = 1.0
    strange: bool = False
    where: str = ""


def slender(mass: float, start: Array, end: Array) -> tuple[Array, Array]:
    """Return the centre and the inertia of a uniform rod between two places."""
    along = end - start
    inertia = mass / 12.0 * (along @ along * np.eye(3) - np.outer(along, along))
    return (start + end) / 2.0, inertia


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between a frame of its parent and a frame of its child, on the bodies' own axes.

    The frames coincide where its coordinates are zero. It turns about z and slides along z of the
    parent's frame; a planar joint's normal is z and its slides are along x and y; of a free and a
    spherical joint slides and turns are along and about x, y, z; of a universal joint the axes are
    z of the parent's frame and z of the child's. ``lead`` [m] is a screw's. A tie, a closure
    that no joint of the table is, has no kind, but ``rows`` between the two frames.
    """

    name: str
    kind: str
    parent: str
    child: str
    on_parent: Frame
    on_child: Frame
    lead: float = 0.0
    rows: tuple[Row, ...] = ()
    where: str = ""

    @property
    def ends(self) -> tuple[str, str]:
        """Parent and child."""
        return self.parent, self.child

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
class Spring:
    """A damper, a spring and dry friction of a joint of one coordinate, in SI units, and the
    coordinate where the spring has no force.
    """

    joint: str
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    friction: float = 0.0


def _amount(what: str, text: str, unit: str) -> float:
    with suppress(ValueError):
        return real(text)
    return quantity(what, text, unit)


@dataclass(frozen=True, eq=False)
class Row:
    """An equation between two frames: ``kind`` is one of :data:`ROWS`, with its numbers.

    ``i`` and ``j`` number axes of the parent's and of the child's frame. ``value`` is what it
    holds; a row with turns holds what it is in the reference posture.
    """

    kind: str
    i: int = 2
    j: int = 2
    value: float = 0.0
    factor: float = 0.0

    @property
    def text(self) -> str:
        """The expression of its value, as Python."""
        factor = repr(float(self.factor) + 0.0)
        return ROWS[self.kind].format(e="xyz"[self.i], f="uvw"[self.j], factor=factor)


@dataclass(frozen=True, eq=False)
class Law:
    """The motion of a coordinate as the text of an expression of ``t`` [s], or samples."""

    text: str = ""
    samples: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    where: str = ""


Part = Body | Joint | Coupling


@dataclass(eq=False)
class Model:
    """A mechanism as a file describes it. ``notes`` say what was ignored, and what was cleaned.

    ``span`` are the instants: start [s], stop [s], count. ``posture`` are rough values of
    coordinates at the start, from which loops that are open in the reference posture are assembled;
    bodies that are only ``drawn`` are moved instead. ``drives`` are the joints whose efforts make
    the motion, where these are not those that have one; ``preferred`` are joints that are driven
    first. ``motors`` are what drives are made of by the names of joints, with the keywords of
    :meth:`.Mechanism.drive`. ``spots`` are what has a name and no mass, by its name of the file:
    its body, and where it is on that. ``payloads`` are bodies whose masses are parameters. Of one
    that is ``floating`` the base is free; ``contacts`` are joints that hold points on the ground.
    ``named`` are the names here by the kind of a part and its name of the file, ``repeated``
    how often a name was wanted once more. ``usual`` are numbers that are the format's, with the
    parts that do not give them. ``rounded`` is by how much axes are off right angles, and where.
    """

    name: str
    file: Path
    bodies: dict[str, Body] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    couplings: dict[str, Coupling] = field(default_factory=dict)
    ties: dict[str, Joint] = field(default_factory=dict)
    springs: list[Spring] = field(default_factory=list)
    motors: dict[str, dict[str, float]] = field(default_factory=dict)
    spots: dict[str, tuple[str, Frame]] = field(default_factory=dict)
    payloads: list[str] = field(default_factory=list)
    floating: bool = False
    contacts: list[str] = field(default_factory=list)
    motions: dict[str, Law] = field(default_factory=dict)
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    span: tuple[float, float, int] = (0.0, 1.0, 101)
    posture: dict[str, float] = field(default_factory=dict)
    drives: list[str] | None = None
    drawn: bool = False
    preferred: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    named: dict[tuple[str, str], str] = field(default_factory=dict)
    usual: dict[str, dict[str, None]] = field(default_factory=dict)
    repeated: dict[str, int] = field(default_factory=dict)
    rounded: tuple[float, str] = (0.0, "")

    def taken(self, name: str) -> bool:
        """Return whether a part has a name here."""
        tables = (self.bodies, self.joints, self.couplings, self.ties)
        return any(name in one for one in ({GROUND}, *tables))

    @property
    def closures(self) -> list[Joint]:
        """Joints and ties."""
        return [*self.joints.values(), *self.ties.values()]

    def refuse(self, where: str, words: str) -> ModelFileError:
        """Return the error of an element of the file."""
        return ModelFileError(f"{self.file.name}: {where + ': ' if where else ''}{words}")

    def known(self, where: str, what: str, stated: str, valid: Collection[str]) -> str:
        """Return a name of the file, which must be one of the valid ones."""
        if stated not in valid:
            raise self.refuse(
                where, f"unknown {what} {shown(stated)}; valid: {', '.join(valid) or 'none'}"
            )
        return stated

    def number(self, where: str, given: object, what: str) -> float:
        """Return a number of the file, which a machine may have."""
        try:
            return number(given)
        except (TypeError, ValueError, OverflowError):
            raise self.refuse(
                where,
                f"{what}: expected a finite number of at most {LARGEST:g}, got {shown(given)}",
            ) from None

    def numbers(self, where: str, given: object, what: str, count: int = 3) -> Array:
        """Return so many numbers of the file, from a list or from a text with blanks."""
        parts = given.split() if isinstance(given, str) else given
        if not isinstance(parts, Sequence) or len(parts) != count:
            raise self.refuse(where, f"{what}: expected {count} numbers, got {shown(given)}")
        return np.array([self.number(where, part, what) for part in parts])

    def direction(self, where: str, found: Array) -> Array:
        """Return a direction of the file, which must have a length."""
        if not np.linalg.norm(found) > SHORTEST:
            raise self.refuse(where, "expected a direction, got zero")
        return found

    def rotation(self, where: str, axes: Array) -> Array:
        """Return axes at right angles that are nearest to those of the file, without its rounding.

        Raises :class:`.ModelFileError` for axes that are off by more than 1e-4.
        """
        exact = right_angled(axes)
        off = float(np.abs(exact - axes).max())
        if off > 1e-4 or np.linalg.det(exact) < 0:
            raise self.refuse(
                where, "axes: expected three directions at right angles, right-handed"
            )
        if off > max(1e-9, self.rounded[0]):
            self.rounded = off, where
        return exact

    def name_of(self, kind: str, stated: str, where: str) -> str:
        """Return a name of the file as one that parts may have, and keep what it was."""
        name = re.sub(r"\W", "_", stated.strip(), flags=re.ASCII)
        name = name if name[:1].isalpha() else f"{kind[0]}_{name}"
        if (kind, stated) in self.named:
            raise self.refuse(where, f"{kind} {shown(stated)}: the name is taken")
        while self.taken(name):
            again = self.repeated[name] = self.repeated.get(name, 0) + 1
            name = f"{name}_{kind}{again if again > 1 else ''}"
        self.named[kind, stated] = name
        return name

    def add(self, part: type[Part], stated: str, where: str, *given: Any, **more: Any) -> str:
        """Add a body, a joint or a coupling under its name of the file; return its name here."""
        joints = self.ties if "rows" in more else self.joints
        parts: dict[type[Part], dict[str, Any]] = {Body: self.bodies, Coupling: self.couplings}
        name = self.name_of(part.__name__.lower(), stated, where)
        parts.get(part, joints)[name] = replace(part(name, *given), where=where, **more)
        return name

    def moving(self, stated: str) -> str:
        """Return the name here of a joint of the file that moves; empty for any other one."""
        joint = self.joints.get(self.named.get(("joint", stated), ""))
        return joint.name if joint is not None and joint.kind != "weld" else ""

    def follow(self, stated: str, leader: str, where: str, ratio: float, offset: float) -> None:
        """Let a joint follow another one of the file: it is held where that one is fixed, and free
        where there is none.
        """
        name, words = self.moving(stated), f"Joint {shown(stated)} follows {shown(leader)}, which"
        if name and (first := self.moving(leader)):
            self.add(Coupling, f"{stated}_mimic", where, first, name, ratio, offset)
        elif name and ("joint", leader) in self.named:
            self.motions[name] = Law(repr(offset), where=where)
            self.notes.append(f"{words} is fixed: it is held at {offset:g}.")
        elif name:
            self.notes.append(f"{words} is no joint of the file: it is free.")
        else:
            self.notes.append(f"Joint {shown(stated)} is fixed, and follows no other one.")

    def motor(self, joint: str, **numbers: float) -> bool:
        """Add numbers of a joint's drive, those that are not zero; false for a joint that has not
        one coordinate.
        """
        if len(self.joints[joint].coordinates) != 1:
            return False
        if given := {word: number for word, number in numbers.items() if number}:
            self.motors[joint] = self.motors.get(joint, {}) | given
        return True

    def load(self, text: str) -> None:
        """Add a mass at a place on the axes of a link or frame: ``FRAME=MASS`` or
        ``FRAME=MASS@(X,Y,Z)``; numbers may have units.

        Raises :class:`.DeclarationError` for any other text, :class:`.ModelFileError` for an
        unknown link or frame.
        """
        found = re.fullmatch(r"(.+?)=([^@]+)(?:@\(([^,]+),([^,]+),([^,]+)\))?", text)
        if found is None:
            raise DeclarationError(
                f"payload {shown(text)}: expected FRAME=MASS or FRAME=MASS@(X,Y,Z), as in"
                " tool0=3kg@(0,0,100mm)"
            )
        what, place = f"payload '{found[1]}'", [one or "0" for one in found.groups()[2:]]
        mass = _amount(f"{what}: mass", found[2], "kg")
        if not mass > 0.0:
            raise DeclarationError(f"{what}: mass must be positive, got {mass:g} kg")
        at = Frame(np.array([_amount(what, one, "m") for one in place]))
        on, frame = self.spot(found[1])
        at = self.frame_of(on).then(frame).then(at)
        name = self.add(Body, f"{found[1]}_payload", "", mass, frame=at, point=True)
        self.attach(name, on, "weld", "")
        self.payloads.append(name)

    def spot(self, stated: str) -> tuple[str, Frame]:
        """Return the body of a link or frame of the file, and where it is on that.

        Raises :class:`.ModelFileError` for an unknown one.
        """
        valid = {
            stated: (here, Frame()) for (kind, stated), here in self.named.items() if kind == "body"
        } | self.spots
        return valid[self.known("", "link or frame", stated, valid)]

    def base(self, body: str, where: str) -> None:
        """Attach the first body to the ground: free if the model is floating."""
        self.attach(body, GROUND, "free" if self.floating else "weld", where)

    def attach(self, body: str, parent: str, kind: str, where: str) -> None:
        """Attach a body as it is: by a ``weld``, or by a ``free`` joint."""
        near = self.frame_of(parent).relative(self.frame_of(body))
        name = f"{body}_{'fixed' if kind == 'weld' else kind}"
        self.add(Joint, name, where, kind, parent, body, near, Frame())

    def joints_on(self) -> dict[str, list[Joint]]:
        """Return the joints on each body."""
        found: dict[str, list[Joint]] = {name: [] for name in (GROUND, *self.bodies)}
        for joint in self.joints.values():
            for name in joint.ends:
                found[name].append(joint)
        return found

    @property
    def coordinates(self) -> dict[str, Joint]:
        """The joints by the full names of their coordinates."""
        return {name: joint for joint in self.joints.values() for name in joint.coordinates}

    def frame_of(self, body: str) -> Frame:
        """Return where a body is in the reference posture."""
        return Frame() if body == GROUND else self.bodies[body].frame

    def frames(self, joint: Joint) -> tuple[Frame, Frame]:
        """Return the two frames of a joint in the reference posture, on the ground."""
        parent, child = self.frame_of(joint.parent), self.frame_of(joint.child)
        return parent.then(joint.on_parent), child.then(joint.on_child)

"""The parts of a mechanism, frozen: parameters, bodies and their points, joints, loads, constraints and non-holonomic rows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from ..errors import ParameterError
from ..system.numerals import readable
from .angles import angle
from .density import Density

Expression = Any
"""A number, or a ``casadi.SX`` scalar in the mechanism's parameters."""

JointKind = Literal["revolute", "prismatic", "slot", "weld"]
End = Literal["base", "tip"]


@dataclass(frozen=True, eq=False)
class Parameter:
    """A number that may change without deriving or compiling again."""

    name: str
    default: float
    unit: str
    low: float
    high: float
    symbol: Any

    def check(self, value: float) -> None:
        """Raise :class:`ParameterError` unless ``value`` is finite and within ``[low, high]``."""
        if found := self.fault(value):
            raise ParameterError(found)

    def number(self, value: Any) -> float:
        """A value as a number; of a parameter in rad it may be a text such as ``"30 deg"``.

        Raises ``TypeError`` or ``ValueError`` for what is none.
        """
        try:
            return float(value)
        except (TypeError, ValueError):
            if self.unit != "rad":
                raise
            return angle(value)

    def fault(self, value: Any) -> str:
        """What is wrong with a value, in words; nothing where it is a finite number within ``[low, high]``."""
        try:
            number = self.number(value)
        except (TypeError, ValueError):
            unit = "" if self.unit == "1" else f" [{self.unit}]" + (", or a text such as '30 deg'" if self.unit == "rad" else "")
            return f"parameter '{self.name}' must be a number{unit}, got {value!r}"
        if not math.isfinite(number):
            return f"parameter '{self.name}' must be a finite number, got {number}"
        if not self.low <= number <= self.high:
            return (
                f"parameter '{self.name}' = {readable(number, self.low, self.high)}{'' if self.unit == '1' else ' ' + self.unit} "
                f"is out of its range [{readable(self.low, number)}, {readable(self.high, number)}]"
            )
        return ""


@dataclass(frozen=True, eq=False)
class Body:
    """Something joints attach to: the ground, a link, or a point mass."""

    name: str

    @property
    def oriented(self) -> bool:
        """Whether it has a direction of its own."""
        return True


@dataclass(frozen=True, eq=False)
class Point:
    """A place on a body, in the body's own axes [m]; ``end`` where it is the base or the tip of a link."""

    body: Body
    x: Expression
    y: Expression
    end: End | None = None


@dataclass(frozen=True, eq=False)
class Ground(Body):
    """The fixed frame."""

    def at(self, x: Expression, y: Expression) -> Point:
        """The point of the ground at (x, y) [m]."""
        return Point(self, x, y)


@dataclass(frozen=True, eq=False)
class RigidMass:
    """Mass [kg], place of the centre of mass in the link's axes [m], and moment of inertia about it [kg m^2]."""

    mass: Expression
    centre: tuple[Expression, Expression]
    inertia: Expression


@dataclass(frozen=True, eq=False)
class Link(Body):
    """A link: its axis runs from its base (station 0) to its tip (station ``length``).

    Its mass lies along the axis with a :class:`.Density`, which gives it a section law, or is known as a whole only
    (:class:`RigidMass`), and then it has none.
    """

    length: Expression
    mass: Density | RigidMass

    @property
    def base(self) -> Point:
        """The base, at station 0."""
        return Point(self, 0.0, 0.0, "base")

    @property
    def tip(self) -> Point:
        """The tip, at station ``length``."""
        return Point(self, self.length, 0.0, "tip")

    def at(self, x: Expression, y: Expression = 0.0) -> Point:
        """The place at station ``x`` along the axis and ``y`` beside it [m]."""
        return Point(self, x, y)


@dataclass(frozen=True, eq=False)
class PointMass(Body):
    """A mass at a point, without extent and so without a direction."""

    mass: Expression

    @property
    def oriented(self) -> bool:
        """It has none."""
        return False


@dataclass(frozen=True, eq=False)
class Path:
    """A point of a body whose place, velocity and acceleration are outputs, and whose motion may be given."""

    name: str
    point: Point


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between a point of its parent and a point of its child.

    - ``revolute`` holds the two points together; the coordinate is the child's direction less the parent's [rad].
    - ``prismatic`` holds the child's point on the line through the parent's point along ``axis`` (a unit vector in the parent's
      axes) and the child's direction at ``angle`` [rad] from the parent's; the coordinate is the place on the line [m].
    - ``slot`` holds the child's point on that line and leaves its direction free.
    - ``weld`` holds the points together and the child's direction at ``angle`` from the parent's; it has no coordinate.

    What slides on a line loads the line's carrier, the parent, where it is at the moment.
    """

    name: str
    kind: JointKind
    parent: Point
    child: Point
    axis: tuple[Expression, Expression] = (1.0, 0.0)
    angle: Expression = 0.0

    @property
    def bodies(self) -> tuple[Body, Body]:
        """Parent and child."""
        return self.parent.body, self.child.body

    @property
    def slides(self) -> bool:
        """Whether it holds a point on a line."""
        return self.kind in ("prismatic", "slot")

    @property
    def holds_direction(self) -> bool:
        """Whether the child's direction follows from the parent's."""
        return self.kind in ("prismatic", "weld") and self.child.body.oriented

    @property
    def coordinate(self) -> Literal["angle", "slide"] | None:
        """The kind of its coordinate; None for a weld, and for a pin at a point mass, which has no direction to measure."""
        if self.slides:
            return "slide"
        return "angle" if self.kind == "revolute" and all(body.oriented for body in self.bodies) else None


@dataclass(frozen=True, eq=False)
class Force:
    """A force [N] at a point, in ground axes, or where ``turning`` in the body's own."""

    name: str
    point: Point
    x: Expression
    y: Expression
    turning: bool

    @property
    def points(self) -> tuple[Point, ...]:
        """Where it acts."""
        return (self.point,)


@dataclass(frozen=True, eq=False)
class Torque:
    """A torque [N m] on a body at a point, and the opposite on another one, or on the ground."""

    name: str
    point: Point
    value: Expression
    against: Point

    @property
    def points(self) -> tuple[Point, ...]:
        """Where it acts, first the point it is for."""
        return (self.point, self.against)


@dataclass(frozen=True, eq=False)
class Spring:
    """A spring and damper between two points: its tension is stiffness (distance - length) + damping (distance)'."""

    name: str
    first: Point
    second: Point
    stiffness: Expression
    length: Expression
    damping: Expression

    @property
    def points(self) -> tuple[Point, ...]:
        """Its ends."""
        return (self.first, self.second)


@dataclass(frozen=True, eq=False)
class LineLoad:
    """A load [N/m] along the whole axis of a link, linear from its base to its tip: ``x`` and ``y`` there and there.

    In ground axes, or where ``turning`` in the link's own.
    """

    name: str
    link: Link
    x: tuple[Expression, Expression]
    y: tuple[Expression, Expression]
    turning: bool

    @property
    def points(self) -> tuple[Point, ...]:
        """Where its resultant is told: the middle of the link."""
        return (self.link.at(self.link.length / 2),)

    @property
    def matter(self) -> Expression:
        """The mass of the link per length [kg/m], which is the same all along it."""
        assert isinstance(self.link.mass, Density)
        mass = self.link.mass.cells[0][0]
        return mass if self.link.mass.per_length else mass / self.link.length


Load = Force | Torque | Spring | LineLoad


@dataclass(frozen=True, eq=False)
class Constraint:
    """Phi(q, t) = 0 in joint coordinates (paper eq. 5)."""

    name: str
    phi: Any


@dataclass(frozen=True, eq=False)
class Row:
    """A non-holonomic row A(q) q' + b = 0 in joint coordinates and rates (paper eq. 3), in place of one drive's effort."""

    name: str
    expression: Any
    replaces: str

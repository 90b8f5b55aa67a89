"""The declaration of a mechanism: its parameters, links, point masses, joints and gravity.

A :class:`Mechanism` is filled part by part and freezes when a scene is made of it. The parts are frozen; what a number can
tell is checked when the part is declared, what depends on the whole when the mechanism freezes, and what depends on the
parameters' values by :meth:`Mechanism.values`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import casadi as ca

from .errors import DeclarationError, ParameterError, UnknownNameError

Expression = Any
"""A number, or a ``casadi.SX`` scalar in the mechanism's parameters."""

JointKind = Literal["revolute", "prismatic"]
End = Literal["base", "tip"]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_RESERVED_ENDINGS = ("_rate", "_acceleration")
_GROUND = "ground"


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
        if not math.isfinite(value):
            raise ParameterError(f"parameter '{self.name}' must be a finite number, got {value}")
        if not self.low <= value <= self.high:
            raise ParameterError(
                f"parameter '{self.name}' = {value:.17g} {self.unit} is out of its range [{self.low:.17g}, {self.high:.17g}]"
            )


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
class Link(Body):
    """A straight uniform rod: its axis runs from its base (station 0) to its tip (station ``length``)."""

    length: Expression
    mass: Expression

    @property
    def base(self) -> Point:
        """The base, at station 0."""
        return Point(self, 0.0, 0.0, "base")

    @property
    def tip(self) -> Point:
        """The tip, at station ``length``."""
        return Point(self, self.length, 0.0, "tip")

    def at(self, x: Expression, y: Expression = 0.0) -> Point:
        """A place at ``x`` along the axis and ``y`` beside it [m]; a link with a joint there has no section law."""
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
class Joint:
    """A joint between a point of its parent and a point of its child.

    A revolute joint holds the two points together; its coordinate is the child's direction less the parent's [rad]. A
    prismatic joint holds the child's point on the line through the parent's point along ``axis`` (a unit vector in the
    parent's axes) and the child's direction at ``angle`` [rad] from the parent's; its coordinate is the place on the line [m].
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
    def constraints(self) -> int:
        """How many relative motions the joint takes away."""
        return 2 if self.kind == "revolute" or self.child.body.oriented else 1

    @property
    def holds_direction(self) -> bool:
        """Whether the child's direction follows from the parent's."""
        return self.kind == "prismatic" and self.child.body.oriented

    @property
    def coordinate(self) -> Literal["angle", "slide"] | None:
        """The kind of its coordinate; None for a pin at a point mass, which has no direction to measure."""
        if self.kind == "prismatic":
            return "slide"
        return "angle" if all(body.oriented for body in self.bodies) else None

    @property
    def reaction_members(self) -> tuple[str, ...]:
        """What its reaction consists of."""
        return ("fx", "fy", "mz") if self.holds_direction else ("fx", "fy")


@dataclass
class Mechanism:
    """A planar mechanism under declaration: links and point masses in the x-y plane, joined to each other and to the ground.

    Gravity is (0, -9.81) m/s^2 unless :meth:`set_gravity` says otherwise. Lengths, masses, places and gravity may be numbers or
    expressions in the symbols that :meth:`parameter` returns.
    """

    name: str
    parameters: dict[str, Parameter] = field(default_factory=dict, init=False)
    bodies: dict[str, Body] = field(default_factory=dict, init=False)
    joints: dict[str, Joint] = field(default_factory=dict, init=False)
    gravity: tuple[Expression, Expression] = field(default=(0.0, -9.81), init=False)
    frozen: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        _check_name("mechanism", self.name)
        self.bodies[_GROUND] = Ground(_GROUND)

    @property
    def ground(self) -> Ground:
        """The fixed frame; ``ground.at(x, y)`` is a point of it, ``ground`` itself its origin."""
        ground = self.bodies[_GROUND]
        assert isinstance(ground, Ground)
        return ground

    @property
    def moving(self) -> tuple[Link | PointMass, ...]:
        """The links and point masses, in the order of declaration."""
        return tuple(body for body in self.bodies.values() if isinstance(body, Link | PointMass))

    @property
    def links(self) -> dict[str, Link]:
        """The links by name."""
        return {name: body for name, body in self.bodies.items() if isinstance(body, Link)}

    def parameter(self, name: str, default: float, unit: str = "1", *, low: float = -math.inf, high: float = math.inf) -> Any:
        """Declare a parameter and return its symbol, a ``casadi.SX`` scalar to build lengths, masses and places from."""
        self._add("parameter", name, self.parameters)
        parameter = Parameter(name, float(default), unit, float(low), float(high), ca.SX.sym(name))
        parameter.check(parameter.default)
        self.parameters[name] = parameter
        return parameter.symbol

    def link(self, name: str, *, length: Expression, mass: Expression) -> Link:
        """Declare a uniform rod of the given length [m] and mass [kg]."""
        self._add("link", name, self.bodies)
        link = Link(name, self._expression(f"link '{name}': length", length), self._expression(f"link '{name}': mass", mass))
        self.bodies[name] = link
        return link

    def point_mass(self, name: str, mass: Expression) -> PointMass:
        """Declare a mass [kg] without extent."""
        self._add("point mass", name, self.bodies)
        body = PointMass(name, self._expression(f"point mass '{name}': mass", mass))
        self.bodies[name] = body
        return body

    def revolute(self, name: str, parent: Body | Point, child: Body | Point) -> Joint:
        """Pin a point of ``child`` to a point of ``parent``; a link stands for its base, the ground for its origin."""
        return self._joint(Joint(name, "revolute", self._point(name, parent), self._point(name, child)))

    def prismatic(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: tuple[Expression, Expression],
        angle: Expression = 0.0,
    ) -> Joint:
        """Let a point of ``child`` slide along ``axis`` (in the parent's axes) through a point of ``parent``.

        ``angle`` [rad] is the child's direction against the parent's. The parent carries the axis, so it must have a direction.
        """
        start = self._point(name, parent)
        if not start.body.oriented:
            raise DeclarationError(
                f"joint '{name}': its parent '{start.body.name}' is a point mass and has no direction to carry the axis; "
                "make the other body the parent"
            )
        direction = (self._expression(f"joint '{name}': axis", axis[0]), self._expression(f"joint '{name}': axis", axis[1]))
        norm = ca.sqrt(ca.sumsqr(ca.vertcat(*direction))) if ca.SX in map(type, direction) else math.hypot(*direction)
        if isinstance(norm, float) and norm == 0.0:
            raise DeclarationError(f"joint '{name}': axis must not be (0, 0)")
        unit = (direction[0] / norm, direction[1] / norm)
        return self._joint(
            Joint(name, "prismatic", start, self._point(name, child), unit, self._expression(f"joint '{name}': angle", angle))
        )

    def set_gravity(self, x: Expression, y: Expression) -> None:
        """Set the acceleration of gravity [m/s^2], in ground axes."""
        self._check_open("set gravity")
        self.gravity = (self._expression("gravity", x), self._expression("gravity", y))

    def freeze(self) -> None:
        """Check the whole and end the declaration. Raises :class:`DeclarationError` for a part that hangs on nothing."""
        if not self.moving:
            raise DeclarationError(f"mechanism '{self.name}' has no link and no point mass")
        reached = {_GROUND}
        while new := {
            body.name
            for joint in self.joints.values()
            for body in joint.bodies
            if body.name not in reached and reached & {other.name for other in joint.bodies}
        }:
            reached |= new
        loose = [body.name for body in self.moving if body.name not in reached]
        if loose:
            raise DeclarationError(
                f"mechanism '{self.name}': {_quoted(loose)} not connected to the ground by any chain of joints; "
                f"joints declared: {', '.join(self.joints) or 'none'}"
            )
        self.frozen = True

    def values(self, overrides: Mapping[str, float] | None = None) -> dict[str, float]:
        """Every parameter's value, the defaults overridden, checked against the ranges and against what the parts allow.

        Raises :class:`UnknownNameError` for a name that is no parameter's, :class:`ParameterError` for a value that is not
        finite or out of range, a length that is not positive, a negative mass, or a mechanism without any mass.
        """
        overrides = dict(overrides or {})
        for name in overrides:
            if name not in self.parameters:
                raise UnknownNameError("parameter", name, self.parameters)
        values = {name: float(overrides.get(name, parameter.default)) for name, parameter in self.parameters.items()}
        for name, value in values.items():
            self.parameters[name].check(value)
        total = 0.0
        for body in self.moving:
            mass = self.number(body.mass, values)
            kind = "link" if isinstance(body, Link) else "point mass"
            if not (mass >= 0.0 and math.isfinite(mass)):
                raise ParameterError(f"{kind} '{body.name}': mass must not be negative, got {mass:.17g} kg")
            total += mass
            if isinstance(body, Link):
                length = self.number(body.length, values)
                if not (length > 0.0 and math.isfinite(length)):
                    raise ParameterError(f"link '{body.name}': length must be positive, got {length:.17g} m")
        if total == 0.0:
            raise ParameterError(f"mechanism '{self.name}' is massless: at least one link or point mass needs a mass")
        return values

    def number(self, expression: Expression, values: Mapping[str, float]) -> float:
        """The value of an expression in the parameters."""
        symbols = [parameter.symbol for parameter in self.parameters.values()]
        numbers = [values[name] for name in self.parameters]
        return float(ca.evalf(ca.substitute(ca.SX(expression), ca.vertcat(*symbols), ca.vertcat(ca.SX(0, 1), *numbers))))

    @property
    def symbols(self) -> Any:
        """The parameters' symbols as one column, in the order of declaration."""
        return ca.vertcat(ca.SX(0, 1), *(parameter.symbol for parameter in self.parameters.values()))

    def _joint(self, joint: Joint) -> Joint:
        self._add("joint", joint.name, self.joints)
        if joint.name.endswith(_RESERVED_ENDINGS):
            raise DeclarationError(f"joint '{joint.name}': names ending in {' or '.join(_RESERVED_ENDINGS)} are taken")
        parent, child = joint.bodies
        if parent is child:
            raise DeclarationError(f"joint '{joint.name}' joins '{parent.name}' to itself")
        self.joints[joint.name] = joint
        return joint

    def _point(self, joint: str, place: Body | Point) -> Point:
        if isinstance(place, Link):
            point = place.base
        elif isinstance(place, Body):
            point = Point(place, 0.0, 0.0)
        elif isinstance(place, Point):
            point = place
        else:
            raise DeclarationError(f"joint '{joint}': expected a link, a point mass, the ground or a point of one, got {place!r}")
        if self.bodies.get(point.body.name) is not point.body:
            raise DeclarationError(f"joint '{joint}': '{point.body.name}' is of another mechanism than '{self.name}'")
        what = f"joint '{joint}': place on '{point.body.name}'"
        return Point(point.body, self._expression(what, point.x), self._expression(what, point.y), point.end)

    def _expression(self, what: str, value: Expression) -> Expression:
        """A finite float, or an SX scalar in this mechanism's parameters."""
        if isinstance(value, ca.SX):
            if value.numel() != 1:
                raise DeclarationError(f"{what} must be a scalar, got one of shape {value.shape}")
            own = {parameter.symbol.element_hash() for parameter in self.parameters.values()}
            foreign = [str(symbol) for symbol in ca.symvar(value) if symbol.element_hash() not in own]
            if foreign:
                raise DeclarationError(f"{what} depends on {_quoted(foreign)}, not a parameter of mechanism '{self.name}'")
            return value
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise DeclarationError(f"{what} must be a number or an expression in parameters, got {value!r}") from None
        if not math.isfinite(number):
            raise DeclarationError(f"{what} must be finite, got {number}")
        return number

    def _add(self, kind: str, name: str, table: Mapping[str, object]) -> None:
        self._check_open(f"add {kind} '{name}'")
        _check_name(kind, name)
        if name in table:
            raise DeclarationError(f"{kind} '{name}' is declared twice in mechanism '{self.name}'")

    def _check_open(self, what: str) -> None:
        if self.frozen:
            raise DeclarationError(f"cannot {what}: mechanism '{self.name}' is frozen, a scene has been made of it")


def _check_name(kind: str, name: str) -> None:
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise DeclarationError(f"{kind} name {name!r} must be a letter followed by letters, digits or underscores")


def _quoted(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names) + (" is" if len(names) == 1 else " are")

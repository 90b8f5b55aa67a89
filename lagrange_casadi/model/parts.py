"""The parts of a mechanism, frozen: parameters, bodies and their points, loads, constraints and
non-holonomic rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from ..base.arguments import Symbolic, public
from ..base.brief import Brief
from ..base.numerals import readable
from ..base.units import Number, in_words, number
from ..base.vectors import Expression as Expression
from ..base.vectors import Vector as Vector
from ..errors import NumberError, ParameterError, shown
from .beams.beam import Beam
from .density import Density

if TYPE_CHECKING:
    import casadi as ca

if TYPE_CHECKING:
    from .joints import Axis, Joint
    from .meshes import Transmission

End = Literal["base", "tip"]

Outline: TypeAlias = list[tuple[Expression, Expression]]
"""Corners of what a body is drawn as, in its own axes [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Parameter(Brief):
    """A number that may change without deriving or compiling again."""

    name: str
    default: float
    unit: str
    low: float
    high: float
    symbol: ca.SX

    def check(self, value: Number) -> None:
        """Raise :class:`ParameterError` unless ``value`` is finite and within ``[low, high]``."""
        if found := self.fault(value):
            raise ParameterError(found)

    def number(self, value: Number) -> float:
        """A value as a number, see :func:`.units.number`.

        Raises :class:`.NumberError` for what is none; it may be infinite.
        """
        return number(value, self.unit, finite=False)

    def fault(self, value: Number) -> str:
        """Describe the fault of a value; empty if it is a finite number within ``[low, high]``."""
        try:
            found = self.number(value)
        except NumberError:
            return f"parameter '{self.name}' must be a {in_words(self.unit)}, got {shown(value)}"
        if not math.isfinite(found):
            return f"parameter '{self.name}' must be a finite number, got {found}"
        if not self.low <= found <= self.high:
            unit = "" if self.unit == "1" else " " + self.unit
            return (
                f"parameter '{self.name}' = {readable(found, self.low, self.high)}{unit}"
                f" is out of its range [{readable(self.low, found)}, {readable(self.high, found)}]"
            )
        return ""


@dataclass(frozen=True, eq=False, repr=False)
class Body(Brief):
    """Something joints attach to: the ground, a link, or a point mass."""

    name: str

    @property
    def oriented(self) -> bool:
        """True if it has a direction of its own."""
        return True


@dataclass(frozen=True, eq=False, repr=False)
class Point(Brief):
    """A place on a body, in the body's own axes [m]; ``end`` where it is the base or the tip of a
    link.
    """

    body: Body
    x: Expression
    y: Expression
    end: End | None = None
    z: Expression = 0.0

    @property
    def place(self) -> Vector:
        """All three numbers."""
        return self.x, self.y, self.z


@dataclass(frozen=True, eq=False, repr=False)
class Roller(Brief):
    """A roller that pictures show: its centre, and its radius [m]."""

    centre: Point
    radius: Expression


@public
@dataclass(frozen=True, eq=False, repr=False)
class Ground(Body):
    """The fixed frame."""

    def at(self, x: Symbolic, y: Symbolic, z: Symbolic = 0.0) -> Point:
        """The point of the ground at (x, y), in space (x, y, z) [m]."""
        return Point(self, x, y, z=z)


@dataclass(frozen=True, eq=False, repr=False)
class RigidMass(Brief):
    """Mass [kg], place of the centre of mass in the link's axes [m], and moments of inertia about
    it [kg m^2]: a matrix, three rows of three, on the link's axes.

    In a plane only that about z is known, and the others are zero. In space they are those of some
    body, unless they are ``accepted`` as they are.
    """

    mass: Expression
    centre: Vector
    inertia: tuple[Vector, Vector, Vector]
    accepted: bool = False


@public
@dataclass(frozen=True, eq=False, repr=False)
class Link(Body):
    """A link: its axis runs from its base (station 0) to its tip (station ``length``).

    Its mass lies along the axis with a :class:`.Density`, which gives it a section law, or is known
    as a whole only (:class:`RigidMass`), and then it has none. ``beam`` says what it is made of,
    where that is known. ``beside`` is the direction that was declared for its y axis in space, of
    length 1 and in ground axes.
    """

    length: Expression
    mass: Density | RigidMass
    beam: Beam | None = None
    beside: Vector | None = None

    @property
    def base(self) -> Point:
        """The base, at station 0."""
        return Point(self, 0.0, 0.0, "base")

    @property
    def tip(self) -> Point:
        """The tip, at station ``length``."""
        return Point(self, self.length, 0.0, "tip")

    def at(self, x: Symbolic, y: Symbolic = 0.0, z: Symbolic = 0.0) -> Point:
        """The place at station ``x`` along the axis and ``y``, in space
        ``z`` too, beside it [m].
        """
        return Point(self, x, y, z=z)


@dataclass(frozen=True, eq=False, repr=False)
class PointMass(Body):
    """A mass at a point, without extent and so without a direction."""

    mass: Expression

    @property
    def oriented(self) -> bool:
        """False: it has none."""
        return False


@dataclass(frozen=True, eq=False, repr=False)
class Path(Brief):
    """A point of a body whose place, velocity and acceleration are outputs, and whose motion may be
    given.
    """

    name: str
    point: Point


@dataclass(frozen=True, eq=False, repr=False)
class Force(Brief):
    """A force with three components [N] at a point, in ground axes, or where ``turning`` in the
    body's own; in a plane the third is zero.
    """

    name: str
    point: Point
    components: Vector
    turning: bool

    @property
    def points(self) -> tuple[Point, ...]:
        """Place where it acts."""
        return (self.point,)


@dataclass(frozen=True, eq=False, repr=False)
class Torque(Brief):
    """A torque with three components [N m] on a body at a point, and the opposite on another one,
    or on the ground; in ground axes, or where ``turning`` in the body's own.

    In a plane the first two are zero.
    """

    name: str
    point: Point
    components: Vector
    against: Point
    turning: bool

    @property
    def points(self) -> tuple[Point, ...]:
        """Places where it acts, first the point it is for."""
        return (self.point, self.against)


@dataclass(frozen=True, eq=False, repr=False)
class Spring(Brief):
    """A spring and damper between two points: its tension is stiffness (distance - length) +
    damping (distance)'.
    """

    name: str
    first: Point
    second: Point
    stiffness: Expression
    length: Expression
    damping: Expression

    @property
    def points(self) -> tuple[Point, ...]:
        """End points."""
        return (self.first, self.second)


@dataclass(frozen=True, eq=False, repr=False)
class LineLoad(Brief):
    """A load [N/m] along a link, ``between`` two distances from its base [m]: a polynomial of the
    place.

    ``x``, ``y``, ``z`` are coefficients of rising powers of (end - xi)/(end - start), as many of
    each: where it ends the first of them acts, where it begins their sum. In ground axes, or where
    ``turning`` in the link's own.
    """

    name: str
    link: Link
    between: tuple[Expression, Expression]
    x: tuple[Expression, ...]
    y: tuple[Expression, ...]
    z: tuple[Expression, ...]
    turning: bool

    @property
    def whole(self) -> bool:
        """True if it acts from the base to the tip."""
        start, end = self.between
        return isinstance(start, float) and start == 0.0 and end is self.link.length

    @property
    def reach(self) -> Expression:
        """The length of the part on which it acts [m]."""
        return self.link.length if self.whole else self.between[1] - self.between[0]

    @property
    def width(self) -> Expression:
        """The length of the part on which it acts, as a ratio to that of the link."""
        return 1.0 if self.whole else self.reach / self.link.length

    @property
    def end(self) -> Expression:
        """End, as a ratio xi/l."""
        return 1.0 if self.whole else self.between[1] / self.link.length

    @property
    def points(self) -> tuple[Point, ...]:
        """Place of its resultant: the middle of the part on which it acts."""
        start, end = self.between
        return (self.link.at(end / 2 if self.whole else (start + end) / 2),)


POSITIVE = ("radius", "length", "stribeck", "smooth")
"""Numbers of a friction that must not be zero."""


@dataclass(frozen=True, eq=False, repr=False)
class Friction(Brief):
    """Friction in a joint along a coordinate of its, that follows what the joint bears; ``symbol``
    stands for it until it is found.

    With the rate v of the coordinate and sigma its sign, or tanh(v/``smooth``), the force or couple
    along the coordinate is::

        -sigma mu radius |R| - viscous v                    in a pin that bears the force R, -sigma
        mu (|N/2 + M/length| + |N/2 - M/length|) - viscous v   in a guide that bears N across its
        line and the moment M.

    A spherical joint rubs as a pin about the axis about which its child turns on its parent at the
    moment: v is the size of their relative angular velocity, which is never negative.

    ``static`` is the coefficient where sliding starts: mu + (static - mu) exp(-(speed/stribeck)^2),
    by the speed of sliding [m/s]. In a joint that slides and turns at once, ``beside`` is its other
    coordinate: sigma is then the share of the speed of sliding that is along this one.
    """

    name: str
    joint: Joint
    axis: Axis
    symbol: ca.SX
    mu: Expression = 0.0
    radius: Expression | None = None
    length: Expression | None = None
    viscous: Expression = 0.0
    static: Expression | None = None
    stribeck: Expression | None = None
    smooth: Expression | None = None
    beside: Axis | None = None

    @property
    def points(self) -> tuple[Point, ...]:
        """Places where it acts: on the joint's child, and back on its parent."""
        return (self.joint.child, self.joint.parent)

    @property
    def numbers(self) -> dict[str, Expression]:
        """Numbers of the friction, by the keywords of its declaration."""
        words = ("mu", "radius", "length", "viscous", "static", "stribeck", "smooth")
        return {word: getattr(self, word) for word in words if getattr(self, word) is not None}

    @property
    def every_way(self) -> bool:
        """True if it acts against any turning of the joint, and not along a coordinate."""
        return self.joint.kind == "spherical"

    @property
    def dry(self) -> bool:
        """True if it depends on the joint's reaction."""
        return not (isinstance(self.mu, float) and self.mu == 0.0 and self.static is None)


Load: TypeAlias = Force | Torque | Spring | LineLoad | Friction


@dataclass(frozen=True, eq=False, repr=False)
class Constraint(Brief):
    """Phi(q, t) = 0 in joint coordinates (paper eq. 5).

    The multiplier of a ``transmission`` acts where its parts touch.

    Phi is differentiated twice, so its slopes must not jump; of a cam those of its ``lift`` alone,
    at the cam's angle: off the contact those of phi may jump as the normal turns, on it that counts
    for nothing.
    """

    name: str
    phi: ca.SX
    transmission: Transmission | None = None
    lift: ca.SX | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Row(Brief):
    """A non-holonomic row A(q) q' + b = 0 in joint coordinates and rates (paper eq. 3),
    in place of one drive's effort.
    """

    name: str
    expression: ca.SX
    replaces: str

"""The parts of a mechanism, frozen: parameters, bodies and their points, paths, and outputs of the
user's own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, NoReturn, TypeAlias, TypeVar

import casadi as ca

from ..base.arguments import Symbolic, public
from ..base.brief import Brief
from ..base.numerals import readable
from ..base.quantities import Output
from ..base.units import Number, number
from ..base.vectors import ZERO
from ..base.vectors import Expression as Expression
from ..base.vectors import Vector as Vector
from ..errors import NumberError, ParameterError, UnknownNameError
from .beams.beam import Beam
from .link_density import Density

Value = TypeVar("Value")

End = Literal["base", "tip"]

Outline: TypeAlias = list[tuple[Expression, Expression]]
"""Corners of what a body is drawn as, in its own axes [m]."""


class Named(dict[str, Value]):
    """Parts of a ``kind`` by their names.

    Raises :class:`.UnknownNameError`, a ``KeyError``, for a name that none of them has.
    """

    def __init__(self, kind: str, parts: Mapping[str, Value] = {}) -> None:
        super().__init__(parts)
        self.kind = kind

    def __missing__(self, name: str) -> NoReturn:
        raise UnknownNameError(self.kind, name, self)


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
        except NumberError as error:
            return f"parameter '{self.name}': {error}"
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

    oriented: ClassVar[bool] = True
    """True if it has a direction of its own."""


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

    @property
    def on_body(self) -> Place:
        """The place by the name of the body."""
        return Place(self.body.name, self.place)


@dataclass(frozen=True)
class Place:
    """A place on a body by its name, in the body's axes [m]."""

    body: str
    at: Vector


@dataclass(frozen=True)
class Roller:
    """A roller that pictures show: its centre, and its radius [m]."""

    centre: Place
    radius: Expression


@dataclass(frozen=True)
class PitchCircles:
    """The pitch circles that pictures show, of two gears or of a ``belt``: their centres and axes
    in the axes of the ``carrier``, and their radii [m].

    A ``rack`` has no second circle, but a place on its pitch line, which is along the second axis.
    """

    carrier: str
    centres: tuple[Vector, Vector]
    axes: tuple[Vector, Vector]
    radii: tuple[Expression, Expression]
    belt: bool = False
    crossed: bool = False
    rack: Place | None = None


@dataclass(frozen=True)
class Track:
    """The groove of a drum that pictures show: the way of its roller's centre, a closed polygon in
    the drum's axes, and the drum's ``axis`` through its ``centre``; the roller is ``held`` on its
    follower, and has a ``radius`` [m].
    """

    centre: Place
    axis: Vector
    way: tuple[Vector, ...]
    held: Place
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
    centre: Vector = ZERO
    inertia: tuple[Vector, Vector, Vector] = (ZERO,) * 3
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

    oriented: ClassVar[bool] = False


@dataclass(frozen=True, eq=False, repr=False)
class Path(Brief):
    """A point of a body whose place, velocity and acceleration are outputs, and whose motion may be
    given.
    """

    name: str
    point: Point


@dataclass(frozen=True, eq=False)
class Asked:
    """A result that an output is made of, and the symbol that stands for it; of a section force the
    ratio xi/l.

    A ``passive`` effort is zero if the joint is not a drive; any other is refused.
    """

    output: Output
    symbol: ca.SX
    ratio: Expression | None = None
    passive: bool = False

    @property
    def wanted(self) -> str:
        """Outputs that must be wanted for it."""
        return (
            "effort" if self.output.group == "effort" else f"{self.output.group}:{self.output.part}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class UserOutput(Brief):
    """An output of the user's own: an expression of time, parameters, measures and results, and its
    unit.
    """

    name: str
    expression: ca.SX
    unit: str
    made_of: tuple[Asked, ...]

"""Loads on a mechanism, frozen: forces, torques, springs, loads along a link, and friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import casadi as ca

from ..base.brief import Brief
from .declared_parts import Expression, Link, Point, Vector
from .joints import Axis, Joint


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

    In a plane the first two are zero. ``coiled`` says that a torsion spring makes it.
    """

    name: str
    point: Point
    components: Vector
    against: Point
    turning: bool
    coiled: bool = False

    @property
    def points(self) -> tuple[Point, ...]:
        """Places where it acts, first the point it is for."""
        return (self.point, self.against)


@dataclass(frozen=True, eq=False, repr=False)
class Spring(Brief):
    """A spring and damper between two points: its tension is stiffness (distance - length) +
    damping (distance)'.

    That of a gas spring has the distance at which it is ``closed`` [m], by which pictures show it.
    """

    name: str
    first: Point
    second: Point
    stiffness: Expression
    length: Expression
    damping: Expression
    closed: Expression | None = None

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
        return self.between[1] - self.between[0]

    @property
    def width(self) -> Expression:
        """The length of the part on which it acts, as a ratio to that of the link."""
        return self.reach / self.link.length

    @property
    def end(self) -> Expression:
        """End, as a ratio xi/l."""
        return self.between[1] / self.link.length

    @property
    def points(self) -> tuple[Point, ...]:
        """Place of its resultant: the middle of the part on which it acts."""
        start, end = self.between
        return (self.link.at((start + end) / 2),)


POSITIVE = ("radius", "length", "stribeck", "smooth", "effort", "speed")
"""Numbers of frictions and drives that must not be zero."""


@dataclass(frozen=True, eq=False, repr=False)
class Friction(Brief):
    """Friction in a joint along a coordinate of its, that follows what the joint bears; ``symbol``
    stands for it until it is found.

    With the rate v of the coordinate and sigma its sign, or tanh(v/``smooth``), the force or couple
    along the coordinate is::

        -sigma mu radius |R| - viscous v                    in a pin that bears the force R, -sigma
        mu (|N/2 + M/length| + |N/2 - M/length|) - viscous v   in a guide that bears N across its
        line and the moment M.

    With ``coulomb`` it is -sigma coulomb - viscous v, whatever the joint bears.

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
    coulomb: Expression | None = None
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
        words = ("mu", "coulomb", "radius", "length", "viscous", "static", "stribeck", "smooth")
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

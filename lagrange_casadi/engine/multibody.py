"""A mechanism as graphs: kinetic energy over velocities, forces that do work along them, loop
equations, extra mobilities.

Every undriven pin on the tree takes the *absolute* direction of the body that hangs on it for its
coordinate, which keeps the energy of a chain short. A driven pin takes the angle between its two
bodies, on which its effort works. Where drives alone set the direction of a body, its cosine and
sine are taken of the sum of the drives' angles: a sum costs fewer instructions than a product of
rotations.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame, Velocities
from ..base.scalars import column
from ..base.vectors import AXES, ZERO, dot
from ..errors import DeclarationError
from ..model.constraints import Row
from ..model.declared_parts import Point, Vector
from ..model.joints import Axis, Joint
from ..model.limits import APART
from ..model.mechanism import Mechanism
from .joint_closure import apart, slide_motion, turned, turning
from .lagrange import LagrangeSystem
from .spherical import SphericalCoordinates
from .three_rotations import ThreeRotations
from .tree import Tree
from .two_force_links import TwoForceLink


@dataclass(frozen=True, eq=False)
class Coordinate:
    """A coordinate of the tree: its name, the body it places, the axis of a joint along which it
    does, and its symbols.

    ``variables`` is what graphs are written in: (cosine, sine, angle) or the slide itself, the
    value last; ``change`` their rates. Cosine and sine are those of ``turn``, an expression in
    coordinates: the direction of the body, or a turn about the axis alone (``relative``).

    ``size`` is what a slide is large beside: all links end to end, at their defaults [m].

    Of a ``ball`` there are three coordinates, by the names of its joint's turns: each has one of
    the body's axes for its variables, and for its rate the angular velocity's component on it,
    which is the rate of nothing.
    """

    name: str
    body: str
    axis: Axis
    driven: bool
    variables: ca.SX
    change: ca.SX
    rate: ca.SX
    acceleration: ca.SX
    turn: Any = None
    relative: bool = False
    spherical: SphericalCoordinates | None = None
    size: float = 1.0

    @property
    def kind(self) -> Literal["angle", "slide", "ball"]:
        """Kind of the coordinate."""
        return "ball" if self.spherical is not None else self.axis.kind

    @property
    def resting(self) -> tuple[float, ...]:
        """Variables at zero."""
        if self.spherical is not None:
            freedoms = self.spherical.joint.freedoms
            turns = [freedom.name for freedom in freedoms if freedom.move == "turn"]
            return AXES[turns.index(self.axis.name)]
        return (1.0, 0.0, 0.0) if self.kind == "angle" else (0.0,)

    @property
    def value(self) -> ca.SX:
        """The symbol of the coordinate itself."""
        return self.variables[-1]

    @property
    def posture_key(self) -> str:
        """Name in a posture if it is not driven: the link whose direction it is, or its own."""
        return self.body if self.kind == "angle" and not self.relative else self.name

    @property
    def by_values(self) -> Expression:
        """Variables over coordinates: over its own value, and those of others in its ``turn``."""
        if self.kind == "slide":
            return self.value
        return ca.vertcat(ca.cos(self.turn), ca.sin(self.turn), self.value)

    def placed(self, value: ca.SX) -> Expression:
        """Variables for a value of the coordinate."""
        return ca.substitute(self.by_values, self.value, value)

    @cached_property
    def keys(self) -> tuple[int, ...]:
        """Names of the variables, of their rates and of their accelerations."""
        return tuple(
            symbol.element_hash()
            for symbol in ca.vertsplit(ca.vertcat(self.variables, self.rate, self.acceleration))
        )


@dataclass(frozen=True, eq=False)
class LoopEquations:
    """Equations that a joint that closes a loop, or a constraint, puts on the coordinates.

    ``residual`` is Phi, followed by its total time derivatives. ``joint`` is None for a
    ``two_force_link``, which has a length, and for a user's constraint. ``counted`` are the
    quantities that a constraint with kinks depends on.
    """

    name: str
    joint: Joint | None
    residual: Any
    residual_rate: Any
    residual_acceleration: Any
    two_force_link: TwoForceLink | None = None
    counted: Any = None

    @cached_property
    def multipliers(self) -> ca.SX:
        """The symbols of its multipliers."""
        return ca.SX.sym(f"lambda_{self.name}", self.residual.numel())

    @property
    def kind(self) -> str:
        """Kind of the part, in a word."""
        return "joint" if self.joint else "two-force link" if self.two_force_link else "constraint"

    @property
    def declared(self) -> bool:
        """True if it is a constraint of the user's."""
        return self.joint is None and self.two_force_link is None


@dataclass(frozen=True, eq=False)
class Applied:
    """Action of a load, or of the multiplier of a constraint or row, at a point of a body, as
    expressions of the state.

    Force [N] and couple [N m] are in ground axes; ``source`` names the load, constraint or row. Of
    a load that is ``distributed`` along a link they are the resultant; ``distributed`` are then its
    coefficients on the link's axes [N/m], as those of a :class:`.LineLoad`.
    """

    source: str
    point: Point
    force: Vector = ZERO
    couple: Vector = ZERO
    distributed: tuple[Vector, ...] | None = None


@dataclass(frozen=True, eq=False)
class Turned:
    """An angle that loads and rows see, of an undriven joint or a link, by its name; ``symbol``
    stands for it in their expressions.

    ``angle`` is known up to whole turns where loops set it.
    """

    name: str
    symbol: Any
    cosine: Any
    sine: Any
    angle: Any

    @property
    def within(self) -> Expression:
        """The angle between -pi and pi."""
        return ca.atan2(self.sine, self.cosine)


@dataclass(frozen=True, eq=False)
class RowGraph:
    """A non-holonomic row: its expression at rest, the sum of the sizes of its terms, and its
    multiplier's symbol.
    """

    row: Row
    residual: Any
    size: Any
    multipliers: Any


@dataclass(frozen=True, eq=False)
class Multibody:
    """The graphs of a mechanism, over the symbols of its coordinates, mobilities, multipliers and
    time.

    The mobilities are in ground axes, those of the joints in ``own_axes`` in the axes of the body
    that hangs on the joint. ``frames`` are without mobilities; ``accelerated`` are with them, and
    their accelerations are less that of gravity. ``efforts`` are the symbols
    of efforts along other coordinates than those whose motion is given, and ``along`` what a unit
    of effort does to a joint's child, in ground axes, both by coordinate; ``axes`` are the
    directions in ground axes about which turns relative to a body turn, by coordinate;
    ``user_outputs`` are the user's outputs, in symbols of results too. ``strokes`` are the
    shares of strokes that are out, by the parts in words.
    """

    mechanism: Mechanism
    tree: Tree
    coordinates: tuple[Coordinate, ...]
    loop_equations: tuple[LoopEquations, ...]
    rows: tuple[RowGraph, ...]
    mobilities: dict[str, Any]
    own_axes: frozenset[str]
    frames: dict[str, Frame]
    accelerated: dict[str, Frame]
    applied: tuple[Applied, ...]
    held: tuple[Applied, ...]
    turned: tuple[Turned, ...]
    efforts: dict[str, Any]
    along: dict[str, Vector]
    axes: dict[str, Vector]
    user_outputs: dict[str, Any]
    strokes: dict[str, Any]
    kinetic: Any
    velocities: Velocities

    @property
    def slack(self) -> float:
        """The largest slope or coefficient that may come of the rounding of axes and places."""
        return APART * self.mechanism.rounding

    @property
    def sphericals(self) -> tuple[SphericalCoordinates, ...]:
        """The balls among the coordinates."""
        return tuple(
            dict.fromkeys(c.spherical for c in self.coordinates if c.spherical is not None)
        )

    def turns_of(self, spherical: SphericalCoordinates) -> ThreeRotations:
        """The three turns of a ball's joint."""
        parent, child = (self.frames[body.name] for body in spherical.joint.bodies)
        return ThreeRotations(spherical.joint, parent, child, spherical.side)

    @property
    def mobility_rates(self) -> Expression:
        """The rates of all extra mobilities, one column."""
        return column(self.mobilities.values())

    def terms(self) -> tuple[ca.SX, ca.SX]:
        """Terms of the Lagrange system along the coordinates and along the mobilities.

        In space velocities are along axes that rest, and lie along the bodies' own at the instant:
        so what these axes and the levers in them depend on is put in at the end, by symbols that
        are ``still`` until then.
        """
        moving = column(c.variables for c in self.coordinates if self.mechanism.space)
        still = ca.SX.sym("still", moving.numel())
        # The axes of a ball change with rates that are those of nothing, and stand still here as
        # all that moves in space does.
        integrable = [c for c in self.coordinates if c.spherical is None]
        system = LagrangeSystem(
            kinetic=self.kinetic,
            force_function=ca.SX(0),
            coordinates=column(c.variables for c in integrable),
            rates=column(c.rate for c in self.coordinates),
            accelerations=column(c.acceleration for c in self.coordinates),
            coordinate_rates=column(c.change for c in integrable),
            mobility_rates=self.mobility_rates,
            velocities=column(self.velocities.symbols),
            velocity_graphs=ca.substitute(column(self.velocities.graphs), moving, still),
            velocity_rates=column(self.velocities.rates),
            velocity_forces=column(self.velocities.forces),
            time=self.mechanism.time,
        )
        along, across = (ca.substitute(ca.SX(term), still, moving) for term in system.terms())
        return along, across

    def motion_along(self, joint: Joint, axis: Axis) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Coordinate, rate and acceleration of any joint along one of its axes: see
        :func:`.motion_along`.
        """
        return motion_along(joint, axis, self.frames, self.coordinates)


def motion_along(
    joint: Joint, axis: Axis, frames: dict[str, Frame], coordinates: tuple[Coordinate, ...]
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Coordinate, rate and acceleration of a joint along one of its axes, on the tree or closing a
    loop. An angle counts turns, but where loops set it is known up to them only.

    Raises :class:`DeclarationError` for an angle of three that a joint that closes a loop has.
    """
    coordinate = own_coordinate(axis, coordinates)
    if coordinate is not None:
        return coordinate.value, coordinate.rate, coordinate.acceleration
    parent, child = (frames[body.name] for body in joint.bodies)
    if axis.kind == "slide":
        place = dot(apart(joint, parent, child), axis.direction)
        rate, acceleration = slide_motion(joint, parent, child, axis.direction)
        return ca.SX(place), ca.SX(rate), ca.SX(acceleration)
    number = [one.coordinate for one in joint.axes if one.kind == "angle"].index(axis.coordinate)
    for spherical in (one.spherical for one in coordinates if one.name == axis.coordinate):
        if spherical is not None:
            turns = ThreeRotations(joint, parent, child, spherical.side)
            return turns.angles[number], turns.rates[number], turns.accelerations[number]
    if joint.turns > 2:
        raise DeclarationError(
            f"joint '{joint.name}' closes a loop, where the angles of a joint with three axes of"
            " rotation are not evaluated"
        )
    rate, acceleration = turning(joint, number, parent, child)
    return ca.SX(turned(joint, number, parent, child)), ca.SX(rate), ca.SX(acceleration)


def own_coordinate(axis: Axis, coordinates: tuple[Coordinate, ...]) -> Coordinate | None:
    """The coordinate of the tree that is along an axis; an absolute direction is not."""
    own = (c for c in coordinates if c.driven or c.relative or c.kind == "slide")
    return next((c for c in own if c.name == axis.coordinate), None)


def change(expression: ca.SX, coordinates: tuple[Coordinate, ...], time: ca.SX) -> ca.SX:
    """The total time derivative of an expression in coordinates' variables,
    their rates, and time.
    """
    moving = column([*(c.variables for c in coordinates), *(c.rate for c in coordinates), time])
    speed = column([*(c.change for c in coordinates), *(c.acceleration for c in coordinates), 1])
    return ca.jtimes(ca.SX(expression), moving, speed)


def split(six: Expression, *, space: bool) -> tuple[Vector, Vector]:
    """A translation and a rotation, or a force and a couple, of all their components that there are
    in a plane or in space; of a point's alone the latter is zero.
    """
    x, y, *others = ca.vertsplit(six)
    z, *about = others if space else (0.0, *others)
    u, v, w = (about if space else (0.0, 0.0, *about)) if about else ZERO
    return (x, y, z), (u, v, w)


def released_forces(kinetic: ca.SX, released: ca.SX, velocities: Velocities) -> ca.SX:
    """The forces along ``released`` rates, taken at rest, that a kinetic energy in velocities
    calls for.
    """
    nothing = ca.SX(0, 1)
    return LagrangeSystem(
        kinetic=kinetic,
        force_function=ca.SX(0),
        coordinates=nothing,
        rates=nothing,
        accelerations=nothing,
        mobility_rates=released,
        velocities=column(velocities.symbols),
        velocity_graphs=column(velocities.graphs),
        velocity_rates=column(velocities.rates),
    ).terms()[1]

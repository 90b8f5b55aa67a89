"""A mechanism as graphs: kinetic energy, force function, power of the loads, loop equations, extra mobilities.

Every undriven pin on the tree takes the *absolute* direction of the body that hangs on it for its coordinate, which keeps the
energy of a chain short; a driven pin takes the angle between its two bodies, the one its effort works on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca

from .lagrange import LagrangeSystem
from .mechanism import Mechanism
from .parts import Joint, Point, Row
from .planar import Displacement, Frame, Moments, slide
from .tree import Tree


@dataclass(frozen=True, eq=False)
class Coordinate:
    """A coordinate of the tree: the joint that carries it, the body it places, and its symbols.

    ``variables`` is what graphs are written in: (cosine, sine, angle) or the slide itself, the value last; ``tangent`` their change
    with the coordinate.
    """

    joint: str
    body: str
    kind: Literal["angle", "slide"]
    driven: bool
    variables: Any
    tangent: Any
    rate: Any
    acceleration: Any

    @property
    def value(self) -> Any:
        """The symbol of the coordinate itself."""
        return self.variables[-1]


@dataclass(frozen=True, eq=False)
class Closure:
    """Equations that a joint or a constraint puts on the coordinates, and the symbols of their multipliers.

    ``phi`` holds every mobility, ``gap`` is the same at rest. ``joint`` is None for a constraint of the user's.
    """

    name: str
    joint: Joint | None
    phi: Any
    gap: Any
    multipliers: Any


@dataclass(frozen=True, eq=False)
class SectionCut:
    """A link's section mobility: it displaces material whose moments are the symbols of ``piece``."""

    displacement: Displacement
    piece: Moments

    @property
    def moments(self) -> Any:
        """The symbols of the displaced material's mass and moments."""
        return ca.vertcat(self.piece.mass, self.piece.first, self.piece.second)


@dataclass(frozen=True, eq=False)
class Applied:
    """What a load, or the multiplier of a constraint or row, does at a point of a body, as expressions of the state.

    Force in ground axes [N] and couple [N m]; ``source`` names the load, constraint or row.
    """

    source: str
    point: Point
    fx: Any
    fy: Any
    mz: Any


@dataclass(frozen=True, eq=False)
class RowGraph:
    """A non-holonomic row: its expression at rest, the sum of the sizes of its terms, and its multiplier's symbol."""

    row: Row
    residual: Any
    size: Any
    multiplier: Any


@dataclass(frozen=True, eq=False)
class Multibody:
    """The graphs of a mechanism, over the symbols of its coordinates, mobilities, multipliers and time."""

    mechanism: Mechanism
    tree: Tree
    coordinates: tuple[Coordinate, ...]
    closures: tuple[Closure, ...]
    rows: tuple[RowGraph, ...]
    joint_mobilities: dict[str, Displacement]
    cuts: dict[str, SectionCut]
    frames: dict[str, Frame]
    applied: tuple[Applied, ...]
    held: tuple[Applied, ...]
    kinetic: Any
    force_function: Any
    forces: Any
    mobility_forces: Any

    @property
    def variables(self) -> Any:
        """All coordinates' variables, one column."""
        return column(c.variables for c in self.coordinates)

    @property
    def rates(self) -> Any:
        """All coordinates' rates, one column."""
        return column(c.rate for c in self.coordinates)

    @property
    def accelerations(self) -> Any:
        """All coordinates' accelerations, one column."""
        return column(c.acceleration for c in self.coordinates)

    @property
    def displacements(self) -> tuple[Displacement, ...]:
        """All extra mobilities, the joints' first."""
        return (*self.joint_mobilities.values(), *(cut.displacement for cut in self.cuts.values()))

    @property
    def system(self) -> LagrangeSystem:
        """The Lagrange system of the whole."""
        return LagrangeSystem(
            kinetic=self.kinetic,
            force_function=self.force_function,
            coordinates=self.variables,
            rates=self.rates,
            accelerations=self.accelerations,
            tangent=ca.diagcat(*(c.tangent for c in self.coordinates)) if self.coordinates else ca.SX(0, 0),
            mobilities=column(d.symbols for d in self.displacements),
            mobility_rates=column(d.rates for d in self.displacements),
            forces=self.forces,
            mobility_forces=self.mobility_forces,
            constraints=column(c.phi for c in self.closures),
            multipliers=column(c.multipliers for c in self.closures),
        )

    def change(self, expression: Any) -> Any:
        """The total time derivative of an expression in the variables, the rates and time."""
        return change(expression, self.coordinates, self.mechanism.time)

    def joint_motion(self, joint: Joint) -> tuple[Any, Any, Any]:
        """Coordinate, rate and acceleration of any joint that has one, on the tree or closing a loop."""
        value = joint_coordinate(joint, self.frames, self.coordinates)
        if joint.coordinate == "angle":
            parent, child = (self.frames[body.name] for body in joint.bodies)
            rate = ca.SX(child.rate - parent.rate)
        else:
            rate = self.change(value)
        return value, rate, self.change(rate)


def joint_coordinate(joint: Joint, frames: dict[str, Frame], coordinates: tuple[Coordinate, ...]) -> Any:
    """A joint's coordinate: a driven one counts turns, any other angle lies in (-pi, pi]."""
    for coordinate in coordinates:
        if coordinate.joint == joint.name and (coordinate.driven or coordinate.kind == "slide"):
            return coordinate.value
    parent, child = (frames[body.name] for body in joint.bodies)
    if joint.coordinate == "angle":
        turn = child.rotation.against(parent.rotation)
        return ca.atan2(turn.s, turn.c)
    return ca.SX(slide(joint, parent, child)[0])


def change(expression: Any, coordinates: tuple[Coordinate, ...], time: Any) -> Any:
    """The total time derivative of an expression in coordinates' variables, their rates, and time."""
    moving = column([*(c.variables for c in coordinates), *(c.rate for c in coordinates), time])
    speed = column([*(c.tangent * c.rate for c in coordinates), *(c.acceleration for c in coordinates), 1])
    return ca.jtimes(ca.SX(expression), moving, speed)


def column(parts: Any) -> Any:
    """Parts one below the other; an empty column where there are none."""
    return ca.vertcat(ca.SX(0, 1), *parts)

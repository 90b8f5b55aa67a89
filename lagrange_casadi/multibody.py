"""From a mechanism and its spanning tree to graphs: kinetic energy, force function, loop equations, extra mobilities.

Every undriven pin on the tree takes the *absolute* direction of the body that hangs on it for its coordinate, which keeps
the energy of a chain short and frees a section's rotation from what is only pinned to its end; a driven pin takes the angle
between its two bodies, the one its effort works on.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca

from .lagrange import LagrangeSystem
from .mechanism import Body, Joint, Link, Mechanism, Point, PointMass
from .planar import Displacement, Frame, Moments, Rotation, closure, slide
from .tree import Branch, Tree


@dataclass(frozen=True, eq=False)
class Coordinate:
    """A coordinate of the tree: the joint that carries it, the body it places, and its symbols.

    ``variables`` is what graphs are written in: (cosine, sine) of an angle, or the slide itself; ``tangent`` their change with
    the coordinate.
    """

    joint: str
    body: str
    kind: Literal["angle", "slide"]
    driven: bool
    variables: Any
    tangent: Any
    rate: Any
    acceleration: Any


@dataclass(frozen=True, eq=False)
class Closure:
    """A joint that closes a loop: Phi with every mobility in it, the same at rest, and the symbols of its multipliers."""

    joint: Joint
    phi: Any
    gap: Any
    multipliers: Any


@dataclass(frozen=True, eq=False)
class SectionCut:
    """A link's section mobility: it displaces the side away from the ground, with the moments ``piece`` of the material."""

    link: Link
    toward_tip: bool
    displacement: Displacement
    piece: Moments

    @property
    def moments(self) -> Any:
        """The symbols of the displaced material's moments."""
        return ca.vertcat(self.piece.mass, self.piece.first, self.piece.second)


@dataclass(frozen=True, eq=False)
class Multibody:
    """The graphs of a mechanism, over the symbols of its coordinates, mobilities and multipliers."""

    mechanism: Mechanism
    tree: Tree
    coordinates: tuple[Coordinate, ...]
    closures: tuple[Closure, ...]
    joint_mobilities: dict[str, Displacement]
    cuts: dict[str, SectionCut]
    frames: dict[str, Frame]
    kinetic: Any
    force_function: Any

    @property
    def variables(self) -> Any:
        """All coordinates' variables, one column."""
        return _column(c.variables for c in self.coordinates)

    @property
    def rates(self) -> Any:
        """All coordinates' rates, one column."""
        return _column(c.rate for c in self.coordinates)

    @property
    def accelerations(self) -> Any:
        """All coordinates' accelerations, one column."""
        return _column(c.acceleration for c in self.coordinates)

    @property
    def displacements(self) -> tuple[Displacement, ...]:
        """All extra mobilities, the joints' first."""
        return (*self.joint_mobilities.values(), *(cut.displacement for cut in self.cuts.values()))

    @property
    def tangent(self) -> Any:
        """The matrix of the variables' change with the coordinates."""
        return ca.diagcat(*(c.tangent for c in self.coordinates))

    @property
    def system(self) -> LagrangeSystem:
        """The Lagrange system of the whole."""
        return LagrangeSystem(
            kinetic=self.kinetic,
            force_function=self.force_function,
            coordinates=self.variables,
            rates=self.rates,
            accelerations=self.accelerations,
            tangent=self.tangent,
            mobilities=_column(d.symbols for d in self.displacements),
            mobility_rates=_column(d.rates for d in self.displacements),
            constraints=_column(c.phi for c in self.closures),
            multipliers=_column(c.multipliers for c in self.closures),
        )

    def change(self, expression: Any) -> Any:
        """The total time derivative of an expression in the variables and rates."""
        moving = ca.vertcat(self.variables, self.rates)
        return ca.jtimes(expression, moving, ca.vertcat(self.tangent @ self.rates, self.accelerations))

    def joint_motion(self, joint: Joint) -> tuple[Any, Any, Any]:
        """Coordinate, rate and acceleration of any joint that has one, on the tree or closing a loop."""
        parent, child = (self.frames[body.name] for body in joint.bodies)
        if joint.coordinate == "angle":
            turn = child.rotation.against(parent.rotation)
            rate = ca.SX(child.rate - parent.rate)
            return ca.atan2(turn.s, turn.c), rate, self.change(rate)
        value = ca.SX(slide(joint, parent, child)[0])
        rate = self.change(value)
        return value, rate, self.change(rate)


def assemble(
    mechanism: Mechanism, tree: Tree, driven: Collection[str], reactions: Collection[str], sections: Collection[str]
) -> Multibody:
    """The graphs of a frozen mechanism, with mobilities for the wanted reactions and sections, and for nothing else.

    The frames and gaps that positions are solved from are built without any mobility: they do not depend on what is wanted.
    """
    carried = {branch.joint.name: _coordinate(branch, branch.joint.name in driven) for branch in tree.branches}
    resting, moved = _Builder(mechanism, carried), _Builder(mechanism, carried)
    for branch in tree.branches:
        resting.hang(branch, displace=False, cut=False)
        moved.hang(branch, displace=branch.joint.name in reactions, cut=branch.far.body.name in sections)
    closures = []
    for joint in tree.closures:
        phi, gap = moved.gap(joint), resting.gap(joint)
        closures.append(Closure(joint, phi, gap, ca.SX.sym(f"lambda_{joint.name}", phi.numel())))
    return Multibody(
        mechanism=mechanism,
        tree=tree,
        coordinates=tuple(coordinate for coordinate in carried.values() if coordinate),
        closures=tuple(closures),
        joint_mobilities=moved.mobilities,
        cuts=moved.cuts,
        frames=resting.frames,
        kinetic=moved.kinetic,
        force_function=moved.force_function,
    )


class _Builder:
    """Grows frames and energies outward from the ground."""

    def __init__(self, mechanism: Mechanism, coordinates: Mapping[str, Coordinate | None]) -> None:
        self.mechanism = mechanism
        self.coordinates = coordinates
        self.frames: dict[str, Frame] = {mechanism.ground.name: Frame()}
        self.outer: dict[str, Frame] = {}
        self.mobilities: dict[str, Displacement] = {}
        self.cuts: dict[str, SectionCut] = {}
        self.kinetic = ca.SX(0)
        self.force_function = ca.SX(0)

    def hang(self, branch: Branch, *, displace: bool, cut: bool) -> None:
        """Place a body on its branch and add its energy, with the branch's mobility and the body's section where wanted."""
        joint, coordinate = branch.joint, self.coordinates[branch.joint.name]
        frame = self._undisplaced(branch, coordinate)
        if displace:
            self.mobilities[joint.name] = Displacement.named(joint.name, rotates=joint.holds_direction)
            frame = frame.displaced(self.mobilities[joint.name], *frame.anchor, _drift(branch, coordinate))
        body = branch.far.body
        assert isinstance(body, Link | PointMass)
        self.frames[body.name] = frame
        whole = Moments.of_uniform(body.mass, body.length) if isinstance(body, Link) else Moments(body.mass)
        if cut and isinstance(body, Link):
            piece = Moments(*(ca.SX.sym(f"mu{i}_{body.name}") for i in range(3)))
            toward_tip = branch.far.end == "base"
            displacement = Displacement.named(f"{body.name}_section", rotates=True)
            self.cuts[body.name] = SectionCut(body, toward_tip, displacement, piece)
            self.outer[body.name] = frame.displaced(displacement, body.length if toward_tip else 0.0, 0.0)
            self._weigh(piece, self.outer[body.name])
            whole = whole.without(piece)
        self._weigh(whole, frame)

    def gap(self, joint: Joint) -> Any:
        """The loop equations of a joint left open by the tree."""
        return ca.SX(closure(joint, self._frame_at(joint.parent), self._frame_at(joint.child)))

    def _frame_at(self, point: Point) -> Frame:
        """The frame that carries a point: the displaced one where a section lies between it and the ground."""
        cut = self.cuts.get(point.body.name)
        displaced = cut is not None and point.end == ("tip" if cut.toward_tip else "base")
        return self.outer[point.body.name] if displaced else self.frames[point.body.name]

    def _undisplaced(self, branch: Branch, coordinate: Coordinate | None) -> Frame:
        """The frame of the body that hangs on a branch, anchored at the joint's point on its child."""
        joint, near = branch.joint, branch.near
        base = self._frame_at(near)
        rotation, rate = self._turn(branch, coordinate, base)
        if joint.kind == "revolute":
            at, speed = base.place_of(near.x, near.y), base.speed_of(near.x, near.y)
            return Frame(at, speed, rotation, rate, (branch.far.x, branch.far.y))
        assert coordinate is not None
        along = (joint.axis[0] * coordinate.variables, joint.axis[1] * coordinate.variables)
        carrier = rotation if branch.reverse else base.rotation
        sliding = carrier.apply(joint.axis[0] * coordinate.rate, joint.axis[1] * coordinate.rate)
        point, anchor = (near.x, near.y), (branch.far.x, branch.far.y)
        if branch.reverse:
            anchor = (anchor[0] + along[0], anchor[1] + along[1])
        else:
            point = (point[0] + along[0], point[1] + along[1])
        at, speed = base.place_of(*point), base.speed_of(*point)
        speed = (speed[0] + branch.sign * sliding[0], speed[1] + branch.sign * sliding[1])
        return Frame(at, speed, rotation, rate, anchor)

    @staticmethod
    def _turn(branch: Branch, coordinate: Coordinate | None, base: Frame) -> tuple[Rotation, Any]:
        if not branch.far.body.oriented:
            return Rotation(), 0.0
        if branch.joint.kind == "prismatic":
            turn = Rotation.by(branch.joint.angle)
            return base.rotation.then(turn.inverse if branch.reverse else turn), base.rate
        assert coordinate is not None
        own = Rotation(coordinate.variables[0], coordinate.variables[1])
        if not coordinate.driven:
            return own, coordinate.rate
        return base.rotation.then(own.inverse if branch.reverse else own), base.rate + branch.sign * coordinate.rate

    def _weigh(self, moments: Moments, frame: Frame) -> None:
        self.kinetic += moments.kinetic(frame)
        self.force_function += moments.force_function(frame, self.mechanism.gravity)


def _coordinate(branch: Branch, driven: bool) -> Coordinate | None:
    joint = branch.joint
    if joint.kind == "revolute" and not branch.far.body.oriented:
        return None
    rate, acceleration = ca.SX.sym(f"{joint.name}_rate"), ca.SX.sym(f"{joint.name}_acceleration")
    body: Body = branch.far.body
    if joint.kind == "prismatic":
        return Coordinate(joint.name, body.name, "slide", driven, ca.SX.sym(joint.name), ca.SX(1), rate, acceleration)
    c, s = ca.SX.sym(f"cos_{joint.name}"), ca.SX.sym(f"sin_{joint.name}")
    return Coordinate(joint.name, body.name, "angle", driven, ca.vertcat(c, s), ca.vertcat(-s, c), rate, acceleration)


def _drift(branch: Branch, coordinate: Coordinate | None) -> tuple[Any, Any]:
    """How a joint's point on its child moves in the axes of the body that hangs on the branch."""
    if not (branch.reverse and branch.joint.kind == "prismatic"):
        return 0.0, 0.0
    assert coordinate is not None
    return branch.joint.axis[0] * coordinate.rate, branch.joint.axis[1] * coordinate.rate


def _column(parts: Any) -> Any:
    return ca.vertcat(ca.SX(0, 1), *parts)

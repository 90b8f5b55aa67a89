"""Grows the graphs of a mechanism outward from the ground, along its spanning tree."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import casadi as ca

from .density import Density
from .mechanism import Mechanism
from .multibody import (
    Applied,
    Closure,
    Coordinate,
    Multibody,
    RowGraph,
    SectionCut,
    change,
    column,
    joint_coordinate,
)
from .parts import Force, Joint, Link, Load, Point, PointMass, RigidMass, Spring, Torque
from .planar import Displacement, Frame, Moments, Rotation, closure, slide
from .tree import Branch, Tree


def assemble(
    mechanism: Mechanism, tree: Tree, driven: Collection[str], reactions: Collection[str], sections: Collection[str]
) -> Multibody:
    """The graphs of a frozen mechanism, with mobilities for the named joints' reactions and links' sections, and for nothing else.

    The frames and gaps that positions are solved from are built without any mobility: they do not depend on what is wanted.
    """
    carried = {branch.joint.name: _coordinate(branch, branch.joint.name in driven) for branch in tree.branches}
    resting, moved = _Builder(mechanism, carried), _Builder(mechanism, carried)
    for branch in tree.branches:
        resting.hang(branch, displace=False, cut=False)
        moved.hang(branch, displace=branch.joint.name in reactions, cut=branch.far.body.name in sections)
    closures = [
        _closure(joint.name, joint, closure(joint, *moved.ends(joint)), closure(joint, *resting.ends(joint)))
        for joint in tree.closures
    ]
    for constraint in mechanism.constraints.values():
        closures.append(_closure(constraint.name, None, moved.counted(constraint.phi), resting.counted(constraint.phi)))
    rows = tuple(_row(resting, row) for row in mechanism.rows.values())
    applied = tuple(part for load in mechanism.loads.values() for part in _apply(load, resting))
    held = [part for c in closures if c.joint is None for part in _hold(resting, c.name, mechanism.constraints[c.name].phi, c)]
    held += [part for graph in rows for part in _hold(resting, graph.row.name, graph.row.expression, graph)]
    forces, mobility_forces = _generalized(moved, applied, rows)
    return Multibody(
        mechanism=mechanism,
        tree=tree,
        coordinates=moved.coordinates,
        closures=tuple(closures),
        rows=rows,
        joint_mobilities=moved.mobilities,
        cuts=moved.cuts,
        frames=resting.frames,
        applied=applied,
        held=tuple(held),
        kinetic=moved.kinetic,
        force_function=moved.force_function,
        forces=forces,
        mobility_forces=mobility_forces,
    )


class _Builder:
    """Frames and energies, grown body by body."""

    def __init__(self, mechanism: Mechanism, carried: Mapping[str, Coordinate | None]) -> None:
        self.mechanism = mechanism
        self.carried = carried
        self.coordinates = tuple(coordinate for coordinate in carried.values() if coordinate)
        self.frames: dict[str, Frame] = {mechanism.ground.name: Frame()}
        self.mobilities: dict[str, Displacement] = {}
        self.cuts: dict[str, SectionCut] = {}
        self.kinetic = ca.SX(0)
        self.force_function = ca.SX(0)

    def ends(self, joint: Joint) -> tuple[Frame, Frame]:
        """The frames of a joint's parent and child."""
        parent, child = joint.bodies
        return self.frames[parent.name], self.frames[child.name]

    def hang(self, branch: Branch, *, displace: bool, cut: bool) -> None:
        """Place a body on its branch and add its energy, with the branch's mobility and the body's section where wanted."""
        joint, coordinate = branch.joint, self.carried[branch.joint.name]
        frame = self._undisplaced(branch, coordinate)
        if displace:
            self.mobilities[joint.name] = Displacement.named(joint.name, rotates=joint.holds_direction)
            frame = frame.displaced(self.mobilities[joint.name], *frame.anchor, _drift(branch, coordinate))
        body = branch.far.body
        assert isinstance(body, Link | PointMass)
        self.frames[body.name] = frame
        whole = moments(body)
        if cut:
            piece = Moments(*(ca.SX.sym(f"mu{i}_{body.name}") for i in range(3)))
            displacement = Displacement.named(f"{body.name}_section", rotates=False)
            self.cuts[body.name] = SectionCut(displacement, piece)
            self._weigh(piece, frame.displaced(displacement, *frame.anchor))
            whole = whole.without(piece)
        self._weigh(whole, frame)

    def counted(self, expression: Any) -> Any:
        """An expression of what the user measures in the tree's own variables, angles counted by turns."""
        return self._measured(expression, turns=True)

    def at_state(self, expression: Any) -> Any:
        """The same with the angles of undriven joints in (-pi, pi], and with rates."""
        return self._measured(expression, turns=False)

    def _measured(self, expression: Any, *, turns: bool) -> Any:
        symbols: list[Any] = []
        values: list[Any] = []
        for measure in self.mechanism.measures.asked:
            symbols += [*measure.places, *measure.rates]
            of = measure.of
            if isinstance(of, Joint):
                values += [self._joint_place(of, turns=turns), self._joint_rate(of)]
            elif isinstance(of, Point):
                frame = self.frames[of.body.name]
                values += [*frame.place_of(of.x, of.y), *frame.speed_of(of.x, of.y)]
            else:
                values += [self.frames[of.name].rotation.angle, self.frames[of.name].rate]
        return ca.substitute(ca.SX(expression), column(symbols), column(values))

    def _joint_place(self, joint: Joint, *, turns: bool) -> Any:
        parent, child = self.ends(joint)
        if turns and joint.coordinate == "angle":
            return ca.SX(child.rotation.angle - parent.rotation.angle)
        return joint_coordinate(joint, self.frames, self.coordinates)

    def _joint_rate(self, joint: Joint) -> Any:
        """The rate of a joint's coordinate, with the rates of the mobilities."""
        parent, child = self.ends(joint)
        if joint.coordinate == "angle":
            return ca.SX(child.rate - parent.rate)
        for coordinate in self.coordinates:
            if coordinate.joint == joint.name:
                return coordinate.rate
        value = ca.SX(slide(joint, parent, child)[0])
        rate = change(value, self.coordinates, self.mechanism.time)
        for displacement in (*self.mobilities.values(), *(cut.displacement for cut in self.cuts.values())):
            rate += ca.jtimes(value, displacement.symbols, displacement.rates)
        return rate

    def _undisplaced(self, branch: Branch, coordinate: Coordinate | None) -> Frame:
        """The frame of the body that hangs on a branch, anchored at the joint's point on its child."""
        joint, near = branch.joint, branch.near
        base = self.frames[near.body.name]
        rotation, rate = self._turn(branch, coordinate, base)
        if not joint.slides:
            at, speed = base.place_of(near.x, near.y), base.speed_of(near.x, near.y)
            return Frame(at, speed, rotation, rate, (branch.far.x, branch.far.y))
        assert coordinate is not None
        along = (joint.axis[0] * coordinate.value, joint.axis[1] * coordinate.value)
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
        if branch.joint.holds_direction:
            turn = Rotation.by(branch.joint.angle)
            return base.rotation.then(turn.inverse if branch.reverse else turn), base.rate
        assert coordinate is not None
        own = Rotation(*ca.vertsplit(coordinate.variables))
        if not coordinate.driven:
            return own, coordinate.rate
        return base.rotation.then(own.inverse if branch.reverse else own), base.rate + branch.sign * coordinate.rate

    def _weigh(self, matter: Moments, frame: Frame) -> None:
        self.kinetic += matter.kinetic(frame)
        self.force_function += matter.force_function(frame, self.mechanism.gravity)


def moments(body: Link | PointMass) -> Moments:
    """Mass and moments of a whole body about its origin."""
    matter = body.mass
    if isinstance(body, Link) and isinstance(matter, Density):
        return Moments(*matter.moments(body.length))
    if isinstance(matter, RigidMass):
        x, y = matter.centre
        second = matter.inertia + matter.mass * (x * x + y * y)
        return Moments(matter.mass, matter.mass * x, second, matter.mass * y)
    return Moments(matter)


def _coordinate(branch: Branch, driven: bool) -> Coordinate | None:
    joint, body = branch.joint, branch.far.body
    if joint.kind == "weld" or (joint.kind == "revolute" and not body.oriented):
        return None
    q, rate, acceleration = (ca.SX.sym(f"{joint.name}{end}") for end in ("", "_rate", "_acceleration"))
    if joint.slides:
        return Coordinate(joint.name, body.name, "slide", driven, q, ca.SX(1), rate, acceleration)
    c, s = ca.SX.sym(f"cos_{joint.name}"), ca.SX.sym(f"sin_{joint.name}")
    return Coordinate(joint.name, body.name, "angle", driven, ca.vertcat(c, s, q), ca.vertcat(-s, c, 1), rate, acceleration)


def _drift(branch: Branch, coordinate: Coordinate | None) -> tuple[Any, Any]:
    """How a joint's point on its child moves in the axes of the body that hangs on the branch."""
    if coordinate is None or not (branch.reverse and branch.joint.slides):
        return 0.0, 0.0
    return branch.joint.axis[0] * coordinate.rate, branch.joint.axis[1] * coordinate.rate


def _closure(name: str, joint: Joint | None, phi: Any, gap: Any) -> Closure:
    return Closure(name, joint, phi, gap, ca.SX.sym(f"lambda_{name}", phi.numel()))


def _apply(load: Load, resting: _Builder) -> list[Applied]:
    """A load as forces and couples at points, by the state."""
    at = resting.at_state
    if isinstance(load, Force):
        x, y = at(load.x), at(load.y)
        if load.turning:
            x, y = resting.frames[load.point.body.name].rotation.apply(x, y)
        return [Applied(load.name, load.point, x, y, ca.SX(0))]
    if isinstance(load, Torque):
        value = at(load.value)
        ends = ((load.point, value), (load.against, -value))
        return [Applied(load.name, point, ca.SX(0), ca.SX(0), couple) for point, couple in ends]
    assert isinstance(load, Spring)
    first, second = (resting.frames[point.body.name] for point in (load.first, load.second))
    (ax, ay), (bx, by) = first.place_of(load.first.x, load.first.y), second.place_of(load.second.x, load.second.y)
    (au, av), (bu, bv) = first.speed_of(load.first.x, load.first.y), second.speed_of(load.second.x, load.second.y)
    dx, dy = bx - ax, by - ay
    distance = ca.sqrt(dx * dx + dy * dy)
    rate = (dx * (bu - au) + dy * (bv - av)) / distance
    tension = at(load.stiffness) * (distance - at(load.length)) + at(load.damping) * rate
    fx, fy = tension * dx / distance, tension * dy / distance
    return [
        Applied(load.name, load.first, ca.SX(fx), ca.SX(fy), ca.SX(0)),
        Applied(load.name, load.second, ca.SX(-fx), ca.SX(-fy), ca.SX(0)),
    ]


def _hold(resting: _Builder, name: str, expression: Any, of: Closure | RowGraph) -> Iterator[Applied]:
    """What a multiplier does to bodies, by what its equation is written in: a joint's coordinate, a place, a direction."""
    multiplier, seen = (of.multipliers, resting.counted) if isinstance(of, Closure) else (of.multiplier, resting.at_state)
    for measure in resting.mechanism.measures.asked:
        symbols = ca.vertcat(*(measure.places if isinstance(of, Closure) else measure.rates))
        if not ca.depends_on(expression, symbols):
            continue
        part = [multiplier * seen(slope) for slope in ca.vertsplit(ca.jacobian(expression, symbols).T)]
        if isinstance(measure.of, Point):
            yield Applied(name, measure.of, part[0], part[1], ca.SX(0))
        elif isinstance(measure.of, Link):
            yield Applied(name, measure.of.base, ca.SX(0), ca.SX(0), part[0])
        elif measure.of.coordinate == "angle":
            yield Applied(name, measure.of.child, ca.SX(0), ca.SX(0), part[0])
            yield Applied(name, measure.of.parent, ca.SX(0), ca.SX(0), -part[0])
        else:
            joint = measure.of
            parent, child = resting.ends(joint)
            ax, ay = parent.rotation.apply(*joint.axis)
            along, _ = slide(joint, parent, child)
            x, y = joint.parent.x + joint.axis[0] * along, joint.parent.y + joint.axis[1] * along
            yield Applied(name, joint.child, part[0] * ax, part[0] * ay, ca.SX(0))
            yield Applied(name, Point(joint.parent.body, x, y), -part[0] * ax, -part[0] * ay, ca.SX(0))


def _row(resting: _Builder, row: Any) -> RowGraph:
    residual = resting.at_state(row.expression)
    rates = column(c.rate for c in resting.coordinates)
    slopes = ca.jacobian(residual, rates).T
    rest = ca.substitute(residual, rates, ca.SX.zeros(rates.numel()))
    return RowGraph(row, residual, ca.sum1(ca.fabs(slopes * rates)) + ca.fabs(rest), ca.SX.sym(f"mu_{row.name}"))


def _generalized(moved: _Builder, applied: tuple[Applied, ...], rows: tuple[RowGraph, ...]) -> tuple[Any, Any]:
    """Q* of the loads and of the rows' multipliers, along coordinates and mobilities: how their power goes with the rates."""
    fx, fy, mz = (ca.SX.sym(name, len(applied)) for name in ("fx", "fy", "mz"))
    power = ca.SX(0)
    for i, part in enumerate(applied):
        frame = moved.frames[part.point.body.name]
        vx, vy = frame.speed_of(part.point.x, part.point.y)
        power += fx[i] * vx + fy[i] * vy + mz[i] * frame.rate
    for graph in rows:
        power += graph.multiplier * moved.at_state(graph.row.expression)
    displacements = (*moved.mobilities.values(), *(cut.displacement for cut in moved.cuts.values()))
    rates = column([*(c.rate for c in moved.coordinates), *(d.rates for d in displacements)])
    slopes = ca.gradient(power, rates)
    resting = column(symbol for d in displacements for symbol in (d.symbols, d.rates))
    slopes = ca.substitute(slopes, resting, ca.SX.zeros(resting.numel()))
    forces = column([*(p.fx for p in applied), *(p.fy for p in applied), *(p.mz for p in applied)])
    slopes = ca.substitute(slopes, ca.vertcat(fx, fy, mz), forces)
    along, across = ca.vertsplit(slopes, [0, len(moved.coordinates), slopes.numel()])
    return along, across

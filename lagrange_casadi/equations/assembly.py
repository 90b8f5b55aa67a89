"""Grows the graphs of a mechanism outward from the ground, along its spanning tree."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import casadi as ca

from ..declare.density import Density
from ..declare.mechanism import Mechanism
from ..declare.parts import Force, Joint, LineLoad, Link, Load, Point, PointMass, RigidMass, Spring, Torque
from ..geometry.planar import Frame, Pair, Rotation, Velocities, closing_gaps, gap_motion, reaction, slide
from .multibody import (
    Applied,
    Coordinate,
    LoopEquations,
    Multibody,
    RowGraph,
    Turned,
    change,
    column,
    joint_coordinate,
    joint_rates,
)
from .tree import Branch, Tree


def assemble(
    mechanism: Mechanism,
    tree: Tree,
    driven: Collection[str],
    reactions: Collection[str],
    pushed: Collection[str] = (),
    own: Collection[str] = (),
) -> Multibody:
    """The graphs of a frozen mechanism, with mobilities for the named joints' reactions, and for nothing else.

    ``driven`` are the joints whose motion is given, and ``pushed`` those along which efforts are unknowns of their own; ``own``
    names the user's outputs.

    The frames and gaps that positions are solved from are built without any mobility: they do not depend on what is wanted.
    Gravity is an acceleration of the ground, upward, in the frames that matter is weighed in (d'Alembert).
    """
    carried = _coordinates(mechanism, tree, driven)
    gravity = mechanism.gravity
    resting = _Builder(mechanism, carried, Frame())
    felt = _Builder(mechanism, carried, Frame(acceleration=(-gravity[0], -gravity[1])))
    for branch in tree.branches:
        resting.hang(branch, displace=False)
        felt.hang(branch, displace=branch.joint.name in reactions)
    loops = [_loop_equations(joint.name, joint, *closing_gaps(joint, *resting.ends(joint))) for joint in tree.closing]
    for constraint in mechanism.constraints.values():
        gap = resting.counted(constraint.phi)
        rate = change(gap, resting.coordinates, mechanism.time)
        loops.append(_loop_equations(constraint.name, None, gap, rate, change(rate, resting.coordinates, mechanism.time)))
    rows = tuple(_row(resting, row) for row in mechanism.rows.values())
    applied = tuple(part for load in mechanism.loads.values() for part in _apply(load, resting))
    held = [
        part
        for loop in loops
        if loop.joint is None
        for part in _hold(resting, loop.name, mechanism.constraints[loop.name].phi, loop)
    ]
    held += [part for graph in rows for part in _hold(resting, graph.row.name, graph.row.expression, graph)]
    velocities = Velocities()
    spun = {b.far.body for b in tree.branches if not b.joint.slides and (b.joint.name in driven or b.near.body is mechanism.ground)}
    kinetic = sum((_kinetic(body, felt, velocities, body in spun) for body in mechanism.moving), ca.SX(0))
    _work(felt, (*applied, *held), loops, velocities)
    outputs = {name: resting.at_state(mechanism.outputs[name].expression) for name in own}
    efforts = {name: ca.SX.sym(f"tau_{name}") for name in pushed}
    for name, effort in efforts.items():
        _push(felt, mechanism.joints[name], effort, velocities)
    return Multibody(
        mechanism=mechanism,
        tree=tree,
        coordinates=resting.coordinates,
        loop_equations=tuple(loops),
        rows=rows,
        mobilities=felt.mobilities,
        frames=resting.frames,
        felt=felt.frames,
        applied=applied,
        held=tuple(held),
        efforts=efforts,
        own=outputs,
        turned=tuple(resting.turned.values()),
        kinetic=kinetic,
        velocities=velocities,
    )


class _Builder:
    """Frames, grown body by body."""

    def __init__(self, mechanism: Mechanism, carried: Mapping[str, Coordinate | None], ground: Frame) -> None:
        self.mechanism = mechanism
        self.carried = carried
        self.coordinates = tuple(coordinate for coordinate in carried.values() if coordinate)
        self.frames: dict[str, Frame] = {mechanism.ground.name: ground}
        self.mobilities: dict[str, Any] = {}
        self.turned: dict[str, Turned] = {}

    def ends(self, joint: Joint) -> tuple[Frame, Frame]:
        """The frames of a joint's parent and child."""
        parent, child = joint.bodies
        return self.frames[parent.name], self.frames[child.name]

    def hang(self, branch: Branch, *, displace: bool) -> None:
        """Place a body on its branch, with the branch's mobility where wanted."""
        joint = branch.joint
        frame = self._undisplaced(branch, self.carried[joint.name])
        if displace:
            self.mobilities[joint.name] = ca.SX.sym(f"ed_{joint.name}", 3 if joint.holds_direction else 2)
            frame = frame.displaced(self.mobilities[joint.name])
        self.frames[branch.far.body.name] = frame

    def counted(self, expression: Any) -> Any:
        """An expression of what the user measures in the tree's own variables, angles counted by turns."""
        return self._measured(expression, turns=True)

    def at_state(self, expression: Any) -> Any:
        """The same with rates; angles that are not driven are symbols of their own, for :mod:`.turns` to tell."""
        return self._measured(expression, turns=False)

    def _measured(self, expression: Any, *, turns: bool) -> Any:
        symbols: list[Any] = []
        values: list[Any] = []
        for measure in self.mechanism.measures.asked:
            symbols += [*measure.places, *measure.rates, *measure.accelerations]
            of = measure.of
            if isinstance(of, Joint):
                known = turns or of.coordinate != "angle" or any(c.joint == of.name and c.driven for c in self.coordinates)
                place = joint_coordinate(of, self.frames, self.coordinates) if known else self._seen(of)
                values += [place, *joint_rates(of, self.frames, self.coordinates)]
            elif isinstance(of, Point):
                frame = self.frames[of.body.name]
                speed, acceleration = frame.motion_of(of.x, of.y)
                values += [*frame.place_of(of.x, of.y), *speed, *acceleration]
            else:
                frame = self.frames[of.name]
                values += [frame.rotation.angle if turns else self._seen(of), frame.rate, frame.angular]
        return ca.substitute(ca.SX(expression), column(symbols), column(values))

    def _seen(self, of: Joint | Link) -> Any:
        """The symbol of an angle."""
        if of.name not in self.turned:
            if isinstance(of, Joint):
                parent, child = self.ends(of)
                turn = child.rotation.against(parent.rotation)
            else:
                turn = self.frames[of.name].rotation
            symbol = ca.SX.sym(f"{of.name}_seen")
            self.turned[of.name] = Turned(of.name, symbol, ca.SX(turn.c), ca.SX(turn.s), ca.SX(turn.angle))
        return self.turned[of.name].symbol

    def _undisplaced(self, branch: Branch, coordinate: Coordinate | None) -> Frame:
        """The frame of the body that hangs on a branch, anchored at the joint's point on its child."""
        joint, near = branch.joint, branch.near
        base = self.frames[near.body.name]
        rotation, rate, angular = self._turn(branch, coordinate, base)
        point, anchor = (near.x, near.y), (branch.far.x, branch.far.y)
        if not joint.slides:
            return Frame(base.place_of(*point), *base.motion_of(*point), rotation, rate, angular, anchor)
        assert coordinate is not None
        along = (joint.axis[0] * coordinate.value, joint.axis[1] * coordinate.value)
        if branch.reverse:
            anchor = (anchor[0] + along[0], anchor[1] + along[1])
        else:
            point = (point[0] + along[0], point[1] + along[1])
        carrier = rotation if branch.reverse else base.rotation
        tx, ty = carrier.apply(branch.sign * joint.axis[0], branch.sign * joint.axis[1])
        (vx, vy), (ax, ay) = base.motion_of(*point)
        sliding, straight, turning = coordinate.rate, coordinate.acceleration, 2 * base.rate * coordinate.rate
        speed = (vx + sliding * tx, vy + sliding * ty)
        # The line turns under what slides on it (Coriolis).
        acceleration = (ax + (straight * tx - turning * ty), ay + (straight * ty + turning * tx))
        return Frame(base.place_of(*point), speed, acceleration, rotation, rate, angular, anchor)

    @staticmethod
    def _turn(branch: Branch, coordinate: Coordinate | None, base: Frame) -> tuple[Rotation, Any, Any]:
        if not branch.far.body.oriented:
            return Rotation(), 0.0, 0.0
        if branch.joint.holds_direction:
            turn = Rotation.by(branch.joint.angle)
            return base.rotation.then(turn.inverse if branch.reverse else turn), base.rate, base.angular
        assert coordinate is not None
        own = Rotation(*ca.vertsplit(coordinate.variables))
        if not coordinate.driven:
            return own, coordinate.rate, coordinate.acceleration
        if coordinate.relative:
            turned = base.rotation.then(own.inverse if branch.reverse else own)
        else:
            turned = replace(own, angle=base.rotation.angle + branch.sign * own.angle)
        return turned, base.rate + branch.sign * coordinate.rate, base.angular + branch.sign * coordinate.acceleration


def _kinetic(body: Link | PointMass, felt: _Builder, velocities: Velocities, spun: bool) -> Any:
    """Kinetic energy of a body (paper eq. 16), in its rate of turning and velocities of its points: no direction is in it.

    Where a body is ``spun``, its velocities are split into that of its joint and that about it: else the square of its rate, which
    bears on no effort, would leave there its rounding.
    """
    frame, matter = felt.frames[body.name], body.mass
    points: list[tuple[Any, Pair]]
    if isinstance(body, Link) and isinstance(matter, Density):
        base, tip, inertia = matter.ends(body.length)
        points = [(base, (0.0, 0.0)), (tip, (body.length, 0.0))]
    elif isinstance(matter, RigidMass):
        points, inertia = [(matter.mass, matter.centre)], matter.inertia
    else:
        points, inertia = [(matter, (0.0, 0.0))], 0.0
    if not (spun and body.oriented):
        energy = sum((mass * ca.sumsqr(velocities.point(frame.motion_of(*place))) / 2 for mass, place in points), ca.SX(0))
        return energy + inertia * velocities.turn(frame.rate, frame.angular) ** 2 / 2
    held, about = velocities.point((frame.speed, frame.acceleration)), frame.about_anchor()
    energy = sum((mass for mass, _ in points), ca.SX(0)) * ca.sumsqr(held) / 2
    for mass, (x, y) in points:
        energy += mass * ca.dot(held, velocities.point(about.motion_of(x, y)))
        inertia += mass * ((x - frame.anchor[0]) ** 2 + (y - frame.anchor[1]) ** 2)
    return energy + inertia * velocities.turn(frame.rate, frame.angular) ** 2 / 2


def _coordinates(mechanism: Mechanism, tree: Tree, driven: Collection[str]) -> dict[str, Coordinate | None]:
    """The coordinate of every branch, by its joint; None where a branch leaves no freedom."""
    # Directions that drives alone set, and their rates, by body.
    turned: dict[str, tuple[Any, Any]] = {mechanism.ground.name: (ca.SX(0), ca.SX(0))}
    found: dict[str, Coordinate | None] = {}
    for branch in tree.branches:
        joint, near, far = branch.joint, branch.near.body.name, branch.far.body
        q, rate, acceleration = (ca.SX.sym(f"{joint.name}{end}") for end in ("", "_rate", "_acceleration"))
        if joint.holds_direction and near in turned:
            turned[far.name] = (turned[near][0] + branch.sign * joint.angle, turned[near][1])
        if joint.kind == "weld" or (joint.kind == "revolute" and not far.oriented):
            found[joint.name] = None
        elif joint.slides:
            found[joint.name] = Coordinate(joint.name, far.name, "slide", joint.name in driven, q, rate, rate, acceleration)
        else:
            turn, spin = q, rate
            if joint.name in driven and near in turned:
                turn, spin = (before + branch.sign * own for before, own in zip(turned[near], (q, rate), strict=True))
                turned[far.name] = turn, spin
            c, s = ca.SX.sym(f"cos_{joint.name}"), ca.SX.sym(f"sin_{joint.name}")
            found[joint.name] = Coordinate(
                joint.name,
                far.name,
                "angle",
                joint.name in driven,
                ca.vertcat(c, s, q),
                ca.vertcat(-s * spin, c * spin, rate),
                rate,
                acceleration,
                turn,
                relative=joint.name in driven and near not in turned,
            )
    return found


def _loop_equations(name: str, joint: Joint | None, gap: Any, rate: Any, acceleration: Any) -> LoopEquations:
    return LoopEquations(name, joint, gap, rate, acceleration, ca.SX.sym(f"lambda_{name}", gap.numel()))


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
    if isinstance(load, LineLoad):
        return [_along(load, resting)]
    assert isinstance(load, Spring)
    first, second = (resting.frames[point.body.name] for point in (load.first, load.second))
    (ax, ay), (bx, by) = first.place_of(load.first.x, load.first.y), second.place_of(load.second.x, load.second.y)
    (au, av), _ = first.motion_of(load.first.x, load.first.y)
    (bu, bv), _ = second.motion_of(load.second.x, load.second.y)
    dx, dy = bx - ax, by - ay
    distance = ca.sqrt(dx * dx + dy * dy)
    rate = (dx * (bu - au) + dy * (bv - av)) / distance
    tension = at(load.stiffness) * (distance - at(load.length)) + at(load.damping) * rate
    fx, fy = tension * dx / distance, tension * dy / distance
    return [
        Applied(load.name, load.first, ca.SX(fx), ca.SX(fy), ca.SX(0)),
        Applied(load.name, load.second, ca.SX(-fx), ca.SX(-fy), ca.SX(0)),
    ]


def _along(load: LineLoad, resting: _Builder) -> Applied:
    """A load along a link: what it is at the ends, and its resultant at the middle of the link."""
    rotation, length = resting.frames[load.link.name].rotation, load.link.length
    (x0, x1), (y0, y1) = ((resting.at_state(value) for value in values) for values in (load.x, load.y))
    ends = ((x0, y0), (x1, y1))
    base, tip = ends if load.turning else (rotation.resolve(*end) for end in ends)
    x, y = (x0 + x1) * (length / 2), (y0 + y1) * (length / 2)
    fx, fy = rotation.apply(x, y) if load.turning else (x, y)
    return Applied(load.name, load.points[0], fx, fy, (tip[1] - base[1]) * (length * length / 12), (base, tip))


def _hold(resting: _Builder, name: str, expression: Any, of: LoopEquations | RowGraph) -> Iterator[Applied]:
    """What a multiplier does to bodies, by what its equation is written in: a joint's coordinate, a place, a direction."""
    multiplier, seen = (of.multipliers, resting.counted) if isinstance(of, LoopEquations) else (of.multiplier, resting.at_state)
    for measure in resting.mechanism.measures.asked:
        symbols = ca.vertcat(*(measure.places if isinstance(of, LoopEquations) else measure.rates))
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
    """A row, and the size of what is added up in it: rates of coordinates, in what is measured, in the row.

    Not the size of its own terms: of a motion along which a row is idle, all of them are rounding.
    """
    residual, rates = resting.at_state(row.expression), column(c.rate for c in resting.coordinates)
    measured = resting.mechanism.measures.rates
    slopes = ca.fabs(resting.at_state(ca.jacobian(row.expression, measured)))
    going = ca.fabs(ca.jacobian(resting.at_state(measured), rates)) @ ca.fabs(rates)
    rest = ca.fabs(resting.at_state(ca.substitute(row.expression, measured, ca.SX.zeros(measured.numel()))))
    return RowGraph(row, residual, slopes @ going + rest, ca.SX.sym(f"mu_{row.name}"))


def _work(felt: _Builder, applied: Iterable[Applied], loops: Iterable[LoopEquations], velocities: Velocities) -> None:
    """Let loads and multipliers do work: along the velocities of points, and of what a closing joint holds together."""
    for part in applied:
        frame = felt.frames[part.point.body.name]
        velocities.point(frame.motion_of(part.point.x, part.point.y), (part.fx, part.fy))
        velocities.turn(frame.rate, frame.angular, part.mz)
    for loop in loops:
        if loop.joint is not None:
            parent, child = felt.ends(loop.joint)
            action = reaction(loop.joint, parent, child, loop.multipliers, closing=True)
            velocities.point(gap_motion(loop.joint, parent, child), (action["fx"], action["fy"]))
            if "mz" in action:
                velocities.turn(child.rate - parent.rate, child.angular - parent.angular, action["mz"])


def _push(felt: _Builder, joint: Joint, effort: Any, velocities: Velocities) -> None:
    """Let an effort do work along a joint's coordinate."""
    parent, child = felt.ends(joint)
    if joint.coordinate == "angle":
        velocities.turn(child.rate - parent.rate, child.angular - parent.angular, effort)
    else:
        ax, ay = parent.rotation.apply(*joint.axis)
        velocities.point(gap_motion(joint, parent, child), (effort * ax, effort * ay))

"""Internal forces from extra mobilities: multipliers and efforts, joint reactions, and the section
law of a link.

The law (exact for a straight link of any density): with mu0 and mu1 the mass and the first moment,
about the base, of the material from the section to the tip,

    axial   = n0 + n1 mu0 + n2 mu1,
    shear   = f0 + f1 mu0 + f2 mu1,
    bending = m0 + f0 (l - xi) + f1 (mu1 - xi mu0) + f2 (mu2 - xi mu1).

Energy is linear in the moments, so n1, n2, f1, f2 are derivatives of the section mobility's
Lagrange terms by the moments (paper eq. 20): n2 and f2 are the square of the link's rate and less
its change. They repeat in bending because d(bending)/d(xi) = -shear, the equilibrium of an element.
n0, f0, m0 are what acts on the tip: the reactions, efforts and loads there. What acts at a station
between base and tip is seen by the sections on its base side. What acts along the link has terms of
its own (:mod:`.distributed_loads`).
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame, Velocities
from ..base.quantities import Check, Column, Output, force_members
from ..base.rotation import Rotation
from ..base.scalars import column, entries
from ..base.tables import table_of
from ..base.vectors import ZERO, cross, dot, nil, plus, times
from ..model.declared_parts import Link, Point, PointMass, Vector
from ..model.joints import Joint
from ..model.limits import at_end
from ..model.link_density import Density
from ..model.mechanism import Mechanism
from ..model.scene import Scene, Wanted
from .assembly import line_reaction
from .distributed_loads import distributed_loads, rotary
from .drives import solve_efforts
from .friction import Solved, needed, solve
from .joint_closure import carried, reaction, supported
from .kinematics import Kinematics
from .mesh_forces import braking, pressing_apart, transmissions_of
from .multibody import Multibody, own_coordinate, released_forces, split
from .multipliers import multipliers_of
from .pressing import frictions_of, joint_friction
from .sizes import reach


def needed_reactions(
    mechanism: Mechanism, reactions: Sequence[str], sections: Sequence[str]
) -> tuple[str, ...]:
    """The joints whose reaction some output needs: those wanted, those that load a wanted link
    beyond its base, those that rub.
    """
    needed = {*reactions, *(friction.joint.name for friction in frictions_of(mechanism).values())}
    for joint in mechanism.joints.values():
        for point in (joint.parent, joint.child):
            moves = joint.slides and point is joint.parent
            if point.body.name in sections and (moves or not _at_base(point)):
                needed.add(joint.name)
    return tuple(name for name in mechanism.joints if name in needed)


def internal_forces(
    multibody: Multibody,
    kinematics: Kinematics,
    want: Wanted,
    scene: Scene,
    signs: Mapping[str, Expression] | None = None,
) -> tuple[dict[Column, Any], ca.SX, Solved]:
    """Derive the efforts, reactions, multipliers of constraints and rows, laws of links and
    frictions that are wanted: columns over time, the driven motion, the iterated unknowns and the
    parameters; the symbols of what equilibrium leaves open in an over-constrained mechanism; and
    the forces of frictions.

    Among the columns, a check measures how far drives are from a place where they cannot make the
    motion, where they are others than the joints whose motion is given. Guides of points and poses
    bear nothing, and load no link. ``signs`` are those of frictions at rest, which are open
    without: see :func:`.solve`.
    """
    weights = scene.weights
    along, across = multibody.terms()
    along = kinematics.found.put_into(along)
    unknowns, values, free = multipliers_of(multibody, kinematics, along)

    unaided = {program.row.replaces for program in multibody.rows}
    drives: dict[str, Any] = {
        c.name: along[i]
        for i, c in enumerate(multibody.coordinates)
        if c.driven and c.name not in unaided
    }
    held: dict[Column, Any] = {}
    if weights is not None and multibody.efforts:
        needs = {
            name: ca.substitute(ca.SX(need), unknowns, values)
            for name, need in drives.items()
            if name in multibody.efforts or name not in weights
        }
        size = reach(multibody.mechanism)
        units = {
            name: 1 if axis.kind == "angle" else size
            for name, (_, axis) in multibody.mechanism.coordinates.items()
        }
        symbols = column(multibody.efforts.values())
        efforts, authority = solve_efforts(multibody.efforts, needs, weights, units)
        drives = {name: multibody.efforts.get(name, drives.get(name)) for name in weights}
        values = ca.substitute(values, symbols, efforts)
        unknowns, values = ca.vertcat(unknowns, symbols), ca.vertcat(values, efforts)
        held = {Check("hold", ", ".join(weights)): authority}
    starts = itertools.accumulate(
        (rates.numel() for rates in multibody.mobilities.values()), initial=0
    )
    by_joint = dict(zip(multibody.mobilities, ca.vertsplit(across, [*starts]), strict=True))
    joints = multibody.mechanism.joints
    supporting = needed_reactions(scene.mechanism, want.reactions, want.sections)
    found = {name: _reaction(multibody, joints[name], by_joint) for name in supporting}
    columns: dict[Column, Any] = (
        {Output("effort", joint): force for joint, force in drives.items()} if want.effort else {}
    )
    for name in want.reactions:
        members = force_members(multibody.mechanism.space, moment=joints[name].bears_moment)
        columns |= {
            Output("reaction", name, member): found[name].ground.member(member)
            for member in members
        }
        if multibody.mechanism.space:
            columns |= _on_joint_axes(joints[name], found[name].local)
    tying = {c.name: c.multipliers for c in multibody.loop_equations if c.declared}
    tying |= {program.row.name: program.multipliers for program in multibody.rows}
    columns |= {Output("multiplier", name): tying[name] for name in want.multipliers}
    if want.reactions:
        columns |= {
            Check("multiplier", name): multiplier
            for name, multiplier in tying.items()
            if name not in want.multipliers
        }
    links = multibody.mechanism.links
    for name in want.sections:
        columns |= _section_law(multibody, links[name], found, drives)
    losses = {}
    for name, friction in frictions_of(multibody.mechanism).items():
        supported_there = found[friction.joint.name].ground
        losses[name] = joint_friction(
            multibody, friction, supported_there.force, supported_there.couple
        )
    for name, transmission in transmissions_of(multibody.mechanism).items():
        if transmission.presses:
            losses[name] = pressing_apart(transmission, tying[name])
        if transmission.loss is not None:
            losses[transmission.loss.name] = braking(multibody, transmission.loss, tying[name])
    rows = [*columns.values(), *(row for one in losses.values() for row in one.rows)]
    # All at once, for a substitution visits the whole graph; and mobilities rest.
    resting = ca.substitute(column(rows), multibody.mobility_rates, 0)
    every = iter(entries(ca.substitute(kinematics.found.put_into(resting), unknowns, values)))
    columns = {name: next(every) for name in columns}
    losses = {name: one.of_rows([next(every) for _ in one.rows]) for name, one in losses.items()}
    acting = solve(
        [losses[name] for name in needed(column(columns.values()), losses, want.frictions)],
        free,
        signs,
    )
    known = ca.substitute(column(columns.values()), acting.symbols, acting.values)
    columns = dict(zip(columns, entries(known), strict=True))
    for name in want.frictions:
        columns |= {
            Output("friction", name, "along"): acting.forces[name],
            Output("friction", name, "loss"): acting.lost[name],
        }
    return columns | acting.checks | held, free, acting


@dataclass(frozen=True, eq=False)
class Action:
    """A force [N] and a couple [N m], on the same axes."""

    force: Vector = ZERO
    couple: Vector = ZERO

    def member(self, name: str) -> Expression:
        """A component by what files call it, as ``fx`` or ``mz``."""
        return (self.force if name[0] == "f" else self.couple)["xyz".index(name[1])]

    def __add__(self, other: Action) -> Action:
        return Action(plus(self.force, other.force), plus(self.couple, other.couple))

    def resolved(self, rotation: Rotation) -> Action:
        """Reaction in turned axes."""
        return Action(rotation.resolve(self.force), rotation.resolve(self.couple))

    def __neg__(self) -> Action:
        return Action(times(-1, self.force), times(-1, self.couple))


@dataclass(frozen=True, eq=False)
class Reaction:
    """Force and moment of a joint's parent on its child: in ground axes, and in the parent's."""

    ground: Action
    local: Action


def _section_law(
    multibody: Multibody, link: Link, found: Mapping[str, Reaction], drives: Expression
) -> dict[Column, Expression]:
    """The coefficients of a link's law: of its material from the section mobility, of the tip and
    stations from what acts there.
    """
    name, space = link.name, multibody.mechanism.space
    table = table_of(space)
    slopes = _material(multibody, name)
    tip = Action()
    load_points: dict[Column, Any] = {}
    for source, place, action in _loads_on(multibody, link, found, drives):
        # About the link's axis, beside which it may act.
        acting = Action(action.force, plus(action.couple, cross((0.0, *place[1:]), action.force)))
        if place[0] is None:
            tip += acting
            continue
        force, couple = acting.force, acting.couple
        acts = (*force, *couple) if space else (*force[:2], couple[2])
        members = (*acts, place[0] / link.length)
        load_points |= {
            Output("station", name, member, source): value
            for member, value in zip(table.load_point, members, strict=True)
        }
    by_mass, by_moment = ([-slopes[k, column] for k in range(slopes.size1())] for column in (0, 1))
    at_tip, about = list(tip.force), tip.couple
    if _between_pins(multibody, link, drives):
        # The moment about the base is zero: of a light link between heavy bodies the tip's reaction
        # would leave rounding only.
        assert isinstance(link.mass, Density)
        _, first, inertia = link.mass.ends(link.length)
        at_tip[1] = -(
            by_mass[1] * first + by_moment[1] * (first * link.length + inertia / link.length)
        )
    along, beside, *above = zip(at_tip, by_mass, by_moment, strict=False)
    law = [*along, *beside, about[2]]
    for plane in above:
        law += [*plane, about[1], about[0]]
    local = {
        Output("law", name, member): ca.SX(value)
        for member, value in zip(table.law, law, strict=True)
    }
    frame = multibody.accelerated[name].along_axis()
    return (
        local
        | load_points
        | distributed_loads(multibody, link)
        | rotary(multibody, link, frame.rate, frame.angular)
    )


def _between_pins(multibody: Multibody, link: Link, drives: Expression) -> bool:
    """Return whether pins of a plane without effort at a link's base and at its tip are all that
    acts on it.
    """
    if multibody.mechanism.space:
        return False
    if any(part.point.body is link for part in (*multibody.applied, *multibody.held)):
        return False
    joints = [joint for joint in multibody.mechanism.joints.values() if link in joint.bodies]
    ends = [
        point.end for joint in joints for point in (joint.parent, joint.child) if point.body is link
    ]
    pins = all(joint.kind == "revolute" and joint.name not in drives for joint in joints)
    return pins and set(ends) == {"base", "tip"}


def _material(multibody: Multibody, name: str) -> Expression:
    """Force on the part of a link beyond a section, along the link and across, for a unit of its
    mass and of its first moment.

    In axes at rest that lie along the link at the instant: the energy does not see which axes at
    rest it is written in, and in these the first moment's forces are the rate squared and its
    change, to the last bit.
    """
    frame, space = multibody.accelerated[name].along_axis(), multibody.mechanism.space
    slopes, symbols = _of_any_link(space)
    motion = (frame.speed, frame.acceleration, frame.rate, frame.angular)
    return ca.substitute(slopes, symbols, column(value for vector in motion for value in vector))


@functools.cache
def _of_any_link(space: bool) -> tuple[Expression, Expression]:
    """Inertia terms with symbols for the velocity and acceleration of the link's base, its angular
    velocity, and its change; and these symbols.
    """
    symbols = ca.SX.sym("motion", 12)
    speed, acceleration, rate, angular = (
        (symbols[k], symbols[k + 1], symbols[k + 2]) for k in (0, 3, 6, 9)
    )
    base_frame = Frame(speed=speed, acceleration=acceleration, rate=rate, angular=angular)
    mass, first, second = (ca.SX.sym(f"mu{i}") for i in range(3))
    released, velocities = ca.SX.sym("ed_section", 3 if space else 2), Velocities()
    translation = (released[0], released[1], released[2] if space else 0.0)
    base = velocities.vector(base_frame.displaced(translation, ZERO).motion_of(ZERO))
    lever = velocities.vector(Frame(rate=rate, angular=angular).motion_of((1.0, 0.0, 0.0)))
    kinetic = (
        mass * ca.sumsqr(base) / 2 + first * ca.dot(base, lever) + second * ca.sumsqr(lever) / 2
    )
    forces = released_forces(kinetic, released, velocities)
    return ca.jacobian(forces, ca.vertcat(mass, first)), symbols


def _loads_on(
    multibody: Multibody, link: Link, found: Mapping[str, Reaction], drives: Expression
) -> Iterator[tuple[str, tuple[Expression, Expression, Expression], Action]]:
    """Actions on a link beyond its base: the part that acts, and in the link's axes the place and
    the force.

    At the tip x is None.
    """
    rotation = multibody.frames[link.name].rotation
    for joint in multibody.mechanism.joints.values():
        for point, sign in ((joint.parent, -1), (joint.child, 1)):
            if point.body is not link or joint.name not in found:
                continue
            # The parent's axes are as near as the joint; another way leads by the ground's.
            local = multibody.mechanism.space and point is joint.parent
            action = found[joint.name].local if local else found[joint.name].ground
            for axis in joint.axes:
                if axis.coordinate in drives:
                    along = multibody.along[axis.coordinate]
                    if local:
                        along = axis.direction if len(joint.axes) == 1 else rotation.resolve(along)
                    push = times(drives[axis.coordinate], along)
                    action += Action(couple=push) if axis.kind == "angle" else Action(push)
            if joint.slides and point is joint.parent:
                place = carried(joint, *(multibody.frames[body.name] for body in joint.bodies))
            elif _at_base(point):
                continue
            else:
                place = _place(point)
            action = action if sign > 0 else -action
            yield joint.name, place, action if local else action.resolved(rotation)
    counts: dict[str, int] = {}
    m = multibody.mechanism
    acting = {*m.joints, *m.loads, *m.constraints, *m.rows, *m.drives}
    for part in (*multibody.applied, *multibody.held):
        if part.point.body is link and part.distributed is None and not _at_base(part.point):
            name = part.source
            while counts.setdefault(part.source, 0) and name in acting:
                counts[part.source] += 1
                name = f"{part.source}_{counts[part.source]}"
            counts[part.source] = max(counts[part.source], 1)
            yield name, _place(part.point), Action(part.force, part.couple).resolved(rotation)


def _at_base(point: Point) -> bool:
    return nil(at_end(point))


def _place(point: Point) -> Vector:
    """A point in the axes of its link [m]; at the tip x is None."""
    return (None if point.end == "tip" else at_end(point), *point.place[1:])


def _reaction(multibody: Multibody, joint: Joint, actions: Mapping[str, Expression]) -> Reaction:
    """Reaction of a joint's parent on its child, without efforts; the moment is about the child's
    point.
    """
    rotation = multibody.frames[joint.parent.body.name].rotation
    if joint.name in multibody.own_axes:
        local = _on_parent(multibody, joint, actions)
        return Reaction(local.resolved(rotation.inverse), local)
    ground = _in_ground_axes(multibody, joint, actions)
    return Reaction(ground, ground.resolved(rotation))


def _in_ground_axes(
    multibody: Multibody, joint: Joint, actions: Mapping[str, Expression]
) -> Action:
    parent, child = (multibody.frames[body.name] for body in joint.bodies)
    for loop in multibody.loop_equations:
        if loop.joint is joint:
            found = Action(*reaction(joint, parent, child, loop.multipliers))
            body = joint.child.body
            if isinstance(body, Link | PointMass) and multibody.tree.lines.get(body) is joint:
                found += Action(*line_reaction(body, joint, multibody.accelerated[body.name]))
            return found
    two_force_link = multibody.tree.two_force_link_of.get(joint)
    if two_force_link is not None:
        force = Action(*split(actions[joint.name], space=True))
        return force if joint.child.body is two_force_link.link else -force
    return Action(*supported(joint, parent, child, *_on_child(multibody, joint, actions)))


def _on_parent(multibody: Multibody, joint: Joint, actions: Mapping[str, ca.SX]) -> Action:
    """A reaction in the parent's axes, of what is in those of the body that hangs on the joint, by
    the joint's own turns.
    """
    force, moment = _on_child(multibody, joint, actions)
    turned = [
        Rotation.about(c.axis.direction, *ca.vertsplit(c.variables))
        for axis in joint.axes
        if axis.kind == "angle" and (c := own_coordinate(axis, multibody.coordinates)) is not None
    ] + [joint.turned]
    if joint.child.body is multibody.tree.branch_of[joint.name].far.body:
        for rotation in reversed(turned):
            force, moment = rotation.apply(force), rotation.apply(moment)
    child = functools.reduce(Rotation.then, turned)
    return Action(*supported(joint, Frame(), Frame(rotation=child), force, moment))


def _on_child(
    multibody: Multibody, joint: Joint, actions: Mapping[str, Expression]
) -> tuple[Vector, Vector]:
    """Force and moment on a joint's child, from a mobility of the tree, in the axes of the
    mobility.
    """
    action = multibody.tree.branch_of[joint.name].sign * actions[joint.name]
    return split(action, space=multibody.mechanism.space)


def _on_joint_axes(joint: Joint, local: Action) -> dict[Column, Expression]:
    """A reaction on the axes of a joint's triad, which its parent carries: what ideal joints leave
    open lies along one of these.
    """
    vectors = {"f": local.force} | ({"m": local.couple} if joint.bears_moment else {})
    return {
        Output("reaction", joint.name, letter + axis): ca.SX(dot(direction, vector))
        for letter, vector in vectors.items()
        for axis, direction in zip("uvw", joint.triad, strict=True)
    }


def load_points_of(outputs: Iterable[Output], link: str) -> tuple[str, ...]:
    """The stations of a link that outputs name, in their order."""
    return tuple(
        dict.fromkeys(
            output.load_point
            for output in outputs
            if output.group == "station" and output.part == link
        )
    )

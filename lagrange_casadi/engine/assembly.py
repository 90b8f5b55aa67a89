"""Grows the graphs of a mechanism outward from the ground, along its spanning tree.

Kinetic energy of bodies (paper eq. 16) is in velocities of points and of directions: no direction
itself is in it. In space a rigid body's energy is that of its centre and of its axes e: E = m v^2 /
2 + sum J_ij e_i' . e_j' / 2 with the second moments J = tr(I) / 2 - I of its mass about the centre.
The rates of the axes are rates of places, as a Lagrange system needs them; the angular velocity is
not. A slender link has but one such axis; one whose slices have rotary inertia has the others too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame, Velocities
from ..base.scalars import column
from ..base.vectors import AXES, ZERO, dot, minus, nil, times
from ..errors import DeclarationError
from ..model.constraints import Constraint, Row
from ..model.corners import smooth_constraint
from ..model.declared_parts import Link, PointMass, RigidMass, Vector
from ..model.joints import Axis, Joint
from ..model.link_density import Density
from ..model.mass_properties import second_moments
from ..model.mechanism import Mechanism
from .applied import applied_by, held_by, push, turned_by, work
from .growing import Grown, coordinates_of
from .joint_closure import loop_residuals
from .mesh_forces import meshed_by
from .multibody import Applied, LoopEquations, Multibody, RowGraph, change, released_forces, split
from .tree import Tree
from .two_force_links import TwoForceFrame


def assemble(
    mechanism: Mechanism,
    tree: Tree,
    driven: Collection[str],
    reactions: Collection[str],
    pushed: Collection[str] = (),
    user_outputs: Collection[str] = (),
) -> Multibody:
    """The graphs of a frozen mechanism, with mobilities for the named joints' reactions, and for
    nothing else.

    ``driven`` are the joints whose motion is given, and ``pushed`` those along which efforts are
    unknowns of their own; ``user_outputs`` names the user's outputs.

    The frames and gaps that positions are solved from are built without any mobility: they do not
    depend on what is wanted. Gravity is an acceleration of the ground, upward, in the frames that
    matter is weighed in (d'Alembert).
    """
    measured = [
        measure.axis.coordinate
        for measure in mechanism.measures.asked.values()
        if measure.axis is not None
    ]
    carried = coordinates_of(mechanism, tree, driven, {*measured, *pushed})
    upward = times(-1, mechanism.gravity)
    weighed = Frame(
        acceleration=upward, carried=Frame(acceleration=upward) if mechanism.space else None
    )
    resting, accelerated = Grown(mechanism, carried, Frame()), Grown(mechanism, carried, weighed)
    for branch in tree.branches:
        resting.hang(branch, displace=False)
        # What acts where loops close is in ground axes.
        accelerated.hang(
            branch,
            displace=branch.joint.name in reactions,
            along=not (tree.closing or tree.two_force_links),
        )
    loops = [
        LoopEquations(joint.name, joint, *loop_residuals(joint, *resting.ends(joint)))
        for joint in tree.closing
    ]
    for two_force_link in tree.two_force_links:
        phi, rate, change_of_rate = map(ca.SX, resting.span(two_force_link, displace=()))
        name = two_force_link.link.name
        loops.append(LoopEquations(name, None, phi, rate, change_of_rate, two_force_link))
        released = [joint.name for joint in two_force_link.joints if joint.name in reactions]
        accelerated.span(two_force_link, displace=released)
    for constraint in mechanism.constraints.values():
        residual = resting.at_state(constraint.phi, counted=True)
        rate = change(residual, resting.coordinates, mechanism.time)
        acceleration = change(rate, resting.coordinates, mechanism.time)
        equations = LoopEquations(constraint.name, None, residual, rate, acceleration)
        if (smooth := smooth_constraint(mechanism, constraint)) is not None:
            counted = resting.at_state(ca.vertcat(*smooth.symbols), counted=True)
            equations = replace(equations, counted=counted)
        loops.append(equations)
    rows = tuple(_row(resting, row) for row in mechanism.rows.values())
    applied = tuple(part for load in mechanism.loads.values() for part in applied_by(load, resting))
    applied += tuple(part for one in mechanism.drives.values() for part in turned_by(one, resting))
    held = [
        part
        for loop in loops
        if loop.declared
        for part in _held(resting, mechanism.constraints[loop.name], loop)
    ]
    held += [
        part
        for program in rows
        for part in held_by(resting, program.row.name, program.row.expression, program)
    ]
    velocities = Velocities()
    spun = {
        b.far.body
        for b in tree.branches
        if not b.joint.slides and (b.joint.name in driven or b.near.body is mechanism.ground)
    }
    slid = {b.far.body for b in tree.branches if b.reverse and b.joint.slides}
    energies = [
        _energy_on_line(body, tree.lines[body], accelerated.frames[body.name], velocities)
        if body in tree.lines
        else kinetic_energy(
            body,
            accelerated.frames[body.name],
            velocities,
            space=mechanism.space,
            spun=body in spun and body.oriented,
            slid=body in slid,
        )
        for body in mechanism.moving
    ]
    kinetic = sum(energies, ca.SX(0))
    work(accelerated, (*applied, *held), loops, velocities)
    # Where a joint with three turns closes a loop, its angles are not measured.
    unmeasured = [joint for joint in tree.closing if joint.turns > 2]
    unmeasured += tree.two_force_link_of
    sphericals = [c.name for c in resting.coordinates if c.spherical is not None]
    outputs = {name: resting.at_state(mechanism.outputs[name].expression) for name in user_outputs}
    efforts = {name: ca.SX.sym(f"tau_{name}") for name in pushed}
    for name, effort in efforts.items():
        _refuse_unmeasured(name, *mechanism.coordinates[name], tree, unmeasured)
        push(accelerated, *mechanism.coordinates[name], effort, velocities)
    return Multibody(
        mechanism=mechanism,
        tree=tree,
        coordinates=resting.coordinates,
        loop_equations=tuple(loops),
        rows=rows,
        mobilities=accelerated.mobilities,
        own_axes=frozenset(accelerated.own_axes),
        frames=resting.frames,
        accelerated=accelerated.frames,
        applied=applied,
        held=tuple(held),
        efforts=efforts,
        along={
            name: resting.along(joint, axis)
            for name, (joint, axis) in mechanism.coordinates.items()
            if joint not in unmeasured and name not in sphericals
        },
        axes=resting.turning,
        user_outputs=outputs,
        strokes={one.what: resting.at_state(one.used) for one in mechanism.strokes.values()},
        turned=tuple(resting.turned.values()),
        kinetic=kinetic,
        velocities=velocities,
    )


def _held(resting: Grown, constraint: Constraint, loop: LoopEquations) -> Iterable[Applied]:
    """Action of a constraint's multiplier on bodies."""
    if constraint.transmission is not None:
        return meshed_by(resting, constraint.transmission, loop.multipliers)
    return held_by(resting, constraint.name, constraint.phi, loop)


def _refuse_unmeasured(
    name: str, joint: Joint, axis: Axis, tree: Tree, unmeasured: Collection[Joint]
) -> None:
    """Raise :class:`DeclarationError` for a drive along a turn that has no angle."""
    if axis.kind != "angle" or joint not in unmeasured:
        return
    two_force_link = tree.two_force_link_of.get(joint)
    why = (
        f"the spin of two-force link '{two_force_link.link.name}' about its own axis moves nothing"
        if two_force_link is not None
        else "the joint closes a loop, where its rotations are not evaluated"
    )
    raise DeclarationError(f"drive '{name}': {why}; drive another joint")


def _row(resting: Grown, row: Row) -> RowGraph:
    """A row, and the size of what is added up in it: rates of coordinates, in what is measured, in
    the row.

    Not the size of its own terms: of a motion along which a row is idle, all of them are rounding.
    """
    residual, rates = resting.at_state(row.expression), column(c.rate for c in resting.coordinates)
    measured = resting.mechanism.measures.rates
    slopes = ca.fabs(resting.at_state(ca.jacobian(row.expression, measured)))
    going = ca.fabs(ca.jacobian(resting.at_state(measured), rates)) @ ca.fabs(rates)
    rest = ca.fabs(
        resting.at_state(ca.substitute(row.expression, measured, ca.SX.zeros(measured.numel())))
    )
    return RowGraph(row, residual, slopes @ going + rest, ca.SX.sym(f"mu_{row.name}"))


def kinetic_energy(
    body: Link | PointMass,
    frame: Frame,
    velocities: Velocities,
    *,
    space: bool,
    spun: bool,
    slid: bool,
) -> Expression:
    """The kinetic energy of a body that moves with a frame.

    Where a body of a plane is ``spun``, its velocities are split into that of its joint and that
    about it: else the square of its rate, which bears on no effort, would leave there its rounding.
    A body that is ``slid`` is held at another of its points at every instant, whose velocity is the
    rate of no place.
    """
    if not (isinstance(body, Link) and isinstance(body.mass, Density)):
        assert not isinstance(body.mass, Density)
        return _rigid(body.mass, frame, velocities, space=space, spun=spun)
    base, tip, inertia = body.mass.ends(body.length)
    points: list[tuple[Any, Vector]] = [(base, ZERO), (tip, (body.length, 0.0, 0.0))]
    if not space:
        return _flat(points, inertia, frame, velocities, spun=spun)
    energy = _slender(points, inertia, frame, velocities, slid=slid)
    return (
        energy
        if body.mass.slices is None
        else energy + _turning(body.mass.slices.whole(body.length), frame, velocities)
    )


def _energy_on_line(
    body: Link | PointMass, joint: Joint, frame: Frame, velocities: Velocities
) -> Expression:
    """The kinetic energy of a body along the line on which it slides, and about it: what is across,
    the line bears (:func:`.line_reaction`), but for the moment about it of what is beside it.
    """
    line, place = joint.triad[0], joint.child.place
    speed, acceleration = frame.motion_of(place)
    along = velocities.number(dot(speed, line), dot(acceleration, line))
    if isinstance(body, PointMass):
        return body.mass * along**2 / 2
    own, going, parts = joint.turned.resolve(line), ca.SX.sym("going", 4), Velocities()
    u, v, w, turning = ca.vertsplit(going)
    moving = Frame(speed=(u, v, w), rate=times(turning, own), anchor=place)
    energy = kinetic_energy(body, moving, parts, space=True, spun=False, slid=False)
    energy = ca.substitute(energy, column(parts.symbols), column(parts.graphs))
    x, y, z, _ = ca.vertsplit(ca.jacobian(ca.jacobian(energy, turning), going).T)
    couple = dot((x, y, z), frame.rotation.resolve(acceleration))
    about = velocities.number(dot(frame.rate, line), dot(frame.angular, line), -couple)
    return ca.substitute(energy, going, ca.vertcat(*times(along, own), about))


def line_reaction(body: Link | PointMass, joint: Joint, frame: Frame) -> tuple[Vector, Vector]:
    """The inertia of a body, and its weight, across the line on which it slides: a force at the
    joint's point of it [N], and a couple [N m].
    """
    (line, across, _), place = joint.triad, joint.child.place
    speed, acceleration = frame.motion_of(place)
    if isinstance(body, PointMass):
        return times(body.mass * dot(acceleration, across), across), ZERO
    released, velocities = ca.SX.sym("ed_line", 6), Velocities()
    moving = Frame(
        speed=speed,
        acceleration=acceleration,
        rotation=frame.rotation,
        rate=frame.rate,
        angular=frame.angular,
        anchor=place,
    ).displaced(*split(released, space=True))
    energy = kinetic_energy(body, moving, velocities, space=True, spun=False, slid=False)
    force, couple = (
        minus(part, times(dot(part, line), line))
        for part in split(released_forces(energy, released, velocities), space=True)
    )
    return force, couple


def _rigid(
    mass_properties: Expression, frame: Frame, velocities: Velocities, *, space: bool, spun: bool
) -> Expression:
    """A rigid body, or a point mass."""
    if not isinstance(mass_properties, RigidMass):
        return (
            mass_properties
            * ca.sumsqr(velocities.vector(frame.shortest.motion_of(frame.anchor)))
            / 2
            if space
            else _flat([(mass_properties, ZERO)], 0.0, frame, velocities, spun=False)
        )
    if not space:
        return _flat(
            [(mass_properties.mass, mass_properties.centre)],
            mass_properties.inertia[2][2],
            frame,
            velocities,
            spun=spun,
        )
    frame = frame.shortest
    energy = (
        mass_properties.mass
        * ca.sumsqr(velocities.vector(frame.motion_of(mass_properties.centre)))
        / 2
    )
    moments = second_moments(mass_properties.inertia)
    axes = {
        i: velocities.vector(_direction(frame, AXES[i]))
        for i in range(3)
        if not all(nil(moment) for moment in moments[i])
    }
    for i in axes:
        energy += moments[i][i] * ca.sumsqr(axes[i]) / 2
        for j in range(i):
            if j in axes and not nil(moments[i][j]):
                energy += moments[i][j] * ca.dot(axes[i], axes[j])
    return energy


def _slender(
    points: list[tuple[float, Vector]],
    inertia: Expression,
    frame: Frame,
    velocities: Velocities,
    *,
    slid: bool,
) -> Expression:
    """A slender link, by the velocity of one of its points and of its axis: of the joint that holds
    it, or of its base.
    """
    (x, y, z), frame = frame.anchor, frame.shortest
    held = x if nil(y) and nil(z) and not slid else 0.0
    base = velocities.vector(frame.motion_of((held, 0.0, 0.0)))
    axis = velocities.vector(
        frame.course if isinstance(frame, TwoForceFrame) else _direction(frame, AXES[0])
    )
    first, second = ca.SX(0), ca.SX(inertia)
    for mass, place in points:
        arm = place[0] - held
        first, second = first + mass * arm, second + mass * (arm * arm)
    total = sum((mass for mass, _ in points), ca.SX(0))
    return total * ca.sumsqr(base) / 2 + first * ca.dot(base, axis) + second * ca.sumsqr(axis) / 2


def _turning(
    moments: tuple[Expression, Expression, Expression], frame: Frame, velocities: Velocities
) -> Expression:
    """The energy of slices that turn, by their second moments yy, zz, yz and the rates of the axes
    in their plane.
    """
    y, z = (velocities.vector(_direction(frame.shortest, axis)) for axis in AXES[1:])
    yy, zz, yz = moments
    return yy * ca.sumsqr(y) / 2 + zz * ca.sumsqr(z) / 2 + (0 if nil(yz) else yz * ca.dot(y, z))


def _direction(frame: Frame, axis: Vector) -> tuple[Vector, Vector]:
    """Rate and acceleration of a direction that a body carries."""
    return Frame(rotation=frame.rotation, rate=frame.rate, angular=frame.angular).motion_of(axis)


def _flat(
    points: list[tuple[Expression, Vector]],
    inertia: Expression,
    frame: Frame,
    velocities: Velocities,
    *,
    spun: bool,
) -> Expression:
    """A body of a plane: masses at points, and what is left of its inertia."""
    if not spun:
        energy = sum(
            (
                mass * ca.sumsqr(velocities.vector(frame.motion_of(place))) / 2
                for mass, place in points
            ),
            ca.SX(0),
        )
        return energy + inertia * velocities.number(frame.rate[2], frame.angular[2]) ** 2 / 2
    held = velocities.vector((frame.speed, frame.acceleration))
    about = replace(frame, at=ZERO, speed=ZERO, acceleration=ZERO)  # the anchor rests
    energy = sum((mass for mass, _ in points), ca.SX(0)) * ca.sumsqr(held) / 2
    for mass, place in points:
        energy += mass * ca.dot(held, velocities.vector(about.motion_of(place)))
        x, y, _ = minus(place, frame.anchor)
        inertia += mass * (x**2 + y**2)
    return energy + inertia * velocities.number(frame.rate[2], frame.angular[2]) ** 2 / 2

"""Action of loads and multipliers on bodies, and the work that they do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Velocities
from ..base.vectors import AXES, ZERO, cross, dot, minus, nil, plus, times
from ..model.declared_parts import Link, Point, Vector
from ..model.drives import Drive
from ..model.joints import Axis, Joint
from ..model.loads import Force, Friction, LineLoad, Load, Spring, Torque
from .growing import Grown
from .joint_closure import carried, reaction, residual_motion
from .multibody import Applied, LoopEquations, RowGraph, motion_along
from .pressing import way_of


def applied_by(load: Load, resting: Grown) -> list[Applied]:
    """A load as forces and couples at points, by the state."""
    if isinstance(load, Force | Torque):
        acts = resting.vector_at_state(load.components)
        if load.turning:
            acts = resting.frames[load.point.body.name].rotation.apply(acts)
        if isinstance(load, Force):
            return [Applied(load.name, load.point, acts)]
        return _both(load.name, load.point, load.against, couple=acts)
    if isinstance(load, LineLoad):
        return [_along(load, resting)]
    if isinstance(load, Friction) and load.every_way:
        couple = times(load.symbol, way_of(load.joint, resting))
        return _both(load.name, load.joint.child, load.joint.parent, couple=couple)
    if isinstance(load, Friction):
        return _along_coordinate(resting, load.name, load.joint, load.axis, load.symbol)
    assert isinstance(load, Spring)
    at = resting.at_state
    first, second = (resting.frames[point.body.name] for point in (load.first, load.second))
    apart = minus(second.place_of(load.second.place), first.place_of(load.first.place))
    closing = minus(second.motion_of(load.second.place)[0], first.motion_of(load.first.place)[0])
    distance = ca.sqrt(dot(apart, apart))
    rate = dot(apart, closing) / distance
    tension = at(load.stiffness) * (distance - at(load.length)) + at(load.damping) * rate
    x, y, z = (tension * component / distance for component in apart)
    return _both(load.name, load.first, load.second, (x, y, z))


def turned_by(drive: Drive, resting: Grown) -> Iterator[Applied]:
    """Actions of a drive's rotor on the bodies of its joint, by its acceleration."""
    joint, axis, spin = drive.joint, drive.axis, drive.spin
    _, rate, acceleration = motion_along(joint, axis, resting.frames, resting.coordinates)
    parent, about = resting.frames[joint.parent.body.name], resting.along(joint, axis)
    taken = drive.reflected * acceleration
    if not nil(spin) and joint.parent.body is not resting.mechanism.ground:
        taken += spin * dot(about, parent.angular)
        turning = plus(times(acceleration, about), times(rate, cross(parent.rate, about)))
        yield Applied(drive.name, _under(resting, joint), couple=times(-spin, turning))
    if not nil(taken):
        yield from _along_coordinate(resting, drive.name, joint, axis, -taken)


def _both(
    name: str, first: Point, second: Point, force: Vector = ZERO, couple: Vector = ZERO
) -> list[Applied]:
    """An action at a point of a body, and the opposite one at a point of another body."""
    opposite = (ZERO if acts is ZERO else times(-1, acts) for acts in (force, couple))
    return [Applied(name, first, force, couple), Applied(name, second, *opposite)]


def held_by(
    resting: Grown, name: str, expression: ca.SX, of: LoopEquations | RowGraph
) -> Iterator[Applied]:
    """Action of a multiplier on bodies, by the terms of its equation: a joint's coordinate, a
    place, a direction.
    """
    for measure in resting.mechanism.measures.asked.values():
        symbols = ca.vertcat(*(measure.places if isinstance(of, LoopEquations) else measure.rates))
        if not ca.depends_on(expression, symbols):
            continue
        part = [
            of.multipliers * resting.at_state(slope, counted=isinstance(of, LoopEquations))
            for slope in ca.vertsplit(ca.jacobian(expression, symbols).T)
        ]
        if isinstance(measure.of, Point):
            x, y, z = (*part, 0.0)[:3]
            yield Applied(name, measure.of, (x, y, z))
        elif isinstance(measure.of, Link):
            yield Applied(name, measure.of.base, couple=(0.0, 0.0, part[0]))
        else:
            assert measure.axis is not None
            yield from _along_coordinate(resting, name, measure.of, measure.axis, part[0])


def work(
    accelerated: Grown,
    applied: Iterable[Applied],
    loops: Iterable[LoopEquations],
    velocities: Velocities,
) -> None:
    """Let loads and multipliers do work: along the velocities of points, and of what a closing
    joint holds together.
    """
    for part in applied:
        frame = accelerated.frames[part.point.body.name]
        _bear(velocities, frame.motion_of(part.point.place), part.force)
        _bear(velocities, (frame.rate, frame.angular), part.couple)
    for loop in loops:
        if loop.two_force_link is not None:
            frame = accelerated.frames[loop.two_force_link.link.name]
            (speed, acceleration), (last_speed, last_acceleration) = (
                frame.motion_of((place, 0.0, 0.0))
                for place in (
                    loop.two_force_link.start,
                    loop.two_force_link.start + loop.two_force_link.length,
                )
            )
            along = times(loop.multipliers, frame.rotation.x)
            _bear(
                velocities,
                (minus(last_speed, speed), minus(last_acceleration, acceleration)),
                along,
            )
        if loop.joint is not None:
            parent, child = accelerated.ends(loop.joint)
            force, moment = reaction(loop.joint, parent, child, loop.multipliers)
            _bear(velocities, residual_motion(loop.joint, parent, child), force)
            _bear(
                velocities,
                (minus(child.rate, parent.rate), minus(child.angular, parent.angular)),
                moment,
            )


def push(
    accelerated: Grown, joint: Joint, axis: Axis, effort: Expression, velocities: Velocities
) -> None:
    """Let an effort do work along a joint's coordinate."""
    parent, child = accelerated.ends(joint)
    along = times(effort, accelerated.along(joint, axis))
    turning = (minus(child.rate, parent.rate), minus(child.angular, parent.angular))
    _bear(
        velocities,
        turning if axis.kind == "angle" else residual_motion(joint, parent, child),
        along,
    )


def _bear(velocities: Velocities, motion: tuple[Vector, Vector], force: Vector) -> None:
    if not all(nil(component) for component in force):
        velocities.vector(motion, force)


def _along(load: LineLoad, resting: Grown) -> Applied:
    """A load along a link: its coefficients on the link's axes, and its resultant at the middle of
    the part on which it acts.

    For a power j of s = (end - xi)/(end - start) the integrals of s^j and of s^j (1/2 - s) from 0
    to 1 say force and couple.
    """
    rotation, reach = resting.frames[load.link.name].rotation, load.reach
    forces = [
        resting.vector_at_state((x, y, z)) for x, y, z in zip(load.x, load.y, load.z, strict=True)
    ]
    resolved = forces if load.turning else [rotation.resolve(one) for one in forces]
    whole, couple = ZERO, ZERO
    for power, (there, here) in enumerate(zip(forces, resolved, strict=True)):
        whole = plus(whole, times(reach / (power + 1), there))
        turning = cross(AXES[0], here) if power else ZERO
        couple = plus(
            couple, times(-(reach * reach) * (power / (2 * (power + 1) * (power + 2))), turning)
        )
    force = rotation.apply(whole) if load.turning else whole
    return Applied(load.name, load.points[0], force, rotation.apply(couple), tuple(resolved))


def _along_coordinate(
    resting: Grown, name: str, joint: Joint, axis: Axis, force: Expression
) -> list[Applied]:
    """Action on its bodies of a force that works along a joint's coordinate."""
    along, under = times(force, resting.along(joint, axis)), _under(resting, joint)
    if axis.kind == "angle":
        return _both(name, joint.child, under, couple=along)
    return _both(name, joint.child, under, along)


def _under(resting: Grown, joint: Joint) -> Point:
    """The point of a joint's parent that bears its child."""
    if not joint.slides:
        return joint.parent
    x, y, z = carried(joint, *resting.ends(joint))
    return Point(joint.parent.body, x, y, z=z)

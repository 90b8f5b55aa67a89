"""Joints in space: sliding directions, closure equations, reactions.

What a plane has none of is nil.

In each function ``parent`` and ``child`` are the frames of a joint's bodies.
"""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from ..base.frames import Frame
from ..base.rotation import Rotation
from ..base.scalars import column
from ..base.vectors import AXES, ZERO, cross, dot, minus, nil, plus, times
from ..model.declared_parts import Expression, Vector
from ..model.joints import Joint

Residual = tuple[Expression, Expression, Expression]
"""Phi, Phi' and Phi''."""


def apart(joint: Joint, parent: Frame, child: Frame) -> Vector:
    """Vector from the parent's point to the child's, in the parent's axes."""
    return minus(parent.local(child.place_of(joint.child.place)), joint.parent.place)


def residual_motion(joint: Joint, parent: Frame, child: Frame) -> tuple[Vector, Vector]:
    """Velocity and acceleration of a joint's point on the child, less those of the parent's point
    that it is at, in ground axes.
    """
    local = child.motion_of(joint.child.place)
    under = (
        parent.motion_at(child.place_of(joint.child.place))
        if joint.slides
        else parent.motion_of(joint.parent.place)
    )
    return minus(local[0], under[0]), minus(local[1], under[1])


def carried(joint: Joint, parent: Frame, child: Frame) -> Vector:
    """The place of the parent where a joint's child is at the moment, in the parent's axes."""
    place = joint.parent.place
    for axis in slides_of(joint):
        place = plus(place, times(dot(apart(joint, parent, child), axis), axis))
    return place


def slides_of(joint: Joint) -> list[Vector]:
    """The directions along which a joint slides, in the parent's axes; and that of a screw."""
    return [joint.triad[freedom.direction] for freedom in joint.freedoms if freedom.move != "turn"]


def slide_motion(
    joint: Joint, parent: Frame, child: Frame, along: Vector
) -> tuple[Expression, Expression]:
    """Rate and acceleration of a joint along a direction in the parent's axes, while nothing moves
    but along the joint's slides.
    """
    axis = parent.rotation.apply(along)
    speed, acceleration = residual_motion(joint, parent, child)
    rate, change = dot(speed, axis), dot(acceleration, axis)
    if len(slides_of(joint)) > 1:
        change -= 2 * dot(cross(parent.rate, speed), axis)
    return rate, change


def turned(joint: Joint, number: int, parent: Frame, child: Frame) -> Expression:
    """The angle of a joint about the first (0) or the second of its one or two turns; in a plane it
    counts turns.
    """
    if joint.planar:
        return child.rotation.against(parent.rotation).angle
    misaligned = misalignment(joint, parent, child)
    first, second, third = (joint.turned.resolve(direction) for direction in _triad(joint))
    if number == 0:
        there = misaligned.apply(second)
        return ca.atan2(dot(there, third), dot(there, second))
    there = misaligned.resolve(first)
    return ca.atan2(dot(there, third), dot(there, first))


def turning(
    joint: Joint, number: int, parent: Frame, child: Frame
) -> tuple[Expression, Expression]:
    """Rate and acceleration of :func:`turned`, while nothing turns but about the joint's axes."""
    rate, angular = minus(child.rate, parent.rate), minus(child.angular, parent.angular)
    axis = turning_axes(joint, parent, child)[number]
    carrier = child if number else parent
    return dot(rate, axis), dot(angular, axis) + dot(rate, cross(carrier.rate, axis))


def loop_residuals(joint: Joint, parent: Frame, child: Frame) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Phi of a joint that closes a loop (paper eq. 5) with Phi' and Phi''.

    Phi are gaps in ground axes or across slides, and of directions where they are held; its
    multipliers are the action of the parent on the child along these gaps.
    """
    residuals = [
        *_residuals_of_place(joint, parent, child),
        *_residuals_of_direction(joint, parent, child),
    ]
    phi, phi_rate, phi_acceleration = (
        column(residual[k] for residual in residuals) for k in range(3)
    )
    return phi, phi_rate, phi_acceleration


def reaction(
    joint: Joint, parent: Frame, child: Frame, multipliers: ca.SX
) -> tuple[Vector, Vector]:
    """Force and moment of the parent on the child at a joint that closes a loop, in ground axes, by
    its multipliers.
    """
    force, moment = ZERO, ZERO
    places = [direction for _, direction in _across(joint, parent)]
    for k, direction in enumerate(places):
        force = plus(force, times(multipliers[k], direction))
    base, misaligned = parent.rotation.then(joint.turned), misalignment(joint, parent, child)
    for k, (local, across) in enumerate(held_directions(joint), len(places)):
        couple = base.apply(cross(misaligned.apply(local), across))
        moment = plus(moment, times(multipliers[k], couple))
    return force, moment


def supported(
    joint: Joint, parent: Frame, child: Frame, force: Vector, moment: Vector
) -> tuple[Vector, Vector]:
    """Reaction of a joint to a force and a moment in ground axes: nothing along its slides, nothing
    about its turns.

    A screw bears a moment about its axis that is less its force along it times its pitch, so that
    both do no work.
    """
    slides = [
        parent.rotation.apply(joint.triad[f.direction]) for f in joint.freedoms if f.move == "slide"
    ]
    if len(slides) == 1 and joint.planar:
        normal = cross(AXES[2], slides[0])
        force = times(dot(force, normal), normal)
    else:
        for axis in slides:
            force = minus(force, times(dot(force, axis), axis))
    if joint.bears_moment:
        for axis in turning_axes(joint, parent, child):
            about = dot(moment, axis)
            if not nil(joint.pitch):
                about += joint.pitch * dot(force, axis)
            moment = minus(moment, times(about, axis))
    return force, moment


def turning_axes(joint: Joint, parent: Frame, child: Frame) -> list[Vector]:
    """The axes in ground axes about which a joint that bears a moment lets its child turn, at right
    angles to each other.
    """
    rotations = [
        joint.triad[freedom.direction] for freedom in joint.freedoms if freedom.move != "slide"
    ]
    local = [joint.turned.resolve(direction) for direction in rotations[1:]]
    return [*map(parent.rotation.apply, rotations[:1]), *map(child.rotation.apply, local[:1])]


def off(joint: Joint, parent: Frame, child: Frame) -> Expression | None:
    """One less the cosine of what the directions that a joint holds are off; None where half a turn
    off is as good.
    """
    rotations = [f for f in joint.freedoms if f.move != "slide"]
    misaligned = misalignment(joint, parent, child)
    if not rotations:
        # Of a plane the trace is 1 + 2 cos.
        return (
            1 - misaligned.c
            if misaligned.angle is not None
            else 1 - (misaligned.x[0] + misaligned.y[1] + misaligned.z[2] - 1) / 2
        )
    if len(rotations) > 1 or joint.planar:
        return None
    axis = joint.turned.resolve(joint.triad[rotations[0].direction])
    return 1 - dot(axis, misaligned.apply(axis))


def misalignment(joint: Joint, parent: Frame, child: Frame) -> Rotation:
    """Rotation of the child from the position in which the joint's coordinates are zero."""
    return child.rotation.against(parent.rotation.then(joint.turned))


def _across(joint: Joint, parent: Frame) -> list[tuple[Vector, Vector]]:
    """The directions along which a joint holds its points together: in the parent's axes, if it
    slides, and in ground axes.
    """
    many = 2 if joint.planar else 3
    if not joint.slides:
        return [(axis, axis) for axis in AXES[:many]]
    slid = {freedom.direction for freedom in joint.freedoms if freedom.move == "slide"}
    held = (joint.triad[k] for k in range(many) if k not in slid)
    return [(axis, parent.rotation.apply(axis)) for axis in held]


def held_directions(joint: Joint) -> tuple[tuple[Vector, Vector], ...]:
    """Pairs of directions that a joint holds at right angles, of its child and of its parent, where
    coordinates are zero.
    """
    if not joint.bears_moment:
        return ()
    own = map(joint.turned.resolve, _triad(joint)) if joint.turns else AXES
    first, second, third = own
    if joint.planar:
        return ((first, second),)
    return (
        ((first, second), (second, third), (third, first)),
        ((first, second), (first, third)),
        ((second, first),),
    )[joint.turns]


def _residuals_of_place(joint: Joint, parent: Frame, child: Frame) -> Iterator[Residual]:
    """Gaps between points."""
    speed, acceleration = residual_motion(joint, parent, child)
    slides, base = slides_of(joint), parent.rotation
    distance = (
        apart(joint, parent, child)
        if slides
        else minus(child.place_of(joint.child.place), parent.place_of(joint.parent.place))
    )
    for along, across in _across(joint, parent):
        # The lines turn under what slides on them (Coriolis).
        turned = sum(
            2 * dot(parent.rate, base.apply(cross(axis, along))) * dot(speed, base.apply(axis))
            for axis in slides
        )
        yield dot(distance, along), dot(speed, across), dot(acceleration, across) - turned


def _residuals_of_direction(joint: Joint, parent: Frame, child: Frame) -> Iterator[Residual]:
    """Gaps of directions that are held."""
    base, misaligned = parent.rotation.then(joint.turned), misalignment(joint, parent, child)
    rate, angular = minus(child.rate, parent.rate), minus(child.angular, parent.angular)
    turning = Frame(
        rate=base.resolve(rate), angular=base.resolve(minus(angular, cross(parent.rate, rate)))
    )
    for local, across in held_directions(joint):
        there = misaligned.apply(local)
        speed, acceleration = turning.motion_of(there)
        yield dot(there, across), dot(speed, across), dot(acceleration, across)


def _triad(joint: Joint) -> tuple[Vector, Vector, Vector]:
    """The joint's directions, from that of its first turn on."""
    first = next((freedom.direction for freedom in joint.freedoms if freedom.move != "slide"), 0)
    u, v, w = (joint.triad[(first + k) % 3] for k in range(3))
    return u, v, w

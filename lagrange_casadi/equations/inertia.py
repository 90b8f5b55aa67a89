"""Kinetic energy of bodies (paper eq. 16), in velocities of points and of directions: no direction itself is in it.

In space a rigid body's energy is that of its centre and of its axes e: E = m v^2 / 2 + sum J_ij e_i' . e_j' / 2 with the second
moments J = tr(I) / 2 - I of its mass about the centre. The rates of the axes are rates of places, as a Lagrange system needs them;
the angular velocity is not. A slender link has but one such axis; one whose slices have rotary inertia has the others too.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from ..declare.density import Density
from ..declare.matter import second_moments
from ..declare.parts import Link, PointMass, RigidMass, Vector
from ..geometry.frames import Frame, Velocities
from ..geometry.vectors import AXES, ZERO, minus, nil
from .bars import BarFrame


def kinetic_energy(body: Link | PointMass, frame: Frame, velocities: Velocities, *, space: bool, spun: bool, slid: bool) -> Any:
    """The kinetic energy of a body that moves with a frame.

    Where a body of a plane is ``spun``, its velocities are split into that of its joint and that about it: else the square of its
    rate, which bears on no effort, would leave there its rounding. A body that is ``slid`` is held at another of its points at
    every instant, whose velocity is the rate of no place.
    """
    if not (isinstance(body, Link) and isinstance(body.mass, Density)):
        assert not isinstance(body.mass, Density)
        return _rigid(body.mass, frame, velocities, space=space, spun=spun)
    base, tip, inertia = body.mass.ends(body.length)
    points: list[tuple[Any, Vector]] = [(base, ZERO), (tip, (body.length, 0.0, 0.0))]
    if not space:
        return _flat(points, inertia, frame, velocities, spun=spun)
    energy = _slender(points, inertia, frame, velocities, slid=slid)
    return energy if body.mass.slices is None else energy + _turning(body.mass.slices.whole(body.length), frame, velocities)


def _rigid(matter: Any, frame: Frame, velocities: Velocities, *, space: bool, spun: bool) -> Any:
    """A rigid body, or a point mass."""
    if not isinstance(matter, RigidMass):
        return (
            matter * ca.sumsqr(velocities.vector(frame.shortest.motion_of(frame.anchor))) / 2
            if space
            else _flat([(matter, ZERO)], 0.0, frame, velocities, spun=False)
        )
    if not space:
        return _flat([(matter.mass, (matter.centre[0], matter.centre[1], 0.0))], matter.inertia, frame, velocities, spun=spun)
    (x, y, z), frame = matter.centre, frame.shortest
    energy = matter.mass * ca.sumsqr(velocities.vector(frame.motion_of((x, y, z)))) / 2
    moments = second_moments(matter.inertia)
    axes = {i: velocities.vector(_direction(frame, AXES[i])) for i in range(3) if not all(nil(moment) for moment in moments[i])}
    for i in axes:
        energy += moments[i][i] * ca.sumsqr(axes[i]) / 2
        for j in range(i):
            if j in axes and not nil(moments[i][j]):
                energy += moments[i][j] * ca.dot(axes[i], axes[j])
    return energy


def _slender(points: list[tuple[Any, Vector]], inertia: Any, frame: Frame, velocities: Velocities, *, slid: bool) -> Any:
    """A slender link, by the velocity of one of its points and of its axis: of the joint that holds it, or of its base."""
    (x, y, z), frame = frame.anchor, frame.shortest
    held = x if nil(y) and nil(z) and not slid else 0.0
    base = velocities.vector(frame.motion_of((held, 0.0, 0.0)))
    axis = velocities.vector(frame.course if isinstance(frame, BarFrame) else _direction(frame, AXES[0]))
    first, second = ca.SX(0), ca.SX(inertia)
    for mass, place in points:
        arm = place[0] - held
        first, second = first + mass * arm, second + mass * (arm * arm)
    total = sum((mass for mass, _ in points), ca.SX(0))
    return total * ca.sumsqr(base) / 2 + first * ca.dot(base, axis) + second * ca.sumsqr(axis) / 2


def _turning(moments: tuple[Any, Any, Any], frame: Frame, velocities: Velocities) -> Any:
    """The energy of slices that turn, by their second moments yy, zz, yz and the rates of the axes in their plane."""
    y, z = (velocities.vector(_direction(frame.shortest, axis)) for axis in AXES[1:])
    yy, zz, yz = moments
    return yy * ca.sumsqr(y) / 2 + zz * ca.sumsqr(z) / 2 + (0 if nil(yz) else yz * ca.dot(y, z))


def _direction(frame: Frame, axis: Vector) -> tuple[Vector, Vector]:
    """Rate and acceleration of a direction that a body carries."""
    return Frame(rotation=frame.rotation, rate=frame.rate, angular=frame.angular).motion_of(axis)


def _flat(points: list[tuple[Any, Vector]], inertia: Any, frame: Frame, velocities: Velocities, *, spun: bool) -> Any:
    """A body of a plane: masses at points, and what is left of its inertia."""
    if not spun:
        energy = sum((mass * ca.sumsqr(velocities.vector(frame.motion_of(place))) / 2 for mass, place in points), ca.SX(0))
        return energy + inertia * velocities.number(frame.rate[2], frame.angular[2]) ** 2 / 2
    held, about = velocities.vector((frame.speed, frame.acceleration)), frame.about_anchor()
    energy = sum((mass for mass, _ in points), ca.SX(0)) * ca.sumsqr(held) / 2
    for mass, place in points:
        energy += mass * ca.dot(held, velocities.vector(about.motion_of(place)))
        x, y, _ = minus(place, frame.anchor)
        inertia += mass * (x**2 + y**2)
    return energy + inertia * velocities.number(frame.rate[2], frame.angular[2]) ** 2 / 2

"""Normal forces at sliding places of joints, and the sliding speeds there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame
from ..base.vectors import dot, minus, norm, times
from ..model.declared_parts import Vector
from ..model.joints import Joint
from ..model.loads import Friction
from ..model.mechanism import Mechanism
from ..model.meshes import Loss, Transmission
from .growing import Grown
from .multibody import Multibody
from .sizes import reach

_REST = 1e-12
"""Fraction of the fastest motion in the mechanism below which a rate is that of rest."""

_TINY = 1e-30
"""The least size that a direction is divided by: at rest it is zero."""


@dataclass(frozen=True, eq=False)
class Contact:
    """Normal force at a sliding place [N], of one component or two, and the ``arm`` of its
    friction: 1 or a radius [m].

    Two components are those of a force; or, of a guide that rests on its ``edges``, what presses
    both together, and what a moment presses them together on opposite sides. Of a thread, ``lean``
    says how much more one direction of sliding presses than the other [m].
    """

    arm: Any
    pressing: tuple[Any, ...]
    lean: Any = 0.0
    edges: bool = False

    def size(self, components: Sequence[Expression]) -> Expression:
        """Size of components together."""
        if self.edges and len(components) == 2:
            one, other = both_edges(components)
            return ca.fabs(one) + ca.fabs(
                other
            )  # no fmax of the components: that passes over what is no number
        return ca.sqrt(sum((x * x for x in components[1:]), components[0] * components[0]))


def both_edges(components: Sequence[Expression]) -> tuple[Expression, Expression]:
    """Normal forces on both edges of a guide."""
    both, tilt = components
    return (both + tilt) / 2, (both - tilt) / 2


@dataclass(frozen=True, eq=False)
class FrictionContact:
    """A friction as expressions of an instant: its contacts, and rate and acceleration of its
    coordinate.

    What presses the parts of a transmission apart is found with frictions, because they depend on
    each other. It has no rate.

    ``slowest`` is the rate below which it rests, and the change of rate below which it goes on to.
    ``beside`` is the speed [m/s] of sliding along the joint's other coordinate, and its change,
    where it has one.
    """

    friction: Friction | Transmission | Loss
    contacts: tuple[Contact, ...]
    rate: Any
    acceleration: Any
    slowest: tuple[Any, Any]
    beside: tuple[Any, ...] = ()

    @property
    def rows(self) -> list[Expression]:
        """All its expressions, in an order that :meth:`of_rows` knows."""
        return [
            *(x for contact in self.contacts for x in contact.pressing),
            self.rate,
            self.acceleration,
            *self.slowest,
            *self.beside,
        ]

    def of_rows(self, rows: Sequence[Expression]) -> FrictionContact:
        """Contact with other expressions."""
        remaining = iter(rows)
        contacts = tuple(
            replace(c, pressing=tuple(next(remaining) for _ in c.pressing)) for c in self.contacts
        )
        rate, acceleration, rests, goes_on, *beside = remaining
        return FrictionContact(
            self.friction, contacts, rate, acceleration, (rests, goes_on), tuple(beside)
        )


def frictions_of(mechanism: Mechanism) -> dict[str, Friction]:
    """The frictions of a mechanism by name."""
    return {name: load for name, load in mechanism.loads.items() if isinstance(load, Friction)}


def joint_friction(
    multibody: Multibody, friction: Friction, force: Vector, couple: Vector
) -> FrictionContact:
    """A friction in a joint whose parent does this to its child, in ground axes, the couple about
    the child's point.
    """
    joint = friction.joint
    if friction.every_way:
        rate, acceleration = (norm(x) for x in turning(joint, multibody.frames))
    else:
        _, rate, acceleration = multibody.motion_along(joint, friction.axis)
    contacts: tuple[Contact, ...] = ()
    if friction.coulomb is not None:
        contacts = (Contact(1.0, (ca.SX(friction.coulomb),)),)
    elif friction.dry and multibody.mechanism.space:
        contacts = _in_space(multibody, friction, force, couple)
    elif friction.dry and friction.axis.kind == "angle":
        contacts = (Contact(friction.radius, (force[0], force[1])),)
    elif friction.dry:
        across = multibody.frames[joint.parent.body.name].rotation.apply(joint.triad[1])
        pressing = dot(force, across)
        if friction.length is None:
            contacts = (Contact(1.0, (pressing,)),)
        else:
            contacts = (Contact(1.0, (pressing, 2 * couple[2] / friction.length), edges=True),)
    beside: tuple[Any, ...] = ()
    if friction.beside is not None:
        lever: Expression = friction.radius if friction.beside.kind == "angle" else 1.0
        _, *rates = multibody.motion_along(joint, friction.beside)
        beside = tuple(lever * x for x in rates)
    slowest = slowest_of(multibody, slides=friction.axis.kind != "angle")
    return FrictionContact(friction, contacts, rate, acceleration, slowest, beside)


def turning(joint: Joint, frames: Mapping[str, Frame]) -> tuple[Vector, Vector]:
    """The angular velocity and acceleration of a joint's child beside its
    parent, in ground axes.
    """
    parent, child = (frames[body.name] for body in joint.bodies)
    return minus(child.rate, parent.rate), minus(child.angular, parent.angular)


def way_of(joint: Joint, grown: Grown) -> Vector:
    """The axis about which a joint's child turns on its parent, or is about to where it turns back;
    any at rest.
    """
    spin, change = turning(joint, grown.frames)
    moves = norm(spin) > slowest_of(grown, slides=False)[0]
    x, y, z = (ca.if_else(moves, now, soon) for now, soon in zip(spin, change, strict=True))
    return times(1 / ca.fmax(norm((x, y, z)), _TINY), (x, y, z))


def slowest_of(multibody: Multibody | Grown, *, slides: bool) -> tuple[Expression, Expression]:
    """The rate below which a coordinate rests, and the change of rate below which it goes on to:
    beside those of the drives.
    """
    unit, fastest, quickest = reach(multibody.mechanism), ca.SX(0), ca.SX(0)
    for driven in (coordinate for coordinate in multibody.coordinates if coordinate.driven):
        size = 1 if driven.kind == "angle" else unit
        fastest += ca.fabs(driven.rate) / size
        quickest += ca.fabs(driven.acceleration) / size
    quickest += fastest * fastest
    least = _REST * (unit if slides else 1)
    # Where the drives themselves turn back, their rates are rounding; their accelerations show how
    # fast they go beside it.
    return least * ca.sqrt(quickest), least * quickest


def _in_space(
    multibody: Multibody, friction: Friction, force: Vector, couple: Vector
) -> tuple[Contact, ...]:
    """Two bearings, ``length`` apart, and a collar that bears the thrust; a guide's two blocks,
    ``length`` apart, and what holds it against turning about its line, at ``radius``; or the flanks
    of a thread.

    With N on a thread's flank at the angle tan(angle) = pitch/radius, the force along the axis is N
    (cos -+ mu sin), and friction takes mu N radius/cos from the couple: less or more where the load
    drives the thread, by the sign of what it does.
    """
    joint, rotation = friction.joint, multibody.frames[friction.joint.parent.body.name].rotation
    u, v, w = (rotation.apply(direction) for direction in joint.triad)
    if friction.every_way:
        return (Contact(friction.radius, force),)
    along, (one, other) = dot(force, u), (dot(force, v), dot(force, w))
    if joint.kind == "screw":
        radius: Any = friction.radius
        pitch = joint.pitch
        leaning = friction.mu * pitch
        steep = (radius * radius + pitch * pitch) / (radius * radius - leaning * leaning)
        return (Contact(steep * radius, (along,), steep * leaning),)
    arm = friction.radius if friction.axis.kind == "angle" else 1.0
    if friction.length is None:
        return (Contact(arm, (one, other)),)
    about = (dot(couple, v) / friction.length, dot(couple, w) / friction.length)
    sides = tuple(
        Contact(arm, (one / 2 + sign * about[1], other / 2 - sign * about[0])) for sign in (1, -1)
    )
    if joint.kind == "cylindrical":
        return sides
    if joint.kind == "prismatic":
        return (*sides, Contact(1.0, (dot(couple, u) / friction.radius,)))
    return (*sides, Contact(arm, (along,)))

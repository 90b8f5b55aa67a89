"""Forces of teeth, belts and chains on the bodies that they couple.

The equation of a transmission ties coordinates, as that of a gear does. Its multiplier does not act
along these, between each gear and its carrier, but where the gears touch, and so pushes them apart
too: for every motion that the joints allow both do the same work. So the multipliers are those of
the equation, and reactions and sections carry what acts where they touch.
"""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from ..base.arrays import Expression
from ..base.vectors import cross, plus, times
from ..model.declared_parts import Point, Vector
from ..model.mechanism import Mechanism
from ..model.meshes import Loss, Mesh, Transmission
from .growing import Grown
from .multibody import Applied, Multibody
from .pressing import Contact, FrictionContact, slowest_of


def meshed_by(resting: Grown, transmission: Transmission, multiplier: ca.SX) -> Iterator[Applied]:
    """Action of a transmission on bodies: in each of its meshes the multiplier along the teeth, and
    the separating force.
    """
    for mesh in transmission.meshes:
        frame = resting.frames[mesh.carrier.name]
        force, couple = (
            resting.vector_at_state(vector) for vector in _summed(transmission, mesh, multiplier)
        )
        back = plus(times(-1, couple), cross(resting.vector_at_state(mesh.reach), force))
        yield Applied(
            transmission.name, mesh.first, frame.rotation.apply(force), frame.rotation.apply(couple)
        )
        x, y, z = resting.vector_at_state(mesh.second.place)
        second = Point(mesh.second.body, x, y, mesh.second.end, z)
        yield Applied(
            transmission.name,
            second,
            frame.rotation.apply(times(-1, force)),
            frame.rotation.apply(back),
        )


def transmissions_of(mechanism: Mechanism) -> dict[str, Transmission]:
    """The transmissions of a mechanism by name."""
    found = ((name, constraint.transmission) for name, constraint in mechanism.constraints.items())
    return {name: transmission for name, transmission in found if transmission is not None}


def pressing_apart(transmission: Transmission, multiplier: Expression) -> FrictionContact:
    """Separating force of a transmission, by its multiplier."""
    contacts = tuple(Contact(factor, (multiplier + slack,)) for factor, slack in transmission.parts)
    return FrictionContact(transmission, contacts, ca.SX(0), ca.SX(0), (ca.SX(0), ca.SX(0)))


def braking(multibody: Multibody, loss: Loss, multiplier: Expression) -> FrictionContact:
    """Friction loss of a transmission, by its multiplier."""
    rate, acceleration = ca.SX(0), ca.SX(0)
    for sign, joint in loss.rotations:
        _, one, change = multibody.motion_along(joint, joint.axes[0])
        rate, acceleration = rate + sign * one, acceleration + sign * change
    contact = Contact(loss.arm, (multiplier,), loss.lean)
    return FrictionContact(
        loss, (contact,), rate, acceleration, slowest_of(multibody, slides=False)
    )


def _summed(transmission: Transmission, mesh: Mesh, multiplier: ca.SX) -> tuple[Vector, Vector]:
    """The force on the first body, and the couple about its point, in the carrier's axes."""
    force, couple = times(multiplier, mesh.along.force), times(multiplier, mesh.along.couple)
    beside = [
        (transmission.symbol, mesh.apart),
        (transmission.loss and transmission.loss.symbol, mesh.braking),
    ]
    for factor, wrench in beside:
        if factor is not None and wrench is not None:
            force = plus(force, times(factor, wrench.force))
            couple = plus(couple, times(factor, wrench.couple))
    return force, couple

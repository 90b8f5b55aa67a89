"""What transmissions do to bodies, from reported multipliers, and that it does no work of its own, in plain vectors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..declare.density import Array
from ..declare.mechanism import Mechanism
from ..declare.meshes import Mesh, Transmission, Wrench
from ..geometry.vectors import Vector


@dataclass(frozen=True, eq=False)
class Touch:
    """A mesh as numbers: the bodies' names, places in the carrier's axes, and forces and couples for units of lambda and of s."""

    first: str
    second: str
    carrier: str
    centre: Array
    reach: Array
    along: tuple[Array, Array]
    apart: tuple[Array, Array]
    slack: float

    def borne(self, multiplier: Array) -> tuple[Array, Array, Array]:
        """Force and couple on the first body, and couple on the second, whose force is the opposite: on the carrier's axes."""
        pressed = (np.abs(multiplier + self.slack) + np.abs(multiplier - self.slack)) / 2.0
        force, couple = (
            np.outer(multiplier, one) + np.outer(pressed, two) for one, two in zip(self.along, self.apart, strict=True)
        )
        return force, couple, np.cross(self.reach, force) - couple


@dataclass(frozen=True, eq=False)
class Placed:
    """A body at all instants: its origin (t, 3), its axes as columns (t, 3, 3), its velocity and angular velocity (t, 3)."""

    at: Array
    axes: Array
    speed: Array
    rate: Array

    def out(self, vectors: Array) -> Array:
        """Vectors on its axes, in ground axes."""
        return np.asarray(np.einsum("tij,tj->ti", self.axes, np.broadcast_to(vectors, self.at.shape)))


def touches_of(mechanism: Mechanism, values: Mapping[str, float], transmission: Transmission | None) -> tuple[Touch, ...]:
    """The meshes of a transmission, for values of the parameters."""

    def numbers(vector: Vector) -> Array:
        return np.array([mechanism.number(x, values) for x in vector])

    def both(wrench: Wrench | None) -> tuple[Array, Array]:
        told = wrench or Wrench()
        return numbers(told.force), numbers(told.couple)

    def touch(mesh: Mesh, slack: float) -> Touch:
        names = (mesh.first.body.name, mesh.second.body.name, mesh.carrier.name)
        return Touch(*names, numbers(mesh.centre), numbers(mesh.reach), both(mesh.along), both(mesh.apart), slack)

    if transmission is None:
        return ()
    slack = mechanism.number(transmission.slack, values)
    return tuple(touch(mesh, slack) for mesh in transmission.meshes)


def actions(touch: Touch, carrier: Placed, multiplier: Array) -> Iterator[tuple[str, Array, Array, Array]]:
    """On each of the two bodies: its name, where, the force and the couple, in ground axes."""
    force, couple, back = touch.borne(multiplier)
    at = carrier.at + carrier.out(touch.centre)
    yield touch.first, at, carrier.out(force), carrier.out(couple)
    yield touch.second, at + carrier.out(touch.reach), -carrier.out(force), carrier.out(back)


def idle(touch: Touch, bodies: Mapping[str, Placed]) -> Array:
    """The power of a unit of the multiplier, over the largest power that is added up in it (t,): zero, but for rounding."""
    one = np.ones(len(bodies[touch.carrier].at))
    terms: list[Array] = []
    for k in (1.0, -1.0):
        # What presses apart takes none either.
        pressed = Touch(touch.first, touch.second, touch.carrier, touch.centre, touch.reach, touch.along, touch.apart, 0.0)
        for name, at, force, couple in actions(pressed, bodies[touch.carrier], k * one):
            body = bodies[name]
            speed = body.speed + np.cross(body.rate, at - body.at)
            terms += [force * speed, couple * body.rate]
    first, second = (np.concatenate(terms[k : k + 4], axis=1) for k in (0, 4))
    gap = np.maximum(*(np.abs(np.sum(powers, axis=1)) for powers in (first, second)))
    size = float(np.max(np.abs(np.concatenate([first, second], axis=1)), initial=0.0))
    return np.asarray(gap / size if size > 0.0 else gap)

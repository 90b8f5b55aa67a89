"""What transmissions do to bodies, from reported multipliers, and that it does no work of its own, in plain vectors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..declare.description import motions_of
from ..instants.solution import Solution

_REST = 1e-12
"""Of the fastest motion that is given: a rate below is that of rest, but for rounding."""


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
    braking: tuple[Array, Array]
    loss: tuple[float, float] = (0.0, 0.0)
    turns: tuple[tuple[int, str], ...] = ()

    @classmethod
    def of(cls, mesh: Mapping[str, Any]) -> Touch:
        """Return a mesh as :class:`.Stated` describes it."""
        centre, reach = (np.array(mesh[name]) for name in ("centre", "reach"))
        along, apart, braking = ((np.array(mesh[name][0]), np.array(mesh[name][1])) for name in ("along", "apart", "braking"))
        turns = tuple((sign, name) for sign, name in mesh["turns"])
        first, second, carrier = mesh["bodies"]
        return cls(first, second, carrier, centre, reach, along, apart, mesh["slack"], braking, tuple(mesh["loss"]), turns)

    def sense(self, solution: Solution) -> Array:
        """The sign with which the first turns on the carrier; where it turns back, that of the instants right after."""
        if not self.turns:
            return np.zeros_like(solution.t)
        motions = [(sign, solution.motion(name)) for sign, name in self.turns]
        rate, change = (np.sum([s * getattr(m, k) for s, m in motions], axis=0) for k in ("rate", "acceleration"))
        drives = [name for name in motions_of(solution.description) if Output("motion", name) in solution.outputs]
        fastest = np.sum([np.abs(solution.motion(name).rate) for name in drives], axis=0)
        return np.asarray(np.sign(np.where(np.abs(rate) > _REST * fastest, rate, change)))

    def borne(self, multiplier: Array, sense: Array) -> tuple[Array, Array, Array]:
        """Force and couple on the first body, and couple on the second, whose force is the opposite: on the carrier's axes.

        ``sense`` is the sign of its rate, or zero without friction.
        """
        pressed = (np.abs(multiplier + self.slack) + np.abs(multiplier - self.slack)) / 2.0
        taken = -(sense * self.loss[0] * np.abs(multiplier) + sense**2 * self.loss[1] * multiplier)
        each = zip(self.along, self.apart, self.braking, strict=True)
        force, couple = (np.outer(multiplier, a) + np.outer(pressed, b) + np.outer(taken, c) for a, b, c in each)
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


def actions(touch: Touch, carrier: Placed, multiplier: Array, sense: Array) -> Iterator[tuple[str, Array, Array, Array]]:
    """On each of the two bodies: its name, where, the force and the couple, in ground axes."""
    force, couple, back = touch.borne(multiplier, sense)
    at = carrier.at + carrier.out(touch.centre)
    yield touch.first, at, carrier.out(force), carrier.out(couple)
    yield touch.second, at + carrier.out(touch.reach), -carrier.out(force), carrier.out(back)


def idle(touch: Touch, bodies: Mapping[str, Placed]) -> Array:
    """The power of a unit of the multiplier, over the largest power that is added up in it (t,): zero, but for rounding."""
    one = np.ones(len(bodies[touch.carrier].at))
    terms: list[Array] = []
    for k in (1.0, -1.0):
        # What presses apart takes none either.
        for name, at, force, couple in actions(replace(touch, slack=0.0), bodies[touch.carrier], k * one, 0.0 * one):
            body = bodies[name]
            speed = body.speed + np.cross(body.rate, at - body.at)
            terms += [force * speed, couple * body.rate]
    first, second = (np.concatenate(terms[k : k + 4], axis=1) for k in (0, 4))
    gap = np.maximum(*(np.abs(np.sum(powers, axis=1)) for powers in (first, second)))
    size = float(np.max(np.abs(np.concatenate([first, second], axis=1)), initial=0.0))
    return np.asarray(gap / size if size > 0.0 else gap)

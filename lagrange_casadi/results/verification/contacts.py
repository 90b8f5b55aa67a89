"""Action of transmissions on bodies, from reported multipliers, and the check that they do no
work.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import Description
from ...model.stated import Touch
from .instant_vectors import Scalar, Vector, most
from .placing import Moving
from .reported import Reported

_REST = 1e-12
"""Fraction of the fastest given motion below which a rate is that of rest."""


def sense(touch: Touch, declared: Description, reported: Reported) -> Scalar:
    """The sign with which the first turns on the carrier; where it turns back, that of the instants
    right after.
    """
    if not touch.rotations:
        return 0.0
    rate = np.sum([sign * reported.rate(name) for sign, name in touch.rotations], axis=0)
    change = np.sum([sign * reported.acceleration(name) for sign, name in touch.rotations], axis=0)
    driven = (name for name in declared.driven if Output("motion", name) in reported.outputs)
    fastest = sum((np.abs(reported.rate(name)) for name in driven), np.zeros_like(reported.t))
    return np.sign(np.where(np.abs(rate) > _REST * fastest, rate, change))


def actions(
    touch: Touch, carrier: Moving, multiplier: Array, sense: Scalar
) -> Iterator[tuple[str, Vector, Vector, Vector]]:
    """Action on each of the two bodies: its name, the place, the force and the couple, in ground
    axes.

    ``sense`` is the sign of the first one's rate, or zero without friction.
    """
    pressed = (np.abs(multiplier + touch.slack) + np.abs(multiplier - touch.slack)) / 2.0
    arm, lean = touch.loss
    taken = -(sense * arm * np.abs(multiplier) + sense**2 * lean * multiplier)
    shares = ((multiplier, touch.along), (pressed, touch.apart), (taken, touch.braking))
    force, couple = Vector(0.0, 0.0, 0.0), Vector(0.0, 0.0, 0.0)
    for size, (pushes, twists) in shares:
        force, couple = force + size * Vector(*pushes), couple + size * Vector(*twists)
    reach = Vector(*touch.reach)
    at, turn = carrier.at + carrier.axes.turn(Vector(*touch.centre)), carrier.axes.turn
    yield touch.first, at, turn(force), turn(couple)
    yield touch.second, at + turn(reach), -turn(force), turn(reach.cross(force) - couple)


def idle(touch: Touch, bodies: Mapping[str, Moving], turned: Scalar, fastest: Scalar) -> Array:
    """The power of a unit of the multiplier (t,), over the largest that it has along the largest
    rates there are: zero, but for rounding.

    Its own bodies may rest while others move: a rack that rolls on a pinion at rest has no speed.
    """
    one, residuals = np.ones_like(fastest), []
    sizes: list[Scalar] = []
    for sign in (1.0, -1.0):
        # What presses apart takes none either.
        terms: list[Scalar] = []
        for name, at, force, couple in actions(
            replace(touch, slack=0.0), bodies[touch.carrier], sign * one, 0.0
        ):
            body = bodies[name]
            moves = body.speed, body.rate.cross(at - body.at)
            for effort, rate in ((force, moves[0]), (force, moves[1]), (couple, body.rate)):
                terms += [a * b for a, b in zip(effort.components, rate.components, strict=True)]
            sizes += [force.size * fastest, couple.size * turned]
        residuals.append(sum(terms, np.zeros_like(one)))
    residual, size = most(residuals), float(np.max(most(sizes)))
    return np.asarray(residual / size if size > 0.0 else residual)

"""Action of transmissions on bodies, from reported multipliers, and the check that they do no
work.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.stated import Touch
from .instant_vectors import NIL, cross, dot, resolve, size, turn
from .placing import Placed

_REST = 1e-12
"""Fraction of the fastest given motion below which a rate is that of rest."""


def _sense(touch: Touch, placed: Placed) -> Array | float:
    """The sign with which the first turns on the carrier, zero without friction; where it turns
    back, that of the instants right after.
    """
    if not touch.rotations:
        return 0.0
    reported = placed.reported
    turning = [sign * reported.motion(name) for sign, name in touch.rotations]
    _, rate, change = np.sum(turning, axis=0)
    driven = (name for name in placed.declared.driven if Output("motion", name) in reported.outputs)
    fastest = sum((np.abs(reported.motion(name)[1]) for name in driven), np.zeros_like(rate))
    return np.asarray(np.sign(np.where(np.abs(rate) > _REST * fastest, rate, change)))


def actions(
    touch: Touch, placed: Placed, multiplier: Array
) -> Iterator[tuple[str, Array, Array, Array]]:
    """Action on each of the two bodies: its name, the place, the force and the couple, in ground
    axes.
    """
    pressed = (np.abs(multiplier + touch.slack) + np.abs(multiplier - touch.slack)) / 2.0
    (arm, lean), sense = touch.loss, _sense(touch, placed)
    taken = -(sense * arm * np.abs(multiplier) + sense**2 * lean * multiplier)
    reported, carrier = placed.reported, placed.bodies[touch.carrier]
    shares = ((multiplier, touch.along), (pressed, touch.apart), (taken, touch.braking))
    force = sum((share * reported.straight(of[0]) for share, of in shares), NIL)
    couple = sum((share * reported.turning(of[1]) for share, of in shares), NIL)
    axes, centre, reach = carrier.axes, *map(reported.straight, (touch.centre, touch.reach))
    at, pushed = carrier.at + turn(axes, centre), turn(axes, force)
    yield touch.first, at, pushed, turn(axes, couple)
    yield touch.second, at + turn(axes, reach), -pushed, turn(axes, cross(reach, force) - couple)


def idle(touch: Touch, placed: Placed) -> Array:
    """The power of a unit of the multiplier (t,), over the largest that it has along the largest
    rates there are: zero, but for rounding.

    Its own bodies may rest while others move: a rack that rolls on a pinion at rest has no speed.
    """
    reported, (turned, fastest, _) = placed.reported, placed.rates
    first, second, carrier = (
        placed.bodies[one] for one in (touch.first, touch.second, touch.carrier)
    )
    at = carrier.at + turn(carrier.axes, reported.straight(touch.centre))
    speed = resolve(carrier.axes, first.speed_at(at) - second.speed_at(at))
    rate = resolve(carrier.axes, first.spin[0] - second.spin[0])
    residual, largest = np.zeros_like(fastest), np.zeros_like(fastest)
    # What presses apart takes none either.
    for wrench in (touch.along, touch.apart):
        force, couple = reported.straight(wrench[0]), reported.turning(wrench[1])
        residual += np.abs(dot(force, speed) + dot(couple, rate))
        largest += size(force) * fastest + size(couple) * turned
    return residual / (float(np.max(largest)) or 1.0)

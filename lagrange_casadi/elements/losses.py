"""Losses where gears mesh: a part of the power that they pass on, or the friction of teeth that slide on each other.

A part of the power is lost by a couple between the gears against the turning of one on the other: it stands for the force of the
teeth beside the pitch point. So nothing but the gears bears it, as with real teeth. With the ratio q of the rate of one gear on the
other to that of the first, and the cosine k between their axes of turning, the couple is

    c = (1 - efficiency) r |W|/(q - (1 - efficiency) k)             where the first drives,
    c = (1 - efficiency) r |W|/(efficiency q + (1 - efficiency) k)  where the second does.
"""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

from ..declare.mechanism import Mechanism
from ..declare.meshes import Fit, Loss, Wrench
from ..declare.parts import Constraint, Expression
from ..errors import DeclarationError
from ..geometry.vectors import cross, dot
from .courses import Course, along, length
from .pitch import Pitch, Teeth
from .ranges import LEAST, at_least, share


def braking_of(pitch: Pitch) -> Wrench:
    """What a unit of friction does to the first gear: a couple against its turning on the second, or a force against sliding."""
    way = along(pitch.relative, length(pitch.relative))
    return Wrench(way, cross(pitch.arm, way)) if pitch.kind == "crossed" else Wrench(couple=way)


def loss_of(
    what: str,
    mechanism: Mechanism,
    name: str,
    first: Course,
    pitch: Pitch,
    teeth: Teeth,
    efficiency: Expression | None,
    mu: Expression | None,
) -> tuple[Loss, list[Fit]]:
    """The law of a loss. Raises :class:`.DeclarationError` for numbers that cannot be."""
    own = mechanism.own
    if (mu is None) == (pitch.kind == "crossed") or (mu is not None and efficiency is not None):
        raise DeclarationError(f"{what}: expected mu of crossed axes, efficiency of others")
    if mu is not None:
        value = own.expression(f"{what}: mu", mu)
        fits = at_least(what, "mu must not be negative", value, 0.0, value)
        # The force at right angles to the teeth, of that along the pitch circle.
        cosine = ca.cos(teeth.pressure) if isinstance(teeth.pressure, ca.SX) else math.cos(teeth.pressure)
        return Loss(f"{name}:loss", value * length(pitch.force) / cosine, 0.0, first.turns), fits
    value = own.expression(f"{what}: efficiency", efficiency)
    fits = share(what, value)
    q, radius = length(pitch.relative), teeth.radii[0]
    k = dot(pitch.axis, pitch.relative) / q
    slip = 1 - value
    driving, driven = q - slip * k, value * q + slip * k
    for divisor in (driving, driven):
        fits += at_least(what, "efficiency is too low for a gear in this ring", divisor, LEAST, value)
    ahead, back = slip * radius / driving, slip * radius / driven
    return Loss(f"{name}:loss", (ahead + back) / 2, (back - ahead) / 2, first.turns), fits


def lost(mechanism: Mechanism, constraint: Constraint, loss: Loss, pitch: Pitch) -> Any:
    """The power that one mesh takes."""
    rate = sum((sign * mechanism.rate(joint) for sign, joint in loss.turns), ca.SX(0))
    force = mechanism.results.multiplier(constraint)
    return length(pitch.relative) * (loss.arm * ca.fabs(force * rate) + loss.lean * force * rate)

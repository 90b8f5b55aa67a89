"""Turns of screws in loops: a loop gives a direction, and a screw slides by every turn.

While an angle that counts turns goes round once, the screw's turns by a whole number of turns too.
So its angle is a sum of such angles, each so often, and about that it swings by less than half a
turn, which the direction gives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..base.scalars import column
from .multibody import Coordinate
from .substitution import Numbers

_STEPS, _DIGITS = 256, 2


def wound_angles(
    screw: Coordinate, variables: ca.SX, counting: Sequence[Coordinate], numbers: Numbers
) -> tuple[ca.SX, ca.SX]:
    """The variables of a screw's angle with its turns, of those that a loop gives; and how far it
    swings.

    ``counting`` are the coordinates whose angles count turns, and ``numbers`` where all is at the
    start of the motion, where the angle is in (-pi, pi].
    """
    c, s, angle = ca.vertsplit(variables)
    about, beside = ca.SX(0), numbers.of(angle)[0]
    for other in counting:
        if ca.depends_on(angle, other.variables) and (revolutions := _turns(angle, other, numbers)):
            about += revolutions * other.value
            beside -= revolutions * numbers.of(other.value)[0]
    # In few digits, lest the last ones of some library's sines be seen in the graph.
    about += round(beside, _DIGITS)
    deviation = swing(c, s, about)
    return ca.vertcat(c, s, about + deviation), deviation


def swing(c: Expression, s: Expression, about: ca.SX) -> Expression:
    """The angle from -pi to pi between an angle, whose cosine and sine are given, and another."""
    return ca.atan2(s * ca.cos(about) - c * ca.sin(about), c * ca.cos(about) + s * ca.sin(about))


def _turns(angle: ca.SX, other: Coordinate, numbers: Numbers) -> int:
    """Revolutions of an angle for one of another angle; none if that cannot go round."""
    turn = ca.SX.sym("turn")
    start = numbers.of(other.value)[0]
    placed = ca.substitute(angle, other.variables, other.placed(other.value, turn))
    remaining = [symbol for symbol in ca.symvar(placed) if not ca.is_equal(symbol, turn)]
    row = ca.Function("row", [turn, column(remaining)], [placed])
    known = [numbers.of(symbol)[0] for symbol in remaining]
    angles = [float(row(start + math.tau * k / _STEPS, known)) for k in range(_STEPS + 1)]
    gone = np.unwrap(angles)
    return round((gone[-1] - gone[0]) / math.tau) if np.isfinite(gone).all() else 0

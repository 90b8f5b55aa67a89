"""The lowest value of a polynomial on an interval, as expressions: its coefficients may depend on
parameters.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import casadi as ca

from ..base.arrays import Expression

_HALVINGS = 30
"""Number of halvings of an interval with a zero of a derivative.

At a turning point a miss by 1e-9 changes a value by its square.
"""


def lowest(cell: Sequence[Expression], start: float, stop: float) -> tuple[ca.SX, ca.SX]:
    """Place u from ``start`` to ``stop`` at which sum_j cell[j] u^j is lowest, and its value there,
    for finite coefficients.
    """
    place, value = ca.SX(start), _at(cell, ca.SX(start))
    turning = _zeros(_derivative(cell), start, stop) if len(cell) > 2 else []
    for u in (ca.SX(stop), *turning):
        other = _at(cell, u)
        lower = other < value
        place, value = ca.if_else(lower, u, place), ca.if_else(lower, other, value)
    return place, value


def _zeros(cell: Sequence[Expression], start: float, stop: float) -> list[ca.SX]:
    """Places from ``start`` to ``stop``, in order: all zeros of a polynomial there, and for those
    that it lacks any others.

    Up to a parabola in closed form; of a higher degree between the zeros of its derivative, where
    it is monotonic.
    """
    if len(cell) == 2:
        return [_within(-cell[0] / ca.SX(cell[1]), start, stop)]
    if len(cell) == 3:
        c, b, a = (ca.SX(x) for x in cell)
        square = b * b - 4.0 * a * c
        root = ca.sqrt(ca.if_else(square > 0.0, square, 0.0))
        # The sum does not cancel; a parabola that is a line has one zero far away.
        total = -0.5 * (b + ca.if_else(b < 0.0, -root, root))
        one, other = _within(total / a, start, stop), _within(c / total, start, stop)
        return [ca.fmin(one, other), ca.fmax(one, other)]
    ends = [ca.SX(start), *_zeros(_derivative(cell), start, stop), ca.SX(stop)]
    return [_zero(cell, low, high) for low, high in itertools.pairwise(ends)]


def _zero(cell: Sequence[Expression], low: Expression, high: Expression) -> Expression:
    negative = _at(cell, low) < 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        same = ca.eq(_at(cell, middle) < 0.0, negative)
        low, high = ca.if_else(same, middle, low), ca.if_else(same, high, middle)
    return high


def _at(cell: Sequence[Expression], u: ca.SX) -> ca.SX:
    value = ca.SX(cell[-1])
    for coefficient in reversed(cell[:-1]):
        value = value * u + coefficient
    return value


def _derivative(cell: Sequence[Expression]) -> list[Expression]:
    return [j * coefficient for j, coefficient in enumerate(cell)][1:]


def _within(x: ca.SX, start: float, stop: float) -> ca.SX:
    """A place in the interval; its start for what is not a number."""
    return ca.if_else(x > start, ca.if_else(x < stop, x, stop), start)

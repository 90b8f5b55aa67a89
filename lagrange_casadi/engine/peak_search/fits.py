"""Polynomials through a few values: at equal steps of time, with where they are largest, and at
Chebyshev's nodes.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ...base.arrays import Array

SEVEN = 7
"""Values through which a polynomial is laid."""

INSIDE = 1e-5
"""Distance, in steps, from an end of all values at which a maximum is sought."""

ASIDE = 1e-2
"""Distance from a kink, in steps, at which both its sides are sampled."""

_TRIALS = 4

_MIDDLE = np.array([231, 1386, -1155, 924, -495, 154, -21]) / 1024
_SLOPES = (
    np.array([-147, 360, -450, 400, -225, 72, -10]) / 60,
    np.array([-1627, 633, 2360, -2350, 1365, -443, 62]) / 1920,
    np.array([-10, -77, 150, -100, 50, -15, 2]) / 60,
)


class Fit(NamedTuple):
    """Polynomials' maximum: its place, in steps from the middle value, its size, slope and
    curvature.

    What a polynomial misses there bends its slope by ``steep`` times that. ``rough`` is its sixth
    difference.
    """

    x: Array
    size: Array
    slope: Array
    curve: Array
    steep: Array
    rough: Array


def window(at: int, count: int) -> int:
    """The first of seven values of ``count`` around one, as far in the middle as there are."""
    return min(max(at - SEVEN // 2, 0), count - SEVEN)


def bounds(at: int, count: int) -> tuple[float, float, float]:
    """Start of the search for a maximum near a value, and its bounds, in steps from the middle of
    its window.
    """
    start = float(at - window(at, count) - SEVEN // 2)
    return (
        start,
        start + INSIDE if at == 0 else start - 1.0,
        start - INSIDE if at == count - 1 else start + 1.0,
    )


def vertices(y: Array, start: Array, low: Array, high: Array) -> Fit:
    """The summits of polynomials through seven values each, (7, m)."""
    d = [(y[3 + k] + y[3 - k]) / 2 - y[3] for k in range(4)]
    o = [(y[3 + k] - y[3 - k]) / 2 for k in range(4)]
    a = [
        y[3],
        (45 * o[1] - 9 * o[2] + o[3]) / 30,
        (270 * d[1] - 27 * d[2] + 2 * d[3]) / 180,
        (8 * o[2] - 13 * o[1] - o[3]) / 24,
        (12 * d[2] - 39 * d[1] - d[3]) / 72,
        (5 * o[1] - 4 * o[2] + o[3]) / 120,
        (15 * d[1] - 6 * d[2] + d[3]) / 360,
    ]

    def at(x: Array, order: int) -> Array:
        total = np.zeros_like(x)
        for k in range(SEVEN - 1, order - 1, -1):
            factor = 1.0
            for j in range(order):
                factor *= k - j
            total = total * x + factor * a[k]
        return total

    x = start
    with np.errstate(all="ignore"):
        for _ in range(_TRIALS):
            slope, curve = at(x, 1), at(x, 2)
            x = np.clip(np.where(curve < 0.0, x - slope / curve, x), low, high)
        square = x * x
        # The product of x - j over the seven places j, and its slope.
        steep = (((7 * square - 70) * square + 147) * square - 36) / (
            x * (((square - 14) * square + 49) * square - 36)
        )
    return Fit(x, at(x, 0), at(x, 1), at(x, 2), steep, np.abs(720 * a[6]))


def stretch(y: Array) -> tuple[Array, Array]:
    """Results of polynomials through seven values each, (7, m), of which the first are those at an
    end, for the step there.

    Their values in its middle, and the least size of their slopes, by steps, at its ends and there:
    zero where they turn.
    """
    slopes = np.stack([weights @ y for weights in _SLOPES])
    least = np.where(
        (slopes > 0.0).all(axis=0) | (slopes < 0.0).all(axis=0), np.abs(slopes).min(axis=0), 0.0
    )
    return _MIDDLE @ y, least


def where(y: Array, at: int, level: float) -> float:
    """Place between value ``at`` and the next of a row, in steps from it, at which it passes a
    number: by a polynomial in the values.
    """
    first = window(at, y.size)
    values = y[first : first + SEVEN] - level
    places = np.arange(first - at, first - at + SEVEN, dtype=float)
    for k in range(1, SEVEN):
        places = (values[k:] * places[:-1] - values[:-k] * places[1:]) / (values[k:] - values[:-k])
    place = float(places[0])
    return place if 0.0 <= place <= 1.0 else float((level - y[at]) / (y[at + 1] - y[at]))


def kink(y: Array) -> list[tuple[float, float]]:
    """Intersection of parabolas through three values on either side of the middle one of seven, in
    steps from it, and their size there.

    And a little before it and after it, for only there does each show what it is worth. Nothing
    where they do not meet in a tip.
    """
    a1 = y[2] - y[1]
    a2 = (y[2] - 2 * y[1] + y[0]) / 2
    b1 = y[4] - y[5]
    b2 = (y[4] - 2 * y[5] + y[6]) / 2

    def left(x: float) -> float:
        return float(y[2] + (x + 1) * (a1 + (x + 2) * a2))

    def right(x: float) -> float:
        return float(y[4] + (1 - x) * (b1 + (2 - x) * b2))

    x = 0.0
    for trial in range(_TRIALS + 1):
        up, down = a1 + (2 * x + 3) * a2, b1 + (3 - 2 * x) * b2
        if not (up > 0.0 and down > 0.0):
            return []
        if trial < _TRIALS:
            x = min(max(x - (left(x) - right(x)) / (up + down), -1.0), 1.0)
    bend = 2 * (abs(a2) + abs(b2))
    if not (up > bend and down > bend and -1.0 < x < 1.0 and left(x) >= y[3]):
        return []
    return [(x, left(x)), (x - ASIDE, left(x - ASIDE)), (x + ASIDE, right(x + ASIDE))]


@functools.cache
def interpolation(degree: int) -> tuple[Array, Array]:
    """Nodes from -1 to 1, and what makes coefficients of Chebyshev's polynomials of the values
    there: values @ weights.
    """
    nodes = chebyshev.chebpts1(degree + 1)
    weights = chebyshev.chebvander(nodes, degree) * (2.0 / (degree + 1))
    weights[:, 0] /= 2.0
    return nodes, np.asarray(weights, float)

"""Where along a link a force turns: the zeros of its derivative between two stations, or what is nearest to them.

All of it is done at many instants at once, and goes on smoothly from instant to instant.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ..declare.density import Array

_HALVINGS = 60
_CLOSE = 4 * float(np.finfo(float).eps)


def zeros_of_shear(shear: Callable[[Array], Array], low: Array, middle: Array, high: Array) -> list[Array]:
    """Where a shear force rises through zero, then where it falls.

    It is monotonic on either side of its turning point, whatever the density: halve that. Where it has no zero there, that end is
    taken at which it is nearer to zero.
    """
    places = [low, middle, high]
    ends = [shear(u) for u in places]
    zeros = []
    for k in (0, 1):
        a, b = places[k : k + 2]
        negative, nearer = ends[k] <= 0.0, np.where(np.abs(ends[k]) <= np.abs(ends[k + 1]), a, b)
        none = negative == (ends[k + 1] <= 0.0)
        for _ in range(_HALVINGS):
            half = (a + b) / 2
            lower = (shear(half) <= 0.0) == negative
            a, b = np.where(lower, half, a), np.where(lower, b, half)
        zeros.append(np.where(none, nearer, (a + b) / 2))
    rises = (ends[1] > ends[0]) | ((ends[1] == ends[0]) & (ends[2] < ends[1]))
    return [np.where(rises, zeros[0], zeros[1]), np.where(rises, zeros[1], zeros[0])]


def zeros_of_uniform_shear(f0: Array, f1: Array, f2: Array, mass: Any, length: Any) -> list[Array]:
    """The same of a link of even mass without stations: f0 + b v + a v^2 = 0 with v = 1 - u.

    The root that would cancel comes from the other one.
    """
    a, b = -f2 * mass * length / 2, f1 * mass + f2 * mass * length
    q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * f0, 0.0)), b)) / 2
    rising, falling = q / a, f0 / q
    return [1.0 - np.where(b < 0.0, falling, rising), 1.0 - np.where(b < 0.0, rising, falling)]


def zeros_between(change: Callable[[Array], Array], low: Array, high: Array, breaks: Sequence[float], degree: int) -> list[Array]:
    """All zeros between ``low`` and ``high`` of what is a polynomial of a ``degree`` between each two ``breaks``.

    ``low`` and ``high`` are (t, parts); ``change`` takes ratios (t, parts, n) and gives the polynomial there. Between two breaks
    there are as many places as the degree, in order: each zero, and where there are fewer of them what is nearest.
    """
    nodes, weights = _interpolation(degree)
    found: list[Array] = []
    for a, b in itertools.pairwise(breaks):
        start, stop = np.clip(a, low, high), np.clip(b, low, high)
        middle, half = (start + stop) / 2, (stop - start) / 2
        values = change(middle[..., None] + half[..., None] * nodes)
        zeros = ordered_zeros(np.moveaxis(values @ weights, -1, 0))
        found += [np.clip(middle + half * zero, start, stop) for zero in zeros]
    return found


def ordered_zeros(coefficients: Array) -> list[Array]:
    """Places from -1 to 1, in order, among which are all zeros there of polynomials of degree n; as many as that.

    ``coefficients`` (n + 1, ...) are those of Chebyshev's polynomials. A polynomial is monotonic between two zeros of its
    derivative, so it has one zero there or none; then that end is taken at which it is nearer to zero. So each place is a
    continuous function of the coefficients, also where zeros come and go.
    """
    levels = [coefficients]
    while len(levels[-1]) > 1:
        levels.append(np.asarray(chebyshev.chebder(levels[-1], axis=0), float))
    one = np.ones(coefficients.shape[1:])
    places: list[Array] = []
    for level, slope in reversed(list(itertools.pairwise(levels))):
        ends = [-one, *places, one]
        values = [_value(level, x) for x in ends]
        places = [
            _zero(level, slope, a, b, at_a, at_b)
            for (a, b), (at_a, at_b) in zip(itertools.pairwise(ends), itertools.pairwise(values), strict=True)
        ]
    return places


def _zero(level: Array, slope: Array, a: Array, b: Array, at_a: Array, at_b: Array) -> Array:
    """The zero of what is monotonic from a to b, by Newton's method kept within what encloses it; or the nearer end."""
    negative = at_a <= 0.0
    none = negative == (at_b <= 0.0)
    nearer, x = np.where(np.abs(at_a) <= np.abs(at_b), a, b), (a + b) / 2
    for _ in range(_HALVINGS):
        now = _value(level, x)
        before = (now <= 0.0) == negative
        a, b = np.where(before, x, a), np.where(before, b, x)
        with np.errstate(all="ignore"):
            ahead = x - now / _value(slope, x)
        ahead = np.where((ahead > a) & (ahead < b), ahead, (a + b) / 2)
        going = np.abs(ahead - x) > _CLOSE
        x = ahead
        if not np.any(going & ~none):
            break
    return np.where(none, nearer, x)


def _value(coefficients: Array, x: Array) -> Array:
    return np.asarray(chebyshev.chebval(x, coefficients, tensor=False))


@functools.cache
def _interpolation(degree: int) -> tuple[Array, Array]:
    """Nodes from -1 to 1, and what makes Chebyshev coefficients of the values there: values @ weights."""
    nodes = chebyshev.chebpts1(degree + 1)
    weights = chebyshev.chebvander(nodes, degree) * (2.0 / (degree + 1))
    weights[:, 0] /= 2.0
    return nodes, np.asarray(weights, float)

"""Extrema of a force along a link: the zeros of its slope between two load points, or the nearest
to them.

All of it is done at many instants at once.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from ..base.arrays import Array
from ..base.interpolation import interpolation

_HALVINGS = 60
_ROUNDING = 2 * float(np.finfo(float).eps)
_CLOSE = 512 * float(np.finfo(float).eps)
"""Tolerance of the place of an extremum: its value changes with the square of that."""


def zeros_of_shear(
    shear: Callable[[Array], Array], low: Array, middle: Array, high: Array, rises: Array
) -> list[Array]:
    """Place at which a shear force rises through zero, then that at which it falls.

    It is monotonic on either side of its turning point ``middle``, whatever the density, so it has
    one zero there or none. Where it has none, that end is taken at which it is nearer to zero.
    ``rises`` says whether it rises before its turning point: where that is at an end, its values
    there differ by rounding alone, and do not decide.
    """
    places = np.stack([low, middle, high])
    ends = np.stack([shear(u) for u in (low, middle, high)])
    zeros = [_between(shear, places[k : k + 2], ends[k : k + 2]) for k in (0, 1)]
    return [np.where(rises, zeros[0], zeros[1]), np.where(rises, zeros[1], zeros[0])]


def _between(function: Callable[[Array], Array], places: Array, ends: Array) -> Array:
    """The zero of what is monotonic between two ``places`` (2, ...), where it is ``ends``; or the
    place at which it is nearer.

    By inverse quadratic interpolation, where that is safe, and else by halves: Chandrupatla, *A new
    hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without using
    derivatives*, Advances in Engineering Software 28 (1997).
    """
    nearer = np.where(np.abs(ends[0]) <= np.abs(ends[1]), places[0], places[1])
    sought = (ends[0] <= 0.0) != (ends[1] <= 0.0)
    (b, a), (at_b, at_a) = places, ends
    step = np.full(a.shape, 0.5)
    for _ in range(_HALVINGS):
        if not sought.any():
            break
        x = np.where(sought, a + step * (b - a), nearer)
        at_x = function(x)
        same = (at_x <= 0.0) == (at_a <= 0.0)
        c, at_c = np.where(same, a, b), np.where(same, at_a, at_b)
        b, at_b = np.where(same, b, a), np.where(same, at_b, at_a)
        a, at_a = x, at_x
        nearer = np.where(sought, np.where(np.abs(at_a) <= np.abs(at_b), a, b), nearer)
        width = np.abs(b - a)
        sought &= (width > _ROUNDING) & (at_a != 0.0)
        with np.errstate(all="ignore"):
            least = np.minimum(_ROUNDING / width, 0.5)
            along, up = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
            curved = at_a / (at_b - at_a) * (at_c / (at_b - at_c))
            curved += (c - a) / (b - a) * (at_a / (at_c - at_a)) * (at_b / (at_c - at_b))
            safe = (up * up < along) & ((1.0 - up) * (1.0 - up) < 1.0 - along)
            step = np.clip(np.where(safe, curved, 0.5), least, 1.0 - least)
    return np.asarray(nearer)


def zeros_of_uniform_shear(
    f0: Array, f1: Array, f2: Array, mass: float, length: float
) -> list[Array]:
    """Zeros of the shear force of a link of even mass without load points: f0 + b v + a v^2 = 0
    with v = 1 - u.

    The root that would cancel comes from the other one.
    """
    a, b = -f2 * mass * length / 2, f1 * mass + f2 * mass * length
    q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * f0, 0.0)), b)) / 2
    rising, falling = q / a, f0 / q
    return [1.0 - np.where(b < 0.0, falling, rising), 1.0 - np.where(b < 0.0, rising, falling)]


class StationaryPoints(NamedTuple):
    """Candidates of extrema, (t, parts, n): their ``places``, and of each ``is_maximum``.

    All zeros of the slope are among the places. The last two are the ends of a part without a
    maximum: the larger of them.
    """

    places: Array
    is_maximum: npt.NDArray[np.bool_]

    def maxima(self, sizes: Array) -> list[Array]:
        """Two summits for each part, (t, parts), in order along the link: the largest, by the
        ``sizes`` at all places.

        Where there is one, it is both; where there is none, both are the place at rest. So a summit
        that comes and goes by rounding, as where the slope is zero at an end, changes nothing.
        """
        heights = np.where(self.is_maximum, sizes, -np.inf)
        none, rests = ~self.is_maximum.any(axis=-1, keepdims=True), sizes.shape[-1] - 2
        larger = rests + np.argmax(sizes[..., rests:], axis=-1, keepdims=True)
        first = np.where(none, larger, np.argmax(heights, axis=-1, keepdims=True))
        np.put_along_axis(heights, first, -np.inf, -1)
        second = np.where(
            heights.max(axis=-1, keepdims=True) > -np.inf,
            np.argmax(heights, axis=-1, keepdims=True),
            first,
        )
        both = [np.take_along_axis(self.places, which, -1)[..., 0] for which in (first, second)]
        return [np.minimum(*both), np.maximum(*both)]


def stationary_points(
    slope: Callable[[Array], Array],
    low: Array,
    high: Array,
    breaks: Sequence[float],
    degree: int,
    *,
    signed: bool = False,
) -> StationaryPoints:
    """Extrema between ``low`` and ``high`` of a function whose ``slope`` is a polynomial of a
    ``degree`` between two ``breaks``.

    ``low`` and ``high`` are (t, parts); ``slope`` takes ratios (t, parts, n), and may have any
    factor that is not negative. What is ``signed`` may be largest in size where it is smallest too.
    A size without a summit rests at its larger end; what is signed nearer to that end at which its
    slope is smaller, for a summit comes in there.
    """
    nodes, weights = interpolation(degree)
    found: list[StationaryPoints] = []
    for a, b in itertools.pairwise(breaks):
        start, stop = np.clip(a, low, high)[..., None], np.clip(b, low, high)[..., None]
        middle, half = (start + stop) / 2, (stop - start) / 2
        values = slope(middle + half * nodes)
        zeros, falls, rises = _zeros(np.moveaxis(values @ weights, -1, 0))
        is_maximum = falls | rises if signed else falls
        found.append(
            StationaryPoints(np.clip(middle + half * zeros, start, stop), is_maximum & (half > 0.0))
        )
    rests = np.stack([_rest(slope, low, high)] * 2 if signed else [low, high], axis=-1)
    found.append(StationaryPoints(rests, np.zeros(rests.shape, bool)))
    return StationaryPoints(*(np.concatenate(rows, axis=-1) for rows in zip(*found, strict=True)))


def _rest(slope: Callable[[Array], Array], low: Array, high: Array) -> Array:
    first, last = (np.abs(slope(u[..., None])[..., 0]) for u in (low, high))
    share = np.divide(first, first + last, out=np.full_like(first, 0.5), where=first + last > 0.0)
    return np.asarray(low + (high - low) * share)


def _zeros(coefficients: Array) -> tuple[Array, npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Places from -1 to 1, in order (..., n), among which are all zeros there of polynomials of
    degree n; as many as that.

    With them comes whether it falls through zero there, or rises. ``coefficients`` (n + 1, ...) are
    those of Chebyshev's polynomials. A polynomial is monotonic between two zeros of its derivative,
    so it has one zero there or none; then that end is taken at which it is nearer to zero.
    """
    levels = [coefficients]
    while len(levels[-1]) > 1:
        levels.append(np.asarray(chebyshev.chebder(levels[-1], axis=0), float))
    one = np.ones((1, *coefficients.shape[1:]))
    places, falls, rises = one[:0], one[:0] > 0.0, one[:0] > 0.0
    for level, slope in reversed(list(itertools.pairwise(levels))):
        ends = np.concatenate([-one, places, one])
        values = _value(level, ends)
        places = _zero(level, slope, ends[:-1], ends[1:], values[:-1], values[1:])
        falls = (values[:-1] > 0.0) & (values[1:] <= 0.0)
        rises = (values[:-1] <= 0.0) & (values[1:] > 0.0)
    return np.moveaxis(places, 0, -1), np.moveaxis(falls, 0, -1), np.moveaxis(rises, 0, -1)


def _zero(level: Array, slope: Array, a: Array, b: Array, at_a: Array, at_b: Array) -> Array:
    """The zeros of what is monotonic from a to b, by Newton's method kept within what encloses it;
    or the nearer end.

    The ends are (parts, ...), the coefficients of polynomials (n + 1, ...).
    """
    found = np.where(np.abs(at_a) <= np.abs(at_b), a, b)
    there = (at_a <= 0.0) != (at_b <= 0.0)
    if not there.any():
        return found
    level, slope = (
        np.broadcast_to(row[:, None], (len(row), *a.shape))[:, there] for row in (level, slope)
    )
    a, b, negative = a[there], b[there], at_a[there] <= 0.0
    x = (a + b) / 2
    with np.errstate(all="ignore"):
        for _ in range(_HALVINGS):
            now = _value(level, x)
            before = (now <= 0.0) == negative
            a, b = np.where(before, x, a), np.where(before, b, x)
            ahead = x - now / _value(slope, x)
            ahead = np.where((ahead > a) & (ahead < b), ahead, (a + b) / 2)
            moved, x = np.abs(ahead - x), ahead
            if not (moved > _CLOSE).any():
                break
    found[there] = x
    return found


def _value(coefficients: Array, x: Array) -> Array:
    return np.asarray(chebyshev.chebval(x, coefficients, tensor=False))

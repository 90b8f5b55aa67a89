"""Where along a link a force turns: the zeros of its slope between two stations, or what is nearest to them.

All of it is done at many instants at once.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from ..declare.density import Array
from ..summits.polynomials import interpolation

_HALVINGS = 60
_CLOSE = 512 * float(np.finfo(float).eps)
"""Where something turns: what a place is off changes a summit by the square of that."""


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


class Turns(NamedTuple):
    """Where something may turn, (t, parts, n): its ``places``, whether it has a ``summit`` there, and its slope's size, ``off``.

    All zeros of the slope are among the places; where there are fewer of them, others are those at which it is nearest to zero.
    What has no summit in a part is told at ``rest`` (t, parts), if that is given.
    """

    places: Array
    summit: npt.NDArray[np.bool_]
    off: Array
    rest: Array | None = None

    def summits(self, sizes: Array) -> list[Array]:
        """Two summits for each part, (t, parts), in order along the link: the largest, by the ``sizes`` at all places.

        Where there is one, it is both; where there is none, both are at rest, or where the slope is smallest, as where a summit has
        just gone.
        """
        heights = np.where(self.summit, sizes, -np.inf)
        none = np.asarray(~self.summit.any(axis=-1, keepdims=True))
        first = np.where(none, np.argmin(self.off, axis=-1, keepdims=True), np.argmax(heights, axis=-1, keepdims=True))
        np.put_along_axis(heights, first, -np.inf, -1)
        second = np.where(heights.max(axis=-1, keepdims=True) > -np.inf, np.argmax(heights, axis=-1, keepdims=True), first)
        both = [np.take_along_axis(self.places, which, -1)[..., 0] for which in (first, second)]
        if self.rest is not None:
            both = [np.where(none[..., 0], self.rest, place) for place in both]
        return [np.minimum(*both), np.maximum(*both)]


def turns_between(
    slope: Callable[[Array], Array], low: Array, high: Array, breaks: Sequence[float], degree: int, *, signed: bool = False
) -> Turns:
    """Where something turns between ``low`` and ``high``, whose ``slope`` is a polynomial of a ``degree`` between two ``breaks``.

    ``low`` and ``high`` are (t, parts); ``slope`` takes ratios (t, parts, n), and may have any factor that is not negative. What is
    ``signed`` may be largest in size where it is smallest too. Where it has no summit it rests nearer to that end at which its
    slope is smaller: a summit comes in there.
    """
    nodes, weights = interpolation(degree)
    found: list[Turns] = []
    for a, b in itertools.pairwise(breaks):
        start, stop = np.clip(a, low, high)[..., None], np.clip(b, low, high)[..., None]
        middle, half = (start + stop) / 2, (stop - start) / 2
        values = slope(middle + half * nodes)
        zeros, falls, rises, off = _zeros(np.moveaxis(values @ weights, -1, 0))
        summit = falls | rises if signed else falls
        found.append(Turns(np.clip(middle + half * zeros, start, stop), summit & (half > 0.0), off))
    places, summit, off = (np.concatenate([getattr(part, name) for part in found], axis=-1) for name in ("places", "summit", "off"))
    return Turns(places, summit, off, _rest(slope, low, high) if signed else None)


def _rest(slope: Callable[[Array], Array], low: Array, high: Array) -> Array:
    first, last = (np.abs(slope(u[..., None])[..., 0]) for u in (low, high))
    share = np.divide(first, first + last, out=np.full_like(first, 0.5), where=first + last > 0.0)
    return np.asarray(low + (high - low) * share)


def _zeros(coefficients: Array) -> tuple[Array, npt.NDArray[np.bool_], npt.NDArray[np.bool_], Array]:
    """Places from -1 to 1, in order (..., n), among which are all zeros there of polynomials of degree n; as many as that.

    With them come whether it falls through zero there, or rises, and how far from zero it is. ``coefficients`` (n + 1, ...) are
    those of Chebyshev's polynomials. A polynomial is monotonic between two zeros of its derivative, so it has one zero there or
    none; then that end is taken at which it is nearer to zero.
    """
    levels = [coefficients]
    while len(levels[-1]) > 1:
        levels.append(np.asarray(chebyshev.chebder(levels[-1], axis=0), float))
    one = np.ones(coefficients.shape[1:])
    places: list[Array] = []
    falls: list[npt.NDArray[np.bool_]] = []
    rises: list[npt.NDArray[np.bool_]] = []
    for level, slope in reversed(list(itertools.pairwise(levels))):
        ends = [-one, *places, one]
        values = [_value(level, x) for x in ends]
        pairs = list(zip(itertools.pairwise(ends), itertools.pairwise(values), strict=True))
        places = [_zero(level, slope, a, b, at_a, at_b) for (a, b), (at_a, at_b) in pairs]
        falls = [(at_a > 0.0) & (at_b <= 0.0) for _, (at_a, at_b) in pairs]
        rises = [(at_a <= 0.0) & (at_b > 0.0) for _, (at_a, at_b) in pairs]
    off = [np.abs(_value(coefficients, x)) for x in places]
    return np.stack(places, axis=-1), np.stack(falls, axis=-1), np.stack(rises, axis=-1), np.stack(off, axis=-1)


def _zero(level: Array, slope: Array, a: Array, b: Array, at_a: Array, at_b: Array) -> Array:
    """The zero of what is monotonic from a to b, by Newton's method kept within what encloses it; or the nearer end."""
    found = np.where(np.abs(at_a) <= np.abs(at_b), a, b)
    there = (at_a <= 0.0) != (at_b <= 0.0)
    if not there.any():
        return found
    level, slope, a, b, negative = level[:, there], slope[:, there], a[there], b[there], at_a[there] <= 0.0
    x = (a + b) / 2
    for _ in range(_HALVINGS):
        now = _value(level, x)
        before = (now <= 0.0) == negative
        a, b = np.where(before, x, a), np.where(before, b, x)
        with np.errstate(all="ignore"):
            ahead = x - now / _value(slope, x)
        ahead = np.where((ahead > a) & (ahead < b), ahead, (a + b) / 2)
        moved, x = np.abs(ahead - x), ahead
        if not (moved > _CLOSE).any():
            break
    found[there] = x
    return found


def _value(coefficients: Array, x: Array) -> Array:
    return np.asarray(chebyshev.chebval(x, coefficients, tensor=False))

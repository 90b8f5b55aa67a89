"""Existence and equality of limits on both sides of a place, from values at ever smaller
distances.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array

Flags = npt.NDArray[np.bool_]

_ORDERS = 5
"""Number of terms, from the first to the fourth power of the distance, that are removed from a
difference one after another.
"""

_NOISY, _NOISIER = 1e-3, 2.0
"""Relative noise up to which a distance counts; or its multiple of the least noise, if all have
more.
"""

_TINY = np.finfo(float).tiny

_HALVINGS, _FEWEST = 8, 4
"""Number of halvings of the distance in which a value that falls to zero is halved, as powers of
the distance do that are slopes of nothing sharp; and the least number of halvings that must show
it.
"""


@dataclass(frozen=True, eq=False)
class Side:
    """Rows (rows, distances, m) at distances from m places, each half of the one before, and how
    far they may be off.

    ``there`` (distances, m) says where there is anything to look at.
    """

    value: Array
    off: Array
    there: Flags

    @property
    def steps(self) -> Side:
        """Changes from one distance to the next."""
        there = self.there[1:] & self.there[:-1]
        return Side(np.diff(self.value, axis=1), self.off[:, 1:] + self.off[:, :-1], there)

    @property
    def sizes(self) -> Array:
        """Sizes over two distances."""
        large = np.abs(self.value)
        return np.maximum(large[:, 1:], large[:, :-1])

    @property
    def nearest_signs(self) -> Array:
        """Signs (rows, m) at the least distance that rounding does not hide; zero if it hides
        all.
        """
        clear = self.there & np.isfinite(self.value) & (np.abs(self.value) > self.off)
        last = self.value.shape[1] - 1 - clear[:, ::-1].argmax(axis=1)[:, None]
        return np.asarray(
            np.where(clear.any(axis=1), np.sign(np.take_along_axis(self.value, last, 1)[:, 0]), 0.0)
        )


def between(before: Side, after: Side) -> Side:
    """Difference between both sides."""
    return Side(after.value - before.value, after.off + before.off, after.there & before.there)


def vanishes(rows: Side, sizes: Array, least: Array) -> tuple[Flags, Array]:
    """Return which rows (rows, m) tend to zero with the distance; and what remains of them, over
    ``sizes`` (rows, distances, m).

    Zero is what is less than ``least``. What tends to rest + c h + d h^2 is extrapolated to h = 0,
    by as many terms as serve. Rounding spoils it where h is small, what is of higher order where it
    is large; so where it is small from a distance on that noise does not hide, but for that noise
    where it is nearer, there is no rest. Of a root or a power it is not small anywhere, but falls
    for ever.
    """
    value, off, there = rows.value, rows.off, rows.there
    sizes, least = (of[:, -value.shape[1] :] for of in (sizes, least))
    found = np.broadcast_to(~there.any(axis=0), (len(value), there.shape[1])).copy()
    lowest, rest = np.full(found.shape, np.inf), np.full(found.shape, np.inf)
    for order in range(_ORDERS):
        if order:
            part = 2.0**order
            value = (part * value[:, 1:] - value[:, :-1]) / (part - 1.0)
            off = (part * off[:, 1:] + off[:, :-1]) / (part - 1.0)
            sizes, least = (np.maximum(of[:, 1:], of[:, :-1]) for of in (sizes, least))
            there = there[1:] & there[:-1]
        gaps = np.where(np.isfinite(value), np.abs(value), np.inf)
        noise = np.where(
            there & np.isfinite(off), off / np.maximum(least, _NOISY * sizes + _TINY), np.inf
        )
        clear = (
            noise <= np.maximum(1.0, _NOISIER * noise.min(axis=1, keepdims=True))
        ) & np.isfinite(noise)
        if order == 1:
            found |= _falls(gaps, clear)
        share = gaps / np.maximum(least + off, _TINY)
        share[~(there & np.isfinite(off))] = 0.0
        # The largest of all that are nearer.
        share = np.maximum.accumulate(share[:, ::-1], axis=1)[:, ::-1]
        share[~clear] = np.inf
        found |= (share <= 1.0).any(axis=1) | ~clear.any(axis=1)
        here = share.argmin(axis=1)[:, None]
        nearest, remaining = (np.take_along_axis(of, here, 1)[:, 0] for of in (share, gaps / sizes))
        lowest, rest = np.minimum(lowest, nearest), np.where(nearest < lowest, remaining, rest)
    return found, rest


def _falls(gaps: Array, clear: Flags) -> Flags:
    """Return which rows fall down to the least distances that noise does not hide."""
    count = gaps.shape[1]
    last = count - 1 - clear[:, ::-1].argmax(axis=1)
    first = np.maximum(last - _HALVINGS, clear.argmax(axis=1))
    end, start = (np.take_along_axis(gaps, k[:, None], 1)[:, 0] for k in (last, first))
    number = np.arange(1, count)[:, None]
    within = (number > first[:, None]) & (number <= last[:, None])
    falls = ((gaps[:, 1:] < gaps[:, :-1]) | ~within).all(axis=1)
    return np.asarray(
        falls & (last - first >= _FEWEST) & (end < start * 0.5 ** ((last - first) / _HALVINGS))
    )

"""Straight steps of paths, what functions give at shares of them, and whether that has equal limits
on both sides of a place, from values at ever smaller distances.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Operand
from ..base.running_errors import running_errors
from .clearance import Flags, bound

if TYPE_CHECKING:
    import casadi as ca

_HALVINGS = 64
"""Number of times that a step is halved."""

_WIDEST, _LIMITS = 2048.0, 47
"""Number of steps away from which a limit is taken, and number of distances, each half of the one
before.
"""

_ORDERS = 5
"""Number of terms, from the first to the fourth power of the distance, that are removed from a
difference one after another.
"""

_NOISY, _NOISIER = 1e-3, 2.0
"""Relative noise up to which a distance counts; or its multiple of the least noise, if all have
more.
"""

_TINY = np.finfo(float).tiny

_FALLING, _FEWEST = 8, 4
"""Number of halvings of the distance in which a value that falls to zero is halved, as powers of
the distance do that are slopes of nothing sharp; and the least number of halvings that must show
it.
"""


@dataclass(frozen=True, eq=False)
class Steps:
    """Straight steps of paths: from ``x`` by ``change`` (symbols, m), ``p`` (fixed, m), and of
    which path (``owner``).

    A share of a step is looked at, from ``low`` to ``high``; ``least`` and ``most`` are where the
    path ends.
    """

    x: Array
    change: Array
    p: Array
    owner: npt.NDArray[np.intp]
    low: Array
    high: Array
    least: Array
    most: Array

    @classmethod
    def of(cls, paths: Array, p: Array) -> Steps:
        """All steps of paths (d, symbols, n) for values ``p`` (d, fixed)."""
        count, symbols, n = paths.shape
        x, direction = (
            np.moveaxis(rows, 1, 0).reshape(symbols, -1)
            for rows in (paths[..., :-1], np.diff(paths))
        )
        number = np.tile(np.arange(n - 1.0), count)
        owner, none = np.repeat(np.arange(count), n - 1), np.zeros(count * (n - 1))
        return cls(x, direction, p.T[:, owner], owner, none, none + 1.0, -number, n - 1.0 - number)

    @classmethod
    def through(cls, paths: Array, p: Array) -> Steps:
        """Values from all instants on, or, if the path rests there, in the direction from which it
        came; as far as asked for.

        A single one goes anywhere.
        """
        count, symbols, n = paths.shape
        ahead = np.diff(paths, append=paths[..., -1:])
        came = np.diff(paths, prepend=paths[..., :1])
        directions = (
            np.where((ahead != 0.0).any(axis=1, keepdims=True), ahead, came)
            if n > 1
            else np.ones(paths.shape)
        )
        x, direction = (
            np.moveaxis(rows, 1, 0).reshape(symbols, -1) for rows in (paths, directions)
        )
        owner, none = np.repeat(np.arange(count), n), np.zeros(count * n)
        return cls(x, direction, p.T[:, owner], owner, none, none, none - np.inf, none + np.inf)

    @classmethod
    def joined(cls, parts: Sequence[Steps]) -> Steps:
        """Several as one."""
        return cls(
            *(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in _STEPS)
        )

    def some(self, which: Operand) -> Steps:
        """Some of the steps."""
        which = np.asarray(which) if len(which) else np.zeros(0, np.intp)
        return Steps(*(getattr(self, name)[..., which] for name in _STEPS))

    def to(self, low: Operand, high: Operand) -> Steps:
        """Other shares of the steps."""
        return replace(self, low=low + 0.0 * self.low, high=high + 0.0 * self.high)

    def at(self, share: Operand) -> Array:
        """The places at shares of the steps, not beyond the path."""
        return np.asarray(self.x + np.clip(share, self.least, self.most) * self.change)

    def off(self, roundings: float, least: float) -> Array:
        """The shares that move by so many roundings of places, or of ``least``."""
        sizes = np.maximum(np.maximum(np.abs(self.x), np.abs(self.x + self.change)), least)
        moves = np.abs(self.change) / np.spacing(sizes)
        return np.asarray(roundings / np.maximum(moves.max(axis=0, initial=0.0), 1.0))

    def halved(self, state: Callable[[Array], Array | npt.NDArray[np.bool_]]) -> Steps:
        """Bisect to where the state of each, (rows, m), changes from that at its low share."""
        low, high = self.low, self.high
        before = state(low)
        for _ in range(_HALVINGS if self.owner.size else 0):
            middle = (low + high) / 2
            if not ((low < middle) & (middle < high)).any():
                # No number is between them.
                break
            same = (state(middle) == before).all(axis=0)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return self.to(low, high)


_STEPS = tuple(entry.name for entry in fields(Steps))


def called(function: ca.Function, *columns: Array) -> Array:
    """The rows (rows, m) of a function of columns."""
    if not columns[0].shape[1]:
        return np.zeros((function.size1_out(0), 0))
    given, found, call, _ = bound(function, columns[0].shape[1])
    for array, values in zip(given, columns, strict=True):
        array[...] = values.T
    call()
    return np.ascontiguousarray(found[0].T)


def sides_of(function: ca.Function, steps: Steps, middle: Array) -> tuple[Side, Side]:
    """Values of a function of places, fixed symbols and paths at ever smaller distances before and
    after a share of each step.
    """
    far = (_WIDEST * 0.5 ** np.arange(_LIMITS))[:, None]
    wide = Steps.joined([steps] * _LIMITS)
    shape = (function.size1_out(0), _LIMITS, steps.owner.size)
    sides = []
    for direction in (-1, 1):
        share = middle + direction * far
        given = (wide.at(share.ravel()), wide.p, wide.change)
        there = (share >= steps.least) & (share <= steps.most)
        value, off = (
            of(function, *given[: function.n_in()]).reshape(shape)
            for of in (called, running_errors)
        )
        sides.append(Side(value, off, there & (far > steps.off(64.0, 0.0))))
    return sides[0], sides[1]


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
    first = np.maximum(last - _FALLING, clear.argmax(axis=1))
    end, start = (np.take_along_axis(gaps, k[:, None], 1)[:, 0] for k in (last, first))
    number = np.arange(1, count)[:, None]
    within = (number > first[:, None]) & (number <= last[:, None])
    falls = ((gaps[:, 1:] < gaps[:, :-1]) | ~within).all(axis=1)
    return np.asarray(
        falls & (last - first >= _FEWEST) & (end < start * 0.5 ** ((last - first) / _FALLING))
    )

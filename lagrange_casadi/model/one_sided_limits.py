"""Limits of functions from both sides of places of paths, over distances that halve."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Flags, spread
from ..base.scalars import called

Numbers = npt.NDArray[np.intp]

_MOST_PLACES = 0.95
"""Fraction of instants at which sizes are no larger than their reference."""

_SAMPLES = 101
"""Number of instants that show the usual sizes of a path."""

_FALLS = 0.95
"""Largest ratio of a difference to the one before, as distances halve, from which a limit follows.
"""

_HALVINGS = 64
"""Number of halvings that find a place."""

_LEVELS, _WIDEST, _FEWEST = 44, 1024.0, 5
"""Number of distances over which a limit is taken, each half of the one before; the largest, in
steps; and the least number of them that show a limit.
"""

_CLEAR, _NOISIER = 1e-10, 1.2
"""Relative rounding at the largest distance of a limit, and the factor by which rounding grows as
the distance halves.
"""

_FARTHEST = 3
"""Number of distances, the largest ones, that show how large values are elsewhere."""

_NO_LIMIT = 1e-3
"""Relative uncertainty of a limit that is none."""

_ORDERS = 4
"""Highest power of the distance that is removed from a limit."""

CROSSED, TOUCHED, OPEN, INSTANT = range(4)
"""Kinds of places: a mark changes its side there; it only touches zero; things may have no bound
there; or a mark is zero at an instant.
"""


class Places(NamedTuple):
    """Places (m,) of paths: from shares ``low`` to ``high`` of a step, and their kinds."""

    step: Numbers
    low: Array
    high: Array
    kind: Numbers

    @property
    def middle(self) -> Array:
        """The places (m,), in steps from the first of all paths."""
        return np.asarray(self.step + (self.low + self.high) / 2)

    def some(self, which: Flags | Numbers) -> Places:
        """Some of the places."""
        step, low, high, kind = self
        return Places(step[which], low[which], high[which], kind[which])


class Side(NamedTuple):
    """Limits (rows, m) from one side, how uncertain they are, their sizes, and those ``far`` away;
    ``near`` (rows, levels, m) are values near the places, but not nearer than those that give the
    limit; ``absent`` (m,) where the path ends.
    """

    limit: Array
    error: Array
    size: Array
    far: Array
    near: Array
    absent: Flags

    @property
    def off(self) -> Array:
        """Uncertainty of the limits, zero where the path ends."""
        return np.where(self.absent, 0.0, self.error)

    def endless(self, usual: Array) -> Flags:
        """Return where there is no limit; ``usual`` (rows, m) are the sizes along the path."""
        size = self.size + _NO_LIMIT * np.maximum(usual, self.far)
        return np.asarray((self.error > _NO_LIMIT * size) & ~self.absent)

    def rounds(self, value: Array) -> Flags:
        """Return where rounding of values near a place is as large as the difference of a value
        from the limit: some of them are neither near to the one nor to the other.
        """
        off = np.abs(value - self.limit)[:, None] / 4
        apart = np.abs(self.near - self.limit[:, None]) > off
        return np.asarray((apart & (np.abs(self.near - value[:, None]) > off)).sum(axis=1) > 2)


class Line:
    """Straight steps of paths (d, symbols, n), for ``p`` (d, fixed): from each instant to the next;
    the last instant, and one at which the path rests, goes on in the way of the step before it.

    ``owner`` is the number of each step's path, ``least`` and ``most`` are the shares of the step
    at which the path ends.
    """

    def __init__(self, paths: Array, p: Array) -> None:
        count, symbols, n = paths.shape
        self.shape = (count, n)
        way = np.ones(paths.shape)
        if n > 1:
            way = np.diff(paths)[..., np.minimum(np.arange(n), n - 2)]
            rests = ~(way != 0.0).any(axis=1)
            came = np.maximum.accumulate(np.where(rests, -1, np.arange(n)), axis=1)
            came = np.where(came < 0, (~rests).argmax(axis=1)[:, None], came)
            way = np.take_along_axis(way, came[:, None], axis=2)
        self.x, self.way = (np.moveaxis(of, 1, 0).reshape(symbols, -1) for of in (paths, way))
        self.p, self.owner = p.T, np.repeat(np.arange(count), n)
        number = np.tile(np.arange(float(n)), count)
        self.least, self.most = -number, n - 1.0 - number

    def at(self, step: Numbers, share: Array, free: Flags | bool = False) -> Array:
        """Places at shares of steps, beyond the ends of the path if they are ``free``."""
        within = np.where(free, share, np.clip(share, self.least[step], self.most[step]))
        return np.asarray(self.x[:, step] + within * self.way[:, step])

    def rows(
        self, function: ca.Function, step: Numbers, share: Array, free: Flags | bool = False
    ) -> Array:
        """The rows (rows, m) of a function at shares of steps."""
        columns = self.at(step, share, free), self.p[:, self.owner[step]], self.way[:, step]
        return called(function, *columns[: function.n_in()])

    def all(self, function: ca.Function) -> Array:
        """The rows at all instants."""
        return called(function, *(self.x, self.p[:, self.owner], self.way)[: function.n_in()])

    def off(self, step: Numbers) -> Array:
        """Shares that move by some roundings of the largest symbol."""
        sizes = np.maximum(np.maximum(np.abs(self.x), np.abs(self.x + self.way)), 1.0)[:, step]
        moves = (np.abs(self.way[:, step]) / np.spacing(sizes)).max(axis=0)
        return np.asarray(4.0 / np.maximum(moves, 1.0))

    def usual(self, bends: ca.Function) -> Array:
        """Sizes (3, d) along the paths of the value, of slopes, and of the curvature.

        A constraint's value is zero but for rounding: it is as large as what is added up in it.
        """
        count, n = self.shape
        some = spread(n, _SAMPLES)
        step = (n * np.arange(count)[:, None] + some).ravel()
        rows = self.rows(bends, step, np.zeros(step.size)).reshape(-1, count, some.size)
        rows = np.where(np.isfinite(rows), np.abs(rows), 0.0)
        terms = (rows[1:-1] * np.abs(self.x[:, step]).reshape(-1, count, some.size)).sum(axis=0)
        sizes = np.maximum(rows[0], terms), rows[1:-1].max(axis=0), rows[-1]
        return np.array([_most(of) for of in sizes])

    def limits(self, bends: ca.Function, places: Places, known: Array) -> Iterator[Side]:
        """Limits before and after each place, from distances up to half of that to the next one of
        all that are ``known``.
        """
        step, low, high, kind = places
        place, known = places.middle, np.concatenate([[-np.inf], np.sort(known), [np.inf]])
        # Where a mark touches zero rounding makes many places of one.
        apart = np.where((kind == OPEN) | (kind == TOUCHED), 1e-4, 1e-9)
        below = known[np.searchsorted(known, place - apart) - 1]
        above = known[np.searchsorted(known, place + apart, side="right")]
        # Places of other paths do not bound.
        first = self.shape[1] * self.owner[step]
        before = np.where(below >= first, place - below, np.inf)
        after = np.where(above < first + self.shape[1], above - place, np.inf)
        off, many, free = self.off(step), step.size, kind == INSTANT
        for way, middle, widest in ((-1.0, low, before), (1.0, high, after)):
            room = way * (np.where(way > 0, self.most[step], self.least[step]) - middle)
            room = np.where(free, np.maximum(room, 1.0), room)
            far = np.minimum(np.minimum(widest / 2, room), _WIDEST)
            far = far * 0.5 ** np.arange(_LEVELS)[:, None]
            share = (middle + way * far).ravel()
            rows = self.rows(bends, np.tile(step, _LEVELS), share, np.tile(free, _LEVELS))
            there = far > 8 * off
            values = np.where(there, rows.reshape(-1, _LEVELS, many), np.nan)
            # Beyond an end of the path there need be no number.
            there &= ~free | np.isfinite(values).all(axis=0)
            yield _limit(values, there.sum(axis=0) < _FEWEST)


def _most(sizes: Array) -> Array:
    """The size (d,) that most of those (d, n) are below that are not zero."""
    few = np.floor((1.0 - _MOST_PLACES) * (sizes > 0.0).sum(axis=1)).astype(int)
    return np.asarray(np.sort(sizes, axis=1)[np.arange(len(sizes)), -1 - few])


def _limit(values: Array, absent: Flags) -> Side:
    """The limits of values (rows, levels, m) as distances halve.

    Powers of the distance are removed one after another, or those of any order at once (Aitken's
    rule); the one that moves least decides.
    """
    far = np.abs(values[:, :_FARTHEST]).max(axis=1, keepdims=True)
    far = np.where(np.isfinite(far), far, 0.0)
    moves = np.diff(values, axis=1)
    falls = np.abs(moves[:, 1:] / moves[:, :-1]) < _FALLS
    aitken = values[:, 2:] - moves[:, 1:] ** 2 / (moves[:, 1:] - moves[:, :-1])
    candidates = [values, np.where(falls, aitken, np.nan)]
    rows = values
    for order in range(1, _ORDERS + 1):
        rows = (2.0**order * rows[:, 1:] - rows[:, :-1]) / (2.0**order - 1.0)
        candidates.append(rows)
    best, least, size = (np.full(values[:, 0].shape, of) for of in (np.nan, np.inf, np.nan))
    level = np.zeros(best.shape, int)
    for number, of in enumerate(candidates):
        moves = np.abs(np.diff(of, axis=1))
        error = np.maximum(np.maximum(moves[:, 2:], moves[:, 1:-1]), moves[:, :-2])
        # Farther off, rounding is less.
        nearer = _NOISIER ** np.arange(error.shape[1])[:, None]
        error = np.maximum(error, _CLEAR * np.maximum(np.abs(of[:, 3:]), far)) * nearer
        error = np.where(np.isfinite(error), error, np.inf)
        k = error.argmin(axis=1)[:, None]
        found, value = (np.take_along_axis(row, k, 1)[:, 0] for row in (error, of[:, 3:]))
        better = (found < least) | ((number == 0) & np.isfinite(found))
        size = np.fmax(size, np.abs(value)) if number == 0 else size
        best, least = np.where(better, value, best), np.where(better, found, least)
        level = np.where(better, k[:, 0] + 3 + _LEVELS - of.shape[1], level)
    half = np.arange(_LEVELS // 2, _LEVELS)
    near = np.where(half[:, None] < level[:, None], values[:, half], np.nan)
    return Side(best, least, np.fmax(size, np.abs(best)), far[:, 0], near, absent)


def halved(same: Callable[[Array], Flags], low: Array, high: Array) -> tuple[Array, Array]:
    """Bisect to where something is not the same as at ``low``."""
    for _ in range(_HALVINGS if low.size else 0):
        middle = (low + high) / 2
        if not ((low < middle) & (middle < high)).any():
            break  # no number is between them
        at = same(middle)
        low, high = np.where(at, middle, low), np.where(at, high, middle)
    return low, high

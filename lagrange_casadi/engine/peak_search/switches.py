"""On which side of a number a watched function is, and where rounding decides that."""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array
from .between import QUIET, SWITCHING, Flags, gaps, hiding_at, lingers, scatter, side, undecided
from .intervals import SIDE, SPACING, Curves, CurveSource, Interval
from .sharpness import Kind


class Switches:
    """Watched functions of a search, with their values ``watched`` (watches, n) at the instants.

    ``step`` is the step between instants that is searched, below zero elsewhere; there ``noises``
    are the functions' roundings, and ``sides`` those on which they are before and after.
    ``ignored`` functions hide too much.
    """

    def __init__(self, source: CurveSource, curves: Curves, t: Array, watched: Array) -> None:
        self.source, self.curves, self.watched, self.step = source, curves, watched, -1
        self.begin, self.length = float(t[0]), float(t[-1] - t[0]) / max(t.size - 1, 1)
        count = len(curves.watches)
        self.noises, self.sides = np.zeros(count), np.zeros((count, 2))
        self.ignored = np.zeros(count, bool)

    def counts(self, t: Array, watched: Array) -> Flags:
        """Return whether what is found at times counts for each quantity, (quantities, t): where a
        watched function that a quantity depends on may be on a side by rounding, that must be one
        that it has at an instant before or after, or the number between both.
        """
        found = np.ones((len(self.curves.units), t.size), bool)
        step = (t - self.begin) // self.length if self.step < 0 else np.full(t.size, self.step)
        step = np.clip(step, 0, self.watched.shape[1] - 2).astype(int)
        for k, watch in enumerate(self.curves.watches):
            if watch.kind not in (Kind.SWITCH, Kind.STEP) or self.ignored[k]:
                continue
            here, all_ = side(watch, watched[k]), side(watch, self.watched[k])
            before, after = all_[step], all_[step + 1]
            seen = (here == before) | (here == after)
            if self.step < 0:
                seen |= (np.minimum(before, after) < here) & (here < np.maximum(before, after))
            else:
                seen |= (here == self.sides[k][:, None]).any(axis=0)
                seen |= ~((self.noises[k] > 0.0) & (gaps(watch, watched[k]) <= self.noises[k]))
            found &= seen | ~self.curves.depending[k][:, None]
        return found

    def measure(self, step: int) -> None:
        """Begin to search a step between instants: how large is the rounding of what switches
        there, as some times next to both instants show, and on which sides it is beyond that,
        before and after.
        """
        self.step, self.noises[:] = step, 0.0
        watches = self.curves.watches
        switching = [k for k in np.flatnonzero(~self.ignored) if watches[k].kind in SWITCHING]
        start, stop = self.begin + self.length * np.array([step, step + 1])
        beside = max(SIDE * self.length, SPACING * max(abs(start), abs(stop)))
        if 2 * QUIET * beside < stop - start and any(
            lingers(self.watched[k], watches[k], step) for k in switching
        ):
            shares = beside * np.arange(QUIET)
            near = self.source.at(np.concatenate([start + shares, stop - shares])).watched
            for k in switching:
                noise = max(map(scatter, np.split(near[k], 2)))
                apart = np.flatnonzero(gaps(watches[k], self.watched[k]) > noise)
                before, after = apart[apart <= step], apart[apart > step]
                ends = [*before[-1:], 0][0], [*after[:1], self.watched.shape[1] - 1][0]
                self.noises[k] = noise
                self.sides[k] = side(watches[k], self.watched[k][[*ends]])

    def vague(self, watched: Array) -> Flags:
        """Steps in which watched functions hide nothing: rounding decides on which side they are,
        or they are ignored, (watches, n - 1).
        """
        return np.asarray(self.undecided(watched) | self.ignored[:, None])

    def undecided(self, watched: Array) -> Flags:
        """Steps in which rounding decides on which side watched functions are, (watches, n - 1)."""
        given = zip(watched, self.curves.watches, self.noises, strict=True)
        return np.array([undecided(*one) for one in given], bool).reshape(-1, watched.shape[1] - 1)

    def is_ignored(self, interval: Interval, step: int) -> bool:
        """Return whether only ignored functions hide something in a step."""
        if not self.ignored.any():
            return False
        hides = self.hiding_at(interval, step)
        return bool(hides.any() and not (hides & ~self.ignored).any())

    def hiding_at(self, interval: Interval, step: int) -> Flags:
        """Return which watched functions hide something in a step, ignored ones too, (watches,)."""
        watched, watches = interval.samples.watched, self.curves.watches
        return hiding_at(watched, watches, interval.step, self.undecided(watched), step)

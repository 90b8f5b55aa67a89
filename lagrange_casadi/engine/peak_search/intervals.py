"""Curves of a search, and a panel of them: equal steps of time with the values at their ends, and
the source of more of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ...base.arrays import Array
from . import fits
from .between import Flags, beyond, passed
from .sharpness import Watch

SIDE = 2e-13
"""Distance of the sides of a kink or a jump, in steps between instants."""

SPACING = 4 * float(np.finfo(float).eps)
"""Shortest step, relative to the time."""

TOPS = 24
"""Local peaks of a quantity that are listed at most: the largest."""

INNER = 8
"""Times inside a step that becomes a panel."""

_TRIALS, _WATCHED = 3, 2


@dataclass(frozen=True, eq=False)
class Curves:
    """Quantity of each curve, unit of each quantity, and watched functions.

    The peak of a quantity is that of the curve of its own that goes furthest: those of a section
    force are the force at the link's ends and stations, and where it turns along the link.
    ``scales`` are of each unit how large others are, ``knots`` times of kinks. ``depends``
    (watches, quantities) says which quantity depends on which watched function; None: all do.
    """

    quantities: tuple[int, ...]
    units: tuple[int, ...]
    scales: tuple[float, ...] = ()
    watches: tuple[Watch, ...] = ()
    knots: tuple[float, ...] = ()
    depends: Flags | None = None

    @property
    def depending(self) -> Flags:
        """Table of the quantities that depend on each watched function, (watches, quantities)."""
        shape = len(self.watches), len(self.units)
        return np.ones(shape, bool) if self.depends is None else self.depends


@dataclass(frozen=True, eq=False)
class Peaks:
    """Value of each quantity that is largest in size, with its sign, its time and ratio xi/l, and
    whether it is reported.

    A peak that is not located is at least this, which was found. ``tops``, where they are asked
    for, (q, :data:`TOPS`, 4), are local peaks in no order: the number of the curve among its
    quantity's own, NaN where there are no more, time, ratio and value. ``error``, of peaks that are
    those of the instants, is how much larger each may be between them.
    """

    value: Array
    t: Array
    xi: Array
    resolved: Flags
    tops: Array | None = None
    error: Array | None = None


class Listed(NamedTuple):
    """Local peaks that are listed: those down to a ``share`` of the largest.

    Where ``sign`` is 1 or -1, peaks are those of values times that, not of sizes. These are counted
    from so far below the least at the instants that a share of little more than a half takes all
    there are between that and the largest.
    """

    share: float
    sign: int = 0


class Samples(NamedTuple):
    """Samples at n times: curves (c, n), the ratios xi/l at which they are taken (c, n), and
    watched functions (w, n).
    """

    values: Array
    places: Array
    watched: Array

    def some(self, which: slice) -> Samples:
        """Samples at some of the times."""
        return Samples(*(rows[:, which] for rows in self))


def joined(*parts: Samples) -> Samples:
    """Join samples at some times and at others, one after another."""
    return Samples(*(np.concatenate(rows, axis=1) for rows in zip(*parts, strict=True)))


class CurveSource(Protocol):
    """Source of curves at any times; NaN where they have no value."""

    def at(self, t: Array) -> Samples:
        """Sample times of the span."""


@dataclass(frozen=True, eq=False)
class Interval:
    """Times at equal steps, and what there is at them."""

    t: Array
    samples: Samples

    @property
    def step(self) -> float:
        """The length of one."""
        return float(self.t[-1] - self.t[0]) / (self.t.size - 1)


@dataclass
class Candidate:
    """A value beside which a curve may rise, by its number in a panel: where to look, and what is
    expected there (:class:`.Fit`).

    ``kink`` has the times at which to look for a kink, and the sizes expected there.
    """

    curve: int
    at: int
    sign: float
    t: float
    size: float
    slope: float
    bend: float
    steep: float
    rough: float
    trust: float
    kink: Sequence[tuple[float, float]]
    closed: bool = False
    again: bool = False


def sides(
    source: CurveSource,
    interval: Interval,
    step: int,
    watches: Sequence[Watch],
    beside: float,
    vague: Flags,
) -> tuple[Array, Samples] | None:
    """The times just before and just after a kink or a jump in a step, and of itself, and what
    there is; None where none is found.

    They are ``beside`` it, as far as the step goes. The watched values show where it is: between
    both it passes its number.
    """
    start, stop = interval.t[step], interval.t[step + 1]
    beside = max(beside, SPACING * float(np.abs(interval.t).max()))
    if interval.t.size < fits.SEVEN or not stop - start > 8 * beside:
        return None
    for _, (k, level) in zip(
        range(_WATCHED),
        passed(interval.samples.watched, watches, step, interval.step, vague),
        strict=False,
    ):
        row, kind = interval.samples.watched[k], watches[k].kind
        place, slope = fits.where(row, step, level), row[step + 1] - row[step]
        before: tuple[float, float] | None = None
        for _ in range(_TRIALS):
            at = start + place * (stop - start)
            t = np.clip(np.array([at - beside, at + beside, at]), start, stop)
            found = source.at(t)
            ends = found.watched[k].tolist()
            apart = all(
                t[j] == end or beyond(kind, ends[j], level) == beyond(kind, row[step + j], level)
                for j, end in enumerate((start, stop))
            )
            if apart and np.isfinite(found.values).all():
                return t, found
            slope = slope if before is None else (ends[2] - before[1]) / (place - before[0])
            before = place, ends[2]
            place += (level - ends[2]) / slope
            if not 0.0 <= place <= 1.0:
                break
    return None

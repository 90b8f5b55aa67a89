"""Statistics of a quantity over time: its mean, its root mean square, its minimum and maximum."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.brief import Brief
from .vector_sizes import highest


@dataclass(frozen=True)
class Extreme:
    """A value that a quantity has, with its sign, its time [s], and of a section force its ratio
    xi/l, else None.
    """

    value: float
    t: float
    xi: float | None = None


@dataclass(frozen=True, repr=False)
class Statistics(Brief):
    """A quantity over the time of a solution, in ``unit``: means by trapezia, and the smallest and
    largest value of the instants.

    Instants at which it is no number do not count: at rest friction may leave it open. ``smallest``
    and ``largest`` are by sign: -5 is smaller than 3. ``peak`` is largest in size. Along a link
    they are exact, whatever the grid of xi. ``mean`` and ``rms``, the root of the mean square, are
    None of a section force: they differ from ratio to ratio.
    """

    name: str
    unit: str
    mean: float | None
    rms: float | None
    smallest: Extreme
    largest: Extreme
    peak: Extreme

    @classmethod
    def over(cls, name: str, unit: str, t: Array, values: Array) -> Statistics:
        """Make them from values (t,) at increasing times."""
        counts = counted(values)
        weights = shares(t, counts)
        there = values if counts.all() else np.where(counts, values, 0.0)
        ends = _ends(t, np.broadcast_to(values, (3, t.size)))
        return cls(name, unit, float(there @ weights), float(np.sqrt(there**2 @ weights)), *ends)

    @classmethod
    def along(cls, name: str, unit: str, t: Array, places: Array, values: Array) -> Statistics:
        """Make them for a section force, from the places along the link at which it is smallest,
        largest, and largest in size, and its values there.

        Places and values are (3, t).
        """
        return cls(name, unit, None, None, *_ends(t, values, places))


def _ends(t: Array, values: Array, places: Array | None = None) -> Iterator[Extreme]:
    """The smallest, the largest and the value largest in size, each of a row of values (3, t)."""
    sizes = -values[0], values[1], np.abs(values[2])
    for k, i in enumerate(map(highest, sizes)):
        xi = None if places is None else float(places[k, i])
        yield Extreme(float(values[k, i]), float(t[i]), xi)


def counted(values: Array) -> npt.NDArray[np.bool_]:
    """Instants at which values (..., t) count: not those at which friction at rest leaves one of
    them indeterminate, and NaN.
    """
    return np.asarray(~np.isnan(values).any(axis=tuple(range(values.ndim - 1))))


def of_counted(values: Array) -> Array:
    """Values (n, members, t) with those of an instant that counts in place of each that does not:
    their extremes are the same.

    What counts at no instant stays as it is.
    """
    counts: Any = ~np.any(np.isnan(values), axis=1)
    first, here = np.argmax(counts, axis=1)[:, None], np.arange(values.shape[2])
    taken = np.where(counts | ~np.any(counts, axis=1)[:, None], here, first)
    return values if counts.all() else np.take_along_axis(values, taken[:, None], axis=2)


def shares(t: Array, counts: npt.NDArray[np.bool_] | None = None) -> Array:
    """The part of the time that each instant stands for, by trapezia, (t,): of the steps whose two
    ends count.

    Where there is no such step, the instants that count have equal parts; NaN where none does.
    """
    weights, counts = np.zeros(t.size), np.ones(t.size, bool) if counts is None else counts
    steps = np.where(counts[:-1] & counts[1:], np.diff(t), 0.0)
    weights[:-1] += steps
    weights[1:] += steps
    if weights.any():
        return np.asarray(weights / weights.sum())
    return np.asarray(
        counts / np.count_nonzero(counts) if counts.any() else np.full(t.size, np.nan)
    )

"""What a quantity is over the whole time: its mean, its root mean square, and where it is smallest and largest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..declare.density import Array
from .sizes import largest


@dataclass(frozen=True)
class Extreme:
    """A value that a quantity has, with its sign, its time [s], and of a section force its ratio xi/l, else None."""

    value: float
    t: float
    xi: float | None = None


@dataclass(frozen=True)
class Statistics:
    """A quantity over the time of a solution, in ``unit``: means by trapezia, and the smallest and largest value of the instants.

    ``smallest`` and ``largest`` are by sign: -5 is smaller than 3. ``peak`` is largest in size. Along a link they are exact,
    whatever the grid of xi. ``mean`` and ``rms``, the root of the mean square, are None of a section force: they differ from ratio
    to ratio.
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
        """Those of values (t,) at increasing times."""
        weights = shares(t)
        chosen = (*_ends(values, values), largest(values))
        ends = (Extreme(float(values[i]), float(t[i])) for i in map(int, chosen))
        return cls(name, unit, float(values @ weights), float(np.sqrt(values**2 @ weights)), *ends)

    @classmethod
    def along(cls, name: str, unit: str, t: Array, places: Array, values: Array) -> Statistics:
        """Those of a section force, from where along the link it is smallest, largest, and largest in size, and what it is there.

        Places and values are (3, t).
        """
        chosen = (*_ends(values[0], values[1]), largest(values[2]))
        ends = (Extreme(float(values[k, i]), float(t[i]), float(places[k, i])) for k, i in enumerate(map(int, chosen)))
        return cls(name, unit, None, None, *ends)


def _ends(low: Array, high: Array) -> tuple[Any, Any]:
    """Where values are smallest and largest; what is no number is neither."""
    return np.argmin(np.where(np.isnan(low), np.inf, low)), np.argmax(np.where(np.isnan(high), -np.inf, high))


def shares(t: Array) -> Array:
    """The part of the time that each instant stands for, by trapezia, (t,)."""
    weights = np.zeros(t.size)
    steps = np.diff(t)
    weights[:-1] += steps
    weights[1:] += steps
    return weights / weights.sum() if t.size > 1 else np.ones(1)

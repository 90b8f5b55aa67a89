"""Results of designs, and the arrays for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.brief import Brief

KEPT = ("value", "peak_t", "xi", "mean", "rms")
"""Results of each design, by name in C."""

Results: TypeAlias = dict[str, Any]
"""Arrays to be filled, a row a design, by their names in C; None for what is not asked for."""


@dataclass(frozen=True, eq=False, repr=False)
class Outcome(Brief):
    """Results of n designs, a row each; rows of designs without a result hold NaN.

    ``status`` (n) is a ``Status``. ``value``, ``t`` and ``xi``, (n, q), are the peak of each
    quantity with its sign, its time [s] and its ratio xi/l, NaN off a link; ``mean`` and ``rms``,
    (n, e), those of each effort over time. ``series`` (n, columns, t) are whole histories, where
    they were asked for, and ``times`` (n, t) their instants [s], where designs may have their own.
    ``over`` (n, q) is the coordinate of the drive at the peak, where instants are asked for by one.
    ``error`` (n, q), of peaks that are those of the instants, is how much larger each may be
    between them.
    """

    status: npt.NDArray[np.int8]
    value: Array
    t: Array
    xi: Array
    mean: Array
    rms: Array
    series: Array | None
    over: Array | None = None
    times: Array | None = None
    error: Array | None = None


@dataclass(frozen=True, eq=False)
class History:
    """One design over instants ``t`` (t,): its ``columns`` (columns, t) and iterated coordinates
    (z, t).

    Where peaks were sought, ``tops`` (q, :data:`.TOPS`, 4) are local ones of its quantities: see
    :class:`.Peaks`. ``outcome`` has its status, and what is kept.
    """

    outcome: Outcome
    t: Array
    columns: Array
    iterated: Array
    tops: Array


def refuse(found: Results, some: npt.NDArray[np.bool_], status: npt.NDArray[np.int8]) -> None:
    """Give some designs another status, and no result."""
    for name, array in found.items():
        if array is not None:
            array[some] = status[some] if name == "status" else np.nan


def rows_of(found: Results, some: slice) -> Results:
    """Some rows of arrays, to be filled."""
    return {name: None if array is None else array[some] for name, array in found.items()}


def outcome_of(
    found: Results,
    series: Array | None = None,
    over: Array | None = None,
    times: Array | None = None,
) -> Outcome:
    """Make it from results."""
    value, t, xi, mean, rms = (found[name] for name in KEPT)
    error = found.get("error")
    return Outcome(found["status"], value, t, xi, mean, rms, series, over, times, error)

"""Instants of a page: all, or, if these are too many, evenly spread ones and those of peaks; and
values with when and where they are.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...base.arrays import Json, spread
from ...results.ordering import ordered
from ...results.solution import Solution
from .array_block import Arrays

MOST = 1_000_000
"""Numbers that a page holds at most, or little more: 8 bytes each, 11 in the page."""

LEAST = 181
"""Instants that it shows at least, where there are so many: fewer look no longer like a motion."""


def shown_instants(solution: Solution) -> npt.NDArray[np.intp]:
    """The instants that are shown, by number."""
    total = solution.t.size
    varying = sum(1 for values in solution.outputs.values() if np.ptp(values) != 0.0)
    largest = (
        2 * len(solution.links_with_sections) * len(solution.table.forces)
    )  # of each where along its link, and how much
    most = max(LEAST, MOST // max(varying + largest, 1))
    if total <= most:
        return np.arange(total)
    return np.unique(np.concatenate([spread(total, most), np.array(_peaks(solution), np.intp)]))


def _peaks(solution: Solution) -> list[int]:
    """The instants of all smallest and largest values, and of the peaks."""
    found: list[int] = []
    for output in ordered(solution):
        if solution.determined(output):
            statistics = solution.statistics(output)
            found += [
                int(np.searchsorted(solution.t, extreme.t))
                for extreme in (statistics.smallest, statistics.largest, statistics.peak)
            ]
    return found


def drive_entry(
    solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays
) -> dict[str, Json] | None:
    """The coordinate by which instants were defined, if any, at those that are chosen."""
    over = solution.over
    if over is None:
        return None
    return {"joint": over.joint, "unit": over.unit, "values": arrays.add(over.values[chosen])}


def mark(solution: Solution, value: float, t: float, xi: float | None) -> dict[str, Json]:
    """A value at one of a solution's instants, with its time, its ratio xi/l where it is along a
    link, and the drive's coordinate where instants are over one.
    """
    axis = solution.over
    at = float(axis.values[int(np.argmax(solution.t == t))]) if axis else None
    return {"value": value + 0.0, "t": t, "xi": xi, "over": at}

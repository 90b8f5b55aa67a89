"""A value with when and where it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..instants.solution import Solution


@dataclass(frozen=True)
class Mark:
    """A value with its time, its ratio xi/l where it is along a link, and the drive's coordinate
    where instants are over one.
    """

    value: float
    t: float
    xi: float | None
    over: float | None


def mark(solution: Solution, value: float, t: float, xi: float | None) -> Mark:
    """The mark of a value at one of a solution's instants."""
    axis = solution.over
    return Mark(
        value + 0.0, t, xi, float(axis.values[int(np.argmax(solution.t == t))]) if axis else None
    )

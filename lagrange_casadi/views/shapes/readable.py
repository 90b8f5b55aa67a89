"""Units that a person reads, chosen by how large values are: kN for 5000 N, mm for 0.02 m.

The data of a figure stay in SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axis import Axis

_STEPS = (
    (1e9, "G", 1e-9),
    (1e6, "M", 1e-6),
    (1e3, "k", 1e-3),
    (0.1, "", 1.0),
    (1e-4, "m", 1e3),
    (0.0, "µ", 1e6),
)
_PREFIXES = {
    "m": ((1.0, "", 1.0), (1e-3, "m", 1e3), (0.0, "µ", 1e6)),
    **dict.fromkeys(("N", "N m", "Pa", "W", "J", "N/m", "N s/m"), _STEPS),
}
"""For units that have prefixes: each from which size it is used, its letter, and its factor."""


@dataclass(frozen=True)
class Scale:
    """Factor of values in SI to be read in ``unit``."""

    factor: float
    unit: str

    def said(self, value: float, digits: int = 4) -> str:
        """A value with its unit."""
        return f"{number(self.factor * value, digits)} {self.unit}"

    def put(self, axis: Axis) -> None:
        """Have the numbers of an axis, or of a colour bar, be in this unit; what is drawn stays as
        it is.
        """
        if self.factor != 1.0:
            axis.set_major_formatter(lambda value, _: number(self.factor * value, 10))


def number(value: float, digits: int = 4) -> str:
    """A number to so many digits that count, with a sign that is as wide as a plus."""
    return f"{value + 0.0:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def instant(solution: Solution, i: int) -> str:
    """An instant, with the drive's coordinate if instants are defined by one."""
    over = f", {solution.over.shown(solution.over.values[i])}" if solution.over else ""
    return f"t = {number(solution.t[i])} s{over}"


def scale_for(unit: str, size: float, si: bool = False) -> Scale:
    """Scale of values of a unit, of which the largest has a ``size``; SI if ``si`` is asked for."""
    prefixes = () if si or not size > 0.0 else _PREFIXES.get(unit, ())
    reached = ((factor, prefix) for least, prefix, factor in prefixes if size >= least)
    factor, prefix = next(reached, (1.0, ""))
    return Scale(factor, prefix + unit)

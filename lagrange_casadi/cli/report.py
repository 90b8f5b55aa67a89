"""How results are said in a line."""

from __future__ import annotations

from ..solution import Peak, Solution


def peak_line(solution: Solution, peak: Peak) -> str:
    """A peak with its place, and how far it may be off where that is estimated."""
    off = f" +- {solution.errors[peak.name]:.0e}" if peak.name in solution.errors else ""
    where = f"t = {peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.4f}")
    return f"  {peak.name:<28}{peak.value:>13.6g}{off} {peak.unit:<4} at {where}"

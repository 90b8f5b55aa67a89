"""How results are said in a line."""

from __future__ import annotations

from ..instants.solution import Peak, Solution


def peak_line(solution: Solution, peak: Peak) -> str:
    """A peak with its place, and how far it may be off where that is estimated; of one that is not told, what was found."""
    off = f" +- {solution.errors[peak.name]:.0e}" if peak.name in solution.errors else ""
    where = f"t = {peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.4f}")
    if peak.least is not None:
        found = f"{peak.least:.6g} {peak.unit} was found at {where}"
        return f"  {peak.name:<28}{'not told':>13} too much hides between the instants, more may help; {found}"
    return f"  {peak.name:<28}{peak.value:>13.6g}{off} {peak.unit:<4} at {where}"

"""How results are said in a line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..instants.solution import Peak, Solution
from ..quantities import RESULTANT, Output

_GROUPS = ("effort", "reaction", "section")


def peak_line(solution: Solution, peak: Peak) -> str:
    """A peak with its place, and how far it may be off where that is estimated; of one that is not told, what was found."""
    error = _error(solution, peak.name)
    off = "" if error is None else f" +- {error:.0e}"
    where = f"t = {peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.4f}")
    if peak.least is not None:
        found = f"{peak.least:.6g} {peak.unit} was found at {where}"
        return f"  {peak.name:<28}{'not told':>13} too much hides between the instants, more may help; {found}"
    return f"  {peak.name:<28}{peak.value + 0.0:>13.6g}{off} {peak.unit:<4} at {where}"


def peak_lines(solution: Solution, refined: Sequence[Peak] = ()) -> Iterator[str]:
    """The peaks of all efforts, reactions with their resultants, and section forces; or, where they are, the refined ones."""
    peaks = {peak.name: peak for peak in refined}
    for output in _told(solution):
        name = str(output)
        if not solution.determined(output):
            yield f"  {name:<28}{'open':>13} {'':<4} equilibrium does not determine it: the mechanism is over-constrained"
            continue
        yield peak_line(solution, peaks.get(name) or solution.peak(name))


def statistics_lines(solution: Solution) -> Iterator[str]:
    """The smallest and the largest value, mean and rms of the same over the instants, below a head."""
    span = f"over {solution.t[-1] - solution.t[0]:.5g} s" if solution.t.size > 1 else "at the one instant"
    yield f"{span:<30}{'smallest':>13} {'largest':>13} {'mean':>13} {'rms':>13}"
    for output in _told(solution):
        if solution.determined(output):
            found = solution.statistics(output)
            ends = " ".join(f"{extreme.value + 0.0:>13.6g}" for extreme in (found.smallest, found.largest))
            mean, rms = (f"{'':>13}" if value is None else f"{value + 0.0:>13.6g}" for value in (found.mean, found.rms))
            yield f"  {found.name:<28}{ends} {mean} {rms} {found.unit}"


def _told(solution: Solution) -> Iterator[Output]:
    """What is told of a solution: a reaction's resultant after its components."""
    for output in solution.quantities():
        if output.group in _GROUPS:
            yield output
            resultant = Output("reaction", output.part, RESULTANT.member)
            if output == resultant.components[-1]:
                yield resultant


def _error(solution: Solution, name: str) -> float | None:
    """How far a quantity may be off; the size of a force by no more than its components together."""
    errors = [solution.errors.get(str(component)) for component in Output.of(name).components]
    told = [error for error in errors if error is not None]
    return math.hypot(*told) if len(told) == len(errors) else None

"""Results in lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..instants.ordering import error_of, told
from ..instants.solution import Peak, Solution
from ..instants.statistics import Statistics

_NOTHING = 1e-37
"""Least number that is not zero, in single precision too."""


def peak_line(solution: Solution, peak: Peak) -> str:
    """A peak with its place, and how far it may be off where that is estimated; of one that is not
    told, what was found.
    """
    error = error_of(solution, peak.name)
    # Of an exact zero the estimate is the least number there is, which tells nobody anything.
    off = (
        ""
        if error is None
        else f"{'' if abs(peak.value) + error < _NOTHING else f' +- {error:.0e}':<9}"
    )
    where = f"t = {peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.4f}")
    if peak.over is not None and solution.over:
        where = f"{solution.over.shown(peak.over)}, {where}"
    if peak.least is not None:
        found = f"{peak.least:.6g} {peak.unit} was found at {where}"
        return (
            f"  {peak.name:<28}{'not told':>13} too much hides between the instants, more may help;"
            f" {found}"
        )
    return f"  {peak.name:<28}{peak.value + 0.0:>13.6g}{off} {peak.unit:<4} at {where}"


def report_lines(solution: Solution, refined: Sequence[Peak] = ()) -> Iterator[str]:
    """All efforts, reactions with their resultants, and section forces: the peaks, or the refined
    ones, then means and ends.
    """
    peaks = {peak.name: peak for peak in refined}
    rows = [
        (output, solution.statistics(output) if solution.determined(output) else None)
        for output in told(solution)
    ]
    for output, found in rows:
        if found is None:
            yield (
                f"  {output!s:<28}{'open':>13} {'':<4} equilibrium does not determine it: the"
                " mechanism is over-constrained"
            )
            continue
        own = found.peak
        over = (
            float(solution.over.values[int(np.argmax(solution.t == own.t))])
            if solution.over
            else None
        )
        yield peak_line(
            solution,
            peaks.get(found.name)
            or Peak(found.name, own.value, found.unit, own.t, own.xi, over=over),
        )
    span = (
        f"over {solution.t[-1] - solution.t[0]:.5g} s"
        if solution.t.size > 1
        else "at the one instant"
    )
    yield f"{span:<30}{'smallest':>13} {'largest':>13} {'mean':>13} {'rms':>13}"
    yield from (_statistics_line(found) for _, found in rows if found)


def _statistics_line(found: Statistics) -> str:
    ends = " ".join(f"{extreme.value + 0.0:>13.6g}" for extreme in (found.smallest, found.largest))
    means = " ".join(
        f"{'':>13}" if value is None else f"{value + 0.0:>13.6g}"
        for value in (found.mean, found.rms)
    )
    return f"  {found.name:<28}{ends} {means} {found.unit}"


def asked_line(words: Sequence[Any], slides: bool) -> str:
    """Line on how the instants are defined, from :meth:`.Timing.words`, for a joint that ``slides``
    or turns.
    """
    start, stop, count, *joint = words
    ends = [
        word.partition(" #")[0] if isinstance(word, str) else f"{word:g}" for word in (start, stop)
    ]
    what = f"{joint[0]} [{'m' if slides else 'rad'}]" if joint else "t [s]"
    return f"{what}: {ends[0]} to {ends[1]}, {count} points"

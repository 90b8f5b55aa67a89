"""How results are said in a line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..instants.solution import Peak, Solution


def peak_line(solution: Solution, peak: Peak) -> str:
    """A peak with its place, and how far it may be off where that is estimated; of one that is not told, what was found."""
    off = f" +- {solution.errors[peak.name]:.0e}" if peak.name in solution.errors else ""
    where = f"t = {peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.4f}")
    if peak.over is not None and solution.over:
        where = f"{solution.over.shown(peak.over)}, {where}"
    if peak.least is not None:
        found = f"{peak.least:.6g} {peak.unit} was found at {where}"
        return f"  {peak.name:<28}{'not told':>13} too much hides between the instants, more may help; {found}"
    return f"  {peak.name:<28}{peak.value:>13.6g}{off} {peak.unit:<4} at {where}"


def asked_line(words: Sequence[Any], slides: bool) -> str:
    """How instants are asked for, from :meth:`.Timing.words`; whether the joint ``slides``, where there is one."""
    start, stop, count, *joint = words
    ends = [word.partition(" #")[0] if isinstance(word, str) else f"{word:g}" for word in (start, stop)]
    what = f"{joint[0]} [{'m' if slides else 'rad'}]" if joint else "t [s]"
    return f"{what}: {ends[0]} to {ends[1]}, {count} points"

"""``lagrange-casadi report``: a page that shows a run in a browser."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..base.packages import check_installed
from .echo import say_step


def report(
    targets: Sequence[Path],
    *,
    out: Path | None = None,
    beside: Mapping[str, float | str] = {},
    case: Path | None = None,
    live: bool = False,
    **given: Any,
) -> None:
    """Write a page for browsers about FILE.h5 or CASE, or about two of them side by side.

    It is one file, which needs no network and no Python. The mechanism moves with its forces drawn
    on it, next to charts and tables. For a sweep there are maps, fronts and a table of designs;
    click a design to see its mechanism move.

    Parameters
    ----------
    targets : FILE.h5|CASE [FILE.h5|CASE]
    out : REPORT.html
        Write the page to this file; default: <name>.html here.
    parameters, t
        As of :func:`.cli.animate.animate`.
    over
        As of :func:`.studies.evaluate.evaluate`.
    wanted
        As of :func:`.studies.evaluate.evaluate`: For a case: show these outputs besides the motion;
        default: those of the case.
    live
        For a case: put the evaluation into the page, with sliders for the parameters; needs
        ziglang.
    beside : NAME=VALUE
        For a case: show a second design beside it, with this parameter changed.
    case
        For a sweep: show the mechanism of this case in motion.
    """
    if live:
        # What is imported takes a second or more.
        check_installed("ziglang", "a live report", "live")
        say_step(1, "loading the program")
    from .report_page import write

    write(targets, out, beside, case, live, **given)

"""View of a sweep in notebooks: its axes, the outcome of its designs, and the range of its
columns.
"""

from __future__ import annotations

from html import escape

import numpy as np

from ...studies.sweep.axes import counted
from ...studies.sweep.best import with_errors
from ...studies.sweep.meanings import STATUS
from ...studies.sweep.reading import Sweep
from ..shapes.index import html_table

_ROWS = 12
"""Columns that are shown at most."""


def summary(sweep: Sweep) -> str:
    """A table of the smallest and the largest value of each column with one value for each design:
    as HTML.
    """
    counts_text = "; ".join(
        f"{count} without: {sweep.statuses[status][1]}" if status else f"{count} with a result"
        for status, count in sweep.counts().items()
        if count
    )
    head = (
        f"<p><b>{escape(sweep.case)}</b>: {counted(sweep.size)} over"
        f" {escape(', '.join(sweep.parameters))}: {escape(counts_text)}</p>"
    )
    names = [
        name
        for name, column in sweep.columns.items()
        if not column.axes and name.startswith(("peak:", "mean:", "rms:", "fluctuation:"))
    ]
    shown = [*sweep.parameters, *with_errors(sweep, names)[:_ROWS]]
    ends = dict.fromkeys(shown, (np.inf, -np.inf))
    for _, values in sweep.blocks([*shown, STATUS]):
        for name in shown:
            finite = values[name][np.isfinite(values[name])]
            low, high = ends[name]
            ends[name] = (
                min(low, finite.min(initial=np.inf)),
                max(high, finite.max(initial=-np.inf)),
            )
    rows = [(name, *_range_cells(ends[name]), sweep.unit(name)) for name in shown]
    more = (
        f"<p>and {len(names) - _ROWS} more; report(PATH) shows all</p>"
        if len(names) > _ROWS
        else ""
    )
    return head + html_table(("column", "smallest", "largest", "unit"), rows) + more


def _range_cells(ends: tuple[float, float]) -> tuple[str, str]:
    low, high = ends
    return (f"{low:.5g}", f"{high:.5g}") if low <= high else ("", "")

"""``lagrange-casadi tolerances``: how far peaks spread for tolerances of the parameters, and which
of them is to blame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..base.table_writers import Cell, aligned
from ..studies.case import load_case
from ..studies.tolerances import Spread, Spreads
from ..studies.tolerances import tolerances as spreads
from .echo import echo
from .options import table_file

_FEW = 3
"""Parameters that are named for each peak."""


def tolerances(
    case: Path,
    *,
    within: Mapping[str, str],
    csv: Path | None = None,
    decimal_comma: bool = False,
    **given: Any,
) -> None:
    """Compute the scatter of the peaks of CASE within tolerances.

    It lists the share of each tolerance in the scatter.

    Parameters
    ----------
    case : CASE
    within : NAME=TOLERANCE
        As of :func:`.studies.tolerances.tolerances`.
    parameters, t, over, wanted
        As of :func:`.studies.tolerances.tolerances`.
    samples : NUMBER
        As of :func:`.studies.tolerances.tolerances`.
    backend
        As of :func:`.studies.tolerances.tolerances`.
    csv
        Write the peaks as CSV, one row per quantity. A name that ends in .xlsx makes a workbook.
    decimal_comma
        As of :func:`.cli.table.best`.
    """
    table = table_file(csv, decimal_comma)
    found = spreads(load_case(case).scene, within, **given)
    _print(found)
    if table:
        table.write(*_rows(found))
        echo(f"wrote {csv}")


def _print(found: Spreads) -> None:
    failed = f", {found.failed} of them without a result" if found.failed else ""
    heads = ["peak of", "nominal", "+- worst", "sigma", "drawn", "least", "largest", "due to"]
    echo(
        (
            f"{found.case}: {found.drawn} designs drawn{failed}; sigma and worst to first order,"
            " the rest of what was drawn"
        ),
        *aligned(heads, [_cells(spread) for spread in found.peaks.values()], left=(0, 7)),
    )


def _cells(spread: Spread) -> list[str]:
    """A row of the table: the spread of a peak, and the parameters to which most of it is due."""
    due = (
        f"{name} {100 * share:.0f}%"
        for name, share in list(spread.shares.items())[:_FEW]
        if share >= 0.005
    )
    return [
        spread.quantity,
        f"{spread.nominal:.5g}",
        *(f"{size:.3g}" for size in (spread.worst, spread.sigma, spread.deviation)),
        *(f"{end:.5g}" for end in (spread.low, spread.high)),
        ", ".join(due),
    ]


def _rows(found: Spreads) -> tuple[list[str], list[list[Cell]]]:
    """Heads and rows; a row has a unit of its own."""
    names = [
        entry.name for entry in fields(next(iter(found.peaks.values()))) if entry.name != "shares"
    ]
    rows = [
        [
            *(getattr(spread, name) for name in names),
            *(spread.shares[name] for name in found.tolerances),
        ]
        for spread in found.peaks.values()
    ]
    return [*names, *(f"share of {name}" for name in found.tolerances)], rows

"""``lagrange-casadi tolerances``: how far peaks spread for tolerances of the parameters, and which
of them is to blame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..base.table_file import Cell, TableFile
from ..studies.case import load_case
from ..studies.tolerances import Spreads
from ..studies.tolerances import tolerances as spreads
from .echo import echo

_FEW = 3
"""Parameters that are named for each peak."""


def tolerances(
    case: Path,
    within: Mapping[str, str],
    csv: TableFile | None,
    **given: Any,
) -> None:
    """See :func:`.commands.tolerances`."""
    found = spreads(load_case(case).scene, within, **given)
    _print(found)
    if csv:
        csv.write(*_rows(found))
        echo(f"wrote {csv.path}")


def _print(found: Spreads) -> None:
    width = max(len(name) for name in found.peaks)
    failed = f", {found.failed} of them without a result" if found.failed else ""
    echo(
        f"{found.case}: {found.drawn} designs drawn{failed}; sigma and worst to first order, the"
        " rest of what was drawn"
    )
    heads = {"nominal": 11, "+- worst": 10, "sigma": 10, "drawn": 10, "least": 11, "largest": 11}
    echo(
        f"  {'peak of':<{width}} {' '.join(f'{head:>{size}}' for head, size in heads.items())} "
        " due to"
    )
    for spread in found.peaks.values():
        due = ", ".join(
            f"{name} {100 * share:.0f}%"
            for name, share in list(spread.shares.items())[:_FEW]
            if share >= 0.005
        )
        echo(
            f"  {spread.quantity:<{width}} {spread.nominal:>11.5g} {spread.worst:>10.3g}"
            f" {spread.sigma:>10.3g} {spread.deviation:>10.3g} {spread.low:>11.5g}"
            f" {spread.high:>11.5g}  {due}"
        )


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

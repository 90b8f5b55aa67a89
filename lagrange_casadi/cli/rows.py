"""Designs or instants as rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ..base.arrays import Array
from ..base.table_file import head
from ..studies.sweep import Sweep
from ..studies.sweep.meanings import STATUS
from .echo import echo

_WIDTH = 10
_BLOCK = 1024


def show(sweep: Sweep, names: Sequence[str], rows: Iterable[tuple[int, Sequence[float]]]) -> int:
    """Print rows below a head of names and units, each with its design's number; how many there
    were.
    """
    heads = ["design", *heads_of(sweep, names)]
    widths = [max(len(head), _WIDTH) for head in heads]
    echo("  ".join(head.rjust(width) for head, width in zip(heads, widths, strict=True)))
    count = 0
    for number, values in rows:
        cells = [
            str(number),
            *(_cell(sweep, name, value) for name, value in zip(names, values, strict=True)),
        ]
        echo("  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True)))
        count += 1
    return count


def rows_of(columns: Sequence[Array]) -> Iterator[list[float]]:
    """The rows of columns of one length."""
    for start in range(0, columns[0].size, _BLOCK):
        yield from np.column_stack([column[start : start + _BLOCK] for column in columns]).tolist()


def heads_of(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The heads of columns of a sweep."""
    return [head(name, sweep.unit(name)) for name in names]


def _cell(sweep: Sweep, name: str, value: float) -> str:
    return sweep.statuses.get(int(value), (str(value), ""))[0] if name == STATUS else f"{value:.6g}"

"""Designs or instants as rows, on a terminal or as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path

import numpy as np

from ..base.arrays import Array
from ..base.publish import writing
from ..studies.sweep import Sweep
from ..studies.sweep.meanings import STATUS
from .echo import echo

_WIDTH = 10
_BLOCK = 1024


def show(sweep: Sweep, names: Sequence[str], rows: Iterable[tuple[int, Sequence[float]]]) -> int:
    """Print rows below a head of names and units, each with its design's number; how many there
    were.
    """
    heads = ["design", *(_head(sweep, name) for name in names)]
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


def write_csv(names: Sequence[str], rows: Iterable[Sequence[float]], path: Path) -> int:
    """Write rows with every digit they have; how many there were."""
    with csv_written(names, rows, path) as count:
        return count


@contextmanager
def csv_written(names: Sequence[str], rows: Iterable[Sequence[float]], path: Path) -> Iterator[int]:
    """Rows with every digit they have, which are put into their place at the end, unless something
    fails; how many there are.
    """
    count = 0
    with writing(path) as (file,):
        text = TextIOWrapper(file, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(names)
        for values in rows:
            writer.writerow([repr(value) for value in values])
            count += 1
        text.detach()
        file.flush()
        yield count


def rows_of(columns: Sequence[Array]) -> Iterator[list[float]]:
    """The rows of columns of one length."""
    for start in range(0, columns[0].size, _BLOCK):
        yield from np.column_stack([column[start : start + _BLOCK] for column in columns]).tolist()


def _head(sweep: Sweep, name: str) -> str:
    unit = sweep.unit(name)
    return name if unit == "1" else f"{name} [{unit}]"


def _cell(sweep: Sweep, name: str, value: float) -> str:
    return sweep.statuses.get(int(value), (str(value), ""))[0] if name == STATUS else f"{value:.6g}"

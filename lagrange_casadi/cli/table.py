"""``lagrange-casadi best`` and ``table``: the designs of a sweep as rows."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any

from ..base.streams import is_standard_output
from ..base.table_writers import aligned, head
from ..errors import NoDesignError, listed
from ..studies.sweep import Sweep, chosen
from ..studies.sweep import best as find
from ..studies.sweep.axes import DESIGN, counted, grouped
from ..studies.sweep.best import conditions_in, counts, missed, with_errors
from ..studies.sweep.meanings import STATUS, in_words
from .echo import echo
from .options import table_file

_WIDE = 6
_ROOM = 160
_WIDTH = 10


def best(
    file: Path,
    *,
    where: Sequence[str] = (),
    csv: Path | None = None,
    decimal_comma: bool = False,
    **given: Any,
) -> None:
    """List the best designs of the sweep FILE.h5.

    Peaks are compared by their size, whatever their sign.

    Parameters
    ----------
    file : FILE.h5
    minimise : COLUMN
        As of :func:`.studies.sweep.best.best`.
    maximise : COLUMN
        As of :func:`.studies.sweep.best.best`.
    where : NAME<NUMBER
        As of :func:`.studies.sweep.best.best`.
    count : N
        As of :func:`.studies.sweep.best.best`.
    columns : COLUMN
        As of :func:`.studies.sweep.best.best`.
    csv
        Also write the designs as CSV. A name that ends in .xlsx makes a workbook.
    decimal_comma
        With --csv: write commas in numbers, and semicolons between cells.
    """
    written = table_file(csv, decimal_comma)
    sweep = Sweep.open(file)
    found = find(sweep, where=where, **given)
    if not found:
        satisfied, with_result = (grouped(count) for count in counts(sweep, where))
        raise NoDesignError(
            f"{file}: no design has a result and meets the conditions: of {counted(sweep.size)},"
            f" {satisfied} meet them, {with_result} of these with a result{missed(sweep, where)}"
        )
    names, piped = list(found[0].values), csv is not None and is_standard_output(csv)
    if not piped:
        _show(sweep, names, [(design.number, list(design.values.values())) for design in found])
    if written:
        rows = ([design.number, *design.values.values()] for design in found)
        written.write([DESIGN, *_heads_of(sweep, names)], rows)
        echo(f"wrote {csv}: {counted(len(found))}", err=piped)


def table(
    file: Path,
    *,
    where: Sequence[str] = (),
    columns: Sequence[str] = (),
    rows: int = 20,
    csv: Path | None = None,
    decimal_comma: bool = False,
) -> None:
    """List the designs of the sweep FILE.h5, or write them as CSV.

    A row is a design; for columns with a value at each xi or t, it is a design at one of these.

    Parameters
    ----------
    file : FILE.h5
    where : NAME<NUMBER
        Choose only rows that satisfy this: <, <=, >, >=, == or !=, in SI units.
    columns : COLUMN
        List this column. Default: the main peaks.
    rows : N
        List this number of rows.
    csv
        Write all rows as CSV; default: all columns without axes. A name that ends in .xlsx makes
        a workbook.
    decimal_comma
        As of :func:`.cli.table.best`.
    """
    written = table_file(csv, decimal_comma)
    sweep = Sweep.open(file)
    along = sweep.axes_of([*columns, *(condition.name for condition in conditions_in(where))])
    single = [name for name, kept in sweep.columns.items() if not kept.axes]
    peaks = [name for name in single if name.startswith("peak:")]
    main = [
        STATUS,
        *with_errors(
            sweep, sorted(peaks, key=lambda name: name.split(":")[1] not in ("effort", "section"))
        ),
    ]
    names = list(
        dict.fromkeys([*sweep.parameters, *along, *(columns or (single if csv else main[:_WIDE]))])
    )
    found, what = _rows(sweep, names, where, along), "row" if along else "design"
    first = next(found, None)
    if first is None:
        raise NoDesignError(f"{file}: no {what} meets the conditions{missed(sweep, where, along)}")
    found = chain([first], found)
    if written:
        written.write(_heads_of(sweep, names), (values for _, values in found))
        satisfied, _ = counts(sweep, where, along)
        echo(f"wrote {csv}: {counted(satisfied, what)}", err=is_standard_output(written.path))
    elif _show(sweep, names, islice(found, min(rows, sys.maxsize))) == rows:
        satisfied, with_result = counts(sweep, where, along)
        if satisfied > rows:
            echo(
                f"... of {counted(satisfied, what)}{' that meet the conditions' if where else ''},"
                f" {grouped(with_result)} with a result; --rows N shows more, --csv OUT.csv writes"
                " all"
            )
    if not columns:
        _mention_others(sweep, names)


def _rows(
    sweep: Sweep, names: Sequence[str], where: Sequence[str], along: Sequence[str]
) -> Iterator[tuple[int, list[float]]]:
    return (
        row
        for numbers, values in chosen(sweep, names, where, along)
        for row in zip(
            numbers.tolist(),
            map(list, zip(*(values[name].tolist() for name in names), strict=True)),
            strict=True,
        )
    )


def _mention_others(sweep: Sweep, shown: Sequence[str]) -> None:
    """Name the columns that are not shown, by their axes, and how to show them."""
    others = [kept for kept in sweep.columns.values() if kept.name not in shown]
    for axes in dict.fromkeys(kept.axes for kept in others):
        names = [kept.name for kept in others if kept.axes == axes]
        over, rows = (
            (f" over {in_words(axes)}", f", a row for every {' and '.join(axes)}")
            if axes
            else ("", "")
        )
        echo(
            f"note: --column NAME shows other columns{over}{rows}: {listed(names, room=_ROOM)}"
            f" (`lagrange-casadi info {sweep.path}` lists all)",
            err=True,
        )


def _show(sweep: Sweep, names: Sequence[str], rows: Iterable[tuple[int, Sequence[float]]]) -> int:
    """Print rows below a head of names and units, each with its design's number; how many there
    were.
    """
    cells = [[str(number), *map(partial(_cell, sweep), names, values)] for number, values in rows]
    echo(*aligned(["design", *_heads_of(sweep, names)], cells, width=_WIDTH, indent=""))
    return len(cells)


def _heads_of(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The heads of columns of a sweep."""
    return [head(name, sweep.unit(name)) for name in names]


def _cell(sweep: Sweep, name: str, value: float) -> str:
    return sweep.statuses.get(int(value), (str(value), ""))[0] if name == STATUS else f"{value:.6g}"

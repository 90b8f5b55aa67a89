"""``lagrange-casadi best`` and ``table``: the designs of a sweep as rows."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any

from ..base.streams import is_standard_output
from ..base.table_file import TableFile, aligned, head
from ..errors import NoDesignError
from ..studies.sweep import Sweep, chosen
from ..studies.sweep import best as find
from ..studies.sweep.axes import DESIGN, counted, grouped
from ..studies.sweep.best import conditions_in, counts, missed, with_errors
from ..studies.sweep.meanings import STATUS, in_words
from .echo import echo

_WIDE = 6
_LISTED = 6
_WIDTH = 10


def best(file: Path, where: Sequence[str], csv: TableFile | None, **given: Any) -> None:
    """See :func:`.commands.best`."""
    sweep = Sweep.open(file)
    found = find(sweep, where=where, **given)
    if not found:
        satisfied, with_result = (grouped(count) for count in counts(sweep, where))
        raise NoDesignError(
            f"{file}: no design has a result and meets the conditions: of {counted(sweep.size)},"
            f" {satisfied} meet them, {with_result} of these with a result{missed(sweep, where)}"
        )
    names, piped = list(found[0].values), csv is not None and is_standard_output(csv.path)
    if not piped:
        _show(sweep, names, [(design.number, list(design.values.values())) for design in found])
    if csv:
        rows = ([design.number, *design.values.values()] for design in found)
        csv.write([DESIGN, *_heads_of(sweep, names)], rows)
        echo(f"wrote {csv.path}: {counted(len(found))}", err=piped)


def table(
    file: Path, where: Sequence[str], columns: Sequence[str], rows: int, csv: TableFile | None
) -> None:
    """See :func:`.commands.table`."""
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
    if csv:
        count = csv.write(_heads_of(sweep, names), (values for _, values in found))
        echo(f"wrote {csv.path}: {counted(count, what)}", err=is_standard_output(csv.path))
    elif _show(sweep, names, islice(found, min(rows, sys.maxsize))) == rows:
        satisfied, with_result = counts(sweep, where, along)
        if satisfied > rows:
            what = counted(satisfied, what) + (" that meet the conditions" if where else "")
            echo(
                f"... of {what}, {grouped(with_result)} with a result; --rows N shows more, --csv"
                " OUT.csv writes all"
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
    others: dict[tuple[str, ...], list[str]] = {}
    for kept in sweep.columns.values():
        if kept.name not in shown:
            others.setdefault(kept.axes, []).append(kept.name)
    for axes, names in others.items():
        more = (
            f" and {len(names) - _LISTED} more (`lagrange-casadi info {sweep.path}` lists them)"
            if len(names) > _LISTED
            else ""
        )
        over, rows = (
            (f" over {in_words(axes)}", f", a row for every {' and '.join(axes)}")
            if axes
            else ("", "")
        )
        echo(
            f"note: --column NAME shows other columns{over}{rows}:"
            f" {', '.join(names[:_LISTED])}{more}",
            err=True,
        )


def _show(sweep: Sweep, names: Sequence[str], rows: Iterable[tuple[int, Sequence[float]]]) -> int:
    """Print rows below a head of names and units, each with its design's number; how many there
    were.
    """
    cells = [[str(number), *map(partial(_cell, sweep), names, values)] for number, values in rows]
    echo(*aligned(["design", *_heads_of(sweep, names)], cells, width=_WIDTH))
    return len(cells)


def _heads_of(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The heads of columns of a sweep."""
    return [head(name, sweep.unit(name)) for name in names]


def _cell(sweep: Sweep, name: str, value: float) -> str:
    return sweep.statuses.get(int(value), (str(value), ""))[0] if name == STATUS else f"{value:.6g}"

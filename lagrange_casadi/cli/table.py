"""``lagrange-casadi table``: the designs of a sweep as rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import click

from ..sweep import Sweep, chosen
from .rows import show, write_csv

_WIDE = 6


@click.command()
@click.argument("file", metavar="FILE.h5", type=click.Path(path_type=Path))
@click.option("--where", multiple=True, metavar="NAME<NUMBER", help="Only designs like this: <, <=, >, >=, == or !=; repeatable.")
@click.option("--column", "columns", multiple=True, metavar="COLUMN", help="This column; repeatable. Default: the main peaks.")
@click.option("--rows", type=click.IntRange(1), default=20, show_default=True, metavar="N", help="How many designs to show.")
@click.option("--csv", type=click.Path(path_type=Path), metavar="OUT.csv", help="Write all designs, by default with all columns.")
def table(file: Path, where: Sequence[str], columns: Sequence[str], rows: int, csv: Path | None) -> None:
    """Show the designs of the sweep FILE.h5, or write them as CSV."""
    sweep = Sweep.open(file)
    single = [name for name, kept in sweep.columns.items() if not kept.axes]
    if csv:
        names = list(dict.fromkeys([*sweep.parameters, *(columns or single)]))
        click.echo(f"wrote {csv}: {write_csv(names, _designs(sweep, names, where), csv)} designs")
        return
    main = ["status", *(name for name in single if name.startswith("peak:") and name.split(":")[1] in ("effort", "section"))]
    names = list(dict.fromkeys([*sweep.parameters, *(columns or main[:_WIDE])]))
    shown = show(sweep, names, islice(_designs(sweep, names, where), rows))
    if shown == rows < sweep.size:
        click.echo(f"... of {sweep.size} designs; --rows N shows more, --csv OUT.csv writes all")
    if len(names) < len(sweep.parameters) + len(single) and not columns:
        click.echo(f"--column NAME shows others: {', '.join(name for name in single if name not in names)}")


def _designs(sweep: Sweep, names: Sequence[str], where: Sequence[str]) -> Iterator[tuple[int, list[float]]]:
    for numbers, values in chosen(sweep, names, where):
        yield from zip(numbers.tolist(), map(list, zip(*(values[name].tolist() for name in names), strict=True)), strict=True)

"""``lagrange-casadi best``: the best designs of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.streams import is_standard_output
from ..base.table_file import TableFile
from ..errors import NoDesignError
from ..studies.sweep import Sweep
from ..studies.sweep import best as find
from ..studies.sweep.axes import DESIGN, counted, grouped
from ..studies.sweep.best import counts, missed
from .echo import echo
from .rows import heads_of, show


def best(
    file: Path,
    minimise: Sequence[str],
    maximise: Sequence[str],
    where: Sequence[str],
    count: int | None,
    columns: Sequence[str],
    csv: TableFile | None,
) -> None:
    """See :func:`.commands.best`."""
    if csv:
        csv.check()
    sweep = Sweep.open(file)
    found = find(
        sweep, minimise=minimise, maximise=maximise, where=where, count=count, columns=columns
    )
    if not found:
        satisfied, with_result = (grouped(count) for count in counts(sweep, where))
        raise NoDesignError(
            f"{file}: no design has a result and meets the conditions: of {counted(sweep.size)},"
            f" {satisfied} meet them, {with_result} of these with a result{missed(sweep, where)}"
        )
    names, piped = list(found[0].values), csv is not None and is_standard_output(csv.path)
    if not piped:
        show(sweep, names, [(design.number, list(design.values.values())) for design in found])
    if csv:
        rows = ([design.number, *design.values.values()] for design in found)
        csv.write([DESIGN, *heads_of(sweep, names)], rows)
        echo(f"wrote {csv.path}: {counted(len(found))}", err=piped)

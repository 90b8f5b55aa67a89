"""``lagrange-casadi plot``: the figures of a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from ..base.files import check_writable
from ..base.units import quantity
from ..errors import NoDesignError
from ..results.store.runs import figure_specs, load
from ..results.store.specs import Spec as FigureSpec
from ..results.store.untrusted import reported_as
from ..studies.sweep import Sweep, is_sweep
from ..views.charts.designs import draw_sweep
from ..views.charts.usual_designs import default_plots
from ..views.shapes.index import MANIFEST, NAME, write_index
from .drawing import draw_with_progress
from .echo import echo
from .options import refuse
from .progress import bar_of
from .strength_lines import not_evaluated_lines

_UNDRAWN = "cannot be drawn"


def plot(
    file: Path,
    *,
    out: Path,
    over: Sequence[str] = (),
    at: Mapping[str, float | str] = {},
    against: Sequence[tuple[str, str]] = (),
    si: bool = False,
    svg: bool = False,
) -> None:
    """Draw the figures of the run or sweep FILE.h5.

    A run has the figures of its case, a sweep has its peaks over parameters.

    Parameters
    ----------
    file : FILE
    out
        Draw into this folder.
    over : NAME
        For a sweep: draw over this parameter, for maps over two; for a list of designs, over any.
    at : NAME=NUMBER
        For a sweep: keep another parameter at this value, or choose designs of a list.
    against : COLUMN COLUMN
        For a sweep: draw the Pareto front of these two columns or parameters.
    si
        Draw axes in SI units without prefixes, in place of kN and mm.
    svg
        Draw figures as SVG, in place of PNG.
    """
    check_writable(out, folder=True)
    MANIFEST.check(out)
    swept = is_sweep(file)
    refuse(
        (swept and si, "--si goes with the file of a run; figures of a sweep are in SI"),
        (
            not swept and (over or at or against),
            "--over, --at and --against go with a sweep's file",
        ),
    )
    if swept:
        sweep = Sweep.open(file)
        there = {name: _number(sweep, name, value) for name, value in at.items()}
        _draw(sweep, default_plots(sweep, over, there, against), out, svg)
    else:
        solution, drawn = load(file), cast("Sequence[FigureSpec]", figure_specs(file))
        with reported_as(_UNDRAWN, file), MANIFEST.filling(out) as draft:
            draw_with_progress(solution, drawn, draft, si, svg)
        if not drawn:
            echo(*not_evaluated_lines(solution), err=True)
    echo(f"wrote the figures in {out}/; {out}/{NAME} shows all of them")


def _draw(
    sweep: Sweep, figures: Mapping[str, Callable[[Sweep], Any]], out: Path, svg: bool
) -> None:
    """Draw figures of a sweep; what shows nothing is said.

    Raises :class:`NoDesignError` where no figure shows anything.
    """
    with reported_as(_UNDRAWN, sweep.path), MANIFEST.filling(out) as draft:
        done = list(bar_of("figures", draw_sweep(sweep, figures, draft, svg), len(figures)))
        skipped = [f"{path.name}: {why}" for path, why in done if why]
        if len(skipped) == len(figures):
            raise NoDesignError(f"there is nothing to draw: {'; '.join(dict.fromkeys(skipped))}")
        write_index(sweep.case, [path for path, why in done if not why], draft)
    echo(*(f"note: not drawn: {line}" for line in skipped), err=True)


def _number(sweep: Sweep, name: str, value: float | str) -> float:
    """Number of a fixed parameter, which may have a unit."""
    return quantity(f"--at: {name}", value, sweep.parameters.get(name, "1"), finite=False)

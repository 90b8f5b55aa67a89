"""``lagrange-casadi identify``: parameters of a case from measurements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from ..results.store.opening import IDENTIFICATION
from ..results.store.runs import check_target
from ..studies.case import load_case
from ..studies.identification import Comparison, Identification, read_measurements
from ..studies.identification import identify as estimate
from ..studies.identification.file import save_identification
from ..views.charts.identification import plot_identification
from ..views.charts.identification_page import check_page, report_identification
from ..views.shapes.pictures import check_picture
from .echo import echo
from .options import HDF5, target


def identify(
    case: Path,
    data: Path,
    names: Mapping[str, str],
    noise: Mapping[str, float],
    counts_per_turn: Sequence[tuple[str, float]],
    trim: float,
    validate: Path | None,
    out: Path | None,
    figure: Path | None,
    report: Path | None,
    **given: Any,
) -> None:
    """See :func:`.design_commands.identify`."""
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_identified.h5", HDF5)
    check_target(out, IDENTIFICATION)
    if figure is not None:
        check_picture(figure)
    if report is not None:
        check_page(report)

    turns = _turns(counts_per_turn)
    read = partial(read_measurements, names=names, noise=noise, counts_per_turn=turns)
    record, other = read(data), None if validate is None else read(validate)
    found = estimate(loaded.scene, record, trim=trim, **given)
    second = None if other is None else found.validate(other, trim)
    echo(*_lines(found, second))
    save_identification(found, out, second)
    echo(f"wrote {out}")
    if figure is not None:
        plot_identification(second or found.comparison, figure)
        echo(f"wrote {figure}")
    if report is not None:
        report_identification(found, report, second)
        echo(f"wrote {report}")
    echo(" ".join(f"--set {word}" for word in found.setting.split()))


def _turns(given: Sequence[tuple[str, float]]) -> float | dict[str, float] | None:
    """Return counts in one turn by column, or those of all, which have no name."""
    named = dict(given)
    if "" not in named:
        return named or None
    if len(given) > 1:
        raise click.UsageError(
            "--counts-per-turn: expected one NUMBER for all columns in counts, or NAME=NUMBER for"
            " each"
        )
    return named[""]


def _lines(found: Identification, second: Comparison | None) -> Iterator[str]:
    yield (
        f"{found.name}: {len(found.base)} combinations of {len(found.values)} parameters from"
        f" {found.measurements}, condition {found.condition:.3g}, {found.rounds} steps"
    )
    width = max(len(one.words) for one in found.base)
    yield f"  {'combination':<{width}} {'value':>12} {'error':>10} {'t':>8}"
    for one in found.base:
        numbers = f"{one.value:>12.6g} {one.error:>10.3g} {one.t:>8.3g}"
        yield f"  {one.words:<{width}} {numbers} {one.unit}"
    for note in found.notes:
        yield f"  {note}"
    for title, compared in (("record", found.comparison), ("validation", second)):
        if compared is not None:
            for name, share in compared.relative.items():
                unit = "" if compared.units[name] == "1" else f" {compared.units[name]}"
                yield (
                    f"  {title}: {name} differs by {compared.residual[name]:.4g}{unit} rms,"
                    f" {100 * share:.3g} % of measured"
                )

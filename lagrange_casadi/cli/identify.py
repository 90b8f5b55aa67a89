"""``lagrange-casadi identify``: parameters of a case from measurements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from ..base.table_writers import aligned
from ..results.store.opening import IDENTIFICATION
from ..results.store.runs import check_target
from ..studies.case import load_case
from ..studies.identification import Comparison, Identification, read_measurements
from ..studies.identification import identify as estimate
from ..studies.identification.identification_file import save_identification
from ..views.charts.identification_chart import plot_identification
from ..views.charts.identification_page import ENDINGS, report_identification
from ..views.shapes.picture_files import check_picture
from .echo import echo, write_asked
from .options import HDF5, refuse, target


def identify(
    case: Path,
    data: Path,
    *,
    names: Mapping[str, str] = {},
    noise: Mapping[str, float] = {},
    counts_per_turn: Sequence[tuple[str, float]] = (),
    trim: float = 0.0,
    validate: Path | None = None,
    out: Path | None = None,
    figure: Path | None = None,
    report: Path | None = None,
    **given: Any,
) -> None:
    """Find parameters of CASE from motion and forces that were measured.

    The first line of DATA.csv has names and units of columns: t [s], the coordinates of all drives,
    as O [deg], and forces, as effort:O [N m], reaction:A:fx [N], section:rod:axial@0.5 [N]. The
    command prints combinations of parameters that the data determine, with standard errors, and the
    values as options --set.

    lagrange-casadi identify cases/slider_crank run.csv --unknown m3 --noise 'effort:O=0.05'

    Parameters
    ----------
    case : CASE
    data : DATA.csv
    unknown : NAME,...
        As of :func:`.studies.identification.identification.identify`.
    parameters
        As of :func:`.studies.identification.identification.identify`.
    names : NAME=HEAD
        As of :func:`.studies.identification.measurements.read_measurements`.
    noise : NAME=NUMBER
        As of :func:`.studies.identification.measurements.read_measurements`.
    prior : NAME=NUMBER
        As of :func:`.studies.identification.identification.identify`.
    counts_per_turn : NUMBER|NAME=NUMBER
        As of :func:`.studies.identification.measurements.read_measurements`.
    robust, consistent
        As of :func:`.studies.identification.identification.identify`.
    cutoff : HZ
        As of :func:`.studies.identification.identification.identify`.
    trim : SECONDS
        As of :func:`.studies.identification.identification.identify`.
    validate : OTHER.csv
        Compare this other record with the model that was found.
    out
        Write to this HDF5 file; default: <case>_identified.h5.
    figure : FILE
        Draw measured and model to this .png, .pdf or .svg.
    report : FILE.html
        Write a page with all tables and pictures.
    """
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_identified.h5", HDF5)
    check_target(out, IDENTIFICATION)
    check_picture(figure)
    check_picture(report, ENDINGS)

    turns = dict(counts_per_turn)
    refuse(
        (
            len(counts_per_turn) > (1 if "" in turns else len(turns)),
            (
                "--counts-per-turn: expected one NUMBER for all columns in counts, or one"
                " NAME=NUMBER for each"
            ),
        )
    )
    read = partial(
        read_measurements,
        names=names,
        noise=noise,
        # A number for all columns has no name.
        counts_per_turn=turns.get("", turns or None),
    )
    record, other = read(data), None if validate is None else read(validate)
    found = estimate(loaded.scene, record, trim=trim, **given)
    if record.first:
        echo(f"note: times of {data.name} count from the stamp of its first row, {record.first}")
    second = None if other is None else found.validate(other, trim)
    echo(*_lines(found, second))
    save_identification(found, out, second)
    echo(f"wrote {out}")
    write_asked(figure, partial(plot_identification, second or found.comparison))
    write_asked(report, lambda path: report_identification(found, path, second))
    echo(" ".join(f"--set {word}" for word in found.setting.split()))


def _lines(found: Identification, second: Comparison | None) -> Iterator[str]:
    yield (
        f"{found.name}: {len(found.base)} combinations of {len(found.values)} parameters from"
        f" {found.measurements}, condition {found.condition:.3g}, {found.rounds} steps"
    )
    rows = [
        [one.words, f"{one.value:.6g}", f"{one.error:.3g}", f"{one.t:.3g}", one.unit]
        for one in found.base
    ]
    yield from aligned(["combination", "value", "error", "t", ""], rows, left=(0, 4))
    yield from (f"  {note}" for note in found.notes)
    for title, compared in (("record", found.comparison), ("validation", second)):
        if compared is not None:
            for name, share in compared.relative.items():
                unit = "" if compared.units[name] == "1" else f" {compared.units[name]}"
                yield (
                    f"  {title}: {name} differs by {compared.residual[name]:.4g}{unit} rms,"
                    f" {100 * share:.3g} % of measured"
                )

"""``lagrange-casadi sweep``: a case over many designs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import click

from ..base.status import Status
from ..case import load_case
from ..declare.notes import drawing_notes
from ..errors import CertificateError
from ..studies.sweep import Axis, Sweep, read_designs
from ..studies.sweep import sweep as carry_out
from ..studies.sweep.axes import counted, grouped
from ..studies.sweep.notes import fatigue_notes, resting_note, turning_note
from .echo import echo
from .options import HDF5, asked, check_ending
from .progress import shown


def sweep(
    case: Path,
    axes: Sequence[tuple[str, Axis]],
    designs: Path | None,
    quiet: bool,
    out: Path | None,
    **options: object,
) -> None:
    """See :func:`.commands.sweep`."""
    if bool(axes) == bool(designs):
        raise click.UsageError(
            "expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv"
        )
    if len({name for name, _ in axes}) < len(axes):
        twice = next(name for k, (name, _) in enumerate(axes) if name in dict(axes[:k]))
        raise click.UsageError(f"--grid: parameter '{twice}' is swept twice")
    if out:
        check_ending("--out", out, HDF5)
    loaded = load_case(case)
    scene = loaded.scene
    swept = read_designs(designs, scene.parameters) if designs else dict(axes)
    out, given = out or Path(f"{loaded.name}_sweep.h5"), asked(options)
    with closing(shown(quiet)) as progress:
        found = carry_out(loaded, swept, out=out, progress=progress, **given)
    _report(found)
    fixed, t, over = (given[name] for name in ("parameters", "t", "over"))
    turning = turning_note(scene, scene.timing(t, over), swept, fixed)
    rests = resting_note(scene, found, fixed, t=t, over=over, wanted=given["wanted"])
    for note in filter(
        None, (*drawing_notes(found.description), rests, turning, *fatigue_notes(found))
    ):
        echo(f"note: {note}")
    echo(
        f"wrote {found.path}"
        if progress.begun
        else f"{found.path} was complete already: nothing was done"
    )
    if wrong := found.counts()[Status.UNCERTIFIED]:
        raise CertificateError(
            f"{counted(wrong)} of those that were checked in full, one of each block,"
            f" {'fails its' if wrong == 1 else 'fail their'} certificate: others may be wrong as"
            " well"
        )


def _report(found: Sweep) -> None:
    shape = " x ".join(str(length) for length in found.dimensions.values())
    product = f"{shape} = " if len(found.dimensions) > 1 else ""
    echo(f"{found.case}: {product}{counted(found.size)} over {', '.join(found.parameters)}")
    for status, many in found.counts().items():
        if status and many:
            echo(f"  {grouped(many)} without a result: {found.statuses[status][1]}")

"""``lagrange-casadi sweep``: a case over many designs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import click

from ..base.status import Status
from ..base.vocabulary import Backend, PeakSearch, Precision
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.notes import drawing_notes
from ..declare.times import Over
from ..errors import CertificateError
from ..studies.sweep import Axis, Keep, Sweep, read_designs
from ..studies.sweep import sweep as carry_out
from ..studies.sweep.axes import counted, grouped
from ..studies.sweep.notes import fatigue_notes, resting_note, turning_note
from .echo import echo
from .options import parameters
from .progress import shown


def sweep(
    case: Path,
    axes: Sequence[tuple[str, Axis]],
    designs: Path | None,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    xi: EvenPoints | None,
    want: Sequence[str],
    keep: Keep,
    peaks: PeakSearch,
    fluctuation: bool,
    backend: Backend,
    precision: Precision,
    newton: int | None,
    flags: str,
    workers: int | None,
    dask: str | None,
    resume: bool,
    force: bool,
    yes: bool,
    quiet: bool,
    out: Path | None,
) -> None:
    """See :func:`.commands.sweep`."""
    if bool(axes) == bool(designs):
        raise click.UsageError(
            "expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv"
        )
    if len({name for name, _ in axes}) < len(axes):
        twice = next(name for k, (name, _) in enumerate(axes) if name in dict(axes[:k]))
        raise click.UsageError(f"--grid: parameter '{twice}' is swept twice")
    if out and out.suffix not in (".h5", ".hdf5"):
        raise click.UsageError(f"--out {out}: expected a name that ends in .h5 or .hdf5")
    loaded = load_case(case)
    scene = loaded.scene
    swept = read_designs(designs, scene.parameters) if designs else dict(axes)
    with closing(shown(quiet)) as progress:
        found = carry_out(
            loaded,
            swept,
            out=out or Path(f"{loaded.name}_sweep.h5"),
            parameters=parameters(settings),
            t=t,
            over=over,
            xi=xi,
            wanted=want or None,
            keep=keep,
            peaks=peaks,
            fluctuation=fluctuation,
            backend=backend,
            precision=precision,
            newton=newton,
            flags=flags,
            workers=workers,
            dask=dask,
            resume=resume,
            force=force,
            many=yes,
            progress=progress,
        )
    _report(found)
    turning = turning_note(scene, scene.timing(t, over), swept, parameters(settings))
    rests = resting_note(scene, found, parameters(settings), t=t, over=over, wanted=want or None)
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

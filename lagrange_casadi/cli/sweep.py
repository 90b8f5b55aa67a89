"""``lagrange-casadi sweep``: a case over many designs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import click

from ..base.room import MOST_THREADS
from ..base.vocabulary import Backend, Precision
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.times import Over
from ..errors import CertificateError
from ..instants.refusal import Status
from ..studies.sweep import KEEPS, Axis, Keep, Sweep, read_designs
from ..studies.sweep import sweep as carry_out
from ..studies.sweep.axes import counted, grouped
from ..studies.sweep.resting import resting_note
from ..studies.sweep.turning import turning_note
from .echo import echo
from .options import AXIS, EVEN_POINTS, PATH, axis, even_points, instants, parameters, settings_by, untabled_rung, wanted
from .options import over as by_drive
from .progress import shown


@click.command()
@click.argument("case", type=PATH)
@click.option(
    "--grid", "axes", type=axis, metavar=AXIS, multiple=True, help="Sweep a parameter; repeatable, the last varies fastest."
)
@click.option(
    "--designs",
    type=PATH,
    metavar="FILE.csv",
    help="Sweep a list: a line of names, then one line for each design.",
)
@settings_by("Give a parameter that is not swept another value; repeatable.")
@instants()
@by_drive
@click.option(
    "--xi", type=even_points, metavar=EVEN_POINTS, help="Keep section forces at these ratios xi/l too, each the largest over time."
)
@wanted("An output that info CASE lists; all leaves out the motion; repeatable.")
@click.option(
    "--keep",
    type=click.Choice(KEEPS),
    default="peaks",
    show_default=True,
    help="Keep peaks, section laws too, or all outputs over time too.",
)
@untabled_rung
@click.option("--workers", type=click.IntRange(1, MOST_THREADS), metavar="N", help="Threads of this machine; default: one a core.")
@click.option("--dask", metavar="ADDRESS", help="Evaluate on a cluster: its Dask scheduler, as tcp://HOST:8786.")
@click.option("--resume", is_flag=True, help="Go on with what is there of the same sweep; start where there is nothing.")
@click.option("--force", is_flag=True, help="Start anew, and replace what is there.")
@click.option("--yes", is_flag=True, help="Allow more than 10^9 designs.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
@click.option("--out", type=PATH, help="The file; default: <case>_sweep.h5 here.")
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
    """Evaluate CASE for every design of a grid or a list, and write one HDF5 file.

    CASE is a folder with a case.py, a Python file, or one that cases lists. Of each design the peaks of what is wanted are kept,
    with their instants and places, and means of efforts. A stopped sweep goes on with --resume. best, table and plot read the file.

    \b
    lagrange-casadi sweep cases/slider_crank --grid l=0.12:0.4:57 --grid m3=0.1,0.5
    lagrange-casadi best slider_crank_sweep.h5 --minimise peak:section:rod:bending
    """
    if bool(axes) == bool(designs):
        raise click.UsageError("expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv")
    if len({name for name, _ in axes}) < len(axes):
        twice = next(name for k, (name, _) in enumerate(axes) if name in dict(axes[:k]))
        raise click.UsageError(f"--grid: parameter '{twice}' is swept twice")
    if out and out.suffix not in (".h5", ".hdf5"):
        raise click.UsageError(f"--out {out}: expected a name that ends in .h5 or .hdf5")
    loaded = load_case(case)
    swept = read_designs(designs, loaded.scene.mechanism.parameters) if designs else dict(axes)
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
    turns = turning_note(loaded.scene, loaded.scene.timing(t, over), swept, parameters(settings))
    rests = resting_note(loaded.scene, found, parameters(settings), t=t, over=over, wanted=want or None)
    for note in filter(None, (rests, turns)):
        echo(f"note: {note}")
    echo(f"wrote {found.path}" if progress.begun else f"{found.path} was complete already: nothing was done")
    if wrong := found.counts()[Status.UNCERTIFIED]:
        raise CertificateError(
            f"{counted(wrong)} of those that were checked in full, one of each block, "
            f"{'fails its' if wrong == 1 else 'fail their'} certificate: others may be wrong as well"
        )


def _report(found: Sweep) -> None:
    shape = " x ".join(str(length) for length in found.dimensions.values())
    product = f"{shape} = " if len(found.dimensions) > 1 else ""
    echo(f"{found.case}: {product}{counted(found.size)} over {', '.join(found.parameters)}")
    for status, many in found.counts().items():
        if status and many:
            echo(f"  {grouped(many)} without a result: {found.statuses[status][1]}")

"""``lagrange-casadi run``: evaluate a case, store it, draw it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import click
import numpy as np

from ..arithmetic.compensated import Precision
from ..case import load_case
from ..declare import turned
from ..declare.even_points import EvenPoints
from ..declare.times import Over
from ..draw.figures import dump_specs
from ..errors import CertificateError
from ..evaluate import evaluate
from ..instants.rung import Backend
from ..instants.solution import Peak, Solution
from ..judge.certificate import failure, summary
from ..store.runs import check_target, save
from ..study.peaks import forces, refine
from ..system.publish import check_free, check_writable, filling
from ..system.room import MOST_THREADS
from .drawing import draw_with_progress
from .options import EVEN_POINTS, even_points, parameters, rung, setting
from .options import over as by_drive
from .report import peak_line


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option(
    "--set", "settings", type=setting, metavar="NAME=VALUE", multiple=True, help="Give a parameter another value; repeatable."
)
@click.option("--t", type=even_points, metavar=EVEN_POINTS, help="Instants [s]; default: the case's.")
@by_drive
@click.option("--xi", type=even_points, metavar=EVEN_POINTS, help="Section ratios xi/l, within 0 and 1; default: the case's.")
@click.option("--want", multiple=True, metavar="OUTPUT", help="effort, reaction:JOINT, section:LINK, motion or all; repeatable.")
@rung
@click.option("--threads", type=click.IntRange(1, MOST_THREADS), metavar="N", help="Threads; default: one a core.")
@click.option("--out", type=click.Path(path_type=Path), help="The file; default: <case>.h5 here.")
@click.option("--figures", type=click.Path(path_type=Path), help="The figures' folder; default: <case>_figures here.")
@click.option("--no-figures", is_flag=True, help="Draw nothing.")
@click.option("--refine-peaks", is_flag=True, help="Seek the reported peaks between the instants too.")
@click.option("--no-certificate", is_flag=True, help="Do not check the solution.")
def run(
    case: Path,
    settings: Sequence[tuple[str, float]],
    t: EvenPoints | None,
    over: Over | None,
    xi: EvenPoints | None,
    want: Sequence[str],
    backend: Backend,
    precision: Precision,
    newton: int | None,
    table: float | None,
    flags: str,
    threads: int | None,
    out: Path | None,
    figures: Path | None,
    no_figures: bool,
    refine_peaks: bool,
    no_certificate: bool,
) -> None:
    """Evaluate CASE, a folder with a case.py or a Python file, and write an HDF5 file and figures."""
    if figures and no_figures:
        raise click.UsageError("--figures and --no-figures exclude each other")
    if out and out.suffix not in (".h5", ".hdf5"):
        raise click.UsageError(f"--out {out}: expected a name that ends in .h5 or .hdf5")
    loaded = load_case(case)
    out = out or Path(f"{loaded.name}.h5")
    folder = None if no_figures else figures or Path(f"{loaded.name}_figures")
    check_target(out)
    if folder:
        if os.path.realpath(folder) == os.path.realpath(out):
            raise click.UsageError(f"--figures {folder}: expected another place than the file's")
        check_writable(folder, folder=True)
    solution = evaluate(
        loaded.scene,
        parameters=parameters(settings),
        t=t,
        over=over,
        xi=xi,
        wanted=want or None,
        backend=backend,
        precision=precision,
        newton=newton,
        table=table,
        flags=flags,
        threads=threads,
        certificate=not no_certificate,
    )
    with filling(folder) if folder else nullcontext() as draft:
        if folder and draft:
            draw_with_progress(solution, loaded.figures, draft)
            check_free(draft, folder)
        save(solution, out, dump_specs(loaded.figures))
    _report(solution, refine(loaded.scene, solution, forces(solution)) if refine_peaks else None)
    told = np.array([[parameter["value"] for parameter in solution.description["parameters"].values()]])
    for note in (*solution.notes, turned.note(loaded.scene, loaded.scene.timing(t, over), told)):
        if note:
            click.echo(f"note: {note}")
    if not no_certificate:
        click.echo(summary(solution.certificate))
    click.echo(f"wrote {out}" + (f" and the figures in {folder}/" if folder else ""))
    if solution.failed:
        raise CertificateError(f"{failure(solution)}; {out} is marked as not certified")


def _report(solution: Solution, refined: Sequence[Peak] | None) -> None:
    backend = solution.provenance.backend
    peaks = {peak.name: peak for peak in refined or ()}
    what = "peaks" if refined is None else "peaks, refined between the instants"
    click.echo(f"{solution.case}: {solution.t.size} instants, {solution.xi.size} ratios xi/l, backend {backend}; {what}:")
    for output in solution.quantities():
        if output.group in ("effort", "reaction", "section"):
            name = str(output)
            if not solution.determined(output):
                click.echo(f"  {name:<28}{'open':>13} {'':<4} equilibrium does not determine it: the mechanism is over-constrained")
                continue
            click.echo(peak_line(solution, peaks.get(name) or solution.peak(name)))

"""``lagrange-casadi report``: a page that shows a run in a browser."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import click

from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.times import Over
from ..errors import CertificateError
from ..evaluate import evaluate
from ..instants.solution import Solution
from ..judge.certificate import failure
from ..report import ENDINGS, Live, with_motion, write_report
from ..report.instants import shown_instants
from ..store.runs import load
from ..store.untrusted import told_as
from ..system.publish import check_writable
from .options import EVEN_POINTS, even_points, parameters, separated, setting
from .options import over as by_drive

_FILES = (".h5", ".hdf5")
_UNSHOWN = "cannot be shown"


@click.command()
@click.argument("target", metavar="FILE.h5|CASE", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), metavar="REPORT.html", help="The page; default: <name>.html here.")
@click.option(
    "--set", "settings", type=setting, metavar="NAME=VALUE", multiple=True, help="Of a case: give a parameter another value."
)
@click.option("--t", type=even_points, metavar=EVEN_POINTS, help="Of a case: instants [s]; default: its own.")
@by_drive
@click.option(
    "--want",
    multiple=True,
    callback=separated,
    metavar="OUTPUT",
    help="Of a case: what is shown besides motion; default: what it wants.",
)
@click.option(
    "--live", is_flag=True, help="Of a case: put the engine into the page, with sliders for the parameters; needs ziglang."
)
def report(
    target: Path,
    out: Path | None,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    want: Sequence[str],
    live: bool,
) -> None:
    """Write a page that shows FILE.h5, or CASE evaluated, in any browser: one file, which needs no network and no Python.

    The mechanism moves, with its forces on it; charts and tables are beside it.
    """
    file = target.suffix in _FILES
    if file and (settings or t or over or want or live):
        raise click.UsageError("--set, --t, --over, --want and --live go with a case, not with a file")
    if out and out.suffix.lower() not in ENDINGS:
        raise click.UsageError(f"--out {out}: expected a name that ends in {' or '.join(ENDINGS)}")
    if file:
        out = out or Path(f"{target.stem}.html")
        check_writable(out)
        solution = load(target)
        with told_as(_UNSHOWN, target):
            write_report(solution, out)
    else:
        case = load_case(target)
        out = out or Path(f"{case.name}.html")
        check_writable(out)
        wanted = with_motion(want or case.scene.wanted)
        engine = (
            Live(case.scene, case.scene.timing(t, over), wanted, f"lagrange-casadi run {shlex.quote(case.name)}") if live else None
        )
        solution = evaluate(case.scene, parameters=parameters(settings), t=t, over=over, wanted=wanted)
        write_report(solution, out, engine)
    _tell(solution, out)


def _tell(solution: Solution, out: Path) -> None:
    """Say what was written. Raises :class:`CertificateError` where the certificate fails: the page is there, and says so."""
    shown, total = shown_instants(solution).size, solution.t.size
    if shown < total:
        click.echo(
            f"note: pictures and charts show {shown} of {total} instants, which is as many as fit; tables are of all", err=True
        )
    click.echo(f"wrote {out}: open it in a browser")
    if solution.failed:
        raise CertificateError(f"{failure(solution)}; {out} says so")

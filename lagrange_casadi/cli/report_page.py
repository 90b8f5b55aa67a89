"""``lagrange-casadi report``: a page that shows a run in a browser."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from ..base.publish import check_writable
from ..case import load_case
from ..codegen.compiler import statements
from ..declare.even_points import EvenPoints
from ..declare.times import Over
from ..errors import CertificateError, DeclarationError, LagrangeCasadiError, one_line
from ..instants.solution import Solution
from ..portable.wasm import check_zig
from ..report import ENDINGS, Live, with_motion, write_report
from ..report.instants import shown_instants
from ..report.live import run_of
from ..report.of_sweep import is_of, write_sweep_report
from ..store.runs import load
from ..store.untrusted import reported_as
from ..studies.evaluate import evaluate
from ..studies.sweep import Sweep, is_sweep
from ..studies.sweep.axes import grouped
from ..verification.certificate import failure
from .echo import echo, say_step
from .options import parameters
from .strength_lines import untold_lines

_FILES = (".h5", ".hdf5")
_UNSHOWN = "cannot be shown"


def report(
    target: Path,
    out: Path | None,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    want: Sequence[str],
    live: bool,
    case: Path | None,
) -> None:
    """See :func:`.commands.report`."""
    file = target.suffix in _FILES
    if file and (settings or t or over or want or live):
        raise click.UsageError(
            "--set, --t, --over, --want and --live go with a case, not with a file"
        )
    if out and out.suffix.lower() not in ENDINGS:
        raise click.UsageError(f"--out {out}: expected a name that ends in {' or '.join(ENDINGS)}")
    if case and not (file and is_sweep(target)):
        raise click.UsageError("--case goes with a sweep's file")
    if file:
        out = out or Path(f"{target.stem}.html")
        check_writable(out)
        if is_sweep(target):
            _of_sweep(target, out, case)
            return
        solution = load(target)
        with reported_as(_UNSHOWN, target):
            write_report(solution, out)
    else:
        loaded = load_case(target)
        scene = loaded.scene
        out = out or Path(f"{loaded.name}.html")
        check_writable(out)
        wanted = with_motion(want or scene.wanted)
        given, timing = parameters(settings), scene.timing(t, over)
        engine = None
        if live:
            say_step(2, f"deriving the equations of {loaded.name}")
            engine = Live.of(scene, timing, wanted, run_of(loaded.name), given)
            size = grouped(statements(engine.source.code))
            say_step(3, f"compiling {size} statements for this machine and for the browser at once")
        # What a page computes anew is what equilibrium tells.
        live_only = False if live else None
        solution = evaluate(
            scene, parameters=given, t=t, over=over, wanted=wanted, elastic=live_only
        )
        if live:
            say_step(4, f"writing {out}")
        write_report(solution, out, engine)
    _announce(solution, out)


def _of_sweep(target: Path, out: Path, case: Path | None) -> None:
    """Write the page of a sweep: with its mechanism in motion where its case is known, and what
    evaluates it is there.
    """
    sweep = Sweep.open(target)
    found = None
    try:
        found = load_case(case or Path(sweep.case))
        check_zig("the mechanism of a design in motion")
        scene = found.scene
        if case is None and not is_of(sweep, scene):
            raise DeclarationError(f"the case '{sweep.case}' is not as it was swept")
    except LagrangeCasadiError as error:
        if case is not None:
            raise
        echo(
            f"note: the page has no mechanism in motion: {one_line(error)}; --case CASE names"
            " another case",
            err=True,
        )
        found = scene = None
    with reported_as(_UNSHOWN, target):
        write_sweep_report(sweep, out, scene, run_of(found.name if found else sweep.case))
    echo(f"wrote {out}: open it in a browser")


def _announce(solution: Solution, out: Path) -> None:
    """Say what was written.

    Raises :class:`CertificateError` where the certificate fails: the page is there, and says so.
    """
    shown, total = shown_instants(solution).size, solution.t.size
    if shown < total:
        echo(
            f"note: pictures and charts show {shown} of {total} instants, which is as many as fit;"
            " tables are of all",
            err=True,
        )
    for line in untold_lines(solution):
        echo(line, err=True)
    echo(f"wrote {out}: open it in a browser")
    if solution.failed:
        raise CertificateError(f"{failure(solution)}; {out} says so")

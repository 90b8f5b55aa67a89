"""Pages of runs, cases, two of them, and sweeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from ..base.files import check_writable
from ..engine.codegen.compiler import statements
from ..errors import DeclarationError, LagrangeCasadiError, one_line
from ..interop.portable.wasm import check_zig
from ..results.solution import Solution
from ..results.store.runs import load
from ..results.store.untrusted import reported_as
from ..results.verification.certificate import refuse_failed
from ..studies.case import load_case, reference
from ..studies.evaluate import evaluate
from ..studies.sweep import Sweep, is_sweep
from ..studies.sweep.axes import grouped
from ..views.report import ENDINGS, Live, with_motion, write_comparison, write_report
from ..views.report.comparison import same_runs
from ..views.report.instants import shown_instants
from ..views.report.live import run_of
from ..views.report.of_sweep import is_of, write_sweep_report
from .echo import echo, say_step
from .options import HDF5, refuse
from .strength_lines import not_evaluated_lines

_UNSHOWN = "cannot be shown"


def write(
    targets: Sequence[Path],
    out: Path | None,
    beside: Mapping[str, float | str],
    case: Path | None,
    live: bool,
    **given: Any,
) -> None:
    """See :func:`.page.report`."""
    target, *others = targets
    file = target.suffix in HDF5
    refuse(
        (
            (live or any(given.values())) and all(one.suffix in HDF5 for one in targets),
            "--set, --t, --over, --want and --live go with a case, not with a file",
        ),
        (
            out and out.suffix.lower() not in ENDINGS,
            f"--out {out}: expected a name that ends in {' or '.join(ENDINGS)}",
        ),
        (
            case and (others or not (file and is_sweep(target))),
            "--case goes with a sweep's file",
        ),
        (len(others) > 1, "expected one or two of FILE.h5 and CASE"),
        (live and (others or beside), "--live goes with one case, and not with --beside"),
        (beside and (others or file), "--beside goes with one case"),
    )
    if others or beside:
        _of_two(targets, out, beside, given)
        return
    loaded = None if file else load_case(target)
    out = out or Path(f"{loaded.name if loaded else target.stem}.html")
    check_writable(out)
    if loaded is None and is_sweep(target):
        _of_sweep(target, out, case)
        return
    if loaded is None:
        solution = load(target)
        with reported_as(_UNSHOWN, target):
            write_report(solution, out)
    else:
        scene = loaded.scene
        given["wanted"] = with_motion(given["wanted"] or scene.wanted)
        engine = None
        if live:
            timing = scene.timing(given["t"], given["over"])
            say_step(2, f"deriving the equations of {loaded.name}")
            run = run_of(reference(loaded, Path()))
            engine = Live.of(scene, timing, given["wanted"], run, given["parameters"])
            size = grouped(statements(engine.source.code))
            say_step(3, f"compiling {size} statements for this machine and for the browser at once")
        # What a live page computes anew is what equilibrium determines.
        solution = evaluate(scene, elastic=False if live else None, **given)
        if live:
            say_step(4, f"writing {out}")
        write_report(solution, out, engine)
    shown, total = shown_instants(solution).size, solution.t.size
    if shown < total:
        echo(
            f"note: pictures and charts show {shown} of {total} instants, which is as many as fit;"
            " tables are of all",
            err=True,
        )
    _announce(out, solution)


def _of_two(
    targets: Sequence[Path],
    out: Path | None,
    beside: Mapping[str, float | str],
    options: Mapping[str, Any],
) -> None:
    """Write the page of two runs, or of a case and the design ``beside`` it."""
    first, *others = targets
    name = "_and_".join(one.stem for one in targets) if others else f"{first.stem}_beside"
    out = out or Path(f"{name}.html")
    check_writable(out)
    solutions: list[Solution] = []
    for target, more in zip((first, *(others or (first,))), ({}, beside), strict=True):
        if target.suffix not in HDF5:
            scene = load_case(target).scene
            given = {
                **options,
                "wanted": with_motion(options["wanted"] or scene.wanted),
                "parameters": {**options["parameters"], **more},
            }
            solutions.append(evaluate(scene, **given))
        elif is_sweep(target):
            raise click.UsageError(f"{target} is a sweep: its page cannot be combined with another")
        else:
            solutions.append(load(target))
    names = [[target.stem for target in targets], [str(target) for target in targets]]
    apart = next((words for words in names if len(set(words)) == 2), ())
    with reported_as(_UNSHOWN, first):
        write_comparison(solutions, out, apart)
    if same_runs(*solutions):
        echo("note: both runs are the same: all their values are equal", err=True)
    _announce(out, *solutions)


def _of_sweep(target: Path, out: Path, case: Path | None) -> None:
    """Write the page of a sweep: with its mechanism in motion where its case is known, and what
    evaluates it is there.
    """
    sweep = Sweep.open(target)
    found = None
    try:
        found = load_case(case or sweep.case_file or Path(sweep.case))
        check_zig("the mechanism of a design in motion")
        scene = found.scene
        if case is None and not is_of(sweep, scene):
            raise DeclarationError(
                f"the case '{reference(found, Path())}' has changed since the sweep"
            )
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
        write_sweep_report(
            sweep, out, scene, run_of(reference(found, Path()) if found else sweep.case)
        )
    echo(f"wrote {out}: open it in a browser")


def _announce(out: Path, *solutions: Solution) -> None:
    """Say what was written, and what it lacks.

    Raises :class:`CertificateError` where a certificate fails: the page is there, and says so.
    """
    echo(*(line for one in solutions for line in not_evaluated_lines(one)), err=True)
    echo(f"wrote {out}: open it in a browser")
    for solution in solutions:
        refuse_failed(solution, f"{out} says so")

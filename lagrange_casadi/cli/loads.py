"""``lagrange-casadi loads``: load cases of links, for programs of finite elements, and spectra."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from ..base.publish import check_writable
from ..base.vocabulary import LOAD_FORMATS
from ..case import load_case
from ..load_cases import (
    bearing_loads,
    link_load_cases,
    write_bearing_loads,
    write_load_cases,
    write_spectrum,
)
from ..studies.evaluate import evaluate
from ..verification.certificate import certified_outputs, refuse_failed, summary
from .echo import echo


def loads(
    case: Path,
    links: Sequence[str],
    out: Path,
    every: bool,
    formats: Sequence[str],
    nodes: Mapping[str, str],
    spectra: Sequence[str],
    classes: int,
    bearings: Sequence[str],
    exponent: float,
    **given: Any,
) -> None:
    """See :func:`.commands.loads`."""
    if not (links or spectra or bearings):
        raise click.UsageError("expected --link, --spectrum or --bearing")
    check_writable(out, folder=True)
    scene, chosen = load_case(case).scene, tuple(dict.fromkeys(links))
    inside = {*chosen, *(re.split("[:@]", f"{name}:")[1] for name in spectra)}
    wanted = certified_outputs(scene.outputs)
    wanted += (name for name in scene.outputs if name in {f"section:{link}" for link in inside})
    solution = evaluate(scene, wanted=wanted, **given)
    refuse_failed(solution)
    instants = solution.t.tolist() if every else None
    cases = [case for link in chosen for case in link_load_cases(solution, link, instants, scene)]
    for one in cases:
        governs = f": {', '.join(one.governs)}" if one.governs else ""
        echo(f"{one.link} at t = {one.t:.6g} s, residual {max(one.residual):.1e}{governs}")
    if cases:
        beams = all(case.rod is not None for case in cases)
        known = [name for name in LOAD_FORMATS if beams or name != "beam"]
        files = write_load_cases(cases, out, formats or known, nodes)
        echo(f"wrote {out}: {len(cases)} load cases in {len(files)} files")
    out.mkdir(parents=True, exist_ok=True)
    for name in spectra:
        file = out / f"{re.sub('[^A-Za-z0-9_.-]', '_', name)}.csv"
        write_spectrum(solution, name, file, classes=classes)
        echo(f"wrote {file}")
    if bearings:
        file = out / "bearings.csv"
        write_bearing_loads([bearing_loads(solution, one, exponent) for one in bearings], file)
        echo(f"wrote {file}")
    echo(summary(solution.certificate))

"""``lagrange-casadi loads``: load cases of links, for programs of finite elements, and spectra."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any

import click

from ..base.files import check_writable
from ..base.table_file import TableFile
from ..base.vocabulary import LOAD_FORMATS
from ..errors import DeclarationError
from ..interop.load_cases import LoadCase, link_load_cases, write_load_cases, write_spectrum
from ..interop.load_cases.beam_model import modelled
from ..results.strength.bearings import bearing_loads
from ..results.verification.certificate import certified_outputs, refuse_failed, summary
from ..studies.case import load_case
from ..studies.evaluate import evaluate
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
        files = write_load_cases(cases, out, formats or _formats(cases), nodes)
        echo(f"wrote {out}: {len(cases)} load cases in {len(files)} files")
    out.mkdir(parents=True, exist_ok=True)
    for name in spectra:
        file = out / f"{re.sub('[^A-Za-z0-9_.-]', '_', name)}.csv"
        write_spectrum(solution, name, file, classes=classes)
        echo(f"wrote {file}")
    if bearings:
        file, each = out / "bearings.csv", ("radial [N]", "axial [N]", "speed [1/min]")
        heads = ["joint", *each, *(f"largest {name}" for name in each)]
        rows = [astuple(bearing_loads(solution, one, exponent)) for one in bearings]
        TableFile(file).write(heads, rows)
        echo(f"wrote {file}")
    echo(summary(solution.certificate))


def _formats(cases: Sequence[LoadCase]) -> list[str]:
    """Return all formats that the links have; say why there is no model of a beam."""
    others = [name for name in LOAD_FORMATS if name != "beam"]
    if any(case.rod is None for case in cases):
        return others
    try:
        for case in cases:
            modelled(case)
    except DeclarationError as error:
        echo(f"format beam is left out: {error}")
        return others
    return [*LOAD_FORMATS]

"""``lagrange-casadi loads``: load cases of links, for programs of finite elements, and spectra."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

import click

from ..base.publish import check_writable
from ..base.table_file import TableFile
from ..base.vocabulary import LOAD_FORMATS
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.scene import kinds
from ..declare.times import Over
from ..errors import CertificateError, DeclarationError
from ..load_cases import LoadCase, link_load_cases, write_load_cases, write_spectrum
from ..load_cases.beam_model import modelled
from ..strength.bearings import bearing_loads
from ..studies.evaluate import evaluate
from ..verification.certificate import failure, summary
from .echo import echo
from .options import parameters

_FORCES = ("reaction", "multiplier", "load", "friction")


def loads_command(
    case: Path,
    links: Sequence[str],
    out: Path,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    every: bool,
    formats: Sequence[str],
    nodes: Sequence[tuple[str, str]],
    spectra: Sequence[str],
    classes: int,
    bearings: Sequence[str],
    exponent: float,
) -> None:
    """See :func:`.commands.loads`."""
    if not (links or spectra or bearings):
        raise click.UsageError("expected --link, --spectrum or --bearing")
    check_writable(out, folder=True)
    scene, chosen = load_case(case).scene, tuple(dict.fromkeys(links))
    inside = {*chosen, *(re.split("[:@]", f"{name}:")[1] for name in spectra)}
    wanted = ["effort", "motion", *(kind for kind in kinds(scene.outputs) if kind in _FORCES)]
    wanted += (name for name in scene.outputs if name in {f"section:{link}" for link in inside})
    solution = evaluate(scene, parameters=parameters(settings), t=t, over=over, wanted=wanted)
    if solution.failed:
        raise CertificateError(failure(solution))
    instants = solution.t.tolist() if every else None
    cases = [case for link in chosen for case in link_load_cases(solution, link, instants, scene)]
    for one in cases:
        governs = f": {', '.join(one.governs)}" if one.governs else ""
        echo(f"{one.link} at t = {one.t:.6g} s, residual {max(one.residual):.1e}{governs}")
    if cases:
        files = write_load_cases(cases, out, formats or _formats(cases), dict(nodes))
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

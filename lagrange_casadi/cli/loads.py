"""``lagrange-casadi loads``: load cases of links, for programs of finite elements, and spectra."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any, get_args

from ..base.files import check_writable
from ..base.table_writers import TableFile
from ..base.vocabulary import LoadFormat
from ..errors import DeclarationError
from ..interop.load_cases import LoadCase, link_load_cases, write_load_cases, write_spectrum
from ..interop.load_cases.beam_model import modelled
from ..results.strength.bearing_life import bearing_loads
from ..results.verification.certificate import certified_outputs, refuse_failed, summary
from ..studies.case import load_case
from ..studies.evaluate import evaluate
from .echo import echo
from .options import refuse


def loads(
    case: Path,
    *,
    links: Sequence[str] = (),
    out: Path,
    every: bool = False,
    formats: Sequence[LoadFormat] = (),
    nodes: Mapping[str, str] = {},
    spectra: Sequence[str] = (),
    classes: int = 64,
    bearings: Sequence[str] = (),
    exponent: float = 3.0,
    **given: Any,
) -> None:
    """Write loads on links of CASE for finite elements, and load spectra.

    Each load case has the forces and moments on the link, its acceleration and gravity, on the
    link's own axes. These are in equilibrium.

    Parameters
    ----------
    case : CASE
    links : NAME
        Write the load cases of this link, rigid body or point mass.
    out : DIR
        Write into this folder.
    parameters, t, over
        As of :func:`.studies.evaluate.evaluate`.
    every
        Write a load case for every instant; default: for those at which a section force or a
        stress of the link, or a reaction on it, is largest.
    formats
        Write this format. inp is included by input files of CalculiX and Abaqus; beam is a model
        that CalculiX runs. Default: all.
    nodes : JOINT=NAME
        Name the node set, or the number, of the node in your mesh that takes a joint's load;
        LINK=NAME names the element set.
    spectra : NAME
        Write the rainflow matrix of a quantity, as reaction:A:fx, section:rod:bending@0.5 or
        stress:rod@0.5.
    classes : CLASSES
        Set the classes of --spectrum, 0 for every cycle as it is.
    bearings : JOINT
        Write equivalent loads and the speed of this joint for catalogues of bearings.
    exponent : P
        Set the exponent of --bearing: 3 for balls, 10/3 for rollers.
    """
    refuse((not (links or spectra or bearings), "expected --link, --spectrum or --bearing"))
    check_writable(out, folder=True)
    scene, chosen = load_case(case).scene, tuple(dict.fromkeys(links))
    inside = {*chosen, *(re.split("[:@]", f"{name}:")[1] for name in spectra)}
    wanted = [
        *certified_outputs(scene.outputs),
        *(name for name in scene.outputs if name in {f"section:{link}" for link in inside}),
    ]
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


def _formats(cases: Sequence[LoadCase]) -> Sequence[LoadFormat]:
    """Return all formats that the links have; say why there is no model of a beam."""
    others = [name for name in get_args(LoadFormat) if name != "beam"]
    if any(case.rod is None for case in cases):
        return others
    try:
        for case in cases:
            modelled(case)
    except DeclarationError as error:
        echo(f"format beam is left out: {error}")
        return others
    return get_args(LoadFormat)

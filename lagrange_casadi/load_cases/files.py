"""Load cases as files: JSON, CSV, and text that an input file of CalculiX or Abaqus includes."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from ..arguments import public
from ..base.publish import filling
from ..base.vocabulary import LOAD_FORMATS
from ..declare.stated import Triple
from ..errors import UnknownNameError
from .equilibrium import LoadCase

_SAME = 1e-9
"""Distance of two places [m] that are one node."""

_UNITS = {
    "t": "s",
    "at": "m",
    "force": "N",
    "moment": "N m",
    "acceleration": "m/s^2",
    "omega": "rad/s",
    "alpha": "rad/s^2",
    "gravity": "m/s^2",
    "mass": "kg",
    "centre": "m",
    "inertia": "kg m^2",
    "residual": "1",
}


@public
def write_load_cases(
    cases: Sequence[LoadCase], folder: str | os.PathLike[str], formats: Sequence[str] = ("json",)
) -> tuple[str, ...]:
    """Write load cases of one or several links.

    Parameters
    ----------
    cases
        The load cases.
    folder
        The folder; files of other names in it stay.
    formats
        Of ``json``, ``csv``, ``inp``.

    Returns
    -------
    tuple of str
        Names of the files: LINK.json, LINK.csv and LINK.inertia.csv, LINK_1.inp, LINK_2.inp, ...

    Raises
    ------
    UnknownNameError
        For another format.
    PathError
        If the folder cannot be written.
    """
    if unknown := [name for name in formats if name not in LOAD_FORMATS]:
        raise UnknownNameError("format", unknown, LOAD_FORMATS)
    links = dict.fromkeys(case.link for case in cases)
    written = []
    with filling(Path(folder)) as draft:
        for link in links:
            chosen = [case for case in cases if case.link == link]
            for name in dict.fromkeys(formats):
                for file, text in _WRITERS[name](chosen):
                    (draft / file).write_text(text, encoding="utf-8", newline="\n")
                    written.append(file)
    return tuple(written)


def _json(cases: Sequence[LoadCase]) -> Iterator[tuple[str, str]]:
    """Yield one file with all load cases of a link."""
    content = {
        "link": cases[0].link,
        "axes": "of the link, from its origin",
        "units": _UNITS,
        "cases": [asdict(case) for case in cases],
    }
    yield f"{cases[0].link}.json", json.dumps(content, indent=1) + "\n"


def _csv(cases: Sequence[LoadCase]) -> Iterator[tuple[str, str]]:
    """Yield a file of loads, and one of inertia, with a row for each."""
    heads = [("at", "{}"), ("force", "f{}"), ("moment", "m{}")]
    loads: list[list[object]] = [["case", "t [s]", "name", *_columns(heads)]]
    heads = [("acceleration", "a{}"), ("omega", "omega_{}"), ("alpha", "alpha_{}")]
    heads += [("gravity", "g{}"), ("centre", "centre_{}")]
    fields: list[list[object]] = [
        [
            *("case", "t [s]", "governs", *_columns(heads), "mass [kg]"),
            *("residual of forces [1]", "residual of moments [1]"),
        ]
    ]
    for number, case in enumerate(cases, 1):
        for load in case.loads:
            loads.append([number, case.t, load.name, *load.at, *load.force, *load.moment])
        vectors = (case.acceleration, case.omega, case.alpha, case.gravity, case.centre)
        row = [x for vector in vectors for x in vector]
        fields.append([number, case.t, " ".join(case.governs), *row, case.mass, *case.residual])
    for name, rows in (("", loads), (".inertia", fields)):
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        yield f"{cases[0].link}{name}.csv", text.getvalue()


def _columns(heads: Sequence[tuple[str, str]]) -> list[str]:
    return [f"{name.format(x)} [{_UNITS[field]}]" for field, name in heads for x in "xyz"]


def _inp(cases: Sequence[LoadCase]) -> Iterator[tuple[str, str]]:
    """Yield a file for each load case, to be included in a step."""
    for number, case in enumerate(cases, 1):
        name = f"{case.link}_{number}.inp"
        yield name, "\n".join(_inp_lines(case, name)) + "\n"


def _inp_lines(case: LoadCase, file: str) -> Iterator[str]:
    yield f"** {case.link} at t = {case.t:.9g} s: {', '.join(case.governs) or 'as asked'}"
    yield "** SI units, on the axes of the link, from its origin. Within a step:"
    yield f"** *INCLUDE, INPUT={file}"
    yield f"** Element set {case.link}: mass {case.mass:.9g} kg, centre {_listed(case.centre)} m"
    yield "** Node sets, each of the one node that takes a joint's load:"
    nodes = _nodes(case)
    for name, (at, _, _) in nodes.items():
        yield f"**   {name} at {_listed(at)} m"
    yield "** Moments are on degrees of freedom 4 to 6 of that node. Of a *RIGID BODY of CalculiX"
    yield "** they are on 1 to 3 of its ROT NODE."
    yield "*CLOAD"
    for name, (_, force, moment) in nodes.items():
        for k, value in enumerate((*force, *moment), 1):
            if value != 0.0:
                yield f"{name}, {k}, {value:.12g}"
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    size, spin = math.hypot(*weight), math.hypot(*case.omega)
    if size or spin:
        yield "*DLOAD"
    if size:
        yield "** gravity less the acceleration of the origin"
        yield f"{case.link}, GRAV, {size:.12g}, {_listed([x / size for x in weight])}"
    if spin:
        yield "** square of the angular velocity, a point of its axis, its direction"
        axis = [x / spin for x in case.omega]
        yield f"{case.link}, CENTRIF, {spin**2:.12g}, 0., 0., 0., {_listed(axis)}"
    if any(case.alpha):
        yield f"** Angular acceleration [rad/s^2]: {_listed(case.alpha)}"
        yield "** CalculiX has no load for it: add the force -m (alpha x r) on the mass m of each"
        yield "** node at r. Without it the loads are not in equilibrium."


def _nodes(case: LoadCase) -> dict[str, tuple[Triple, Triple, Triple]]:
    """Return places by names of node sets, each with the sum of its forces and moments: two loads
    at one place are one node's.
    """
    found: dict[str, tuple[Triple, Triple, Triple]] = {}
    for load in case.loads:
        for name, (at, force, moment) in found.items():
            if math.dist(at, load.at) <= _SAME:
                found[name] = (at, _sum(force, load.force), _sum(moment, load.moment))
                break
        else:
            name = load.name.partition(":")[2].replace(":", "_")
            while name.upper() in {other.upper() for other in found}:
                name += "_"
            found[name] = (load.at, load.force, load.moment)
    return found


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(f"{x:.12g}" for x in numbers)


_WRITERS: dict[str, Callable[[Sequence[LoadCase]], Iterator[tuple[str, str]]]] = dict(
    zip(LOAD_FORMATS, (_json, _csv, _inp), strict=True)
)
"""Names and texts of the files of a link, by format."""

"""Load cases as files: JSON, CSV, and input of programs of finite elements."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from ..arguments import public
from ..base.publish import filling
from ..base.vocabulary import LOAD_FORMATS
from ..errors import DeclarationError, UnknownNameError
from .beam_model import beam_model
from .loads import LoadCase, nodes_of
from .solver_text import calculix, nastran

_NASTRAN = 10
"""Numbers of Nastran's load sets of a load case."""

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
    cases: Sequence[LoadCase],
    folder: str | os.PathLike[str],
    formats: Sequence[str] = ("json",),
    nodes: Mapping[str, str] | None = None,
) -> tuple[str, ...]:
    """Write load cases of one or several links.

    Parameters
    ----------
    cases
        The load cases.
    folder
        The folder; files of other names in it stay.
    formats
        Of ``json``, ``csv``; ``inp`` and ``nas``, which input files of CalculiX or Abaqus, and of
        Nastran include; ``beam``, for a link with a beam an input file of CalculiX that runs.
    nodes
        Names of node sets or numbers of nodes in your mesh, by names of joints and loads; by the
        name of a link that of its element set. Default: these names themselves, and for Nastran
        1, 2, ...

    Returns
    -------
    tuple of str
        Names of the files: LINK.json, LINK.csv and LINK.inertia.csv, and for each load case
        LINK_1.inp, LINK_1.nas, LINK_1.beam.inp, ...

    Raises
    ------
    UnknownNameError
        For another format, and for ``nodes`` of a part that loads no link.
    DeclarationError
        For ``beam`` of a link without one, or whose material has no moduli.
    PathError
        If the folder cannot be written.
    """
    if unknown := [name for name in formats if name not in LOAD_FORMATS]:
        raise UnknownNameError("format", unknown, LOAD_FORMATS)
    links, chosen = dict.fromkeys(case.link for case in cases), dict(nodes or {})
    loaded = {name: None for case in cases for name in (*nodes_of(case), case.link)}
    if unknown := [name for name in chosen if name not in loaded]:
        raise UnknownNameError("load", unknown, loaded)
    written = []
    with filling(Path(folder)) as draft:
        for link in links:
            own = [case for case in cases if case.link == link]
            for name in dict.fromkeys(formats):
                for file, text in _files(name, own, chosen):
                    (draft / file).write_text(text, encoding="utf-8", newline="\n")
                    written.append(file)
    return tuple(written)


def _files(
    name: str, cases: Sequence[LoadCase], nodes: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Yield names and texts of the files of a link in a format."""
    if name in ("json", "csv"):
        yield from _json(cases) if name == "json" else _csv(cases)
        return
    for number, case in enumerate(cases, 1):
        file = f"{case.link}_{number}.{'beam.inp' if name == 'beam' else name}"
        if name == "inp":
            lines = calculix(case, file, nodes)
        elif name == "nas":
            lines = nastran(case, _NASTRAN * number, nodes)
        elif case.rod is None:
            raise DeclarationError(
                f"load cases of link '{case.link}': format 'beam' needs a link with a beam"
            )
        else:
            lines = beam_model(case, case.rod, nodes)
        yield file, "\n".join(lines) + "\n"


def _json(cases: Sequence[LoadCase]) -> Iterator[tuple[str, str]]:
    """Yield one file with all load cases of a link."""
    content = {
        "link": cases[0].link,
        "axes": "of the link, from its origin",
        "units": _UNITS,
        "cases": [_numbers(case) for case in cases],
    }
    yield f"{cases[0].link}.json", json.dumps(content, indent=1) + "\n"


def _numbers(case: LoadCase) -> dict[str, object]:
    found = asdict(replace(case, rod=None))
    del found["rod"]
    return found


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

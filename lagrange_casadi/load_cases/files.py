"""Load cases as files: JSON, CSV, and input of programs of finite elements."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from ..arguments import public
from ..base.csv_rows import csv_text
from ..base.publish import filling
from ..base.vocabulary import LOAD_FORMATS
from ..errors import UnknownNameError
from .beam_model import beam_model
from .loads import LoadCase, node_sets
from .solver_text import calculix, nastran

_SOLVERS = {
    "inp": (calculix, "inp"),
    "nas": (nastran, "nas"),
    "beam": (beam_model, "beam.inp"),
}
"""Writers of a file for one load case, and endings of its name, by format."""

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
    loaded = dict.fromkeys(
        name
        for case in cases
        for name in (*(node.name for _, node in node_sets(case, {})), case.link)
    )
    if unknown := [name for name in chosen if name not in loaded]:
        raise UnknownNameError("load", unknown, loaded)
    files: dict[str, str] = {}
    for link in links:
        own = [case for case in cases if case.link == link]
        for name in dict.fromkeys(formats):
            files |= _files(name, own, chosen)
    with filling(Path(folder)) as draft:
        for file, text in files.items():
            (draft / file).write_text(text, encoding="utf-8", newline="\n")
    return tuple(files)


def _files(name: str, cases: Sequence[LoadCase], nodes: Mapping[str, str]) -> dict[str, str]:
    """Return the texts of the files of a link in a format, by their names."""
    link = cases[0].link
    if name == "json":
        return {f"{link}.json": _json(link, cases)}
    if name == "csv":
        return {f"{link}.csv": _csv_of_loads(cases), f"{link}.inertia.csv": _csv_of_inertia(cases)}
    lines, ending = _SOLVERS[name]
    return {
        f"{link}_{number}.{ending}": "\n".join(lines(case, number, nodes)) + "\n"
        for number, case in enumerate(cases, 1)
    }


def _json(link: str, cases: Sequence[LoadCase]) -> str:
    every = [asdict(replace(case, rod=None)) for case in cases]
    for numbers in every:
        del numbers["rod"]
    content = {"link": link, "axes": "of the link, from its origin", "units": _UNITS}
    return json.dumps({**content, "cases": every}, indent=1) + "\n"


def _csv_of_loads(cases: Sequence[LoadCase]) -> str:
    heads = ["case", "t [s]", "name", *_columns(at="{}", force="f{}", moment="m{}")]
    rows = (
        [number, case.t, load.name, *load.at, *load.force, *load.moment]
        for number, case in enumerate(cases, 1)
        for load in case.loads
    )
    return csv_text([heads, *rows])


def _csv_of_inertia(cases: Sequence[LoadCase]) -> str:
    heads = _columns(
        acceleration="a{}", omega="omega_{}", alpha="alpha_{}", gravity="g{}", centre="centre_{}"
    )
    last = ["mass [kg]", "residual of forces [1]", "residual of moments [1]"]
    rows: list[list[object]] = [["case", "t [s]", "governs", *heads, *last]]
    for number, case in enumerate(cases, 1):
        vectors = (case.acceleration, case.omega, case.alpha, case.gravity, case.centre)
        numbers = itertools.chain(*vectors, [case.mass], case.residual)
        rows.append([number, case.t, " ".join(case.governs), *numbers])
    return csv_text(rows)


def _columns(**names: str) -> list[str]:
    """Return heads of the columns of vectors."""
    return [f"{name.format(x)} [{_UNITS[field]}]" for field, name in names.items() for x in "xyz"]

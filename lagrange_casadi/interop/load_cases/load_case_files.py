"""Load cases as files: JSON, CSV, and input of programs of finite elements."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import get_args

import numpy as np

from ...base.arguments import public
from ...base.folders import filling
from ...base.table_writers import csv_text
from ...base.vocabulary import LoadFormat
from ...errors import DeclarationError, check_known, shown
from .beam_model import beam_model
from .calculix import calculix
from .load_case import Load, LoadCase, nodes_of

_NAME = re.compile(r"[^\s,*][^\r\n,]*")
"""Names of nodes in input files: no comma, and no beginning of a keyword or a comment."""

_SOLVERS = {"inp": ("inp", calculix), "beam": ("beam.inp", beam_model)}
"""Endings of files of one load case, and their texts, by format."""

_FIELDS = {
    "t": ("s", "t"),
    "at": ("m", "x, y, z"),
    "force": ("N", "fx, fy, fz"),
    "moment": ("N m", "mx, my, mz"),
    "acceleration": ("m/s^2", "ax, ay, az"),
    "omega": ("rad/s", "omega_x, omega_y, omega_z"),
    "alpha": ("rad/s^2", "alpha_x, alpha_y, alpha_z"),
    "gravity": ("m/s^2", "gx, gy, gz"),
    "mass": ("kg", "mass"),
    "centre": ("m", "centre_x, centre_y, centre_z"),
    "inertia": ("kg m^2", ""),
    "residual": ("1", "residual of forces, residual of moments"),
}
"""Units of the fields of loads and load cases, and heads of their columns."""

_LOAD = ("at", "force", "moment")
_INERTIA = ("acceleration", "omega", "alpha", "gravity", "centre", "mass", "residual")


@public
def write_load_cases(
    cases: Sequence[LoadCase],
    folder: str | os.PathLike[str],
    formats: Sequence[str] = ("json",),
    nodes: Mapping[str, str | int] | None = None,
) -> tuple[str, ...]:
    """Write load cases of one or several links.

    Parameters
    ----------
    cases
        The load cases.
    folder
        The folder; files of other names in it stay.
    formats
        Of ``json``, ``csv``; ``inp``, which input files of CalculiX or Abaqus include; ``beam``,
        for a link with a beam an input file of CalculiX that runs.
    nodes
        Names of node sets or numbers of nodes in your mesh, by names of joints and loads; by the
        name of a link that of its element set. Default: these names themselves.

    Returns
    -------
    tuple of str
        Names of the files: LINK.json, LINK.csv and LINK.inertia.csv, and for each load case
        LINK_1.inp, LINK_1.beam.inp, ...

    Raises
    ------
    UnknownNameError
        For another format, and for ``nodes`` of a part that loads no link.
    DeclarationError
        For ``beam`` of a link without one, or whose material has no moduli; for one node at several
        places, and for what cannot name one.
    PathError
        If the folder cannot be written.
    """
    check_known("format", formats, get_args(LoadFormat))
    links = dict.fromkeys(case.link for case in cases)
    chosen = {name: str(node) for name, node in (nodes or {}).items()}
    loads = (node.name for case in cases for node in nodes_of(case, {}))
    loaded = dict.fromkeys([*loads, *links])
    check_known("load", chosen, loaded)
    if wrong := [node for node in chosen.values() if not _NAME.fullmatch(node)]:
        raise DeclarationError(f"nodes: expected names or numbers of nodes, got {shown(wrong[0])}")
    files = {
        f"{link}{ending}": text
        for link in links
        for name in formats
        for ending, text in _texts(name, [case for case in cases if case.link == link], chosen)
    }
    with filling(Path(folder)) as draft:
        for file, text in files.items():
            (draft / file).write_text(text, encoding="utf-8", newline="\n")
    return tuple(files)


def _texts(
    name: str, cases: Sequence[LoadCase], nodes: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Yield files of a link's load cases in a format: endings of their names, and texts."""
    if name == "json":
        units = {field: unit for field, (unit, _) in _FIELDS.items()}
        content = {"link": cases[0].link, "axes": "of the link, from its origin", "units": units}
        every = [{name: x for name, x in vars(case).items() if name != "rod"} for case in cases]
        yield ".json", json.dumps({**content, "cases": every}, indent=1, default=vars) + "\n"
    elif name == "csv":
        yield ".csv", _csv(cases, "name", _LOAD, lambda case: [(x.name, x) for x in case.loads])
        governs = _csv(cases, "governs", _INERTIA, lambda case: [(" ".join(case.governs), case)])
        yield ".inertia.csv", governs
    else:
        ending, text = _SOLVERS[name]
        for number, case in enumerate(cases, 1):
            yield f"_{number}.{ending}", text(case, number, nodes)


def _csv(
    cases: Sequence[LoadCase],
    head: str,
    fields: Sequence[str],
    parts: Callable[[LoadCase], Iterable[tuple[str, Load | LoadCase]]],
) -> str:
    """Return a table of fields, a row for each of the named parts of a load case."""
    units = (_FIELDS[field] for field in fields)
    columns = [f"{name} [{unit}]" for unit, names in units for name in names.split(", ")]
    rows = (
        [number, case.t, name, *np.hstack([getattr(part, field) for field in fields]).tolist()]
        for number, case in enumerate(cases, 1)
        for name, part in parts(case)
    )
    return csv_text([["case", "t [s]", head, *columns], *rows])

"""Load cases as files: JSON, CSV, and input of programs of finite elements."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..arguments import public
from ..base.csv_rows import csv_text
from ..base.publish import filling
from ..base.vocabulary import LOAD_FORMATS
from ..errors import UnknownNameError
from .beam_model import beam_model
from .loads import Load, LoadCase, node_sets
from .solver_text import calculix, nastran

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
    chosen, by_link, loaded = dict(nodes or {}), dict[str, list[LoadCase]](), dict[str, None]()
    for case in cases:
        by_link.setdefault(case.link, []).append(case)
        loaded |= dict.fromkeys([*(node.name for node in node_sets(case, {}).values()), case.link])
    if unknown := [name for name in chosen if name not in loaded]:
        raise UnknownNameError("load", unknown, loaded)
    files: dict[str, str] = {}
    for link, own in by_link.items():
        for name in formats:
            if name in _OF_LINK:
                files |= {f"{link}.{end}": text(own) for end, text in _OF_LINK[name].items()}
            else:
                end, lines = _OF_CASE[name]
                for number, case in enumerate(own, 1):
                    text = "\n".join(lines(case, number, chosen))
                    files[f"{link}_{number}.{end}"] = f"{text}\n"
    with filling(Path(folder)) as draft:
        for file, text in files.items():
            (draft / file).write_text(text, encoding="utf-8", newline="\n")
    return tuple(files)


def _json(cases: Sequence[LoadCase]) -> str:
    units = {field: unit for field, (unit, _) in _FIELDS.items()}
    content = {"link": cases[0].link, "axes": "of the link, from its origin", "units": units}
    every = [{name: x for name, x in vars(case).items() if name != "rod"} for case in cases]
    return json.dumps({**content, "cases": every}, indent=1, default=vars) + "\n"


def _csv_of_loads(cases: Sequence[LoadCase]) -> str:
    each = enumerate(cases, 1)
    return _csv("name", _LOAD, ((k, one, load.name, load) for k, one in each for load in one.loads))


def _csv_of_inertia(cases: Sequence[LoadCase]) -> str:
    each = enumerate(cases, 1)
    return _csv("governs", _INERTIA, ((k, one, " ".join(one.governs), one) for k, one in each))


def _csv(
    head: str,
    fields: Sequence[str],
    parts: Iterable[tuple[int, LoadCase, str, Load | LoadCase]],
) -> str:
    """Return a table of fields, a row for each part of a load case that has a number and a name."""
    units = (_FIELDS[field] for field in fields)
    columns = [f"{name} [{unit}]" for unit, names in units for name in names.split(", ")]
    rows = (
        [number, case.t, name, *np.hstack([getattr(part, field) for field in fields]).tolist()]
        for number, case, name, part in parts
    )
    return csv_text([["case", "t [s]", head, *columns], *rows])


_OF_LINK = {"json": {"json": _json}, "csv": {"csv": _csv_of_loads, "inertia.csv": _csv_of_inertia}}
"""Texts of all load cases of a link, by format and by ending of the file's name."""

_OF_CASE = {
    "inp": ("inp", calculix),
    "nas": ("nas", nastran),
    "beam": ("beam.inp", beam_model),
}
"""Endings of files of one load case, and their lines, by format."""

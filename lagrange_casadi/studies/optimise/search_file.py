"""The file of a search: HDF5, sealed like all files of the package."""

from __future__ import annotations

import os
from collections.abc import Iterator

import h5py
import numpy as np
import numpy.typing as npt

from ...results.store.opening import SEARCH, opened_file, read_all, sealed_file
from ...results.store.untrusted import check_dataset, shown
from .front import Front
from .optimum import Optimum
from .search_run import CONVERGED

_COLUMNS = ("start", "objective", "excess", "result")
"""Columns of a history, before the parameters that were chosen."""


def save(found: Optimum | Front, path: str | os.PathLike[str]) -> None:
    """Write the history and the result of a search, replacing the file at ``path`` whole or not at
    all.

    Raises :class:`.PathError` where no file can be put there, :class:`.StoreError` where it cannot
    be written.
    """
    with sealed_file(path, SEARCH) as file:
        file.attrs["case"] = found.case
        if isinstance(found, Optimum):
            _write_optimum(file, found)
        else:
            _write_front(file, found)


def check_optimum(path: str | os.PathLike[str]) -> list[str]:
    """Faults of a search's file, one line each; none if it is whole, and its contents are known to
    be an optimum.

    Raises :class:`.StoreError` for what is not a whole file of a search, :class:`.PathError` for
    none.
    """
    found: list[str] = []
    with opened_file(path, SEARCH) as file:
        read_all(file)
        for group in file["points"].values() if "points" in file else [file]:
            found += _contradictions(group)
        if file.attrs["stopped"]:
            found.append("the search was stopped before its end")
        if not file.attrs["feasible"]:
            found.append("a limit does not hold")
        if not file.attrs["converged"]:
            found.append("it is not known to be an optimum")
    return found


def _contradictions(group: h5py.Group) -> Iterator[str]:
    """Contradictions between an optimum's parts: starts, ends and optima are rows of the history.

    Raises ``KeyError``, ``ValueError`` and others where it is not what a search writes.
    """
    place, names = (
        group.name.rstrip("/"),
        [name for name, item in group["parameters"].items() if item.attrs["chosen"]],
    )
    history, optima = group["history"], group["optima"]
    check_dataset(history, (len(history), len(_COLUMNS) + len(names)))
    if list(history.attrs["columns"]) != [*_COLUMNS, *names]:
        yield f"{place}/history: its columns are not those of a history"
    runs, ends = [], []
    for number, start in group["starts"].items():
        rows = history[()][history[:, 0] == int(number)]
        for end in ("start", "end"):
            check_dataset(start[end], (len(names),))
        came = np.array([start.attrs["objective"], start.attrs["excess"], *start["end"]])
        begins = len(rows) == 0 or _alike(rows[0, len(_COLUMNS) :], start["start"])
        if not begins or (
            len(rows) and not any(_alike(np.delete(row, [0, 3]), came) for row in rows)
        ):
            yield f"{start.name}: does not agree with the history"
        shown(start.attrs["ending"])
        runs.append(np.delete(came, 1))
        if start.attrs["ending"] == CONVERGED:
            ends.append(runs[-1])
    chosen = [group.attrs["objective"], *(group["parameters"][name][()] for name in names)]
    if not any(_alike(chosen, run) for run in runs):
        yield (
            f"{place}/parameters: are not the design at which a start has ended, with its objective"
        )
    check_dataset(optima["designs"], (len(optima["objective"]), len(names)))
    check_dataset(optima["starts"], (len(optima["objective"]),))
    best = np.column_stack([optima["objective"], optima["designs"]])
    if int(np.sum(optima["starts"])) != len(ends) or not all(
        any(_alike(row, end) for end in ends) for row in best
    ):
        yield f"{optima.name}: are not the designs at which starts have converged"


def _alike(one: npt.ArrayLike, other: npt.ArrayLike) -> bool:
    return np.array_equal(np.asarray(one, float), np.asarray(other, float), equal_nan=True)


def _write_front(file: h5py.File, front: Front) -> None:
    names = list(front.points[0].optimum.values)
    said = ("stopped", "feasible", "converged", "evaluations")
    file.attrs.update({name: getattr(front, name) for name in said})
    group = file.create_group("front", track_order=True)
    group.attrs.update(
        {
            "minimised": list(map(str, front.minimised)),
            "units": list(front.units),
            "parameters": names,
        }
    )
    group["objectives"] = front.objectives
    group["trades"] = np.array([point.trades for point in front.points])
    group["designs"] = np.array(
        [[point.optimum.values[name] for name in names] for point in front.points]
    )
    group["converged"] = np.array([point.optimum.converged for point in front.points])
    points = file.create_group("points", track_order=True)
    for number, point in enumerate(front.points):
        _write_optimum(points.create_group(f"{number}", track_order=True), point.optimum)


def _write_optimum(file: h5py.Group, optimum: Optimum) -> None:
    names = list(optimum.values)
    said = (
        "unit",
        "objective",
        "feasible",
        "converged",
        "stopped",
        "residual",
        "curvature",
        "transmission",
        "evaluations",
    )
    file.attrs["minimised"] = str(optimum.minimised)
    file.attrs.update({name: getattr(optimum, name) for name in said})
    parameters = file.create_group("parameters", track_order=True)
    for name, value in optimum.parameters.items():
        parameters[name] = value
        parameters[name].attrs["chosen"] = name in names
        if name in names:
            parameters[name].attrs["multiplier"] = optimum.bounds[name]
    limits = file.create_group("limits", track_order=True)
    for number, limit in enumerate(optimum.limits):
        group = limits.create_group(f"{number}")
        group.attrs.update(
            {
                "constraint": str(limit.constraint),
                "value": limit.value,
                "limit": limit.constraint.limit,
                "active": limit.active,
                "multiplier": limit.multiplier,
            }
        )
    starts = file.create_group("starts", track_order=True)
    for number, start in enumerate(optimum.starts):
        group = starts.create_group(f"{number}")
        group["start"], group["end"] = (
            np.array([values[name] for name in names]) for values in (start.values, start.end)
        )
        group.attrs.update(
            {"objective": start.objective, "excess": start.excess, "ending": start.ending}
        )
    optima = file.create_group("optima", track_order=True)
    optima["designs"] = np.array(
        [[one.values[name] for name in names] for one in optimum.optima]
    ).reshape(-1, len(names))
    optima["objective"] = np.array([one.objective for one in optimum.optima])
    optima["starts"] = np.array([one.starts for one in optimum.optima], int)
    history = file.create_dataset("history", data=optimum.history)
    history.attrs["columns"] = [*_COLUMNS, *names]

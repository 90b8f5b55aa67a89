"""The faults of a sweep's file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...base.status import Status
from ...errors import one_line
from ...model.even_points import points
from ...results.store.attributes import check_attributes, described
from ...results.store.dataset_words import unlike, unlike_conventions, without_scale
from ...results.store.untrusted import check_chunks, reported_as, structured
from ..checkpoint import Checkpoint
from .axes import are_described, counted, grouped, size_of
from .design_blocks import designs_in, slabs
from .meanings import STATUS, Column, Meanings
from .plan import Identity
from .reading import Sweep


def check_sweep(path: str | Path) -> list[str]:
    """Faults of a file, one line each; none if it is whole and consistent.

    Every dataset is read, so every checksum is verified; every unit, sign and status must be the
    schema's, every axis have its scale and the values that were asked for; where a design has a
    result, and only there, its columns must have numbers, but for what equilibrium leaves open; and
    no design may fail its certificate.

    Raises :class:`StoreError` for what is not a whole file of a sweep, :class:`PathError` for none.
    """
    sweep = Sweep.open(path)
    found: list[str] = []
    meanings = _meanings(sweep)
    with sweep.opened() as file:
        found += unlike_conventions(file, meanings.table)
        found += _check_scales(file, sweep, meanings)
        found += _check_asked(file, sweep)
        for kept in sweep.columns.values():
            try:
                found += _check_column(file, sweep, kept, meanings)
            except Exception as error:
                found.append(f"{kept.name}: damaged: {one_line(error)}")
    return found


def unfinished(path: Path) -> Checkpoint | None:
    """The folder of an unfinished sweep, by its own path, or by that of the file that is not there
    yet; else None.
    """
    if not path.name:
        return None
    folder = Checkpoint.of(path.with_name(path.name.removesuffix(".parts")), "sweep")
    at_work = folder.begun and (path == folder.path or not path.exists())
    return folder if at_work and folder.plan["study"] == folder.study else None


def identity_of(folder: Checkpoint) -> Identity:
    """The identity of an unfinished sweep. Raises :class:`StoreError` for a damaged one."""
    with reported_as("damaged", folder.path):
        identity: Identity = structured(Identity, folder.plan["identity"], "plan")
        described(identity["mechanism"])
    return identity


def progress(folder: Checkpoint) -> str:
    """Progress of an unfinished sweep, and how to continue it; the sweep may be at work meanwhile,
    for nothing is touched.

    Raises :class:`StoreError` where its plan cannot be read.
    """
    with reported_as("damaged", folder.path):
        size = size_of(identity_of(folder)["grid"])
    return (
        f"unfinished: {grouped(designs_in(folder.parts))} of {counted(size)} done; run it again"
        " with resume=True to continue"
    )


def flaws(folder: Checkpoint) -> Iterator[str]:
    """Faults of the parts of an unfinished sweep, a line each; all is read, and nothing touched."""
    for name in folder.parts:
        # A sweep at work may come to its end meanwhile.
        if folder.read(name) is None and folder.path_of(name).exists():
            yield f"{name}: damaged: it will be done again"


def _meanings(sweep: Sweep) -> Meanings:
    """Meanings of columns and axes, by what was asked for."""
    times = sweep.identity["t"]
    joint = times[3] if len(times) > 3 else ""
    shared = not joint and not any(isinstance(bound, str) for bound in times[:2])
    return Meanings(sweep.description, joint, shared)


def _check_scales(file: h5py.File, sweep: Sweep, meanings: Meanings) -> list[str]:
    """Faults of axes: each is read, and its numbers must be finite."""
    found: list[str] = []

    def visit(place: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and place.replace("/", ":") not in sweep.columns:
            try:
                check_chunks(item)
                if not np.isfinite(item[()]).all():
                    found.append(f"{place}: values that are not finite")
                found.extend(unlike(item, *meanings.of_axis(place.rpartition("/")[2])))
            except Exception as error:
                found.append(f"{place}: damaged: {one_line(error)}")

    file.visititems(visit)
    return found


def _check_asked(file: h5py.File, sweep: Sweep) -> Iterator[str]:
    """Compare what a file states twice: the case and its parameters, and the axes with what was
    asked for.
    """
    identity: Mapping[str, Any] = sweep.identity
    yield from check_attributes(file.attrs, sweep.description)
    values = {name: file["grid"][name][()] for name in sweep.parameters}
    if not are_described(identity["grid"], values):
        yield "grid: differs from the plan"
    for axis in ("t", "xi"):
        if (
            axis in file
            and axis not in sweep.dimensions
            and not np.array_equal(file[axis][()], points(identity[axis]))
        ):
            yield f"{axis}: differs from the plan"


def _check_column(file: h5py.File, sweep: Sweep, kept: Column, meanings: Meanings) -> Iterator[str]:
    dataset, status = file[kept.place], file[STATUS]
    yield from without_scale(dataset, (*sweep.dimensions, *kept.axes))
    check_chunks(dataset)
    yield from unlike(dataset, *meanings.of_column(kept.name, sweep.columns))
    dims = tuple(sweep.dimensions.values())
    missing = surplus = unknown = wrong = 0
    for _, _, where in slabs(dims, dataset.chunks[: len(dims)]):
        values, states = np.asarray(dataset[where]), np.asarray(status[where])
        if kept.name == STATUS:
            unknown += int(np.sum(~np.isin(states, list(sweep.statuses))))
            wrong += int(np.sum(states == Status.UNCERTIFIED))
            continue
        there = ~np.isnan(values).any(axis=tuple(range(states.ndim, values.ndim)))
        missing += int(np.sum(~there & (states == 0)))
        surplus += int(np.sum(there & (states != Status.OK)))
    if unknown:
        yield f"{kept.name}: {unknown} of the designs have an unknown status"
    if wrong:
        yield (
            f"{counted(wrong)}, of those that were checked in full, without a certificate: others"
            " may be wrong as well"
        )
    if missing and "missing" not in dataset.attrs:
        yield f"{kept.name}: {missing} of the designs that have a result lack it"
    if surplus:
        yield f"{kept.name}: {surplus} of the designs that have no result have a number"

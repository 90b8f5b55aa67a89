"""Is a sweep's file whole and consistent?"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from ..errors import one_line
from .blocks import slabs
from .columns import STATUS
from .reading import Kept, Sweep


def check_sweep(path: str | Path) -> list[str]:
    """What is wrong with a file, one line each; nothing where it is whole and consistent.

    Every dataset is read, so every checksum is verified; every axis must have its scale, and where a design has a result, and only
    there, its columns must have numbers, but for what equilibrium leaves open.

    Raises :class:`StoreError` for what is not a whole file of a sweep, :class:`PathError` for none.
    """
    sweep = Sweep.open(path)
    found: list[str] = []
    with h5py.File(path, "r") as file:
        for kept in sweep.columns.values():
            try:
                found += _check_column(file, sweep, kept)
            except (OSError, RuntimeError, KeyError) as error:
                found.append(f"{kept.name}: damaged: {one_line(error)}")
    return found


def _check_column(file: h5py.File, sweep: Sweep, kept: Kept) -> Iterator[str]:
    dataset, status = file[kept.name.replace(":", "/")], file[STATUS]
    names = (*sweep.dimensions, *kept.axes)
    for axis, name in enumerate(names):
        if file[name] not in dataset.dims[axis].values():
            yield f"{kept.name}: axis {axis} has no scale {name}"
    expected = tuple(file[name].size for name in names)
    if dataset.shape != expected:
        yield f"{kept.name}: shape {dataset.shape}, expected {expected}"
        return
    dims = tuple(sweep.dimensions.values())
    missing = surplus = unknown = 0
    for _, _, where in slabs(dims, dataset.chunks[: len(dims)]):
        values, states = np.asarray(dataset[where]), np.asarray(status[where])
        if kept.name == STATUS:
            unknown += int(np.sum(~np.isin(states, list(sweep.statuses))))
            continue
        there = ~np.isnan(values).any(axis=tuple(range(states.ndim, values.ndim)))
        missing += int(np.sum(~there & (states == 0)))
        surplus += int(np.sum(there & (states != 0)))
    if unknown:
        yield f"{kept.name}: {unknown} designs have a status that is none"
    if missing and not _open(sweep, kept.name):
        yield f"{kept.name}: {missing} designs that have a result lack it"
    if surplus:
        yield f"{kept.name}: {surplus} designs that have no result have a number"


def _open(sweep: Sweep, name: str) -> bool:
    """Whether equilibrium leaves a column open."""
    part = ":".join(name.split(":")[1:3])
    return any(other.startswith(part) for other in sweep.undetermined)

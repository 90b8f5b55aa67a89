"""The file of a sweep: parts joined, in chunks that the plan alone sets; ``docs/sweeps.md`` is its
schema.

Every dimension's scale is in the root, where netCDF looks for it, and those of parameters are under
``grid`` as well.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import BinaryIO

import h5py
import numpy as np
import numpy.typing as npt

from ...errors import DeclarationError
from ...results.store.dataset_words import conventions, say
from ...results.store.opening import SWEEP, sealed
from ...results.store.scales import LARGE, Scales
from .axes import DESIGN, Grid
from .chunks import FILTERS
from .design_blocks import chunk_of, slabs
from .meanings import KINDS, Column
from .plan import Plan

WORDS = ("versions", "mechanism", "wanted", "t", "xi", "grid")
"""Attributes that are JSON; the others of a plan's identity are as they stand."""

_CHUNK = 1 << 15


def check_names(plan: Plan) -> None:
    """Raise :class:`DeclarationError` for a parameter whose dimension would bear a name that the
    file keeps for its own.
    """
    harvest, designs = plan.harvest, plan.designs
    taken = {"grid", DESIGN, "t", "xi", harvest.axis.name}
    taken |= {name for name, kind in KINDS.items() if not kind.optional}
    taken |= {column.name.partition(":")[0] for column in harvest.columns}
    for name in designs.dimensions:
        if name in taken and isinstance(designs, Grid):
            raise DeclarationError(
                f"parameter '{name}' cannot be an axis: the file uses that name itself; sweep"
                " a list of designs instead"
            )


@contextmanager
def joining(
    plan: Plan, bytes_: BinaryIO, breathe: Callable[[], None]
) -> Iterator[Callable[[Sequence[bytes]], None]]:
    """The file of a plan, sealed at the end, to which its blocks are given in order.

    ``breathe`` lets an interrupt through, while long axes are written.
    """
    with sealed(bytes_, SWEEP) as file:
        scales = Scales(file)
        _begin(file, plan, scales, breathe)
        datasets = [
            (_created(file, plan, column, scales), (0,) * len(column.axes))
            for column in plan.harvest.columns
        ]
        scales.finish()
        slabs = plan.slabs()

        def append(contents: Sequence[bytes]) -> None:
            _, _, where = next(slabs)
            corner = tuple(place.start for place in where)
            for (dataset, rest), content in zip(datasets, contents, strict=True):
                dataset.id.write_direct_chunk((*corner, *rest), content)
            os.fsync(bytes_.fileno())  # else all of it waits for the disk in the end

        yield append


def _begin(file: h5py.File, plan: Plan, scales: Scales, breathe: Callable[[], None]) -> None:
    """Scales and attributes."""
    grid = file.create_group("grid", track_order=True)
    designs, meanings = plan.designs, plan.harvest.meanings
    if not isinstance(designs, Grid):
        scale = _stream(
            file,
            DESIGN,
            (designs.size,),
            lambda start, stop: np.arange(start, stop),
            np.int64,
            breathe,
        )
        scale.make_scale(DESIGN)
        say(scale, *meanings.of_axis(DESIGN))
    for name in designs.names:
        length = designs.dimensions.get(name, designs.size)
        scale = _stream(
            grid,
            name,
            (length,),
            partial(designs.scale, name),
            np.float64,
            breathe,
        )
        say(scale, *meanings.of_axis(name))
        if isinstance(designs, Grid):
            file[name] = scale
            scale.make_scale(name)
        else:
            scales.attach(scale, [DESIGN])
    instants = plan.harvest.axis
    for axis, values in ((instants.name, instants.values), ("xi", plan.harvest.xi)):
        if any(axis in column.axes for column in plan.harvest.columns):
            scale = file.create_dataset(
                axis, data=values, fletcher32=True, fillvalue=np.nan, **LARGE
            )
            say(scale, *meanings.of_axis(axis))
            scale.make_scale(axis)
    for key, value in plan.identity.items():
        file.attrs[key] = json.dumps(value) if key in WORDS else value
    file.attrs.update(conventions(meanings.table))
    file.attrs["parameters"] = json.dumps(dict(plan.values))
    file.attrs["columns"] = len(plan.harvest.columns)
    if plan.case_file:
        file.attrs["case_file"] = plan.case_file


def _stream(
    group: h5py.Group,
    name: str,
    shape: tuple[int, ...],
    values: Callable[[int, int], npt.ArrayLike],
    dtype: npt.DTypeLike,
    breathe: Callable[[], None],
) -> h5py.Dataset:
    """A dataset over one axis, filled in pieces."""
    chunk = chunk_of(shape, _CHUNK)
    dataset = group.create_dataset(
        name, shape, dtype, chunks=chunk, fillvalue=_nothing(dtype), **FILTERS, **LARGE
    )
    for start, stop, where in slabs(shape, chunk):
        dataset[where] = values(start, stop)
        breathe()
    return dataset


def _nothing(dtype: npt.DTypeLike) -> float:
    """Value of a dataset that was never written: no number, or one without a meaning."""
    return np.nan if np.dtype(dtype).kind == "f" else np.iinfo(dtype).min


def _created(file: h5py.File, plan: Plan, column: Column, scales: Scales) -> h5py.Dataset:
    """The dataset of a column, empty."""
    shape, chunk = (*plan.dims, *column.lengths), (*plan.chunk, *column.lengths)
    dataset = file.create_dataset(
        column.place, shape, column.dtype, chunks=chunk, fillvalue=_nothing(column.dtype), **FILTERS
    )
    say(dataset, column.unit, column.attributes)
    scales.attach(dataset, (*plan.designs.dimensions, *column.axes))
    return dataset

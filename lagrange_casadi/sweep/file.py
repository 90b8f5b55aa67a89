"""The file of a sweep: parts joined, column by column, in chunks that the plan alone sets; ``docs/sweeps.md`` is its schema.

Every dimension's scale is in the root, where netCDF looks for it, and those of parameters are under ``grid`` as well.
"""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..codegen import cores
from ..derive import derive
from ..errors import DeclarationError
from ..publish import PatientFile
from ..quantities import CONVENTIONS
from .axes import DESIGN, Designs, Grid
from .chunks import FILTERS, encoded
from .columns import KINDS, Column
from .parts import Part
from .plan import SCHEMA, Plan

WORDS = ("versions", "mechanism", "wanted", "t", "xi", "grid")
"""Attributes that are JSON; the others of a plan's identity are as they stand."""

_CHUNK = 1 << 15
_CHUNK_WITH_AXES = 1 << 17
_AXES = {"t": ("s", "time"), "xi": ("1", "place along a link, ratio xi/l")}
_TAKEN = ("grid", *KINDS, DESIGN, *_AXES)

Slab = tuple[int, int, tuple[Any, ...]]


def check_names(designs: Designs) -> None:
    """Raise :class:`DeclarationError` for a parameter whose dimension would bear a name that the file keeps for its own."""
    for name in designs.dimensions:
        if name in _TAKEN and isinstance(designs, Grid):
            raise DeclarationError(
                f"parameter '{name}' cannot be an axis: the file keeps that name for its own; sweep a list of designs instead"
            )


def chunk_of(dims: Sequence[int], target: int) -> tuple[int, ...]:
    """The shape of chunks of about ``target`` designs that are runs of design numbers, each axis cut into equal lengths."""
    chunk: list[int] = []
    room = max(target, 1)
    for length in reversed(dims):
        here = length if length <= room else math.ceil(length / math.ceil(length / room))
        room = room // length if length <= room else 1
        chunk.append(here)
    return tuple(chunk[::-1])


def slabs(dims: Sequence[int], chunk: Sequence[int]) -> Iterator[Slab]:
    """The runs of design numbers, from and to before, that chunks hold, in order, and the selection of the designs' axes."""
    cut = next((axis for axis, length in enumerate(chunk) if length != 1), len(dims) - 1)
    inner = math.prod(dims[cut + 1 :])
    whole = (slice(None),) * (len(dims) - cut - 1)
    for count, outer in enumerate(np.ndindex(*dims[:cut])):
        for start in range(0, dims[cut], chunk[cut]):
            stop = min(start + chunk[cut], dims[cut])
            before = count * dims[cut]
            yield (before + start) * inner, (before + stop) * inner, (*outer, slice(start, stop), *whole)


def join(plan: Plan, parts: Sequence[Part], path: Path, breathe: Callable[[], None], told: Callable[[float], None]) -> None:
    """Write the file of a plan from all its parts. ``breathe`` lets interrupts through; ``told`` hears which share is done.

    Raises :class:`StoreError` for a damaged part, and ``OSError`` where the file cannot be written.
    """
    columns = plan.columns
    with (
        ThreadPoolExecutor(cores()) as pool,
        PatientFile(path, "w+") as bytes_,
        h5py.File(bytes_, "w", track_order=True) as file,
    ):
        _begin(file, plan)
        for done, column in enumerate(columns):
            _write(file, plan, column, parts, breathe, pool)
            told((done + 1) / len(columns))
        file.flush()
        file.attrs["complete"] = True


def _begin(file: h5py.File, plan: Plan) -> None:
    """Scales and attributes."""
    grid = file.create_group("grid", track_order=True)
    parameters = plan.scene.mechanism.parameters
    designs = plan.designs
    if not isinstance(designs, Grid):
        scale = _stream(file, DESIGN, (designs.size,), lambda start, stop: np.arange(start, stop), np.int64)
        scale.make_scale(DESIGN)
        scale.attrs["units"], scale.attrs["long_name"] = "1", "number of the design"
    for name in designs.names:
        length = designs.dimensions.get(name, designs.size)
        scale = _stream(grid, name, (length,), lambda start, stop, name=name: designs.scale(name, start, stop), np.float64)
        scale.attrs["units"], scale.attrs["long_name"] = parameters[name].unit, f"parameter {name}"
        if isinstance(designs, Grid):
            file[name] = scale
            scale.make_scale(name)
        else:
            scale.dims[0].attach_scale(file[DESIGN])
    for axis, values in (("t", plan.harvest.t), ("xi", plan.harvest.xi)):
        if any(axis in column.axes for column in plan.columns):
            scale = file.create_dataset(axis, data=values, fletcher32=True)
            scale.attrs["units"], scale.attrs["long_name"] = _AXES[axis]
            scale.make_scale(axis)
    file.attrs["schema"] = SCHEMA
    for key, value in plan.identity.items():
        file.attrs[key] = json.dumps(value) if key in WORDS else value
    file.attrs["conventions"] = CONVENTIONS
    file.attrs["parameters"] = json.dumps(dict(plan.values))
    file.attrs["undetermined"] = json.dumps(derive(plan.scene, plan.task.wanted).undetermined)
    file.attrs["columns"] = len(plan.columns)


def _stream(group: Any, name: str, shape: tuple[int, ...], values: Callable[..., Any], dtype: Any) -> Any:
    """A dataset over one axis, filled in pieces."""
    chunk = chunk_of(shape, _CHUNK)
    dataset = group.create_dataset(name, shape, dtype, chunks=chunk, **FILTERS)
    for start, stop, where in slabs(shape, chunk):
        dataset[where] = values(start, stop)
    return dataset


def _write(file: h5py.File, plan: Plan, column: Column, parts: Sequence[Part], breathe: Callable[[], None], pool: Executor) -> None:
    dims = tuple(plan.designs.dimensions.values())
    chunk = chunk_of(dims, _CHUNK_WITH_AXES // math.prod(column.lengths) if column.axes else _CHUNK)
    dataset = file.create_dataset(
        column.place, (*dims, *column.lengths), column.dtype, chunks=(*chunk, *column.lengths), fillvalue=0, **FILTERS
    )
    dataset.attrs["units"] = column.unit
    for key, text in column.attributes.items():
        dataset.attrs[key] = text
    for axis, name in enumerate((*plan.designs.dimensions, *column.axes)):
        dataset.dims[axis].attach_scale(file[name])
    size = math.prod((*chunk, *column.lengths))
    pieces = recut((part.read(column) for part in parts), (stop for _, stop, _ in slabs(dims, chunk)))
    made = _ahead(pool, lambda values: encoded(values, size), pieces)
    for (_, _, where), content in zip(slabs(dims, chunk), made, strict=True):
        breathe()
        corner = (place.start or 0 if isinstance(place, slice) else place for place in where)
        dataset.id.write_direct_chunk((*corner, *(0 for _ in column.lengths)), content)


def _ahead(pool: Executor, make: Callable[[Any], bytes], pieces: Iterable[Any]) -> Iterator[bytes]:
    """What a pool makes of pieces, in their order, a few at a time."""
    waiting: deque[Any] = deque()
    for piece in pieces:
        waiting.append(pool.submit(make, piece))
        if len(waiting) > 2 * cores():
            yield waiting.popleft().result()
    while waiting:
        yield waiting.popleft().result()


def recut(pieces: Iterable[Any], stops: Iterable[int]) -> Iterator[Any]:
    """Arrays cut anew along their first axis, so that they end where told."""
    rest: list[Any] = []
    held = done = 0
    source = iter(pieces)
    for stop in stops:
        while done + held < stop:
            rest.append(next(source))
            held += len(rest[-1])
        whole = np.concatenate(rest) if len(rest) > 1 else rest[0]
        yield whole[: stop - done]
        rest, held, done = [whole[stop - done :]], held - (stop - done), stop

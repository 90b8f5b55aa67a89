"""Checks of a file before it is believed: the shape of its JSON, the targets of its links, and the
kinds of its datasets.

HDF5 and JSON allow far more than this package writes. Anything else is reported as damage, in one
line that names the file.
"""

from __future__ import annotations

import functools
import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import h5py
import numpy as np

from ...base.arrays import Array
from ...errors import DeclarationError, LagrangeCasadiError, StoreError, one_line

Shape = Any
"""``str``, ``int``, ``float`` or ``bool``, or None for null; a tuple of shapes, any of which will
do; ``[shape]`` for a list, and ``[shape, shape, ...]`` for one of so many; ``{str: shape}`` for a
mapping of any names, ``{"name": shape, ...}`` for one that has these, at least."""

_hints = functools.cache(get_type_hints)


@contextmanager
def reported_as(what: str, path: str | os.PathLike[str]) -> Iterator[None]:
    """Raise :class:`StoreError`, one line with the file and ``what`` it is, for whatever is raised
    and is no error of ours.
    """
    try:
        yield
    except (LagrangeCasadiError, MemoryError):
        raise
    except Exception as error:
        unquoted = ValueError(*error.args) if isinstance(error, KeyError) else error
        text = one_line(unquoted) or type(error).__name__
        raise StoreError(f"{path}: {what}: {text}") from error


def parsed(text: str | bytes, shape: Shape, what: str = "JSON") -> Any:
    """JSON of a shape.

    Raises ``ValueError`` for what is not JSON, and as :func:`check_shape` does.
    """
    found = read_json(text, what)
    check_shape(found, shape, what)
    return found


def read_json(text: str | bytes, what: str) -> Any:
    """JSON of any shape. Raises ``ValueError`` for what is not JSON."""
    try:
        return json.loads(text)
    except (ValueError, TypeError, RecursionError):
        raise ValueError(f"{what} is not JSON") from None


def check_shape(value: object, shape: Shape, what: str) -> None:
    """Raise ``ValueError`` for what came from JSON and has another shape, with the place."""
    if place := _mismatch(value, shape, what):
        raise ValueError(f"{place} is not of the expected kind")


def structured(kind: Any, value: Any, place: str) -> Any:
    """Make a value of a type from JSON: of a dataclass, ``tuple``, ``Mapping``, ``Literal`` of
    texts, the last of ``X | Y | None``, ``Any``, or ``str``, ``float`` or ``bool``.

    Raises ``ValueError`` for JSON of another form, with the place.
    """
    origin, of = get_origin(kind), get_args(kind)
    if kind is Any:
        return value
    if origin in (Union, UnionType):
        *_, last = (one for one in of if one is not NoneType)
        return None if value is None else structured(last, value, place)
    if isinstance(kind, type) and is_dataclass(kind):
        check_shape(value, {}, place)
        hints, known = _hints(kind), {one.name for one in fields(kind)}
        if more := sorted(value.keys() - known):
            raise ValueError(f"{place} has an unknown part '{more[0]}'")
        given = {
            one.name: structured(hints[one.name], value.get(one.name), f"{place}.{one.name}")
            for one in fields(kind)
            if one.name in value or one.default is one.default_factory is MISSING
        }
        try:
            return kind(**given)
        except DeclarationError as error:
            raise ValueError(f"{place}: {error}") from None
    if origin in (tuple, Sequence):
        several = origin is Sequence or of[-1] is ...
        each = of[:1] * len(value) if isinstance(value, list) and several else of
        if not isinstance(value, list) or len(each) != len(value):
            raise ValueError(f"{place} is not of the expected kind")
        pairs = enumerate(zip(each, value, strict=True))
        return tuple(structured(*pair, f"{place}[{k}]") for k, pair in pairs)
    if origin is Mapping:
        check_shape(value, {}, place)
        return {name: structured(of[1], one, f"{place}.{name}") for name, one in value.items()}
    check_shape(value, str if origin is Literal else kind, place)
    if origin is Literal and value not in of:
        raise ValueError(f"{place} is not of the expected kind")
    return float(value) if kind is float else value


def shown(value: str) -> str:
    """A text that can be shown. Raises ``ValueError`` for anything else."""
    if not isinstance(value, str) or re.search("[\0\ud800-\udfff]", value):
        raise ValueError(f"{value!r:.40} is not a text")
    return value


def number(attributes: Mapping[str, Any], name: str) -> float:
    """The number that an attribute states.

    Raises ``ValueError`` for an attribute that is no real number, ``KeyError`` for none.
    """
    value = attributes[name]
    if not isinstance(value, float | np.floating):
        raise ValueError(f"{name} is not of the expected kind")
    return float(value)


def check_links(file: h5py.File) -> None:
    """Raise ``ValueError`` for a link to anywhere but the file itself, and for a name that cannot
    be shown.
    """

    def astray(place: bytes, link: h5py.h5l.LinkInfo) -> bytes | None:
        return (
            None
            if link.type == h5py.h5l.TYPE_HARD and _is_shown(place.decode(errors="surrogateescape"))
            else place
        )

    place = file.id.links.visit(astray, info=True)
    if place is not None:
        raise ValueError(f"{place.decode(errors='replace')} is a link to elsewhere, or not a name")


def check_dataset(dataset: h5py.Dataset, shape: Sequence[int] | None = None) -> None:
    """Raise ``ValueError`` for what is no dataset of numbers that the file itself holds, or has
    another shape.
    """
    name = getattr(dataset, "name", "a dataset")
    if (
        not isinstance(dataset, h5py.Dataset)
        or dataset.shape is None
        or dataset.dtype.kind not in "fi"
    ):
        raise ValueError(f"{name} is no dataset of numbers")
    if dataset.is_virtual or dataset.external:
        raise ValueError(f"{name} is kept in another file")
    if shape is not None and dataset.shape != tuple(shape):
        raise ValueError(f"{name} has the shape {dataset.shape}, expected {tuple(shape)}")


def numbers(dataset: h5py.Dataset, shape: tuple[int, ...] | None = None) -> Array:
    """The numbers of a dataset, of a shape if one is given.

    Raises ``ValueError`` for what has others.
    """
    check_numbers(dataset, shape)
    return np.asarray(dataset[()], np.float64)


def check_numbers(dataset: h5py.Dataset, shape: Sequence[int] | None) -> None:
    """Raise ``ValueError`` for a dataset that has no numbers, or another shape."""
    check_dataset(dataset, shape)
    check_chunks(dataset)


def check_chunks(dataset: h5py.Dataset) -> None:
    """Raise ``ValueError`` where chunks of a dataset are missing, for which HDF5 would make numbers
    up.
    """
    stored = dataset.id.get_storage_size()
    if dataset.compression is None and stored < dataset.nbytes:
        raise ValueError(f"{dataset.name} has {stored} bytes of {dataset.nbytes}")
    if dataset.chunks is not None:
        expected = math.prod(
            -(-length // chunk) for length, chunk in zip(dataset.shape, dataset.chunks, strict=True)
        )
        if (count := dataset.id.get_num_chunks()) != expected:
            raise ValueError(f"{dataset.name} has {count} chunks of {expected}")


def _mismatch(value: object, shape: Shape, place: str) -> str:
    """The first place where a value has another shape; nothing where none has."""
    if isinstance(shape, tuple):
        return "" if any(not _mismatch(value, one, place) for one in shape) else place
    if isinstance(shape, list):
        if not isinstance(value, list) or len(shape) not in (1, len(value)):
            return place
        each = shape if len(shape) > 1 else shape * len(value)
        return next(
            filter(
                None,
                (
                    _mismatch(*pair, f"{place}[{k}]")
                    for k, pair in enumerate(zip(value, each, strict=True))
                ),
            ),
            "",
        )
    if isinstance(shape, Mapping):
        if not isinstance(value, dict):
            return place
        if strange := next((name for name in value if not _is_shown(name)), ""):
            return f"{place}.{strange!r}"
        asked = dict.fromkeys(value, shape[str]) if str in shape else shape
        missing = next((f"{place}.{name}" for name in asked if name not in value), "")
        return missing or next(
            filter(
                None,
                (_mismatch(value[name], one, f"{place}.{name}") for name, one in asked.items()),
            ),
            "",
        )
    if shape is None:
        return "" if value is None else place
    if shape is float:
        return "" if _is_real(value) else place
    if shape is str:
        return "" if isinstance(value, str) and _is_shown(value) else place
    return "" if type(value) is shape else place


def _is_shown(value: str) -> bool:
    try:
        return shown(value) == value
    except ValueError:
        return False


def _is_real(value: object) -> bool:
    try:
        return type(value) is float or (type(value) is int and math.isfinite(float(value)))
    except OverflowError:
        return False

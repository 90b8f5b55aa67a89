"""Checks of a file before it is believed: the form of its JSON, the targets of its links, and the
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
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import MISSING, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints, is_typeddict

import h5py
import numpy as np

from ...base.arrays import Array
from ...errors import DeclarationError, LagrangeCasadiError, StoreError, one_line

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


def parsed(text: str | bytes, kind: Any, what: str = "JSON") -> Any:
    """A value of a type from JSON.

    Raises ``ValueError`` for what is not JSON, and as :func:`structured` does.
    """
    try:
        value = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        raise ValueError(f"{what} is not JSON") from None
    return structured(kind, value, what)


def structured(kind: Any, value: Any, place: str) -> Any:
    """Make a value of a type from JSON: of a dataclass, a ``TypedDict``, ``tuple``, ``Mapping``,
    ``Literal`` of texts, ``Any``, ``str``, ``int``, ``float`` or ``bool``, or of the first that
    fits of a union.

    Raises ``ValueError`` for JSON of another form, with the place.
    """
    origin, of = get_origin(kind), get_args(kind)
    if kind is Any:
        return value
    if origin in (Union, UnionType):
        # The last names the fault, so null comes first.
        *others, last = sorted(of, key=lambda one: one is not NoneType)
        for one in others:
            with suppress(ValueError):
                return structured(one, value, place)
        return structured(last, value, place)
    if is_dataclass(kind) or is_typeddict(kind):
        return _record(kind, value, place)
    if origin in (tuple, Sequence):
        several = origin is Sequence or of[-1] is ...
        each = of[:1] * len(value) if isinstance(value, list) and several else of
        _check_kind(isinstance(value, list) and len(each) == len(value), place)
        pairs = enumerate(zip(each, value, strict=True))
        return tuple(structured(*pair, f"{place}[{k}]") for k, pair in pairs)
    if origin in (Mapping, dict):
        _check_kind(isinstance(value, dict), place)
        return {
            structured(of[0], name, f"{place}.{name!r}"): structured(of[1], one, f"{place}.{name}")
            for name, one in value.items()
        }
    if origin is Literal:
        _check_kind(value in of, place)
    elif kind is float:
        real = type(value) is float or (type(value) is int and abs(value) <= sys.float_info.max)
        _check_kind(real, place)
        return float(value)
    else:
        _check_kind(_is_shown(value) if kind is str else type(value) is kind, place)
    return value


def _record(kind: Any, value: Any, place: str) -> Any:
    """Make a dataclass or a ``TypedDict`` from JSON."""
    _check_kind(isinstance(value, dict), place)
    hints = _hints(kind)
    needed = dict.fromkeys(hints, True)
    if is_dataclass(kind):
        needed = {one.name: one.default is one.default_factory is MISSING for one in fields(kind)}
    if more := sorted(value.keys() - needed):
        raise ValueError(f"{place} has an unknown part {more[0]!r}")
    given = {
        name: structured(hints[name], value.get(name), f"{place}.{name}")
        for name in needed
        if needed[name] or name in value
    }
    try:
        return kind(**given)
    except DeclarationError as error:
        raise ValueError(f"{place}: {error}") from None


def _check_kind(fits: bool, place: str) -> None:
    """Raise ``ValueError`` for a place whose value does not fit."""
    if not fits:
        raise ValueError(f"{place} is not of the expected kind")


def shown(value: str) -> str:
    """A text that can be shown. Raises ``ValueError`` for anything else."""
    if not _is_shown(value):
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
    check_dataset(dataset, shape)
    check_chunks(dataset)
    return np.asarray(dataset[()], np.float64)


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


def _is_shown(value: object) -> bool:
    return isinstance(value, str) and not re.search("[\0\ud800-\udfff]", value)

"""Contents of a sweep's file, checked before they are believed: its scene, its axes, its columns,
its statuses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypedDict

import h5py
import numpy as np

from ...results.store.attributes import described
from ...results.store.untrusted import (
    check_dataset,
    check_links,
    check_shape,
    parsed,
    read_json,
    shown,
)
from .axes import DESIGN
from .file import WORDS
from .meanings import KINDS, STATUS
from .plan import IDENTITY, Identity

_NAMED = (
    "backend",
    "precision",
    "compiler",
    "flags",
    "rung",
    "sources",
    "keep",
    "scene",
    "case",
)


@dataclass(frozen=True)
class KeptColumn:
    """Description of a column in a file: unit, meaning, and its axes beyond those of the
    designs.
    """

    name: str
    unit: str
    long_name: str
    axes: tuple[str, ...]


class Contents(TypedDict):
    """Description of a sweep, from its file."""

    identity: Identity
    dimensions: dict[str, int]
    parameters: dict[str, str]
    columns: dict[str, KeptColumn]
    statuses: dict[int, tuple[str, str]]


def contents(file: h5py.File) -> Contents:
    """The fields of a :class:`.Sweep` that its file has.

    Raises ``ValueError``, ``KeyError`` and others where it is not what a sweep writes.
    """
    check_links(file)
    attributes = file.attrs
    identity: Any = {key: read_json(attributes[key], key) for key in WORDS} | {
        key: _plain(attributes[key]) for key in _NAMED
    }
    check_shape(identity, IDENTITY, "attributes")
    described(identity["mechanism"])
    columns: dict[str, KeptColumn] = {}
    status = file[STATUS]
    names = [dim[0].name.rpartition("/")[2] for dim in status.dims]
    dimensions = dict(zip(names, status.shape, strict=True))

    def length(name: str) -> int:
        return dimensions[name] if name in dimensions else int(file[name].size)

    def visit(place: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset):
            folder, _, last = place.rpartition("/")
            if item.is_scale or folder == "grid":
                check_dataset(item, [length(last if item.is_scale else DESIGN)])
            else:
                axes = tuple(
                    item.dims[axis][0].name.rpartition("/")[2]
                    for axis in range(len(names), item.ndim)
                )
                check_dataset(item, [*status.shape, *map(length, axes)])
                name = place.replace("/", ":")
                if name.partition(":")[0] not in KINDS:
                    raise ValueError(f"{place} is no column of a sweep")
                columns[name] = KeptColumn(
                    name, shown(item.attrs["units"]), shown(item.attrs["long_name"]), axes
                )

    file.visititems(visit)
    if list(dimensions) not in ([DESIGN], list(file["grid"])):
        raise ValueError(
            f"it is over {', '.join(dimensions)}, and has values of {', '.join(file['grid'])}"
        )
    if len(columns) != _plain(attributes["columns"]):
        raise ValueError(f"it has {len(columns)} columns of {attributes['columns']}")
    sentences = parsed(status.attrs["sentences"], {str: str}, "sentences")
    meanings = shown(status.attrs["flag_meanings"]).split()
    if len(meanings) != len(sentences):
        raise ValueError(f"it has {len(meanings)} words for {len(sentences)} statuses")
    return {
        "identity": identity,
        "dimensions": dimensions,
        "parameters": {name: shown(file["grid"][name].attrs["units"]) for name in file["grid"]},
        "columns": {
            name: columns[name]
            for name in sorted(
                columns, key=lambda name: (tuple(KINDS).index(name.partition(":")[0]), name)
            )
        },
        "statuses": {
            int(number): (word, sentence)
            for (number, sentence), word in zip(sentences.items(), meanings, strict=True)
        },
    }


def _plain(value: str | np.int64) -> str | int:
    return int(value) if isinstance(value, np.integer) else shown(value)

"""Contents of a sweep's file, checked before they are believed: its scene, its axes, its columns,
its statuses.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from ...results.store.attributes import described
from ...results.store.untrusted import (
    check_dataset,
    check_links,
    parsed,
    shown,
    structured,
)
from .axes import DESIGN
from .meanings import KINDS, STATUS, Column
from .plan import Identity
from .sweep_file import WORDS

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


def contents(file: h5py.File) -> dict[str, Any]:
    """The fields of a :class:`.Sweep` that its file has.

    Raises ``ValueError``, ``KeyError`` and others where it is not what a sweep writes.
    """
    check_links(file)
    attributes = file.attrs
    identity: Any = {key: parsed(attributes[key], Any, key) for key in WORDS} | {
        key: _plain(attributes[key]) for key in _NAMED
    }
    structured(Identity, identity, "attributes")
    described(identity["mechanism"])
    columns: dict[str, Column] = {}
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
                words = {"long_name": shown(item.attrs["long_name"])}
                columns[name] = Column(name, shown(item.attrs["units"]), words, axes)

    file.visititems(visit)
    if list(dimensions) not in ([DESIGN], list(file["grid"])):
        raise ValueError(
            f"it is over {', '.join(dimensions)}, and has values of {', '.join(file['grid'])}"
        )
    if len(columns) != _plain(attributes["columns"]):
        raise ValueError(f"it has {len(columns)} columns of {attributes['columns']}")
    sentences = parsed(status.attrs["sentences"], Mapping[str, str], "sentences")
    meanings = shown(status.attrs["flag_meanings"]).split()
    if len(meanings) != len(sentences):
        raise ValueError(f"it has {len(meanings)} words for {len(sentences)} statuses")
    order = sorted(columns, key=lambda name: (tuple(KINDS).index(name.partition(":")[0]), name))
    axes = dict.fromkeys(axis for name in reversed(order) for axis in columns[name].axes)
    return {
        "identity": identity,
        "dimensions": dimensions,
        "parameters": {name: shown(file["grid"][name].attrs["units"]) for name in file["grid"]},
        "axes": {axis: shown(file[axis].attrs["units"]) for axis in axes},
        "columns": {name: columns[name] for name in order},
        "statuses": {
            int(number): (word, sentence)
            for (number, sentence), word in zip(sentences.items(), meanings, strict=True)
        },
    }


def _plain(value: str | np.int64) -> str | int:
    return int(value) if isinstance(value, np.integer) else shown(value)

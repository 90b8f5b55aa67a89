"""Descriptions of datasets and files, beside numbers: units, meanings, signs and conventions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from ...base.quantities import Output
from ...base.tables import CF, Table

if TYPE_CHECKING:
    import h5py


def place_of(name: str | Output) -> str:
    """The place in a file of a quantity's full name."""
    return str(name).replace(":", "/")


def conventions(table: Table) -> dict[str, str]:
    """Attributes of a file as a whole."""
    return {"Conventions": CF, "conventions": table.conventions}


def say(dataset: h5py.Dataset, unit: str, words: Mapping[str, str]) -> None:
    """Write the unit of a dataset, and other words about it, by attribute."""
    dataset.attrs.update({"units": unit, **words})


def unlike(dataset: h5py.Dataset, unit: str, words: Mapping[str, str]) -> Iterator[str]:
    """Yield what a dataset says otherwise, a line each."""
    place = dataset.name.removeprefix("/")
    if not _states(dataset, "units", unit):
        yield f"{place}: units {dataset.attrs.get('units')!r}, expected {unit!r}"
    yield from (
        f"{place}: {key} differs from the schema"
        for key, text in words.items()
        if not _states(dataset, key, text)
    )


def without_scale(dataset: h5py.Dataset, axes: Sequence[str]) -> Iterator[str]:
    """Yield the axes of a dataset that have not the scales of given names, a line each."""
    for axis, scale in enumerate(axes):
        if dataset.file[scale] not in dataset.dims[axis].values():
            yield f"{dataset.name.removeprefix('/')}: axis {axis} has no scale /{scale}"


def unlike_conventions(file: h5py.File, table: Table) -> Iterator[str]:
    """Yield what a file says otherwise of all that it holds, a line each."""
    yield from (
        f"{key}: differs from the schema"
        for key, text in conventions(table).items()
        if not _states(file, key, text)
    )


def _states(item: h5py.HLObject, key: str, text: str) -> bool:
    """Return whether an attribute is a text; arrays are none."""
    value = item.attrs.get(key)
    return isinstance(value, str) and value == text

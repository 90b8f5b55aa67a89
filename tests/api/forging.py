"""Files changed as HDF5 allows, and sealed anew: what somebody would do who wants them believed."""

from __future__ import annotations

import contextlib

import h5py
from internals import opening

LISTS = ("DIMENSION_LIST", "REFERENCE_LIST")
"""What HDF5 keeps of axes: references, which are places in the file."""

OWN = (*LISTS, "CLASS", "NAME")
"""Attributes that HDF5 itself writes."""


def attributes(file):
    """Yield every attribute of a file but references: its place, name and value."""
    places = ["/"]
    file.visit(places.append)
    for place in places:
        for name, value in file[place].attrs.items():
            if name not in LISTS:
                yield place, name, value


@contextlib.contextmanager
def forging(path):
    """A file to change."""
    kind, content = opening.kind_of(path), path.read_bytes()
    assert kind
    path.write_bytes(content[: -opening.SIZE])
    with h5py.File(path, "r+") as file:
        yield file
    with path.open("ab") as file:
        opening.seal(file, kind)


def edit(path, change):
    """Change a file by a function of it."""
    with forging(path) as file:
        change(file)

"""Files changed as HDF5 allows, and sealed anew: what somebody would do who wants them believed."""

from __future__ import annotations

import contextlib

import h5py
from internals import opening


def unseal(path):
    """Take the seal off a file; what it is of."""
    kind, content = opening.kind_of(path), path.read_bytes()
    assert kind
    path.write_bytes(content[: -opening.SIZE])
    return kind


@contextlib.contextmanager
def forging(path):
    """A file to change."""
    kind = unseal(path)
    with h5py.File(path, "r+") as file:
        yield file
    with path.open("ab") as file:
        opening.seal(file, kind)


def edit(path, change):
    """Change a file by a function of it."""
    with forging(path) as file:
        change(file)


def flip(path, place, mask=1):
    """Flip bits of one byte, and leave the seal as it is."""
    content = bytearray(path.read_bytes())
    content[place] ^= mask
    path.write_bytes(content)

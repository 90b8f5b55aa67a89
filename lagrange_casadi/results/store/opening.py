"""Files of this program, HDF5 with a seal: one that is opened to read is held to its seal, its
schema and its version looked at, before anything is believed; one that is written is sealed.

The seal is the last 256 bytes of a file, text after HDF5's own end, where no reader of HDF5 looks:
what the file is of, how many bytes come before, and their digest, the SHA-256 of the SHA-256 of
every MiB, so that all cores can share the work. It is written last, so a file that has one was
finished.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from io import FileIO
from pathlib import Path
from typing import BinaryIO

import h5py
import numpy as np

from ...base.files import SIGNATURE, digest, is_locked, writing
from ...base.space import cores
from ...base.streams import check_regular
from ...errors import PathError, StoreError, check_kind, one_line
from .untrusted import check_links, reported_as, shown

VERSION = 1
"""Version of the schema of all kinds of files."""

RUN = "lagrange-casadi"
SWEEP, SEARCH, IDENTIFICATION = (f"{RUN}-{kind}" for kind in ("sweep", "optimum", "identification"))
KINDS = {
    RUN: ("the file of a run", "that of a run, which `load` reads"),
    SWEEP: ("the file of a sweep", "that of a sweep, which `Sweep.open` reads"),
    SEARCH: (
        "the file of a search",
        "that of a search for designs, which the command check reads",
    ),
    IDENTIFICATION: (
        "the file of an identification",
        "that of an identification, which the command check reads",
    ),
}
"""Names of files in messages by their schemas, and who reads them."""

SIZE = 256
"""Bytes of a seal."""

_SEAL = re.compile(
    rb"lagrange-casadi seal 1\nof (\S+)\nbytes \d+\n"
    rb"SHA-256 of the SHA-256 of every MiB [0-9a-f]{64}\n *\n"
)
_PIECE = 1 << 20
_FEW, _MOST = 4, 8
"""Pieces from which on another thread pays, and threads that outrun any memory."""


@dataclass(frozen=True)
class VerifiedFile:
    """A file that was verified: which, and when it was last changed."""

    device: int
    inode: int
    size: int
    changed: int

    @classmethod
    def of(cls, file: int | str | os.PathLike[str]) -> VerifiedFile:
        """Make it from a path, or the number of an open file. Raises ``OSError``."""
        status = os.stat(file)
        return cls(status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns)

    def is_at(self, path: str | os.PathLike[str]) -> bool:
        """Return whether the file is still there, unchanged."""
        try:
            return self == VerifiedFile.of(path)
        except OSError:
            return False


@contextmanager
def sealed(bytes_: BinaryIO, kind: str) -> Iterator[h5py.File]:
    """A file of a kind to write, which is sealed at the end.

    ``bytes_`` is a :class:`.PatientFile`, which raises failures of the disk when it is closed.
    """
    with h5py.File(bytes_, "w", track_order=True) as file:
        file.attrs.update({"schema": kind, "schema_version": VERSION})
        yield file
        file.flush()
        file.attrs["complete"] = True
    seal(bytes_, kind)


def seal(file: BinaryIO, kind: str) -> None:
    """Put the seal at the end of an open file that is otherwise finished. Raises ``OSError``."""
    file.write(_seal(file.name, kind, file.seek(0, os.SEEK_END)))


@contextmanager
def sealed_file(path: str | os.PathLike[str], kind: str) -> Iterator[h5py.File]:
    """A file of a kind to write, which replaces what is at the path whole or not at all.

    Raises :class:`PathError` where no file can be put, :class:`StoreError` where it cannot be
    written.
    """
    with writing(Path(path), hdf5=True) as bytes_, sealed(bytes_, kind) as file:
        yield file


@contextmanager
def opened_file(
    path: str | os.PathLike[str], kind: str, verified: VerifiedFile | None = None
) -> Iterator[h5py.File]:
    """Open a whole file of a kind.

    All of it is held to its seal, unless it is still the one that was ``verified``. Raises
    :class:`PathError` for none, :class:`StoreError` for one of another kind or version, and one
    that was not finished or is not as it was written; whatever reading it raises becomes a
    :class:`StoreError`.
    """
    if not verified or not verified.is_at(path):
        _refuse_other(path, kind_of(path) or kind, kind)
        verified = verify(path)
    with reported_as("damaged", path):
        try:
            file = h5py.File(path, "r")
        except BlockingIOError:
            raise StoreError(f"{path}: another program has it open to write") from None
        with file:
            if not verified.is_at(path):
                raise StoreError(f"{path}: was changed while it was read")
            _refuse_other(path, file.attrs.get("schema"), kind)
            written = file.attrs.get("schema_version")
            if not isinstance(written, np.integer) or written != VERSION:
                stored = written if isinstance(written, np.integer) else repr(written)
                raise StoreError(
                    f"{path}: schema version {stored}, this program reads version {VERSION}: run it"
                    " again"
                )
            if not file.attrs.get("complete", False):
                raise StoreError(f"{path}: was not written to its end")
            yield file


def kind_of(path: str | os.PathLike[str]) -> str | None:
    """Kind of a file, by its seal alone; None if there is no file, or none with a seal."""
    try:
        with _opened(path) as file:
            return _stated(file)[1]
    except (PathError, StoreError):
        return None


def verify(path: str | os.PathLike[str]) -> VerifiedFile:
    """Read all of a file, and hold it to its seal.

    Raises :class:`PathError` for no file, :class:`StoreError` for one that is damaged, has no seal,
    or was never of this package.
    """
    with _opened(path) as file:
        if is_locked(path):
            raise StoreError(f"{path}: another program has it open to write")
        found, (last, kind) = VerifiedFile.of(file.fileno()), _stated(file)
        if kind is None:
            raise StoreError(f"{path}: {_unsealed(file)}")
        if _seal(path, kind, found.size - SIZE) != last:
            raise StoreError(f"{path}: damaged: its bytes are not those that were written")
    return found


@contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[FileIO]:
    """A regular file to read; pipes and devices are not even opened."""
    check_kind("file", path, "a path", str, os.PathLike)
    check_regular(path)
    try:
        with open(path, "rb", buffering=0) as file:
            yield file
    except OSError as error:
        raise StoreError(f"{path}: cannot be read: {one_line(error)}") from None


def _stated(file: FileIO) -> tuple[bytes, str | None]:
    """The last bytes of a file, as many as a seal has, and the kind that they state; None where
    they are no seal.
    """
    file.seek(max(0, file.seek(0, os.SEEK_END) - SIZE))
    last = file.read(SIZE)
    found = _SEAL.fullmatch(last)
    return last, found[1].decode(errors="replace") if found else None


def _seal(path: str | os.PathLike[str], kind: str, length: int) -> bytes:
    """The seal of the first ``length`` bytes of a file."""

    def piece(start: int) -> bytes:
        with open(path, "rb") as file:
            file.seek(start)
            return sha256(file.read(min(_PIECE, length - start))).digest()

    starts = range(0, length, _PIECE)
    with ThreadPoolExecutor(min(cores(), _MOST, 1 + len(starts) // _FEW)) as pool:
        found = digest(f"{kind} {length}\n".encode(), *pool.map(piece, starts))
    text = (
        f"lagrange-casadi seal 1\nof {kind}\nbytes {length}\n"
        f"SHA-256 of the SHA-256 of every MiB {found}\n"
    )
    return text.encode().ljust(SIZE - 1) + b"\n"


def _unsealed(file: FileIO) -> str:
    """Describe the fault of a file that has no seal."""
    file.seek(0)
    if file.read(len(SIGNATURE)) != SIGNATURE:
        return "not a file of this program: it begins otherwise than HDF5"
    return (
        "it has no seal: damaged, cut short, changed by another program, or from before there were"
        " seals; run it again"
    )


def read_all(file: h5py.File) -> None:
    """Read all of a file.

    Raises what HDF5 does for one that is damaged, :class:`StoreError` for links that lead out of
    it, and ``ValueError`` for a text that cannot be shown.
    """
    check_links(file)
    _read("/", file)
    file.visititems(_read)


def _read(_place: str, item: h5py.Group | h5py.Dataset) -> None:
    """Read all of a part."""
    for value in item.attrs.values():
        for text in np.ravel(value):
            if not isinstance(text, np.generic) or isinstance(text, np.character):
                shown(str(text))
    if isinstance(item, h5py.Dataset):
        item[()]


def check_identification(path: str | os.PathLike[str]) -> list[str]:
    """Faults of the file of an identification, one line each; none if it is whole.

    Raises :class:`StoreError` for what is not a whole file of one, :class:`PathError` for none.
    """
    with opened_file(path, IDENTIFICATION) as file:
        read_all(file)
    return []


def _refuse_other(path: str | os.PathLike[str], found: object, kind: str) -> None:
    """Raise :class:`StoreError` for a file of another kind."""
    if found != kind:
        what = f"its attribute 'schema' is {found!r}"
        if isinstance(found, str) and found in KINDS:
            what = f"but {KINDS[found][1]}"
        raise StoreError(f"{path}: not {KINDS[kind][0]}, {what}")

"""Files of this program. One that is opened to read is held to its seal, its schema and its version
looked at, before anything is believed; one that is written is sealed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from ...base.publish import PatientFile, replacing
from ...base.seal import VerifiedFile, kind_of, seal, verify
from ...errors import StoreError
from .untrusted import check_links, reported_as, shown

SCHEMA = "lagrange-casadi"
IDENTIFICATION, IDENTIFICATION_VERSION = f"{SCHEMA}-identification", 1
_KNOWN = {
    SCHEMA: "that of a run, which `load` reads",
    f"{SCHEMA}-sweep": "that of a sweep, which `Sweep.open` reads",
    f"{SCHEMA}-optimum": "that of a search for designs, which the command check reads",
    IDENTIFICATION: "that of an identification, which the command check reads",
}


@contextmanager
def opened_file(
    path: str | os.PathLike[str],
    schema: str,
    version: int,
    kind: str,
    of: str = "",
    verified: VerifiedFile | None = None,
) -> Iterator[h5py.File]:
    """Open a whole file of a ``version`` of a schema, which messages call ``kind``, its version
    that ``of`` it.

    All of it is held to its seal, unless it is still the one that was ``verified``. Raises
    :class:`PathError` for none, :class:`StoreError` for another file, another version, and one that
    was not finished or is not as it was written; whatever reading it raises becomes a
    :class:`StoreError`.
    """
    if not verified or not verified.is_at(path):
        _refuse_other(path, kind_of(path) or schema, schema, kind)
        verified = verify(path)
    with reported_as("damaged", path):
        try:
            file = h5py.File(path, "r")
        except BlockingIOError:
            raise StoreError(f"{path}: another program has it open to write") from None
        with file:
            if not verified.is_at(path):
                raise StoreError(f"{path}: was changed while it was read")
            _refuse_other(path, file.attrs.get("schema"), schema, kind)
            written = file.attrs.get("schema_version")
            if not isinstance(written, np.integer) or written != version:
                stored = written if isinstance(written, np.integer) else repr(written)
                raise StoreError(
                    f"{path}: schema version {stored}{of}, this program reads version"
                    f" {version}: run it again"
                )
            if not file.attrs.get("complete", False):
                raise StoreError(f"{path}: was not written to its end")
            yield file


@contextmanager
def sealed_file(
    path: str | os.PathLike[str], schema: str, version: int, case: str
) -> Iterator[h5py.File]:
    """A file of a schema to write, of a case, which is sealed and then replaces what is at the path
    whole or not at all.

    Raises :class:`PathError` where no file can be put, :class:`StoreError` where it cannot be
    written.
    """
    with replacing(Path(path), hdf5=True) as draft:
        with PatientFile(draft, "x+") as bytes_, h5py.File(bytes_, "w", track_order=True) as file:
            file.attrs.update({"schema": schema, "schema_version": version, "case": case})
            yield file
            file.attrs["complete"] = True
        seal(draft, schema)


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
    kind = "the file of an identification"
    with opened_file(path, IDENTIFICATION, IDENTIFICATION_VERSION, kind) as file:
        read_all(file)
    return []


def _refuse_other(path: str | os.PathLike[str], found: str, schema: str, kind: str) -> None:
    """Raise :class:`StoreError` for a file of another schema."""
    if not isinstance(found, str) or found != schema:
        what = (
            f"but {_KNOWN[found]}"
            if isinstance(found, str) and found in _KNOWN
            else f"its attribute 'schema' is {found!r}"
        )
        raise StoreError(f"{path}: not {kind}, {what}")

"""One way to write a file: beside its place under another name, flushed, then renamed, so that it
appears whole or not at all; the lock and the digest of all that is kept.
"""

from __future__ import annotations

import hashlib
import io
import os
import platform
import re
import shutil
import stat
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from ..errors import BusyError, PathError, StoreError, one_line
from .streams import SOCKET, open_stream, stream_word

try:
    import fcntl
except ImportError:  # where there is none, nothing keeps two processes apart
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from typing_extensions import Buffer

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""The first bytes of HDF5."""

LOCK = "lock"
"""Name of the file by which a folder is held."""


def check_writable(target: Path, *, folder: bool = False, hdf5: bool = False) -> None:
    """Raise :class:`PathError` where no file (or folder) can be put at ``target``: said before
    anything is computed.

    What is no ``hdf5`` file itself replaces none; and it may go to a device or a pipe, which one of
    HDF5 may not. Raises :class:`BusyError` for an HDF5 file that another program writes.
    """
    try:
        stream, place = stream_word(target), settled(target)
        taken, whole = place.exists(), place.is_dir()
    except OSError as error:
        raise PathError(f"cannot write {target}: {error.strerror}") from None
    if stream and (hdf5 or stream == SOCKET):
        raise PathError(f"cannot write {target}: it is {stream}, not a file")
    if not folder and whole:
        raise PathError(f"cannot write {target}: it is a folder")
    if folder and (stream or (taken and not whole)):
        raise PathError(f"cannot write {target}: it is {stream or 'a file'}, not a folder")
    if stream:
        if not os.access(target, os.W_OK):
            raise PathError(f"cannot write {target}: it is not writable")
        return
    if not place.parent.is_dir():
        lacking = "is a file" if place.parent.exists() else "does not exist"
        raise PathError(f"cannot write {target}: folder {place.parent} {lacking}")
    if not folder and not hdf5 and is_hdf5(place):
        raise PathError(f"cannot write {target}: it is an HDF5 file; choose another name")
    if hdf5 and place.is_file() and is_locked(place):
        raise BusyError(f"cannot write {target}: another program has it open to write")
    for there in (place.parent, *([place] if whole else [])):
        if not os.access(there, os.W_OK):
            raise PathError(f"cannot write {target}: folder {there} is not writable")


def settled(target: Path) -> Path:
    """Resolve a path: a symbolic link stays, its target is written; ``.`` and ``..`` get a name."""
    nameless = target.name in ("", "..")
    return Path(os.path.realpath(target)) if nameless or os.path.islink(target) else target


def is_hdf5(path: Path) -> bool:
    """Return whether a file is HDF5, with or without a user block.

    Raises :class:`PathError` where it cannot be read.
    """
    if not path.is_file():
        return False
    try:
        path.open("rb").close()  # h5py says of what it cannot read that it is none
    except OSError as error:
        raise PathError(
            f"cannot write {path}: what is there cannot be read: {error.strerror}"
        ) from None
    import h5py

    return bool(h5py.is_hdf5(path))


class PatientFile(io.FileIO):
    """A file to write that keeps its first failure to itself, until :meth:`close` raises it.

    HDF5 does not survive a write that fails: it prints, and may crash when it closes. So it never
    hears of one.
    """

    failure: OSError | None = None

    def write(self, data: Buffer, /) -> int:
        """Write all of ``data``, or pass over as much."""
        view, done = memoryview(data).cast("B"), 0
        try:
            while self.failure is None and done < view.nbytes:
                done += super().write(view[done:])
        except OSError as error:
            self.failure = error
        if self.failure is not None:
            self.seek(view.nbytes - done, os.SEEK_CUR)
        return view.nbytes

    def truncate(self, size: int | None = None, /) -> int:
        """Cut or stretch the file, unless it has failed."""
        try:
            return super().truncate(size) if self.failure is None else size or 0
        except OSError as error:
            self.failure = error
            return size or 0

    def close(self) -> None:
        """Close the file, and raise what failed, once."""
        super().close()
        failure, self.failure = self.failure, None
        if failure is not None:
            raise failure


@contextmanager
def writing(target: Path, *, hdf5: bool = False, within: Path | None = None) -> Iterator[BinaryIO]:
    """A file to write, which is put into its place on success, and is none on any failure; on
    return it outlives a loss of power.

    What is a device, a pipe, or standard output is written straight to. One of ``hdf5`` is a
    :class:`PatientFile`. Until it is whole it is ``within`` a folder, by default that of its place.
    Raises as :func:`check_writable` does, and :class:`StoreError`.
    """
    check_writable(target, hdf5=hdf5)
    with reporting(target), ExitStack() as stack:
        if stream_word(target):
            yield stack.enter_context(open_stream(target))
            return
        place = settled(target)
        draft = stack.enter_context(beside((within or place.parent) / place.name)) / place.name
        with PatientFile(draft, "x+") if hdf5 else draft.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        put(draft, place)
        _flush(place.parent)


def put(draft: Path, target: Path) -> None:
    """Rename a file over ``target``, where nothing is or another file.

    Raises as :func:`refuse_other` does, ``OSError``.
    """
    refuse_other(target)
    os.replace(draft, target)


def refuse_other(target: Path) -> None:
    """Raise :class:`PathError` for what is there and not a file: a folder, a link, a device, a
    pipe.
    """
    if os.path.lexists(target) and not stat.S_ISREG(os.lstat(target).st_mode):
        raise PathError(f"cannot write {target}: what is there is not a file")


@contextmanager
def beside(target: Path) -> Iterator[Path]:
    """A folder for drafts of ``target``, held as long as its process lives; those that a kill has
    left are removed first.
    """
    # Locks may not reach another host that shares the disk, so drafts of its own have another
    # ending.
    prefix, suffix = f".{target.name}.", f".{zlib.crc32(platform.node().encode()):08x}"
    drafts = re.compile(rf"{re.escape(prefix)}[a-z0-9_]{{8}}{re.escape(suffix)}")
    for name in filter(drafts.fullmatch, os.listdir(target.parent)):
        with suppress(OSError), held(target.parent / name) as alone:
            if alone:
                shutil.rmtree(target.parent / name, ignore_errors=True)
    # Who takes it for one that was left may hold it, and remove it, as it is removed here.
    made = tempfile.TemporaryDirectory(
        dir=target.parent, prefix=prefix, suffix=suffix, ignore_cleanup_errors=True
    )
    with made as work, held(Path(work), wait=True):
        yield Path(work)


@contextmanager
def held(folder: Path, *, wait: bool = False) -> Iterator[bool]:
    """Hold a folder, made where it is not, by a lock that ends with its process, however that ends;
    whether this machine has locks.

    Raises ``BlockingIOError`` where another process holds it and ``wait`` is not asked for,
    ``OSError``.
    """
    path = folder / LOCK
    with ExitStack() as stack:
        while True:
            stack.close()
            try:
                file = stack.enter_context(path.open("ab"))
                able = _lock(file, wait=wait)
                if os.path.samestat(os.fstat(file.fileno()), os.stat(path)):
                    break
            except FileNotFoundError:  # nobody has held it yet, or who did has removed it
                folder.mkdir(exist_ok=True)
        yield able


def is_locked(path: str | os.PathLike[str]) -> bool:
    """Return whether another program has a file open to write, as HDF5 shows by a lock."""
    try:
        with open(path, "rb") as file:
            _lock(file, shared=True)
    except OSError as error:  # also of what cannot be read, or has no locks
        return isinstance(error, BlockingIOError)
    return False


def _lock(file: BinaryIO, *, shared: bool = False, wait: bool = False) -> bool:
    """Lock a file until it is closed; whether this machine has locks.

    Raises ``BlockingIOError`` where another process holds it and ``wait`` is not asked for.
    """
    if fcntl is None:
        return False
    kind = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
    fcntl.flock(file, kind if wait else kind | fcntl.LOCK_NB)
    return True


def digest(*contents: bytes) -> str:
    """The SHA-256 of contents, one after another."""
    found = hashlib.sha256()
    for content in contents:
        found.update(content)
    return found.hexdigest()


@contextmanager
def reporting(target: Path) -> Iterator[None]:
    """Say failures of the disk in one line: raise :class:`StoreError` for ``OSError``."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else one_line(error)
        raise StoreError(f"cannot write {target}: {reason}") from None


def _flush(folder: Path) -> None:
    """Wait until the names in a folder are on the disk. Raises ``OSError``."""
    if hasattr(os, "O_DIRECTORY"):  # else a folder cannot be opened
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)

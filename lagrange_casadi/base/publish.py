"""Files that appear whole or not at all: written under another name beside their place, then
renamed.
"""

from __future__ import annotations

import io
import os
import platform
import re
import shutil
import signal
import stat
import tempfile
import threading
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from ..errors import BusyError, PathError, StoreError, one_line
from .interrupts import interrupts
from .locks import lock
from .seal import SIGNATURE, is_held
from .streams import SOCKET, open_stream, stream_word

if TYPE_CHECKING:
    from typing_extensions import Buffer


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
    if hdf5 and place.is_file() and is_held(place):
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
        with path.open("rb") as file:
            size, place = file.seek(0, os.SEEK_END), 0
            while place < size:
                file.seek(place)
                if file.read(len(SIGNATURE)) == SIGNATURE:
                    return True
                place = 2 * place or 512
            return False
    except OSError as error:
        raise PathError(
            f"cannot write {path}: what is there cannot be read: {error.strerror}"
        ) from None


def put(draft: Path, target: Path) -> None:
    """Rename a file over ``target``, where nothing is or another file.

    Raises :class:`PathError` for anything else, ``OSError``.
    """
    _refuse_other(target)
    os.replace(draft, target)


@contextmanager
def replacing(target: Path, *, hdf5: bool = False) -> Iterator[Path]:
    """A temporary file to write, renamed to ``target`` on success and removed on any failure."""
    check_writable(target, hdf5=hdf5)
    place = settled(target)
    with reporting(target), _beside(place) as work:
        draft = work / place.name
        yield draft
        flush(draft)
        put(draft, place)


@contextmanager
def writing(*targets: Path) -> Iterator[list[BinaryIO]]:
    """Files to write, which are put into their places together on success, and are none on any
    failure.

    What is a device, a pipe, or standard output is written straight to. Raises as
    :func:`check_writable` does, and :class:`StoreError`.
    """
    for target in targets:
        check_writable(target)
    with reporting(*targets), ExitStack() as stack:
        files: list[BinaryIO] = []
        drafts: list[tuple[Path, Path]] = []
        for target in targets:
            if stream_word(target):
                files.append(stack.enter_context(open_stream(target)))
                continue
            place = settled(target)
            draft = stack.enter_context(_beside(place)) / place.name
            files.append(stack.enter_context(draft.open("wb")))
            drafts.append((draft, place))
        yield files
        for file in files:
            file.close()
        for draft, _ in drafts:
            flush(draft)
        for draft, place in drafts:
            put(draft, place)


@contextmanager
def uninterrupted() -> Iterator[Callable[[], None]]:
    """Hold interrupts back, for HDF5 does not survive an exception in its midst.

    What is yielded lets one through where it is called; one that nobody let through comes at the
    end.
    """
    noticed = threading.Event()

    def breathe() -> None:
        if noticed.is_set():
            raise KeyboardInterrupt

    repeated = [signal.SIGALRM] if hasattr(signal, "SIGALRM") else []
    able = threading.current_thread() is threading.main_thread()
    before = (
        [
            (number, signal.signal(number, lambda *_: noticed.set()))
            for number in (*interrupts(), *repeated)
        ]
        if able
        else []
    )
    try:
        yield breathe
    finally:
        for number, handler in before:
            signal.signal(number, handler)
    breathe()


class PatientFile(io.FileIO):
    """A file to write that keeps its first failure to itself, until :meth:`close` raises it.

    HDF5 does not survive a write that fails: it prints, and may crash when it closes. So it never
    hears of one.
    """

    failure: OSError | None = None

    def write(self, data: Buffer, /) -> int:
        """Write all of ``data``, or pass over as much."""
        view = memoryview(data).cast("B")
        try:
            done = 0
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
def filling(folder: Path, first: str = "") -> Iterator[Path]:
    """A temporary folder to fill, which on success becomes ``folder``, or whose files move into it;
    on any failure it is removed.

    Into a folder that is there, the file of the name ``first`` moves before the others.
    """
    check_writable(folder, folder=True)
    place = settled(folder)
    # What is mounted there takes no file from beside it by a new name.
    within = place / place.name if os.path.ismount(place) else place
    with reporting(folder), _beside(within) as work:
        draft = work / place.name
        draft.mkdir()
        yield draft
        if not os.path.lexists(place):
            os.rename(draft, place)
            return
        check_free(draft, folder)
        for file in sorted(draft.iterdir(), key=lambda file: (file.name != first, file)):
            put(file, folder / file.name)


def check_free(work: Path, folder: Path) -> None:
    """Raise :class:`PathError` where something in ``folder``, such as a folder, bears the name of a
    file in ``work``.
    """
    for name in sorted(draft.name for draft in work.iterdir()):
        _refuse_other(folder / name)


def _refuse_other(target: Path) -> None:
    """Raise :class:`PathError` for what is there and not a file: a folder, a link, a device, a
    pipe.
    """
    if os.path.lexists(target) and not stat.S_ISREG(os.lstat(target).st_mode):
        raise PathError(f"cannot write {target}: what is there is not a file")


@contextmanager
def _beside(target: Path) -> Iterator[Path]:
    """A folder for drafts of ``target``, locked as long as its process lives; those that a kill has
    left are removed first.
    """
    # Locks may not reach another host that shares the disk, so drafts of its own have another
    # ending.
    prefix, suffix = f".{target.name}.", f".{zlib.crc32(platform.node().encode()):08x}"
    drafts = re.compile(rf"{re.escape(prefix)}[a-z0-9_]{{8}}{re.escape(suffix)}")
    for name in filter(drafts.fullmatch, os.listdir(target.parent)):
        with ExitStack() as locks:
            if _lock(target.parent / name, locks, wait=False):
                shutil.rmtree(target.parent / name, ignore_errors=True)
    while True:
        with (
            ExitStack() as locks,
            tempfile.TemporaryDirectory(dir=target.parent, prefix=prefix, suffix=suffix) as work,
        ):
            _lock(Path(work), locks, wait=True)
            if os.path.isdir(
                work
            ):  # else another process took it for one that was left, before it was locked
                yield Path(work)
                return


def _lock(folder: Path, locks: ExitStack, *, wait: bool) -> bool:
    """Lock a folder until ``locks`` are closed; whether that was done.

    It is not where another process holds it, or nothing can.
    """
    if not hasattr(os, "O_DIRECTORY"):  # nor are there locks
        return False
    try:
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        locks.callback(os.close, number)
        return lock(number, wait=wait) and os.path.samestat(os.fstat(number), os.stat(folder))
    except OSError:
        return False


@contextmanager
def reporting(*targets: Path) -> Iterator[None]:
    """Say failures of the disk in one line: raise :class:`StoreError` for ``OSError``."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else one_line(error)
        raise StoreError(f"cannot write {' and '.join(map(str, targets))}: {reason}") from None


def flush(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk. Raises ``OSError``."""
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)

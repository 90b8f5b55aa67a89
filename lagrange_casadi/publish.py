"""Files that appear whole or not at all: written under another name beside their place, then renamed."""

from __future__ import annotations

import io
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .errors import PathError, StoreError, one_line
from .interrupts import interrupts

_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def check_writable(target: Path, *, folder: bool = False, hdf5: bool = False) -> None:
    """Raise :class:`PathError` where no file (or folder) can be put at ``target``: said before anything is computed.

    What is no ``hdf5`` file itself replaces none.
    """
    try:
        taken, whole = target.exists() or target.is_symlink(), target.is_dir()
    except OSError as error:
        raise PathError(f"cannot write {target}: {error.strerror}") from None
    if not folder and whole:
        raise PathError(f"cannot write {target}: it is a folder")
    if folder and taken and not whole:
        raise PathError(f"cannot write {target}: it is a file, not a folder")
    if not target.parent.is_dir():
        lacking = "is a file" if target.parent.exists() else "does not exist"
        raise PathError(f"cannot write {target}: folder {target.parent} {lacking}")
    if not folder and not hdf5 and _is_hdf5(target):
        raise PathError(f"cannot write {target}: it is an HDF5 file; choose another name")
    for place in (target.parent, *([target] if target.is_dir() else [])):
        if not os.access(place, os.W_OK):
            raise PathError(f"cannot write {target}: folder {place} is not writable")


def _is_hdf5(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(_SIGNATURE)) == _SIGNATURE
    except OSError:
        return False


@contextmanager
def replacing(target: Path, *, hdf5: bool = False) -> Iterator[Path]:
    """A temporary file to write, renamed to ``target`` on success and removed on any failure."""
    check_writable(target, hdf5=hdf5)
    with telling(target), _beside(target) as work:
        draft = work / target.name
        yield draft
        with draft.open("rb") as written:
            os.fsync(written.fileno())
        os.replace(draft, target)


@contextmanager
def uninterrupted() -> Iterator[Callable[[], None]]:
    """Hold interrupts back, for HDF5 does not survive an exception in its midst.

    What is yielded lets one through where it is called; one that nobody let through comes at the end.
    """
    seen = threading.Event()

    def breathe() -> None:
        if seen.is_set():
            raise KeyboardInterrupt

    repeated = [signal.SIGALRM] if hasattr(signal, "SIGALRM") else []
    able = threading.current_thread() is threading.main_thread()
    before = [(number, signal.signal(number, lambda *_: seen.set())) for number in (*interrupts(), *repeated)] if able else []
    try:
        yield breathe
    finally:
        for number, handler in before:
            signal.signal(number, handler)
    breathe()


class PatientFile(io.FileIO):
    """A file to write that keeps its first failure to itself, until :meth:`close` raises it.

    HDF5 does not survive a write that fails: it prints, and may crash when it closes. So it never hears of one.
    """

    failure: OSError | None = None

    def write(self, data: Any, /) -> int:
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
def filling(folder: Path) -> Iterator[Path]:
    """A temporary folder to fill, whose files move into ``folder`` on success and are removed on any failure."""
    check_writable(folder, folder=True)
    # What is mounted there takes no file from beside it by a new name.
    within = folder / folder.name if os.path.ismount(folder) else folder
    with telling(folder), _beside(within) as work:
        yield work
        folder.mkdir(exist_ok=True)
        for draft in sorted(work.iterdir()):
            os.replace(draft, folder / draft.name)


@contextmanager
def _beside(target: Path) -> Iterator[Path]:
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}.") as work:
        yield Path(work)


@contextmanager
def telling(target: Path) -> Iterator[None]:
    """Say failures of the disk in one line: raise :class:`StoreError` for ``OSError``."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else one_line(error)
        raise StoreError(f"cannot write {target}: {reason}") from None

"""The seal of a file: shows, before HDF5 reads a byte, that the file is as it was written.

It is the last 256 bytes of a file, text after HDF5's own end, where no reader of HDF5 looks: what
the file is of, how many bytes come before, and their digest, the SHA-256 of the SHA-256 of every
MiB, so that all cores can share the work. It is written last, so a file that has one was finished.
"""

from __future__ import annotations

import hashlib
import os
import threading
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path

from ..errors import PathError, StoreError, check_kind, one_line
from .locks import lock
from .space import cores
from .streams import check_regular

SIZE = 256
"""Bytes of a seal."""

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""The first bytes of HDF5."""

_MAGIC = b"lagrange-casadi seal 1\n"
_PIECE = 1 << 20
_FEW, _MOST = 4, 8
"""Pieces from which on another thread pays, and threads that outrun any memory."""


@dataclass(frozen=True)
class Seal:
    """Contents of a seal: the ``kind`` of the file, the number of bytes before the seal, and their
    digest.
    """

    kind: str
    length: int
    digest: str

    @classmethod
    def of(cls, file: FileIO, kind: str, length: int) -> Seal:
        """The seal of the first ``length`` bytes of a file."""
        file.seek(0)
        digest = hashlib.sha256(b"".join([f"{kind} {length}\n".encode(), *_digests(file, length)]))
        return cls(kind, length, digest.hexdigest())

    @classmethod
    def read(cls, text: bytes) -> Seal | None:
        """The seal that the last bytes of a file are, None where they are none.

        Raises ``ValueError`` for one that is damaged.
        """
        if not text.startswith(_MAGIC):
            return None
        kind, length, digest = (
            line.rpartition(" ")[2] for line in text.decode("ascii").split("\n")[1:4]
        )
        found = cls(kind, int(length), digest)
        if found.text != text:
            raise ValueError("damaged")
        return found

    @property
    def text(self) -> bytes:
        """Text of the seal in the file."""
        lines = (
            f"of {self.kind}\nbytes {self.length}\nSHA-256 of the SHA-256 of every MiB"
            f" {self.digest}\n"
        )
        return (_MAGIC + lines.encode()).ljust(SIZE - 1) + b"\n"


@dataclass(frozen=True)
class VerifiedFile:
    """A file that was verified: which, and when it was last changed."""

    device: int
    inode: int
    size: int
    changed: int

    @classmethod
    def of(cls, status: os.stat_result) -> VerifiedFile:
        """Make it from the system's description of a file."""
        return cls(status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns)

    def is_at(self, path: str | os.PathLike[str]) -> bool:
        """Return whether the file is still there, unchanged."""
        try:
            return self == VerifiedFile.of(os.stat(path))
        except OSError:
            return False


def seal(path: Path, kind: str) -> VerifiedFile:
    """Put the seal at the end of a file that is otherwise finished, which is as good as verified
    then. Raises ``OSError``.
    """
    with path.open("r+b", buffering=0) as file, ThreadPoolExecutor(1) as aside:
        written = aside.submit(os.fsync, file.fileno())  # the disk works meanwhile
        found = Seal.of(file, kind, file.seek(0, os.SEEK_END))
        written.result()
        file.write(found.text)
        return VerifiedFile.of(os.fstat(file.fileno()))


def kind_of(path: str | os.PathLike[str]) -> str | None:
    """Kind of a file, by its seal alone; None if there is no file, or none with a whole seal."""
    try:
        with _opened(path) as file:
            found = _at_the_end(path, file)
    except (PathError, StoreError):
        return None
    return found.kind if found else None


def verify(path: str | os.PathLike[str]) -> VerifiedFile:
    """Read all of a file, and hold it to its seal.

    Raises :class:`PathError` for no file, :class:`StoreError` for one that is damaged, has no seal,
    or was never of this package.
    """
    with _opened(path) as file:
        if is_held(path):
            raise StoreError(f"{path}: another program has it open to write")
        there, found = os.fstat(file.fileno()), _at_the_end(path, file)
        if found is None:
            raise StoreError(f"{path}: {_unsealed(file)}")
        if there.st_size != found.length + SIZE:
            raise StoreError(
                f"{path}: damaged: it has {there.st_size} bytes, and had {found.length + SIZE}"
            )
        if Seal.of(file, found.kind, found.length) != found:
            raise StoreError(f"{path}: damaged: its bytes are not those that were written")
    return VerifiedFile.of(there)


def is_held(path: str | os.PathLike[str]) -> bool:
    """Return whether another program has a file open to write, as HDF5 shows by a lock."""
    try:
        with open(path, "rb") as file:
            lock(file.fileno(), shared=True)
    except BlockingIOError:
        return True
    except OSError:  # what cannot be read, or has no locks
        return False
    return False


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


def _at_the_end(path: str | os.PathLike[str], file: FileIO) -> Seal | None:
    """The seal of a file. Raises :class:`StoreError` for one that is damaged."""
    file.seek(max(0, file.seek(0, os.SEEK_END) - SIZE))
    try:
        return Seal.read(file.read(SIZE))
    except ValueError:
        raise StoreError(f"{path}: damaged: its seal cannot be read") from None


def _unsealed(file: FileIO) -> str:
    """Describe the fault of a file that has no seal."""
    file.seek(0)
    if file.read(len(SIGNATURE)) != SIGNATURE:
        return "not a file of this program: it begins otherwise than HDF5"
    return (
        "it has no seal: cut short, changed by another program, or from before there were seals;"
        " run it again"
    )


def _digests(file: FileIO, length: int) -> list[bytes]:
    """The digests of the pieces of a file from here on.

    Threads take turns to read, so that it is read in order.
    """
    sizes = [min(_PIECE, length - start) for start in range(0, length, _PIECE)]
    found, numbers, turn = [b""] * len(sizes), iter(range(len(sizes))), threading.Lock()

    def work(_: int) -> None:
        buffer = memoryview(bytearray(_PIECE))
        while True:
            with turn:
                number = next(numbers, None)
                if number is None:
                    return
                try:
                    piece = buffer[: _fill(file, buffer[: sizes[number]])]
                except BaseException:
                    deque(numbers, 0)  # no other thread goes on
                    raise
            found[number] = hashlib.sha256(piece).digest()

    threads = min(cores(), _MOST, 1 + len(sizes) // _FEW)
    if threads == 1:
        work(0)
        return found
    with ThreadPoolExecutor(threads) as pool:
        try:
            list(pool.map(work, range(threads)))
        finally:  # nor after an interrupt
            with turn:
                deque(numbers, 0)
    return found


def _fill(file: FileIO, buffer: memoryview) -> int:
    """Read as much as there is room for, or as there is left; how many bytes that was."""
    done = 0
    while done < len(buffer) and (count := file.readinto(buffer[done:])):
        done += count
    return done

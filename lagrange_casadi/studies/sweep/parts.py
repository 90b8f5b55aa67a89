"""Committed parts of a sweep: a folder of parts, each whole or absent, and a lock on it that ends
with its process.

A part holds the columns of the designs from ``start`` to before ``stop``: a line of JSON that
describes them, a line that is the SHA-256 of that line, and then the columns one after another, as
chunks of the file, each with a CRC-32 of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, TypedDict

from ...base.locks import lock
from ...base.publish import flush, put, reporting, settled
from ...errors import BusyError, PathError, StoreError, one_line
from ...results.store.attributes import described
from ...results.store.untrusted import parsed
from .columns import Column
from .plan import IDENTITY, Identity


class _Head(TypedDict):
    """First line of a part: its designs, and the place and length of each column."""

    start: int
    stop: int
    columns: dict[str, list[int]]


_HEAD = {"start": int, "stop": int, "columns": {str: [int, int]}}
_PLAN, _LOCK, _FORCED, _JOINED, _DRAFT, _PART = (
    "plan.json",
    "lock",
    "forced",
    "joined.h5",
    ".draft",
    ".part",
)


@dataclass(frozen=True)
class Part:
    """A committed part: its designs, how many bytes their columns take, and the columns' names."""

    path: Path
    start: int
    stop: int
    size: int
    columns: tuple[str, ...] = ()

    def read(self) -> list[bytes]:
        """Columns of the part.

        Where one is not what was committed the part is deleted: raises :class:`StoreError`.
        """
        try:
            contents, flaw = self._read()
        except OSError as error:
            raise StoreError(f"cannot read {self.path}: {one_line(error)}") from None
        if flaw:
            self.path.unlink()
            raise StoreError(f"{self.path} was damaged, in {flaw}, and is deleted")
        return contents

    def flaw(self) -> str | None:
        """Differences from what was committed; nothing is deleted."""
        return self._read()[1]

    def _read(self) -> tuple[list[bytes], str | None]:
        with self.path.open("rb") as file:
            try:
                columns: dict[str, list[int]] = _head(file)["columns"]
            except ValueError:
                return [], "head"
            contents = [file.read(length) for length, _ in columns.values()]
        sums = zip(columns.items(), contents, strict=True)
        return contents, next(
            (
                f"column {name}"
                for (name, (_, checksum)), content in sums
                if zlib.crc32(content) != checksum
            ),
            None,
        )


@dataclass(frozen=True)
class Folder:
    """The folder of the parts of the sweep into ``target``."""

    target: Path

    @classmethod
    def of(cls, target: Path) -> Folder:
        """Resolve a path, so that a symbolic link stays one."""
        return cls(settled(target))

    @property
    def path(self) -> Path:
        """Path of the folder."""
        return self.target.with_name(f"{self.target.name}.parts")

    @property
    def joined(self) -> Path:
        """Path of the file before it is in its place."""
        return self.path / _JOINED

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder, made where it is not, and removed where no part is left in it.

        Raises :class:`BusyError` where another process holds it.
        """
        with reporting(self.target):
            self._refuse_foreign()
            number = self._lock()
        try:
            yield
        finally:
            # After the folder was removed, another sweep may have made it anew: then its lock is
            # not this one.
            if self._is_held(number) and not list(self.path.glob(f"*{_PART}")):
                self.remove()
            os.close(number)

    def _refuse_foreign(self) -> None:
        """Raise :class:`PathError` where the folder holds what no sweep put there."""
        names = sorted(path.name for path in self.path.iterdir()) if self.path.is_dir() else []
        for name in names:
            if name not in (_PLAN, _LOCK, _FORCED, _JOINED) and not name.endswith((_PART, _DRAFT)):
                raise PathError(
                    f"{self.path} holds '{name}', which is not part of a sweep: move it, or write"
                    " to another file"
                )

    def _lock(self) -> int:
        while True:
            self.path.mkdir(exist_ok=True)
            try:
                number = os.open(self.path / _LOCK, os.O_RDWR | os.O_CREAT, 0o666)
            except FileNotFoundError:
                continue
            try:
                lock(number)
                # Another sweep may have ended, and removed the folder, between the two calls.
                if self._is_held(number):
                    return number
            except BlockingIOError:
                os.close(number)
                raise BusyError(
                    f"another sweep is writing {self.target}: wait for it, or write another file"
                ) from None
            os.close(number)

    def _is_held(self, number: int) -> bool:
        """Return whether the open lock is the folder's."""
        try:
            return os.path.samestat(os.fstat(number), os.stat(self.path / _LOCK))
        except FileNotFoundError:
            return False

    @property
    def begun(self) -> bool:
        """True if a sweep was begun here."""
        return os.path.isfile(self.path / _PLAN)  # of a name that is too long too

    @property
    def identity(self) -> Identity:
        """Identity of the parts. Raises :class:`StoreError` if it cannot be read."""
        try:
            found: Identity = parsed((self.path / _PLAN).read_text(), IDENTITY, "plan")
            described(found["mechanism"])
        except (OSError, ValueError, RecursionError) as error:
            raise StoreError(
                f"{self.path / _PLAN}: damaged: {one_line(error)}; start anew with force=True"
            ) from None
        return found

    @property
    def forced(self) -> bool:
        """True if a file that was there when the sweep began is to be replaced."""
        return (self.path / _FORCED).is_file()

    def begin(self, identity: Identity, *, forced: bool = False) -> None:
        """Say what the parts will be of, and remove what is there of another sweep."""
        with reporting(self.target):
            self._clear()
            if forced:
                (self.path / _FORCED).touch()
            self._publish(_PLAN, [json.dumps(identity, indent=1).encode()])

    def commit(
        self, start: int, stop: int, columns: Sequence[Column], contents: Sequence[bytes]
    ) -> Part:
        """Commit a block: on return it outlives a kill and a loss of power.

        Raises :class:`StoreError` where that fails.
        """
        name = _name(start, stop)
        sums = {
            column.name: (len(content), zlib.crc32(content))
            for column, content in zip(columns, contents, strict=True)
        }
        head = json.dumps({"start": start, "stop": stop, "columns": sums}).encode()
        lines = head + b"\n" + hashlib.sha256(head).hexdigest().encode() + b"\n"
        with reporting(self.target):
            self._publish(name, [lines, *contents])
        return Part(self.path / name, start, stop, sum(map(len, contents)), tuple(sums))

    def parts(self) -> list[Part]:
        """The parts that are whole, in order; what is not is removed.

        Their columns are checked where they are read.
        """
        found: list[Part] = []
        for path, part in self._looked_through():
            if part is None:
                path.unlink()
            else:
                found.append(part)
        for draft in self.path.glob(f"*{_DRAFT}"):
            draft.unlink()
        return found

    def done(self) -> int:
        """Number of designs of the whole parts; nothing is changed, so a sweep may be at work
        meanwhile.
        """
        return sum(part.stop - part.start for _, part in self._looked_through() if part)

    def flaws(self) -> Iterator[str]:
        """Faults of the parts, a line each; all is read, and nothing touched."""
        for path, part in self._looked_through():
            try:
                flaw = (
                    part.flaw()
                    if part
                    else "its header or length, or an earlier one has the same designs"
                )
            except FileNotFoundError:  # a sweep at work has come to its end
                continue
            if flaw:
                yield f"{path.name}: damaged in {flaw}: it will be done again"

    def _looked_through(self) -> Iterator[tuple[Path, Part | None]]:
        after = 0
        for path in sorted(self.path.glob(f"*{_PART}")):
            part = _whole(path)
            if part and part.start < after:
                part = None
            yield path, part
            after = part.stop if part else after

    def publish(self) -> None:
        """Put the joined file into its place, and remove the folder."""
        with reporting(self.target):
            flush(self.joined)
            put(self.joined, self.target)
            flush(self.target.parent)
        self.remove()

    def remove(self) -> None:
        """Remove the folder; the lock goes last."""
        with suppress(OSError):
            # The plan last: by it the next run knows that the file is whole, and ends the removal.
            self._clear(plan_last=True)
            shutil.rmtree(self.path)

    def _clear(self, *, plan_last: bool = False) -> None:
        # The plan first: without it, what else is left is nobody's.
        for path in sorted(self.path.iterdir(), key=lambda path: (path.name == _PLAN) == plan_last):
            if path.name != _LOCK:
                path.unlink()

    def _publish(self, name: str, contents: Sequence[bytes | memoryview]) -> None:
        draft = self.path / f"{name}{_DRAFT}"
        try:
            with draft.open("wb") as file:
                for content in contents:
                    file.write(content)
                file.flush()
                os.fsync(file.fileno())
            os.replace(draft, self.path / name)
        except OSError:
            with suppress(OSError):
                draft.unlink()
            raise
        flush(self.path)


def _name(start: int, stop: int) -> str:
    return f"{start:012d}-{stop:012d}{_PART}"


def _whole(path: Path) -> Part | None:
    """A part, unless its head is not what was committed, or its length."""
    if not path.is_file():
        return None
    try:
        with path.open("rb") as file:
            head = _head(file)
            start, stop, columns = head["start"], head["stop"], head["columns"]
            size = sum(length for length, _ in columns.values())
            whole = os.fstat(file.fileno()).st_size == file.tell() + size and path.name == _name(
                start, stop
            )
        return Part(path, start, stop, size, tuple(columns)) if whole else None
    except (OSError, ValueError):
        return None


def _head(file: BinaryIO) -> _Head:
    """Head of a part. Raises ``ValueError`` if it is damaged."""
    head, digest = file.readline(), file.readline()
    if hashlib.sha256(head[:-1]).hexdigest().encode() != digest[:-1]:
        raise ValueError("damaged")
    try:
        content: _Head = parsed(head, _HEAD, "head")
    except RecursionError:
        raise ValueError("damaged") from None
    if not 0 <= content["start"] < content["stop"] or any(
        length < 0 for length, _ in content["columns"].values()
    ):
        raise ValueError("damaged")
    return content

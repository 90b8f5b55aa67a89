"""Journal of a search: a file beside its result, a line for every finished run, each whole or
absent.

The first line describes the search. Every line begins with the CRC-32 of the rest.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from ...base.arrays import Json
from ...base.locks import lock
from ...base.publish import check_writable, reporting, settled
from ...errors import BusyError, PathError, StoreError
from ...results.store.untrusted import check_shape
from ..sweep.plan import difference
from .search_run import WORDS, SearchRun
from .solver import SearchTask

_FIRST = b' {"identity": '
"""Beginning of the first line after its checksum."""


def journal_of(target: Path) -> Path:
    """Path of the journal of a search into ``target``."""
    place = settled(target)
    return place.with_name(f"{place.name}.journal")


@dataclass(eq=False)
class Journal:
    """The ways that were gone, by what they are of.

    One without a ``file`` keeps them in memory alone.
    """

    target: Path | None = None
    file: IO[bytes] | None = None
    known: dict[str, SearchRun] = field(default_factory=dict)

    def get(self, task: SearchTask) -> SearchRun | None:
        """The way of an errand, where it was gone."""
        return self.known.get(_key(task))

    def put(self, task: SearchTask, run: SearchRun) -> None:
        """Keep a way: on return it outlives a kill.

        Raises :class:`StoreError` where it cannot be written.
        """
        key = _key(task)
        self.known[key] = run
        if self.file is not None and self.target is not None:
            with reporting(journal_of(self.target)):
                self.file.write(_line({"of": key, "trail": run.words}))
                self.file.flush()
                os.fsync(self.file.fileno())

    def remove(self) -> None:
        """Remove it: what it is of is done."""
        self.known.clear()


@contextmanager
def kept(
    target: Path | None, identity: Mapping[str, Json], *, resume: bool, force: bool
) -> Iterator[Journal]:
    """The journal of a search into ``target``, locked; nothing is kept on disk where that is None.

    It is removed where nothing is in it. One whose first line a kill cut short holds nothing, and a
    new one takes its place. Raises :class:`PathError` where one is there and neither ``resume`` nor
    ``force`` is asked for, :class:`StoreError` where it is of another search, :class:`BusyError`
    where another process writes it.
    """
    if target is None:
        yield Journal()
        return
    check_writable(target, hdf5=True)
    path = journal_of(target)
    with reporting(path):
        begun = path.exists() and not (path.is_file() and _holds_nothing(path.read_bytes()))
    if begun and not (resume or force):
        raise PathError(
            f"{path} is of an unfinished search: continue with resume=True, or start anew with"
            " force=True"
        )
    journal, ours = Journal(target), False
    try:
        with reporting(path), path.open("a+b") as file:
            try:
                lock(file.fileno())
            except BlockingIOError:
                raise BusyError(
                    f"another search is writing {target}: wait for it, or write another file"
                ) from None
            journal.file = file
            file.seek(0)
            ours = force or _holds_nothing(file.read())
            if force or not _read(journal, path, identity):
                file.truncate(0)
                file.write(_line({"identity": identity}))
                file.flush()
            ours = True
            yield journal
    finally:
        if ours and not journal.known:
            path.unlink(missing_ok=True)


def _read(journal: Journal, path: Path, identity: Mapping[str, Json]) -> bool:
    """Read what is there; whether it is of anything.

    Raises :class:`StoreError` where it is of another search.
    """
    assert journal.file is not None
    journal.file.seek(0)
    content = journal.file.read()
    lines = [words for line in content.splitlines() if (words := _words(line)) is not None]
    if content and not content.endswith(b"\n"):
        journal.file.write(b"\n")  # a line that a kill cut short is none
    if not lines or "identity" not in lines[0]:
        if not _holds_nothing(content):
            raise StoreError(
                f"{path} is not the file of a search, or is damaged: force=True replaces it"
            )
        return False
    for words in lines:
        if "trail" in words:
            journal.known[words["of"]] = SearchRun.read(words["trail"])
        elif found := difference(words["identity"], identity):
            raise StoreError(
                f"{path} is of another search: {found}; start anew with force=True, or write"
                " another file"
            )
    return True


def _holds_nothing(content: bytes) -> bool:
    """Return whether a journal is empty, or has the beginning of its first line alone, which a kill
    cut short.
    """
    checksum, said = content[:8], content[8:]
    cut = said.startswith(_FIRST) or _FIRST.startswith(said)
    return b"\n" not in content and cut and all(digit in b"0123456789abcdef" for digit in checksum)


def _line(words: Mapping[str, Json]) -> bytes:
    text = json.dumps(words).encode()
    return f"{zlib.crc32(text):08x} ".encode() + text + b"\n"


def _words(line: bytes) -> Any:
    """Contents of a line; None if it is not whole."""
    checksum, _, text = line.partition(b" ")
    if checksum != f"{zlib.crc32(text):08x}".encode():
        return None
    try:
        words = json.loads(text)
        check_shape(
            words, {"identity": {}} if "identity" in words else {"of": str, "trail": WORDS}, "line"
        )
    except (ValueError, RecursionError, TypeError):
        return None
    return words


def _key(task: SearchTask) -> str:
    problem = task.problem
    key = [
        str(problem.objective),
        [c.words for c in problem.constraints],
        task.start,
        task.scales,
    ]
    return json.dumps(key)

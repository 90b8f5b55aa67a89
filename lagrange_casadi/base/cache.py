"""The user's cache folder: what was derived and built before, kept whole or not at all, and no more
of it than fits a limit.

All files of one thing begin with the same hash. What was used longest ago goes first. Any number of
processes may read, keep and remove at once: a thing of which a file is gone is not there, and is
made again; one that is open, or loaded, stays so.

Code is loaded from it, so nobody else may be able to write it: where somebody may, a temporary
folder serves this process.
"""

from __future__ import annotations

import atexit
import functools
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ..errors import DeclarationError, PathError, lacking, warn
from .files import LOCK, beside, digest
from .numerals import real

VARIABLE = "LAGRANGE_CASADI_CACHE_SIZE"
"""The variable that sets another limit: bytes, or a number and k, M, G or T; 0 keeps nothing."""

LIMIT = 500_000_000
"""Bytes that are kept at most, unless the variable says otherwise."""

_UNITS = {"": 1, "k": 10**3, "M": 10**6, "G": 10**9, "T": 10**12}
_OURS = re.compile(r"([0-9a-f]{32}(?:-iterated)?)\.(?:graph|c|cpp|so|sha256|log)")
_WORK, _ARRIVING = "lagrange_casadi-", "arriving"
"""First part of names of temporary folders, and name beside which files are written."""

_SHARE = 16
"""Divisor of the room in a folder: so much a process may fill before it looks at the folder again,
beside others that fill it too.
"""

_left: dict[tuple[Path, int], float] = {}
"""Bytes that this process may put into a folder, of a limit, before it looks at all files there."""


@dataclass(frozen=True)
class Entry:
    """One thing that is kept: its files, their size in bytes, and when it was last used, in seconds
    of the system's clock.
    """

    files: tuple[os.DirEntry[str], ...]
    size: int
    used: float


def limit() -> int:
    """Bytes that are kept at most.

    Raises :class:`DeclarationError` where the variable says no size.
    """
    text = os.environ.get(VARIABLE, "").strip()
    if not text:
        return LIMIT
    found = re.fullmatch(r"([0-9.]+) ?([kMGT]?)B?", text)
    with suppress(ValueError, OverflowError):
        if found:
            return int(real(found[1]) * _UNITS[found[2]])
    raise DeclarationError(
        f"${VARIABLE} = '{text}': expected bytes, as in 200000000, 200M or 2G; 0 keeps nothing"
    )


def place() -> Path:
    """Path of the folder, whether it exists or not."""
    import platformdirs

    return Path(platformdirs.user_cache_dir("lagrange_casadi", appauthor=False))


def folder() -> Path | None:
    """Folder of kept files, or None: nothing is to be kept, or, with a warning once, the folder
    cannot be written.

    It is a temporary folder of this process, with a warning once, if others may write into the
    user's.
    """
    if limit() == 0:
        return None
    try:
        return _usable(place())
    except OSError as error:
        warn(f"cannot use the cache folder {place()} now: {error.strerror}")
        return None


@functools.lru_cache
def _usable(place: Path) -> Path | None:
    """The folder, or one in its place; None if it cannot be written.

    Raises ``OSError`` where that may be otherwise soon.
    """
    try:
        place.mkdir(0o700, parents=True, exist_ok=True)
        if why := distrusted(place):
            warn(f"the cache folder {place} is not used, because {why}; a temporary one is")
            place = Path(tempfile.mkdtemp(prefix=_WORK, dir=_private()))
            atexit.register(shutil.rmtree, place, ignore_errors=True)
        with tempfile.TemporaryFile(dir=place):
            return place
    except OSError as error:
        if lacking(error):
            raise
        warn(f"cannot write into the cache folder {place}: {error.strerror}; nothing is kept")
        return None


@contextmanager
def working_folder() -> Iterator[Path]:
    """A temporary folder into which nobody else can write.

    Raises :class:`PathError` where none can be made, ``OSError``.
    """
    with tempfile.TemporaryDirectory(prefix=_WORK, dir=_private()) as work:
        yield Path(work)


def _private() -> str:
    """Parent of temporary folders.

    Raises :class:`PathError` if others may put something else in their place.
    """
    there = tempfile.gettempdir()
    if why := distrusted(Path(there), shared=True):
        raise PathError(
            f"nothing can be built in the temporary folder {there}, because {why}; set $TMPDIR"
            " to a folder of your own"
        )
    return there


def distrusted(path: Path, *, shared: bool = False) -> str:
    """Reason why somebody else may have written a path, in words; empty if only this user and root
    can.

    As for ssh, the file or folder and all folders that lead to it must belong to them, and nobody
    else may write into them, but for a group that is this user's alone. Folders that lead to it,
    and ``path`` itself if it is ``shared``, may be as ``/tmp`` is: in these everybody removes and
    renames only what is his own. Raises ``OSError`` if nothing is there.
    """
    if not hasattr(os, "geteuid"):
        return ""
    # Where root's files look like nobody's, as in a container, those of "/" do.
    trusted = {0, os.geteuid(), os.stat("/").st_uid}
    given, real = Path(os.path.abspath(path)), Path(os.path.realpath(path))
    for part in dict.fromkeys([real, *real.parents, given, *given.parents]):
        status = os.lstat(part)
        if status.st_uid not in trusted:
            return f"{part} belongs to another user"
        writers = status.st_mode & (
            stat.S_IWOTH | (0 if _is_own_group(status.st_gid) else stat.S_IWGRP)
        )
        sticky = status.st_mode & stat.S_ISVTX and (shared or part != real)
        if writers and not sticky and not stat.S_ISLNK(status.st_mode):
            return f"others may write into {part}"
    return ""


@functools.lru_cache
def _is_own_group(number: int) -> bool:
    """Return whether a group bears this user's name, and has no other member."""
    try:
        import grp
        import pwd

        user, group = pwd.getpwuid(os.geteuid()).pw_name, grp.getgrgid(number)
    except (ImportError, KeyError):
        return False
    return group.gr_name == user and set(group.gr_mem) <= {user}


def read(name: str) -> str | None:
    """A text that was kept, or None; a damaged one is said to be."""
    place = folder()
    if place is None:
        return None
    file, seal, text, why = place / name, "", "", "was damaged"
    try:
        if found := distrusted(file):
            why = f"is not trusted ({found})"
        else:
            seal, _, text = file.read_text(encoding="utf-8").partition("\n")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError):
        pass
    if seal == digest(text.encode()):
        use(file)
        return text
    warn(f"the cached {file} {why} and is made again")
    return None


def write(name: str, text: str) -> None:
    """Keep a text; where the folder is full, do without."""
    place = folder()
    if place is None:
        return
    with suppress(OSError), _arriving(place) as near:
        (near / name).write_text(f"{digest(text.encode())}\n{text}", encoding="utf-8")


def keep(files: Sequence[Path], place: Path) -> None:
    """Copy files into the cache, each whole or not at all, and make room for them.

    Raises ``OSError``.
    """
    with _arriving(place) as near:
        for file in files:
            shutil.copyfile(file, near / file.name)


@contextmanager
def _arriving(place: Path) -> Iterator[Path]:
    """A folder whose files are put into the cache, seals before libraries, and room is made for
    them. Raises ``OSError``.
    """
    with beside(place / _ARRIVING) as near:
        yield near
        names = sorted(name for name in os.listdir(near) if name != LOCK)
        size = sum(os.path.getsize(near / name) for name in names)
        for name in names:
            os.replace(near / name, place / name)
    _make_space(place, {name.partition(".")[0] for name in names}, size)


def use(file: Path) -> None:
    """Note that what a file belongs to was used now."""
    with suppress(OSError):
        os.utime(file)


def entries(place: Path) -> dict[str, Entry]:
    """Entries of a folder by their hash, the one used longest ago first. Raises ``OSError``."""
    found: dict[str, list[os.DirEntry[str]]] = {}
    for file in os.scandir(place):
        if ours := _OURS.fullmatch(file.name):
            with suppress(FileNotFoundError):
                file.stat()  # which it keeps
                found.setdefault(ours[1], []).append(file)
    listed = {
        name: Entry(
            tuple(files),
            sum(file.stat().st_size for file in files),
            max(file.stat().st_mtime for file in files),
        )
        for name, files in found.items()
    }
    return dict(sorted(listed.items(), key=lambda item: item[1].used))


def remove(entries: Iterable[Entry]) -> int:
    """Remove things; how many bytes that were. What cannot be removed stays."""
    removed = 0
    for entry in entries:
        with suppress(OSError):
            # A seal first: without it a library is not believed, whoever looks meanwhile.
            for file in sorted(entry.files, key=lambda file: not file.name.endswith(".sha256")):
                Path(file).unlink(missing_ok=True)
            removed += entry.size
    return removed


def _make_space(place: Path, fresh: set[str], size: int) -> None:
    """Remove what was used longest ago, until the rest is within the limit; what is ``fresh``, of a
    ``size`` in bytes, stays.
    """
    key = place, limit()
    _left[key] = _left.get(key, 0.0) - size
    if _left[key] > 0.0:
        return
    with suppress(OSError):
        kept = entries(place)
        beyond = sum(entry.size for entry in kept.values()) - limit()
        for name, entry in kept.items():
            if beyond > 0 and name not in fresh:
                beyond -= remove([entry])
        _left[key] = -beyond / _SHARE

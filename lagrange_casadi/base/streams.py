"""Devices, pipes, and what standard output goes to: they are written straight to, for no file may
be put in their place, and are never read.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from ..errors import PathError, StoreError

SOCKET = "a socket"
"""Kind that cannot be written by its path."""

_PATIENCE = 10.0
_PAUSE = 0.02
_FLAGS = os.O_WRONLY | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_NONBLOCK", 0)


def stream_word(path: Path) -> str:
    """Kind of a path that takes bytes and keeps no file, in words; empty if it may be a file.

    Raises ``OSError``.
    """
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return ""
    if _standard(path) is not None:
        return "what standard output or error goes to"
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return ""
    return "a pipe" if stat.S_ISFIFO(mode) else SOCKET if stat.S_ISSOCK(mode) else "a device"


def check_regular(path: str | os.PathLike[str], names: str = "") -> None:
    """Raise :class:`PathError` for what is no file to read: to open a pipe may take for ever, to
    open a device may do something.

    ``names`` says which names there are in place of files, for a path without a suffix.
    """
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):
        listed = f"; {names}" if names and not os.path.splitext(path)[1] else ""
        raise PathError(f"{path}: no such file{listed}") from None
    if not stat.S_ISREG(mode):
        raise PathError(
            f"{path}: is {'a folder' if stat.S_ISDIR(mode) else 'a device or a pipe'}, not a file"
        )


def open_stream(path: Path) -> BinaryIO:
    """Open a path to write.

    Raises ``OSError``, and :class:`StoreError` for a pipe that nobody begins to read.
    """
    number = _standard(path)
    if number is not None:
        sys.stdout.flush()
        sys.stderr.flush()
        return os.fdopen(os.dup(number), "wb")
    until = time.monotonic() + _PATIENCE
    while True:
        try:
            number = os.open(path, _FLAGS)
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
            if time.monotonic() > until:
                raise StoreError(f"cannot write {path}: nothing reads from it") from None
            time.sleep(_PAUSE)
        else:
            os.set_blocking(number, True)
            return os.fdopen(number, "wb")


def is_standard_output(path: Path) -> bool:
    """Return whether a path leads to the program's own output."""
    return _standard(path) == 1


def _standard(path: Path) -> int | None:
    """Return the one of standard output and error to which a path leads."""
    for number in (1, 2):
        with suppress(OSError):
            if os.path.samestat(os.stat(path), os.fstat(number)):
                return number
    return None

"""The user's cache folder: what was derived and built before, kept whole or not at all."""

from __future__ import annotations

import functools
import hashlib
import os
import shutil
import tempfile
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import platformdirs


def folder() -> Path | None:
    """Where things are kept, or None, and a warning once, where that cannot be written."""
    place = Path(platformdirs.user_cache_dir("lagrange_casadi", appauthor=False))
    return place if _writable(place) else None


@functools.lru_cache
def _writable(place: Path) -> bool:
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return True
    except OSError as error:
        warnings.warn(f"cannot write into the cache folder {place}: {error.strerror}; nothing is kept", stacklevel=3)
        return False


def read(name: str) -> str | None:
    """A text that was kept, or None; a damaged one is said to be."""
    place = folder()
    if place is None or not (place / name).exists():
        return None
    try:
        seal, _, text = (place / name).read_text().partition("\n")
    except (OSError, UnicodeDecodeError):
        seal, text = "", ""
    if seal == digest(text.encode()):
        return text
    warnings.warn(f"the cached {place / name} was damaged and is made again", stacklevel=2)
    return None


def write(name: str, text: str) -> None:
    """Keep a text; where the folder is full, do without."""
    place = folder()
    if place is None:
        return
    with suppress(OSError), tempfile.TemporaryDirectory() as work:
        draft = Path(work) / name
        draft.write_text(f"{digest(text.encode())}\n{text}")
        keep([draft], place)


def keep(files: Sequence[Path], place: Path) -> None:
    """Copy files into the cache, each whole or not at all. Raises ``OSError``."""
    with tempfile.TemporaryDirectory(dir=place, prefix="build-") as near:
        for file in files:
            shutil.copy2(file, Path(near) / file.name)
        for file in files:
            os.replace(Path(near) / file.name, place / file.name)


def digest(content: bytes) -> str:
    """What tells whether a content is whole."""
    return hashlib.sha256(content).hexdigest()

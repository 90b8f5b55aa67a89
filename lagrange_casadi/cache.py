"""The user's cache folder: what was derived and built before, kept whole or not at all."""

from __future__ import annotations

import functools
import hashlib
import os
import tempfile
import warnings
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
        digest, _, text = (place / name).read_text().partition("\n")
    except (OSError, UnicodeDecodeError):
        digest, text = "", ""
    if digest == _digest(text):
        return text
    warnings.warn(f"the cached {place / name} was damaged and is made again", stacklevel=2)
    return None


def write(name: str, text: str) -> None:
    """Keep a text; where the folder is full, do without."""
    place = folder()
    if place is None:
        return
    try:
        with tempfile.TemporaryDirectory(dir=place, prefix="build-") as work:
            draft = Path(work) / name
            draft.write_text(f"{_digest(text)}\n{text}")
            os.replace(draft, place / name)
    except OSError:
        pass


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()

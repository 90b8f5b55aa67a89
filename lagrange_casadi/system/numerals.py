"""Numbers as people write them: Python's own readers also take 1_0 for 10."""

from __future__ import annotations


def real(text: str) -> float:
    """Read a number, ``nan`` and ``inf`` too. Raises ``ValueError`` for what is none."""
    return float(_plain(text))


def whole(text: str) -> int:
    """Read a whole number. Raises ``ValueError`` for what is none."""
    return int(_plain(text))


def _plain(text: str) -> str:
    if "_" in text:
        raise ValueError(f"expected a number, got {text!r}")
    return text

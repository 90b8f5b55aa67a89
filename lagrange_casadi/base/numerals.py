"""Numbers as people write and read them: Python's own readers also take 1_0 for 10, and digits of
any script.
"""

from __future__ import annotations


def real(text: str) -> float:
    """Read a number, ``nan`` and ``inf`` too. Raises ``ValueError`` for what is none."""
    return float(plain(text))


def whole(text: str) -> int:
    """Read a whole number. Raises ``ValueError`` for what is none."""
    return int(plain(text))


def readable(value: float, *others: float) -> str:
    """A number with as few digits as a reader needs: at least six, and so many that it differs from
    others that it differs from.
    """
    for digits in (6, 9, 12):
        text = f"{value + 0.0:.{digits}g}"
        if all(value == other or text != f"{other + 0.0:.{digits}g}" for other in others):
            return text
    return f"{value:.17g}"


def plain(text: str) -> str:
    """A text that may be a number: without underscores and digits of other scripts.

    Raises ``ValueError`` for any other.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"expected a number, got {text!r}")
    return text

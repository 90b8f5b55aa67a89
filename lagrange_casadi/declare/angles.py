"""Angles as people type them."""

from __future__ import annotations

import math

from ..errors import DeclarationError
from ..system.numerals import real


def angle(text_or_number: str | float) -> float:
    """An angle [rad]: a number in rad, or a text such as ``"350 deg"``, ``"720deg"``, ``"1.5 rad"``, ``"1.5"``.

    Raises :class:`.DeclarationError` for anything else, and for what is not finite.
    """
    words = str(text_or_number).strip()
    try:
        # Whole and half turns are the same doubles as multiples of math.pi.
        found = real(words[:-3]) / 180.0 * math.pi if words.endswith("deg") else real(words.removesuffix("rad"))
    except ValueError:
        found = math.nan
    if isinstance(text_or_number, bool) or not math.isfinite(found):
        raise DeclarationError(f"expected an angle in rad, or with its unit as in '350 deg', got {text_or_number!r}")
    return found

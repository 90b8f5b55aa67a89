"""Angles as people type them."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from typing import Any

from ..errors import AngleError
from ..system.numerals import real

_WRITTEN = re.compile(r"\s*(\S+?)\s*(deg|rad)?\s*")


def angle(value: object) -> float:
    """An angle in rad: a number is one, a text is a number that ``deg`` or ``rad`` may follow, as ``"350 deg"``.

    Raises :class:`.AngleError`, a ``ValueError``, for anything else, and for what is not finite.
    """
    found = math.nan
    if isinstance(value, str):
        number, unit = match.groups() if (match := _WRITTEN.fullmatch(value)) else ("", None)
        try:
            # Whole and half turns are the same doubles as multiples of math.pi.
            found = real(number) / 180.0 * math.pi if unit == "deg" else real(number)
        except ValueError:
            found = math.nan
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        found = float(value)
    if not math.isfinite(found):
        raise AngleError(f"expected a finite number [rad], or a text such as '350 deg' or '1.2 rad', got {value!r}")
    return found


def typed(value: object) -> tuple[Any, bool]:
    """A text of an angle with its unit as a number [rad], and that it was one; anything else as it is."""
    with suppress(AngleError):
        if isinstance(value, str) and value.rstrip().endswith(("deg", "rad")):
            return angle(value), True
    return value, False

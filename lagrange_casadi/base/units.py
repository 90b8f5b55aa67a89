"""Numbers, and texts that give one with its unit."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from decimal import Decimal, DecimalException
from numbers import Integral
from typing import Any, NamedTuple, TypeAlias, TypeGuard

import casadi as ca
import numpy as np

from ..errors import DeclarationError, NumberError, shown
from .numerals import real

UNITS: dict[str, dict[str, float]] = {
    "rad": {"rad": 1.0, "deg": math.radians(1.0), "turn": math.tau},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "kg": {"kg": 1.0, "g": 1e-3},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
}
"""Units that a text may have for a number, and their size, for each SI unit."""

_EXAMPLES = {"rad": "'350 deg' or '1.2 rad'", "m": "'100 mm'", "kg": "'500 g'", "s": "'20 ms'"}
_WRITTEN = re.compile(r"\s*(\S*[\d.])\s*([A-Za-z]+)(/\S+)?\s*")
_BASE = {word: unit for unit, words in UNITS.items() for word in words}

Number: TypeAlias = float | str
"""A number, or a text of one with its unit."""


class Within(NamedTuple):
    """Annotation of a number: finite, and from ``low`` to ``high``, or ``above`` low."""

    low: float = -math.inf
    high: float = math.inf
    above: bool = False

    def admits(self, value: float) -> bool:
        """Return whether a number is in this range."""
        return (
            -math.inf < value < math.inf
            and (self.low < value if self.above else self.low <= value)
            and value <= self.high
        )

    @property
    def words(self) -> str:
        """The range, to be said after what is in it."""
        if self.high < math.inf:
            return f" from {self.low:.17g} to {self.high:.17g}"
        return (
            f" above {self.low:g}"
            if self.above and self.low
            else f" of at least {self.low:g}"
            if self.low > -math.inf
            else ""
        )


def typed(value: object) -> tuple[Any, str]:
    """A text with a unit as a number, and the unit that it is then in, as rad, m or m/s; anything
    else as it is, and no unit.
    """
    if (
        not isinstance(value, str)
        or not (found := _WRITTEN.fullmatch(value))
        or found[2] not in _BASE
    ):
        return value, ""
    digits, word, per = found[1], found[2], found[3] or ""
    with suppress(ValueError, OverflowError, DecimalException):
        number = real(digits)
        if word == "deg":  # whole and half turns are the same doubles as multiples of math.pi
            number = number / 180.0 * math.pi
        elif word == "turn":
            number *= math.tau
        elif word != _BASE[word]:  # as its decimals say, rounded once
            number = float(Decimal(digits) * Decimal(repr(UNITS[_BASE[word]][word])))
        if math.isfinite(number):
            return number, _BASE[word] + per
    return value, ""


def number(value: object, unit: str = "1", *, finite: bool = True) -> float:
    """A number in a unit: either a number, or a text with a unit, such as ``"350 deg"``,
    ``"100 mm"`` or ``"500 g"``.

    Raises :class:`.NumberError`, a ``ValueError``, for anything else, and if it must be ``finite``
    for what is not.
    """
    read, written_unit = typed(value)
    found = double(read) if written_unit in ("", unit) else None
    if found is None or not (math.isfinite(found) or not finite):
        raise NumberError(
            f"expected {'a finite ' if finite else 'a '}{in_words(unit)}, got {shown(value)}"
        )
    return found


def in_words(unit: str) -> str:
    """Describe a number in a unit, and that it may be a text if it may."""
    base, per, rest = unit.partition("/")
    example = _EXAMPLES.get(base, "")
    if per and example:
        example = f"'{example.split(chr(39))[1]}/{rest}'"
    text = f", or a text such as {example}" if example else ""
    return f"number{'' if unit == '1' else f' [{unit}]'}{text}"


def quantity(what: str, value: object, unit: str = "1", *, finite: bool = True) -> float:
    """A number in a unit, see :func:`number`.

    Raises :class:`DeclarationError`, naming ``what``, for anything else.
    """
    try:
        return number(value, unit, finite=finite)
    except NumberError as error:
        raise DeclarationError(f"{what}: {error}") from None


def count(what: str, value: object, least: int = 1, most: float = math.inf) -> int:
    """A whole number in a range.

    Raises :class:`DeclarationError`, naming ``what``, for anything else.
    """
    if not is_whole(value) or abs(value) >= 2**63 or not least <= value <= most:
        raise DeclarationError(
            f"{what}: expected a whole number{Within(least, most).words}, got {shown(value)}"
        )
    return int(value)


def within(what: str, value: object, low: float, high: float) -> float:
    """A number from ``low`` to ``high``.

    Raises :class:`DeclarationError`, naming ``what``, for anything else.
    """
    found = double(value)
    if found is None or not low <= found <= high:
        raise DeclarationError(
            f"{what}: expected a number from {low:g} to {high:g}, got {shown(value)}"
        )
    return found


def is_whole(value: object) -> TypeGuard[int]:
    """Return whether a value is a whole number of any size, and no truth value."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def double(value: Any) -> float | None:
    """Number of Python; None for anything else, such as truth values, texts, arrays, dates and
    symbols.
    """
    if type(value) is float:
        return value
    if isinstance(value, ca.SX | ca.DM):
        return float(value) if value.is_scalar() and value.is_constant() else None
    value = value.item() if isinstance(value, np.ndarray) and not value.shape else value
    strange = isinstance(value, bool | complex | np.ndarray) or not hasattr(
        type(value), "__float__"
    )
    if not strange and not (isinstance(value, np.generic) and value.dtype.kind not in "iuf"):
        with suppress(TypeError, ValueError, OverflowError, NotImplementedError, RuntimeError):
            return float(value)
    return None

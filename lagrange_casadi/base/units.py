"""Numbers, and texts that give one with its unit: ``"5 kN"``, ``"1500 rpm"``, ``"12 kg cm^2"``.

A unit is a product of names, with spaces, ``*`` or ``·`` between them, each with a power, as
``cm^2``, ``cm2`` or ``cm²``. One ``/`` may follow, and after that one name, or several in
parentheses.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from contextlib import suppress
from decimal import Context, Decimal
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import casadi as ca
import numpy as np

from ..errors import DeclarationError, NumberError, shown

_BASES = ("kg", "m", "s", "rad")
_POWERS = {
    "": 0,
    "n": -9,
    "u": -6,
    "m": -3,
    "c": -2,
    "d": -1,
    "da": 1,
    "h": 2,
    "k": 3,
    "M": 6,
    "G": 9,
}
_UNITS: dict[str, tuple[str, int, str, str]] = {
    "kg": ("1", 0, "", ""),
    "g": ("1/1000", 0, "kg", "u m"),
    "t": ("1000", 0, "kg", ""),
    "m": ("1", 0, "", "n u m c d k"),
    "l": ("1/1000", 0, "m^3", "m c"),
    "s": ("1", 0, "", "n u m"),
    "min": ("60", 0, "s", ""),
    "h": ("3600", 0, "s", ""),
    "rad": ("1", 0, "", "u m"),
    "deg": ("1/180", 1, "rad", ""),
    "turn": ("2", 1, "rad", ""),
    "rev": ("2", 1, "rad", ""),
    "rpm": ("1/30", 1, "rad/s", ""),
    "Hz": ("1", 0, "1/s", "m k M"),
    "N": ("1", 0, "kg m/s^2", "u m c da k M G"),
    "Nm": ("1", 0, "N m", "u m c k M"),
    "Ncm": ("1/100", 0, "N m", ""),
    "Nmm": ("1/1000", 0, "N m", ""),
    "J": ("1", 0, "N m", "u m k M G"),
    "W": ("1", 0, "J/s", "u m k M G"),
    "Pa": ("1", 0, "N/m^2", "h k M G"),
    "bar": ("100000", 0, "Pa", "m"),
    "strain": ("1", 0, "1", "u m"),
    "%": ("1/100", 0, "1", ""),
}
"""Each unit: its size in others, and how often pi is a factor of that; and the prefixes that the
unit takes. A prefix that would only be a slip, as in mPa, is none.
"""

_NAMES = {
    prefix + name: (name, _POWERS[prefix])
    for name, (*_, prefixes) in _UNITS.items()
    for prefix in ("", *prefixes.split())
}

_KINDS: dict[str, tuple[str, str]] = {
    "1": ("a number without a unit", ""),
    "rad": ("an angle", "'350 deg' or '1.2 rad'"),
    "rad/s": ("an angular speed", "'90 deg/s' or '1500 rpm'"),
    "rad/s^2": ("an angular acceleration", "'90 deg/s^2'"),
    "rad/s^3": ("an angular jerk", "'90 deg/s^3'"),
    "m": ("a length", "'100 mm'"),
    "m/s": ("a speed", "'100 mm/s'"),
    "m/s^2": ("an acceleration", "'100 mm/s^2'"),
    "m/s^3": ("a jerk", "'100 mm/s^3'"),
    "m^2": ("an area", "'20 cm^2'"),
    "m^3": ("a volume", "'20 cm^3'"),
    "m^4": ("a second moment of area", "'20 cm^4'"),
    "s": ("a time", "'20 ms'"),
    "1/s": ("a frequency", "'50 Hz'"),
    "kg": ("a mass", "'500 g'"),
    "kg/m": ("a mass per length", "'500 g/m'"),
    "kg/m^2": ("a mass per area", "'500 g/m^2'"),
    "kg/m^3": ("a density", "'7.85 t/m^3'"),
    "kg m": ("a second moment of mass per length", "'12 kg mm'"),
    "kg m^2": ("a moment of inertia", "'12 kg cm^2'"),
    "N": ("a force", "'5 kN'"),
    "N/m": ("a force per length", "'5 N/mm'"),
    "N m": ("a moment or an energy", "'250 N m'"),
    "N m/rad": ("a moment per angle", "'250 N m/rad'"),
    "N s/m": ("a damping", "'5 N s/mm'"),
    "N m s/rad": ("a damping of rotation", "'2 N m s/rad'"),
    "Pa": ("a pressure or a stress", "'3 MPa'"),
    "W": ("a power", "'5 kW'"),
    "W/m^2": ("a power per area", "'5 W/mm^2'"),
}
"""Kinds of quantities by their units of SI: what they are called, and a text that gives one."""

_DIGITS = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_TEXT = re.compile(rf"\s*(?=({_DIGITS}))\1\s*((?:1\s*/|[^\s.,0-9]).*?)\s*")
_FACTOR = re.compile(r"([A-Za-z%]+)(?:\^?(-?[1-9][0-9]?))?")
_UNCLEAR = re.compile(r"m\s+([A-Za-z]+)(\^?[1-9])?(?![\^\-0-9A-Za-z]).*")
_SIGNS = str.maketrans("¹²³⁴⁻µμ·⋅", "1234-uu**") | str.maketrans({"°": "deg"})
_RPM = ("1/min", "min^-1", "min-1")
"""Names for rpm on data sheets of motors."""

EXACT = Context(prec=40)
"""Arithmetic in which products of decimals are as their digits say."""

Number: TypeAlias = float | str
"""A number, or a text of one with its unit."""


class Unit(NamedTuple):
    """A unit: its ``size`` in SI, times pi to the power ``turns``; its powers of kg, m, s, rad."""

    size: Decimal = Decimal(1)
    turns: int = 0
    powers: tuple[int, ...] = (0, 0, 0, 0)

    @classmethod
    def of(cls, text: str) -> Unit:
        """Read a unit. Raises :class:`.NumberError` for a text that is none, or could be two."""
        if found := _UNCLEAR.fullmatch(text):
            raise NumberError(f"'{text}' is unclear; expected 'm{found[1]}' or 'm*{found[1]}'")
        return _unit(text)

    def times(self, other: Unit, power: int) -> Unit:
        """The product of this unit and a power of another one."""
        return Unit(
            EXACT.multiply(self.size, EXACT.power(other.size, power)),
            self.turns + power * other.turns,
            tuple(a + power * b for a, b in zip(self.powers, other.powers, strict=True)),
        )

    def number(self, digits: str | Decimal) -> float:
        """So many of this unit in units of SI, rounded once; and again by a factor pi.

        Raises ``ArithmeticError`` for digits of a number that is far beyond doubles.
        """
        return float(EXACT.multiply(EXACT.create_decimal(digits), self.size)) * math.pi**self.turns

    @property
    def factor(self) -> float:
        """The size in units of SI."""
        return float(EXACT.multiply(self.size, EXACT.power(_PI, self.turns)))

    @property
    def of_si(self) -> str:
        """The unit of SI of this kind."""
        return _of_si(self.powers)

    @property
    def kind(self) -> str:
        """Quantity that is measured in this unit, in words."""
        return _KINDS.get(self.of_si, (f"a quantity in {self.of_si}",))[0]


_PI = Decimal("3.1415926535897932384626433832795028841972")


@lru_cache(maxsize=1024)
def _unit(text: str) -> Unit:
    if text in _BASES:
        return Unit(powers=tuple(int(text == base) for base in _BASES))
    words = text.translate(_SIGNS).replace("**", "^").strip()
    words = "rpm" if words in _RPM else words
    above, per, below = (part.strip() for part in words.partition("/"))
    several = below.startswith("(") and below.endswith(")")
    if per and not several and not _FACTOR.fullmatch(below):
        raise NumberError(
            f"'{text}' is unclear; expected one unit after one '/', or several in parentheses, as"
            " in N/(m s)"
        )
    found = Unit()
    for factor in re.split(r"\s*\*\s*|\s+", above) if above not in ("", "1") else ():
        parts = _FACTOR.fullmatch(factor)
        name, power = parts.groups("1") if parts else (factor, "1")
        found = found.times(_named(name), int(power))
    return found.times(_unit(below[1:-1] if several else below), -1) if per else found


def _named(name: str) -> Unit:
    """The unit of a name, which may have a prefix."""
    if name not in _NAMES:
        close = [other for other in _NAMES if other.casefold() == name.casefold()]
        hint = f" (did you mean '{close[0]}'?)" if close else ""
        valid = f"valid: {', '.join(_UNITS)}, some with prefixes, as kN"
        raise NumberError(f"unknown unit '{name}'{hint}; {valid}")
    word, exponent = _NAMES[name]
    size, turns, others, _ = _UNITS[word]
    whole, _, part = size.partition("/")
    one = Unit(EXACT.divide(Decimal(whole), Decimal(part or 1)).scaleb(exponent), turns)
    return one.times(_unit(others or word), 1)


@lru_cache(maxsize=1024)
def _of_si(powers: tuple[int, ...]) -> str:
    for name in _KINDS:
        if _unit(name).powers == powers:
            return name
    above, below = (
        [
            name if size == 1 else f"{name}^{size}"
            for name, power in zip(_BASES, powers, strict=True)
            if (size := sign * power) > 0
        ]
        for sign in (1, -1)
    )
    divisor = " ".join(below) if len(below) < 2 else f"({' '.join(below)})"
    return f"{' '.join(above) or '1'}{'/' if below else ''}{divisor}"


def vocabulary() -> dict[str, dict[str, Any] | str]:
    """The units as data, for a program in another language that reads them: size in SI and powers
    of each name, signs and what they stand for, patterns, and kinds by their powers.
    """
    return {
        "names": {name: [Unit.of(name).factor, *Unit.of(name).powers] for name in (*_NAMES, *_RPM)},
        "signs": {chr(k): chr(to) if isinstance(to, int) else to for k, to in _SIGNS.items()},
        "factor": _FACTOR.pattern,
        "unclear": _UNCLEAR.pattern,
        "kinds": {",".join(map(str, Unit.of(unit).powers)): a for unit, (a, _) in _KINDS.items()},
    }


def typed(value: object) -> tuple[Any, str]:
    """A text with a unit as a number in SI, and the unit that it is then in, as rad, m or N/m;
    anything else as it is, and no unit.
    """
    if isinstance(value, str) and (parts := _TEXT.fullmatch(value)):
        with suppress(NumberError, ArithmeticError):
            unit = Unit.of(parts[2])
            if math.isfinite(found := unit.number(parts[1])):
                return found, unit.of_si
    return value, ""


def numbers_in(given: Iterable[object]) -> tuple[tuple[float, ...], str]:
    """Numbers, of which some may be texts, as ``"30 deg"``, and the unit of SI that these are in;
    none where none is a text.

    Raises :class:`.NumberError` for anything else, :class:`.DeclarationError` for several units.
    """
    read = [typed(value) for value in given]
    units = dict.fromkeys(unit for _, unit in read if unit)
    if len(units) > 1:
        raise DeclarationError(
            f"expected values of one unit, got some in {' and some in '.join(units)}"
        )
    return tuple(number(value, finite=False) for value, _ in read), next(iter(units), "")


def in_si(value: object, unit: str) -> Any:
    """Return a value, or a list of values, with its texts as numbers in a unit.

    Raises :class:`.NumberError` for a text that is no number in such a unit.
    """
    if isinstance(value, list | tuple):
        return [in_si(one, unit) for one in value]
    return number(value, unit) if isinstance(value, str) else value


def known(word: str) -> Unit | None:
    """The unit that a word stands for; None for a word of the user's own."""
    with suppress(NumberError):
        return Unit.of(word)
    return None


def differs(word: str, unit: str) -> str:
    """Say what a word for a unit stands for, and what was expected: ``unit``, or another of its
    kind; nothing where that is so.
    """
    given, wanted = known(word), known(unit)
    if word == unit or (given and wanted and given.powers == wanted.powers):
        return ""
    here = f"{word}, {given.kind}" if given and word else f"'{word}'" if word else "no unit"
    return f"{here}; expected {wanted.kind if wanted else 'numbers'} [{unit}]"


def unlike(word: str, unit: str) -> str:
    """Say by which factor a unit is of another size than ``unit``; nothing for a word of the user's
    own, and for another kind: times a factor of one an expression is its symbol, as l kg/m of a
    rod.
    """
    given = known(word)
    if given is None or differs(word, unit):
        return ""
    factor = given.times(Unit.of(unit), -1).factor
    return "" if factor == 1.0 else f"{word}; expected {unit}: multiply it by {factor!r}"


def in_unit(what: str, values: Iterable[float], given: str, unit: str) -> list[float]:
    """Numbers of texts, which were read in a unit of SI ``given``, in another ``unit``; as they are
    where no text was read.

    Raises :class:`.DeclarationError`, naming ``what``, for a unit of another kind.
    """
    if given and (wrong := differs(given, unit)):
        raise DeclarationError(f"{what} is in {wrong}")
    scale = Unit() if given in ("", unit) else Unit.of(given).times(Unit.of(unit), -1)
    # What was rounded in SI has fifteen digits.
    read = (float(f"{scale.number(Decimal(value)):.15g}") for value in values)
    return [*(values if scale == Unit() else read)]


def number(value: object, unit: str = "1", *, finite: bool = True) -> float:
    """A number in a unit: either a number, or a text with a unit, such as ``"350 deg"``,
    ``"100 mm"`` or ``"5 kN"``.

    Raises :class:`.NumberError`, a ``ValueError``, for anything else, and if it must be ``finite``
    for what is not.
    """
    found, why = double(value), ""
    if isinstance(value, str):
        found, why = _written(value, unit)
    if found is None or not (math.isfinite(found) or not finite):
        raise NumberError(
            f"expected {'a finite ' if finite else 'a '}{in_words(unit)}, got {shown(value)}{why}"
        )
    return found


def _written(text: str, unit: str) -> tuple[float | None, str]:
    """The number that a text gives in a unit, or why there is none.

    Raises :class:`.NumberError` for a text with a unit of another kind.
    """
    parts = _TEXT.fullmatch(text)
    if not parts:
        return None, ""
    digits, word = parts.groups()
    if word == unit:
        return float(digits), ""
    try:
        given = Unit.of(word)
    except NumberError as error:
        return None, f": {error}"
    if wanted := known(unit):
        if given.powers != wanted.powers:
            of = "" if unit == "1" else f" [{unit}]"
            raise NumberError(f"{shown(text)} is {given.kind}; expected {wanted.kind}{of}")
        with suppress(ArithmeticError):
            return given.times(wanted, -1).number(digits), ""
    return None, ""


def in_words(unit: str) -> str:
    """Describe a number in a unit, and that it may be a text if it may."""
    written = known(unit)
    example = _KINDS.get(written.of_si, ("", ""))[1] if written else ""
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


class Within(NamedTuple):
    """Annotation of a number: finite, and from ``low`` to ``high``, or ``above`` low; in a ``unit``
    it may be a text, as :func:`number` reads.
    """

    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    unit: str = ""

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

"""Units as they are written, such as ``kg m^2`` or ``1/s^2``, in powers of the SI's base units."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class BaseUnit:
    """``factor`` times powers of :data:`BASE`, as many ``exponents``."""

    factor: float
    exponents: tuple[int, ...]


def base_unit(text: str) -> BaseUnit | None:
    """Return a unit in base units; None if it is unknown, or ambiguous, as ``N/m s``."""
    top, *bottom = text.replace("²", "^2").replace("³", "^3").split("/")
    if any(len(_factors(part)) != 1 for part in bottom):
        return None
    factor, exponents = 1.0, [0] * len(BASE)
    for sign, part in ((1, top), *((-1, part) for part in bottom)):
        for word in _factors(part):
            found = re.fullmatch(r"([^\d^*\s-]+)(?:\^?(-?\d))?|1", word)
            known = _named(found[1] or "1") if found else None
            if found is None or known is None:
                return None
            power = sign * int(found[2] or 1)
            factor *= known.factor**power
            exponents = [n + power * m for n, m in zip(exponents, known.exponents, strict=True)]
    return BaseUnit(factor, tuple(exponents))


def _factors(part: str) -> list[str]:
    return re.split(r"\s*[*·.]\s*|\s+", part.replace("**", "^").strip())


def _unit(factor: float = 1.0, **exponents: int) -> BaseUnit:
    return BaseUnit(factor, tuple(exponents.get(name, 0) for name in BASE))


_UNITS = {
    "1": _unit(),
    "%": _unit(0.01),
    **{name: _unit(**{name: 1}) for name in BASE},
    "g": _unit(1e-3, kg=1),
    "t": _unit(1e3, kg=1),
    "N": _unit(kg=1, m=1, s=-2),
    "J": _unit(kg=1, m=2, s=-2),
    "W": _unit(kg=1, m=2, s=-3),
    "Pa": _unit(kg=1, m=-1, s=-2),
    "bar": _unit(1e5, kg=1, m=-1, s=-2),
    "Hz": _unit(s=-1),
    "C": _unit(A=1, s=1),
    "V": _unit(kg=1, m=2, s=-3, A=-1),
    "deg": _unit(math.pi / 180, rad=1),
    "rev": _unit(math.tau, rad=1),
    "rpm": _unit(math.tau / 60, rad=1, s=-1),
    "min": _unit(60.0, s=1),
    "h": _unit(3600.0, s=1),
    "L": _unit(1e-3, m=3),
    "l": _unit(1e-3, m=3),
}
_PREFIXES = {
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "d": 1e-1,
    "c": 1e-2,
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,
    "n": 1e-9,
}
_PREFIXED = ("g", "m", "s", "A", "K", "mol", "rad", "N", "J", "W", "Pa", "bar", "Hz", "V", "L", "l")


def _named(name: str) -> BaseUnit | None:
    known = _UNITS.get(name)
    if known is None and name[:1] in _PREFIXES and name[1:] in _PREFIXED:
        rest = _UNITS[name[1:]]
        known = BaseUnit(_PREFIXES[name[0]] * rest.factor, rest.exponents)
    return known

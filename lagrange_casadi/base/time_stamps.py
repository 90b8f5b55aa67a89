"""Times as logs have them: numbers, stamps of UNIX, ISO 8601, and seconds beside nanoseconds.

A double has no room for the nanoseconds since 1970: the first stamp is taken from the others as
decimals.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timedelta, timezone
from decimal import Decimal
from typing import NamedTuple

from .numerals import plain
from .units import EXACT, Unit

_ISO = re.compile(
    r"(\d{4}-\d\d-\d\d)[T ](\d\d:\d\d:\d\d)(\.\d+)?\s*(?:Z|([+-]\d\d):?(\d\d))?", re.ASCII
)
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
_UNIX = Decimal(10**8), Decimal(10**10)
"""Seconds since 1970 that are those of a log, of the years 1973 to 2286; what is less is a time."""

_POWERS = {"s": 0, "ms": -3, "us": -6, "ns": -9}


def stamp(cells: Sequence[str]) -> Decimal:
    """The time that a cell has, in its unit; of ISO 8601, and of seconds and nanoseconds in two
    cells, in s.

    Raises ``ValueError`` or ``ArithmeticError`` for what is no finite time.
    """
    if found := _ISO.fullmatch(cells[0]):
        day, time, part, hours, minutes = found.groups()
        zone = f"{hours}:{minutes}" if hours else "+00:00"
        since = datetime.fromisoformat(f"{day} {time}{zone}") - _EPOCH
        return EXACT.add(Decimal(since // timedelta(seconds=1)), Decimal(f"0{part or ''}"))
    total = Decimal(0)
    for power, cell in zip((0, -9), cells, strict=False):
        total = EXACT.add(total, EXACT.create_decimal(plain(cell)).scaleb(power, EXACT))
    if not total.is_finite():
        raise ValueError(cells)
    return total


class Clock(NamedTuple):
    """Conversion of stamps to times [s]: their ``unit``, the ``origin`` that is time zero, and its
    cells as they stand in the file, where time zero is not the file's own, with ``words`` for what
    they are.
    """

    unit: Unit
    origin: Decimal = Decimal(0)
    first: str = ""
    words: str = ""

    @classmethod
    def of(cls, cells: Sequence[str], word: str) -> Clock:
        """Judge by the first row: ``word`` is the unit that is stated, if any. Errors are those of
        :func:`stamp`.
        """
        found, first = stamp(cells), " and ".join(cells)
        if len(cells) == 2 or _ISO.fullmatch(cells[0]):
            return cls(Unit(), found, first, "s and ns" if len(cells) == 2 else "ISO 8601")
        powers = {word: _POWERS[word]} if word in _POWERS else {} if word else _POWERS
        for unit, power in powers.items():
            if _UNIX[0] <= found.scaleb(power) < _UNIX[1]:
                return cls(Unit.of(unit), found, first, f"{unit} since 1970")
        return cls(Unit.of(word or "s"))

    def read(self, cells: Sequence[str]) -> float:
        """The time [s] of a row. Errors are those of :func:`stamp`."""
        return self.unit.number(EXACT.subtract(stamp(cells), self.origin))

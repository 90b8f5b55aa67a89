"""Tables of values over time, as controllers and loggers write them: columns of a CSV file by their
heads or numbers, with units in the heads or in a row below them, and counts of encoders.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TypeVar

import numpy as np

from ..errors import DeclarationError, UnknownNameError
from .arrays import Array
from .csv_rows import Row, headings, read_rows
from .units import UNITS, double

MEASURED: dict[str, dict[str, float]] = {
    **UNITS,
    "rad/s": {"rad/s": 1.0, "deg/s": math.radians(1.0)},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": math.radians(1.0)},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0, "kN m": 1e3, "mN m": 1e-3},
    "W": {"W": 1.0, "kW": 1e3},
    "1": {"1": 1.0, "ustrain": 1e-6},
}
"""Units that a column may have, and their sizes, for each SI unit."""

SIZES = {word: (unit, size) for unit, words in MEASURED.items() for word, size in words.items()}
COUNTS = ("count", "counts")
_MISSING = ("", "nan", "na", "n/a", "null", "-")
"""Cells of values that are missing."""

Given = TypeVar("Given")


@dataclass(frozen=True, eq=False)
class RecordedTable:
    """A file's columns: their ``heads`` as they are written, none if the first row is of numbers,
    the ``names`` in these, the ``units`` in these or in a row below, and the rows of numbers.
    """

    path: Path
    heads: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Iterator[Row]

    @classmethod
    def read(cls, path: Path, expected: str, skip: int = 0) -> RecordedTable:
        """Read what is above the numbers, but for ``skip`` lines; see :func:`.read_rows`."""
        rows = read_rows(path, expected, skip)
        first = next(rows)
        unread = [cell for cell in first.cells if math.isnan(first.number(cell))]
        if meant := [cell for cell in unread if _is_meant(cell)]:
            raise DeclarationError(f"{first.where}: expected a finite number, got {meant[0]!r}")
        if not unread:
            return cls(path, (), (), ("",) * len(first.cells), chain([first], rows))
        names, units = zip(*headings(first.cells), strict=True)
        if (below := next(rows, None)) is not None:
            words = [cell.strip("[]()") for cell in below.cells]
            if {"", "1"}.issuperset(words) or not {"", *SIZES, *COUNTS}.issuperset(words):
                rows = chain([below], rows)
            else:
                units = tuple(unit or word for unit, word in zip(units, words, strict=True))
        return cls(path, first.cells, names, units, rows)

    def place(self, column: str | int, what: str = "column") -> int:
        """Return the place of a column, from 0, by its head, with or without unit, or its number
        from 1.
        """
        where, many = self.path.name, len(self.units)
        if isinstance(column, str):
            both = zip(self.heads, self.names, strict=True)
            found = [k for k, words in enumerate(both) if column in words]
            if not found:
                valid = self.names or [f"the numbers 1 to {many}"]
                raise UnknownNameError(what, column, valid, place=where)
            if len(found) > 1:
                raise DeclarationError(f"{where}: expected one column '{column}', got {len(found)}")
            return found[0]
        if isinstance(column, bool) or not isinstance(column, int) or not 1 <= column <= many:
            raise DeclarationError(
                f"{where}: column {column!r} is not one of its {many} columns, numbered from 1"
            )
        return column - 1

    def columns(self, time: int, places: Sequence[int], gaps: bool = False) -> Array:
        """Return times, which increase, and the columns at some places, (1 + columns, rows); with
        ``gaps``, missing values are NaN.
        """
        found: list[list[float]] = []
        for row in self.rows:
            numbers = [row.number(row.cells[place]) for place in (time, *places)]
            for k, place in enumerate((time, *places)):
                cell = row.cells[place]
                if math.isnan(numbers[k]) and not (gaps and k and cell.lower() in _MISSING):
                    column = self.heads[place] if self.heads else place + 1
                    raise DeclarationError(
                        f"{row.where}: expected a finite number, got {cell!r} in column {column}"
                    )
            if found and not numbers[0] > found[-1][0]:
                raise DeclarationError(
                    f"{row.where}: times must increase, but {row.cells[time]} follows"
                    f" {found[-1][0]:g}"
                )
            found.append(numbers)
        columns: Array = np.array(found, float).reshape(-1, 1 + len(places)).T
        return columns


def for_each(
    place: str, names: Collection[str], what: str, given: Mapping[str, Given] | Given, usual: Given
) -> dict[str, Given]:
    """Return an option for each name, from one for all, or from a mapping that has some.

    Raises :class:`.UnknownNameError` for other names in the mapping.
    """
    if not isinstance(given, Mapping):
        return dict.fromkeys(names, given)
    if unknown := [name for name in given if name not in names]:
        raise UnknownNameError(what, unknown, names, place=place)
    return {name: given.get(name, usual) for name in names}


def count_sizes(
    place: str,
    columns: Mapping[str, str | int],
    units: Mapping[str, str],
    counts_per_turn: object,
) -> dict[str, float]:
    """Return the size of a count [rad] for each name of a column whose unit is counts, by how many
    counts of its encoder are a turn: one number for all, or numbers by name.
    """
    turns = for_each(place, columns, "column of counts_per_turn=", counts_per_turn, None)
    sizes = {}
    for name, turn in turns.items():
        if units[name] not in COUNTS:
            if isinstance(counts_per_turn, Mapping) and name in counts_per_turn:
                unit = units[name] or "no unit"
                raise DeclarationError(
                    f"{place}: column {columns[name]} is in {unit}; expected counts, of which"
                    f" counts_per_turn= says {turn!r} are a turn"
                )
            continue
        per_turn = double(turn) or 0.0
        if not 0.0 < per_turn < math.inf:
            raise DeclarationError(
                f"{place}: column {columns[name]} is in counts; expected counts_per_turn=, a number"
                f" above 0, got {turn!r}"
            )
        sizes[name] = math.tau / per_turn
    return sizes


def _is_meant(cell: str) -> bool:
    """Return whether a cell that is no finite number is no word of a head either: ``nan``, ``1_0``,
    or digits of another script.
    """
    endless = cell.lower().lstrip("+-") in ("nan", "inf", "infinity")
    return endless or (any(map(str.isdigit, cell)) and not any(map(str.isalpha, cell)))

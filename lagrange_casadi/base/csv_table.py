"""Tables as people and programs write them, CSV of one kind or another: columns by their heads,
which may have units, and rows, each with the line on which it stands.

Controllers and loggers write values over time, without heads, with units in a row below them, or in
counts of encoders.
"""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import TypeVar

import numpy as np

from ..errors import DeclarationError, PathError, UnknownNameError, check_known, one_line
from .arrays import Array
from .numerals import plain
from .streams import check_regular
from .time_stamps import Clock, stamp
from .units import Unit, differs, double, known

COUNTS = ("count", "counts")
_SI = Unit()
_MISSING = ("", "nan", "na", "n/a", "null", "-")
"""Cells of values that are missing."""

Given = TypeVar("Given")

_DELIMITERS = (";", "\t", ",")
_QUOTED = re.compile(r'"[^"]*"')
_DECIMAL = re.compile(r"[-+]?(?=[.,]?[0-9])[0-9]*([.,])[0-9]*(?:[eE][-+]?[0-9]+)?(?: *[a-z]+)?")
_HEADING = re.compile(r"(.*?)\s*(?:[\[(]\s*([^\[\]()]+?)\s*[\])])?")
_TWO_NUMBERS = re.compile("[0-9],[0-9]")
_TEXT = re.compile(r"(?![-+.,]?\d|[-+]?inf(inity)?$)\S", re.IGNORECASE)
_TWO_TIMES = re.compile(r"(.*)secs?\n\1n(?:ano)?secs?")
_MARKS = {".": "decimal points", ",": "decimal commas"}


@dataclass(frozen=True)
class Row:
    """The cells of a ``line`` by its number, without spaces round them.

    ``where`` names the file and the line, as errors do.

    ``marks`` are the decimal marks that numbers of the table have had so far, each with where; None
    if cells are parted by commas, for then only a point can be one.
    """

    where: str
    line: int
    cells: tuple[str, ...]
    marks: dict[str, str] | None = field(default=None, compare=False)

    def pointed(self, cell: str) -> str:
        """A cell; a number with a decimal comma gets a point.

        Raises :class:`.DeclarationError` if the table has numbers of the other kind too: in one of
        them the mark parts thousands.
        """
        found = _DECIMAL.fullmatch(cell)
        if self.marks is None or not found:
            return cell
        self.marks.setdefault(found[1], self.where)
        for mark, where in self.marks.items():
            if mark != found[1]:
                other = f"numbers with {_MARKS[mark]}, as in {where}"
                raise DeclarationError(f"{self.where}: '{cell}' among {other}; expected one kind")
        return cell.replace(",", ".")

    def number(self, cell: str, unit: Unit = _SI) -> float:
        """A cell's number in a ``unit``, in SI and rounded once, so that 35 mm are 0.035; NaN for
        what is no finite number.

        Raises :class:`.DeclarationError` as :meth:`pointed` does.
        """
        try:
            found = unit.number(plain(self.pointed(cell)))
        except (ArithmeticError, ValueError):
            return math.nan
        return found if math.isfinite(found) else math.nan

    def finite(self, column: object, cell: str, unit: Unit = _SI) -> float:
        """A cell's number as :meth:`number` gives it.

        Raises :class:`.DeclarationError`, which names the ``column``, for what is no finite number.
        """
        found = self.number(cell, unit)
        if math.isnan(found):
            raise DeclarationError(
                f"{self.where}, column '{column}': expected a finite number, got {cell!r}"
            )
        return found

    def positive(self, column: str, cell: str, unit: Unit = _SI, *, zero: bool = False) -> float:
        """A cell's number, above zero, or at least that if it may be ``zero``.

        Raises :class:`.DeclarationError`, which names the ``column``, for any other.
        """
        found = self.number(cell, unit)
        if not (found > 0.0 or (zero and found == 0.0)):
            raise DeclarationError(
                f"{self.where}: {column}: expected a positive number, got {cell!r}"
            )
        return found


@dataclass(frozen=True, eq=False)
class Table:
    """A file's columns: the row of its ``head``, the ``names`` and the ``units`` in that, and the
    rows below. There are no names if the first row is of numbers. ``texts`` are the cells of the
    first row of a log that are no numbers, by their place.
    """

    path: Path
    head: Row
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Iterator[Row]
    texts: Mapping[int, str] = field(default_factory=dict)

    @classmethod
    def read(
        cls, path: str | os.PathLike[str], expected: str, skip: int = 0, others: str = ""
    ) -> Table:
        """Read the head, below ``skip`` lines; arguments and errors are those of
        :func:`read_rows`.
        """
        rows = read_rows(path, expected, skip, others)
        head = next(rows)
        found = [match for cell in head.cells if (match := _HEADING.fullmatch(cell))]
        names, units = tuple(match[1] for match in found), tuple(match[2] or "" for match in found)
        return cls(Path(path), head, names, units, rows)

    @classmethod
    def recorded(cls, path: Path, expected: str, skip: int = 0) -> Table:
        """Read a table of values over time: the first row may be of numbers, and units may stand in
        a row below the heads.
        """
        table = cls.read(path, expected, skip)
        head, rows = table.head, table.rows
        unread = [cell for cell in head.cells if math.isnan(head.number(cell))]
        if meant := [cell for cell in unread if _is_meant(cell)]:
            raise DeclarationError(f"{head.where}: expected a finite number, got {meant[0]!r}")
        first: Row | None = head
        if not unread or _is_time(head.pointed(head.cells[0])):
            table = replace(table, names=(), units=("",) * len(head.cells))
        else:
            first = next(rows, None)
            words = [cell.strip("[]()") for cell in first.cells] if first else []
            ours = all(word in ("", *COUNTS) or known(word) is not None for word in words)
            if ours and not {"", "1"}.issuperset(words):
                units = (unit or word for unit, word in zip(table.units, words, strict=True))
                table, first = replace(table, units=tuple(units)), next(rows, None)
        if first is None:
            return table
        texts = {
            place: cell
            for place, (cell, unit) in enumerate(zip(first.cells, table.units, strict=True))
            if _TEXT.match(cell) and not unit and cell.lower() not in _MISSING
        }
        return replace(table, rows=chain([first], rows), texts=texts)

    def units_of(
        self,
        needed: Mapping[str, str],
        optional: Mapping[str, str] | None = None,
        usual: Mapping[str, str] | None = None,
    ) -> dict[str, Unit]:
        """Return the units of columns, each of which has one of the kind of a unit; of those that
        are ``optional``, if they are there. ``usual`` are those of heads without a unit.

        Raises :class:`.DeclarationError` for a column that is there twice, or is needed and is not
        there, and for units of other kinds.
        """
        found = {}
        for name, unit in {**needed, **(optional or {})}.items():
            where, many = self.head.where, self.names.count(name)
            if not many and name not in needed:
                continue
            if many != 1:
                raise DeclarationError(
                    f"{where}: expected one column '{name}' of {', '.join(needed)}, got"
                    f" {', '.join(self.head.cells)}"
                )
            word = self.units[self.names.index(name)] or (usual or {}).get(name, "")
            if wrong := differs(word or ("1" if unit == "1" else ""), unit):
                raise DeclarationError(f"{where}: column '{name}' is in {wrong}")
            found[name] = Unit.of(word or unit)
        return found

    def entries(self, what: str) -> Iterator[tuple[Row, dict[str, str]]]:
        """Rows with their cells by name, one for each of ``what``.

        Raises :class:`.DeclarationError` if there are none.
        """
        first = next(self.rows, None)
        if first is None:
            raise DeclarationError(
                f"{self.head.where}: expected a line for every {what} below this head"
            )
        for row in chain([first], self.rows):
            yield row, dict(zip(self.names, row.cells, strict=True))

    def named(self, what: str) -> Iterator[tuple[Row, str, dict[str, str]]]:
        """Rows with the name of one of ``what``, and their cells.

        Raises :class:`.DeclarationError` for a row without a name, and for a name that another has.
        """
        names = set[str]()
        for row, cells in self.entries(what):
            name = cells["name"]
            if not name.isprintable() or not name:
                raise DeclarationError(f"{row.where}: it has no name")
            if name in names:
                raise DeclarationError(f"{row.where}: {what} '{name}' is listed twice")
            names.add(name)
            yield row, name, cells

    def place(self, column: str | int, what: str = "column") -> int:
        """Return the place of a column, from 0, by its head, with or without unit, or its number
        from 1.
        """
        where, many = self.path.name, len(self.units)
        if isinstance(column, str):
            both = zip(self.head.cells, self.names, strict=False)
            found = [k for k, words in enumerate(both) if column in words] or self._joint(column)
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

    def _joint(self, name: str) -> list[int]:
        """Places of a joint's position in a log of ROS: below ``.../NAME/position``, or beside the
        column whose cells are its name, as ``position_0`` beside ``name_0``.
        """
        named = [self.head.cells[k] for k, cell in self.texts.items() if cell == name]
        heads = {"position".join(head.rsplit("name", 1)) for head in named if "name" in head}
        cells = enumerate(self.head.cells)
        return [k for k, head in cells if head in heads or head.endswith(f"/{name}/position")]

    def times(self, column: str | int | Sequence[str | int]) -> list[int]:
        """Places of the times: of one column, or of two with seconds and nanoseconds; where the
        first of these is named, the second may stand beside it.
        """
        if not isinstance(column, str | int):
            return [self.place(one, "column of times") for one in column]
        at = self.place(column, "column of times")
        beside = "\n".join(self.names[at : at + 2])
        return [at, at + 1] if _TWO_TIMES.fullmatch(beside) else [at]

    def columns(
        self, time: Sequence[int], places: Sequence[int], unit: str = "", gaps: bool = False
    ) -> tuple[Array, Clock]:
        """Return times [s], which increase, and the columns at some places, (1 + columns, rows),
        and the clock by which times were read, in a ``unit`` if that is stated; with ``gaps``,
        missing values are NaN.
        """
        found: list[list[float]] = []
        clock, before = Clock(_SI), ""
        called = self.head.cells if self.names else range(1, len(self.units) + 1)

        if unit and (wrong := differs(unit, "s")):
            raise DeclarationError(f"{self.path.name}: column '{called[time[0]]}' is in {wrong}")
        for row in self.rows:
            cells = [row.pointed(row.cells[place]) for place in time]
            try:
                clock = clock if found else Clock.of(cells, unit)
                numbers = [clock.read(cells)]
            except (ArithmeticError, ValueError):
                raise DeclarationError(
                    f"{row.where}, column '{called[time[0]]}': expected a finite number, or a time"
                    f" as 2025-01-31T12:00:00Z, got '{', '.join(cells)}'"
                ) from None
            for place in places:
                cell = row.cells[place]
                missing = gaps and cell.lower() in _MISSING
                numbers.append(math.nan if missing else row.finite(called[place], cell))
            if found and not numbers[0] > found[-1][0]:
                raise DeclarationError(
                    f"{row.where}: times must increase, but {' and '.join(cells)} follows {before}"
                )
            found.append(numbers)
            before = " and ".join(cells)
        return np.array(found, float).reshape(-1, 1 + len(places)).T, clock


def read_rows(
    path: str | os.PathLike[str], expected: str, skip: int = 0, names: str = ""
) -> Iterator[Row]:
    """The rows of a table in UTF-8 or UTF-16, the head first where it has one; lines that are empty
    or begin with ``#``, and the first ``skip`` lines, are passed over.

    Cells are parted by semicolons, tabs or commas: the first of these that the first row has, if
    it has any; below lines that were skipped, which other programs wrote, by spaces if it has none.
    Where they are not parted by commas, the decimal mark may be one, in all numbers or in none.
    Cells may be quoted; a row is one line, and all rows have as many cells.

    Raises :class:`.PathError` for what is no regular file, with the ``names`` that may stand in its
    place as :func:`.check_regular` says, or cannot be read as text, and
    :class:`.DeclarationError` for a row that is longer or shorter than the first, for a quote that
    does not end on its line, and for a file without rows, of which ``expected`` says what was.
    """
    check_regular(path, names)
    first, delimiter, length = "", "", 0
    marks: dict[str, str] | None = None
    try:
        with open(path, encoding=encoding_of(path)) as file:
            for number, line in enumerate(file, 1):
                if number <= skip or line.lstrip().startswith("#") or not line.strip():
                    continue
                if not first:
                    unquoted = _QUOTED.sub("", line)
                    usual = " " if skip else ";"
                    delimiter = next((mark for mark in _DELIMITERS if mark in unquoted), usual)
                    marks = None if delimiter == "," else {}
                where = f"{path}, line {number}"
                cells = _cells(where, line, delimiter)
                if not any(cells):
                    continue
                if not first:
                    first, length = line, len(cells)
                if len(cells) != length:
                    longer = line if len(cells) > length else first
                    comma = delimiter == "," and _TWO_NUMBERS.search(longer)
                    why = (
                        ": decimal commas? expected points, or ';' between cells"
                        if comma
                        else ", as in the first row"
                    )
                    raise DeclarationError(f"{where}: {len(cells)} cells, expected {length}{why}")
                yield Row(where, number, cells, marks)
    except (OSError, UnicodeError) as error:
        raise PathError(f"{path}: cannot be read as text: {one_line(error)}") from None
    if not first:
        raise DeclarationError(f"{path}: it has no rows; expected {expected}")


def for_each(
    place: str, names: Collection[str], what: str, given: Mapping[str, Given] | Given, usual: Given
) -> dict[str, Given]:
    """Return an option for each name, from one for all, or from a mapping that has some.

    Raises :class:`.UnknownNameError` for other names in the mapping.
    """
    if not isinstance(given, Mapping):
        return dict.fromkeys(names, given)
    check_known(what, given, names, place=place)
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
                raise DeclarationError(
                    f"{place}: column {columns[name]} is in {units[name] or 'no unit'}; expected"
                    f" counts, of which counts_per_turn= says {turn!r} are a turn"
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


def _cells(where: str, line: str, delimiter: str) -> tuple[str, ...]:
    try:
        line = " ".join(line.split()) if delimiter == " " else line
        (cells,) = csv.reader([line], delimiter=delimiter, strict=True)
    except csv.Error as error:
        why = (
            "a quote is opened and never closed"
            if str(error) == "unexpected end of data"
            else one_line(error)
        )
        raise DeclarationError(
            f"{where}: no cells with {delimiter!r} between them: {why}"
        ) from None
    return tuple(cell.strip() for cell in cells)


def encoding_of(path: str | os.PathLike[str]) -> str:
    """The encoding of a text: UTF-16 where the first bytes say so. Raises ``OSError``."""
    with open(path, "rb") as file:
        return "utf-16" if file.read(2) in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"


def _is_time(cell: str) -> bool:
    with suppress(ArithmeticError, ValueError):
        stamp([cell])
        return True
    return False


def _is_meant(cell: str) -> bool:
    """Return whether a cell that is no finite number is no word of a head either: ``nan``, ``1_0``,
    or digits of another script.
    """
    endless = cell.lower().lstrip("+-") in ("nan", "inf", "infinity")
    return endless or (any(map(str.isdigit, cell)) and not any(map(str.isalpha, cell)))

"""Rows of tables as people and programs write them, CSV of one kind or another, each with the line
on which it stands.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal

from ..errors import DeclarationError, PathError, check_kind, one_line
from .numerals import plain
from .streams import check_regular

_DELIMITERS = (";", "\t", ",")
_QUOTED = re.compile(r'"[^"]*"')
_DECIMAL = re.compile(r"[-+]?(?=[.,]?[0-9])[0-9]*([.,])[0-9]*(?:[eE][-+]?[0-9]+)?(?: *[a-z]+)?")
_HEADING = re.compile(r"(.*?)\s*(?:[\[(]\s*([^\[\]()]+?)\s*[\])])?")
_TWO_NUMBERS = re.compile("[0-9],[0-9]")
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

    def number(self, cell: str, per: int = 1) -> float:
        """A cell's number over ``per``, rounded once, so that 35 over 1000 is 0.035; NaN for what
        is no finite number.

        Raises :class:`.DeclarationError` as :meth:`pointed` does.
        """
        try:
            found = float(Decimal(plain(self.pointed(cell))) / per)
        except (ArithmeticError, ValueError):
            return math.nan
        return found if math.isfinite(found) else math.nan


def headings(cells: Sequence[str]) -> list[tuple[str, str]]:
    """Names of columns with their units, as of ``height [mm]`` or ``height (mm)``; an empty text
    if a cell has no unit.
    """
    found = (_HEADING.fullmatch(cell) for cell in cells)
    return [(match[1], match[2] or "") for match in found if match]


def read_rows(
    path: str | os.PathLike[str], expected: str, skip: int = 0, names: str = ""
) -> Iterator[Row]:
    """The rows of a table in UTF-8, the head first where it has one; lines that are empty or begin
    with ``#``, and the first ``skip`` lines, are passed over.

    Cells are parted by semicolons, tabs or commas: the first of these that the first row has, if
    it has any; below lines that were skipped, which other programs wrote, by spaces if it has none.
    Where they are not parted by commas, the decimal mark may be one, in all numbers or in none.
    Cells may be quoted; a row is one line, and all rows have as many cells.

    Raises :class:`.PathError` for what is no regular file, with the ``names`` that may stand in its
    place as :func:`.check_regular` says, or cannot be read as text, and
    :class:`.DeclarationError` for a row that is longer or shorter than the first, for a quote that
    does not end on its line, and for a file without rows, of which ``expected`` says what was.
    """
    check_kind("file", path, "a path", str, os.PathLike)
    check_regular(path, names)
    first, delimiter, length = "", "", 0
    marks: dict[str, str] | None = None
    try:
        with open(path, encoding="utf-8-sig") as file:
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
    except (OSError, UnicodeDecodeError) as error:
        raise PathError(f"{path}: cannot be read as text: {one_line(error)}") from None
    if not first:
        raise DeclarationError(f"{path}: it has no rows; expected {expected}")


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows as text, with commas and points; numbers have every digit they have."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


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

"""Rows of CSV files as people and programs write them, each with the line on which it stands."""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from ..errors import DeclarationError, PathError, check_kind, one_line

_DELIMITERS = (";", "\t", ",")


@dataclass(frozen=True)
class Row:
    """The cells of a line, without spaces round them. ``where`` names the file and the line, as errors do.

    ``comma`` tells whether the decimal point may be a comma.
    """

    where: str
    cells: tuple[str, ...]
    comma: bool = False

    def number(self, cell: str, per: int = 1) -> float:
        """A cell's number over ``per``, rounded once, so that 35 over 1000 is 0.035; NaN for what is no finite number."""
        try:
            found = float(Decimal("x" if "_" in cell else cell.replace(",", ".") if self.comma else cell) / per)
        except (ArithmeticError, ValueError):
            return math.nan
        return found if math.isfinite(found) else math.nan


def read_rows(path: str | os.PathLike[str], expected: str) -> list[Row]:
    """The rows of a CSV file in UTF-8, the head first where it has one; empty lines and those that begin with ``#`` are left out.

    Cells are parted by semicolons, tabs or commas: the first of these that the first row has. Where they are not parted by commas,
    the decimal point may be one. Cells may be quoted; a row is one line.

    Raises :class:`.PathError` for a file that cannot be read as text, and :class:`.DeclarationError` for a quote that does not end
    on its line, and for a file without rows, of which ``expected`` says what was.
    """
    check_kind("file", path, "a path", str, os.PathLike)
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").split("\n")
    except FileNotFoundError:
        raise PathError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise PathError(f"{path}: is a folder, not a file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise PathError(f"{path}: cannot be read as text: {one_line(error)}") from None
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not kept:
        raise DeclarationError(f"{path.name}: it has no rows; expected {expected}")
    delimiter = next((mark for mark in _DELIMITERS if mark in kept[0][1]), ",")
    return [_row(f"{path.name}, line {number}", line, delimiter) for number, line in kept]


def _row(where: str, line: str, delimiter: str) -> Row:
    try:
        (cells,) = csv.reader([line], delimiter=delimiter, strict=True)
    except csv.Error as error:
        why = "a quote is opened and never closed" if str(error) == "unexpected end of data" else one_line(error)
        raise DeclarationError(f"{where}: no cells with {delimiter!r} between them: {why}") from None
    return Row(where, tuple(cell.strip() for cell in cells), delimiter != ",")

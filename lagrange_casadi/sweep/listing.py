"""A list of designs from CSV: a head of parameters' names, and a line a design."""

from __future__ import annotations

import csv
import math
import os
from array import array
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

import numpy as np

from ..declare.angles import typed
from ..errors import DeclarationError, PathError, check_kind
from ..system.numerals import real
from .axes import Listed, check_known, not_parameter


def read_designs(path: str | os.PathLike[str], parameters: Collection[str] | None = None) -> Listed:
    """Read a list of designs, for :func:`.sweep`: a first line of parameters' names, then a line of values for each design.

    Cells are separated by commas, numbers have points, the text is UTF-8. Angles may have a unit, as ``30 deg``. Empty lines are
    passed over. Returns a :class:`.Listed`.

    With the names of ``parameters``, as of a mechanism, the head is checked against them before any number is read; without, a
    sweep checks it.

    Raises :class:`PathError` for no file, :class:`DeclarationError` for a head or a cell that is wrong, with its line and column.
    """
    check_kind("file", path, "a path", str, os.PathLike)
    if not Path(path).is_file():
        raise PathError(f"{path}: {'is a folder, not a file' if Path(path).is_dir() else 'no such file'}")
    values, lines, angles = array("d"), array("q"), dict[str, None]()
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = _rows(path, file)
            names = [name.strip() for name in next(rows, (1, []))[1]]
            _check_head(path, names)
            if parameters is not None:
                check_known(names, parameters, str(path))
            for line, row in rows:
                if not any(cell.strip() for cell in row):
                    continue
                if len(row) != len(names):
                    short = f", column '{names[len(row)]}' is missing" if len(row) < len(names) else ""
                    raise DeclarationError(f"{path}, line {line}: {len(row)} cells, expected {len(names)}{short}")
                for name, cell in zip(names, row, strict=True):
                    value, is_angle = typed(cell)
                    values.append(value if is_angle else _number(path, line, name, cell))
                    angles |= {name: None} if is_angle else {}
                lines.append(line)
    except UnicodeDecodeError as error:
        raise DeclarationError(f"{path}: not a table of text in UTF-8: {error}") from None
    except OSError as error:
        raise PathError(f"{path}: {error.strerror}") from None
    if not lines:
        raise DeclarationError(f"{path}: no designs below its head {', '.join(names)}")
    return Listed(tuple(names), np.array(values).reshape(-1, len(names)), np.array(lines), str(path), tuple(angles))


def _rows(path: str | os.PathLike[str], file: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
    """The rows, each with the line on which it begins."""
    reader = csv.reader(file, strict=True)
    while True:
        line = reader.line_num + 1
        try:
            yield line, next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            why = "a quote is opened and never closed" if str(error) == "unexpected end of data" else error
            raise DeclarationError(f"{path}, line {line}: not cells with commas between them: {why}") from None


def _check_head(path: str | os.PathLike[str], names: list[str]) -> None:
    if not any(names):
        raise DeclarationError(f"{path}: empty; expected a first line of parameters' names")
    if len(names) == 1 and (found := next((sign for sign in ";\t|" if sign in names[0]), "")):
        what = "a tab" if found == "\t" else f"'{found}'"
        raise DeclarationError(f"{path}, line 1: cells are separated by {what}, expected ',' (and '.' in numbers)")
    for column, name in enumerate(names, 1):
        place = f"{path}, line 1, column {column}"
        if not name:
            raise DeclarationError(f"{place}: expected a parameter's name, got an empty cell")
        if _is_number(name):
            raise DeclarationError(f"{place}: expected a parameter's name, got '{name}': put a line of names above the numbers")
        if ":" in name:
            raise DeclarationError(f"{place}: {not_parameter(name)}")
        if names.index(name) != column - 1:
            raise DeclarationError(f"{place}: '{name}' stands there already as column {names.index(name) + 1}")


def _is_number(text: str) -> bool:
    try:
        real(text)
    except ValueError:
        return False
    return True


def _number(path: str | os.PathLike[str], line: int, name: str, cell: str) -> float:
    try:
        value = real(cell)
        if not math.isfinite(value):
            raise ValueError
    except ValueError:
        raise DeclarationError(f"{path}, line {line}, column '{name}': expected a finite number, got '{cell.strip()}'") from None
    return value

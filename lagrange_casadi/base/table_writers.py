"""Tables as they are written: rows below a line of heads, as text, as CSV or as a workbook."""

from __future__ import annotations

import csv
import errno
import math
import os
import re
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from io import StringIO, TextIOWrapper
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any, BinaryIO, TextIO

from ..errors import DeclarationError, StoreError
from .files import check_writable, writing
from .packages import check_installed

Cell = float | str

_ROWS, _COLUMNS = 1_048_576, 16_384
"""Rows and columns of a workbook at most, heads included."""
_OTHER_BOOKS = (".xls", ".xlsb", ".xlsm", ".ods")
"""Suffixes of workbooks that are not written."""
_WIDTH = 12
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")


def head(name: str, unit: str) -> str:
    """The head of a column: its name, and its unit in brackets if it has one."""
    return name if unit in ("", "1") else f"{name} [{unit}]"


@dataclass(frozen=True)
class TableFile:
    """Place of a table: a workbook where ``path`` ends in .xlsx, else CSV.

    CSV has commas between cells and points in numbers; with ``decimal_comma`` it has semicolons
    and commas. Numbers in CSV have every digit they have, in a workbook 16.
    """

    path: Path
    decimal_comma: bool = False

    def __post_init__(self) -> None:
        """Raise where the table cannot be written, before anything is computed.

        Raises :class:`.DeclarationError` for a workbook with decimal commas or of another kind,
        :class:`.LagrangeCasadiError` where openpyxl is missing, :class:`.PathError` where no file
        can be put.
        """
        if self.path.suffix.lower() in _OTHER_BOOKS:
            raise DeclarationError(
                f"{self.path}: no table is written as {self.path.suffix}; use .csv or .xlsx"
            )
        if self._is_workbook:
            if self.decimal_comma:
                raise DeclarationError(
                    f"{self.path}: decimal commas are for CSV; a workbook has numbers, and the"
                    " spreadsheet program decides how to display them"
                )
            check_installed("openpyxl", "a workbook", "xlsx")
        check_writable(self.path)

    def write(self, heads: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
        """Write rows, which are put into their place at the end."""
        with self.written(heads, rows):
            pass

    @contextmanager
    def written(self, heads: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Iterator[None]:
        """Write rows, which are put into their place at the end, unless something fails."""
        with writing(self.path) as file:
            write = self._write_workbook if self._is_workbook else self._write_csv
            write(file, heads, rows)
            yield

    @property
    def _is_workbook(self) -> bool:
        return self.path.suffix.lower() == ".xlsx"

    def _write_csv(
        self, file: BinaryIO, heads: Sequence[str], rows: Iterable[Sequence[Cell]]
    ) -> None:
        text = TextIOWrapper(file, encoding="utf-8", newline="")
        write_csv(text, chain([heads], rows), self.decimal_comma)
        text.detach()
        file.flush()

    def _write_workbook(
        self, file: BinaryIO, heads: Sequence[str], rows: Iterable[Sequence[Cell]]
    ) -> None:
        if len(heads) > _COLUMNS:
            raise DeclarationError(
                f"{self.path}: {len(heads)} columns, but a workbook has {_COLUMNS} at most; write"
                " CSV"
            )
        import openpyxl
        from openpyxl.cell import WriteOnlyCell
        from openpyxl.utils import get_column_letter

        book = openpyxl.Workbook(write_only=True)
        sheet = book.create_sheet("table")
        sheet.freeze_panes = "A2"
        for column, words in enumerate(heads, 1):
            sheet.column_dimensions[get_column_letter(column)].width = max(len(words) + 2, _WIDTH)
        made = partial(_cell, WriteOnlyCell, sheet)
        try:
            with closing(sheet):
                for count, row in enumerate(chain([heads], rows)):
                    if count == _ROWS:
                        raise DeclarationError(
                            f"{self.path}: a workbook has {_ROWS} rows at most; write CSV"
                        )
                    sheet.append(list(map(made, row)))
        except Exception as error:
            if type(error).__module__ != "lxml.etree":
                raise
            code = getattr(errno, str(error).removeprefix("IO_"), errno.EIO)
            raise StoreError(
                f"cannot write {self.path}: the temporary folder {tempfile.gettempdir()}:"
                f" {os.strerror(code)}"
            ) from None
        book.save(file)


def _cell(of: Callable[..., Any], sheet: object, value: Cell) -> Any:
    """A cell of a sheet: what is no finite number is a text, and NaN is nothing."""
    if not isinstance(value, str):
        if math.isfinite(value):
            return value
        value = "" if math.isnan(value) else str(value)
    found = of(sheet, _UNPRINTABLE.sub("", value))
    found.data_type = "s"  # else what begins with = is a formula
    return found


def write_csv(text: TextIO, rows: Iterable[Sequence[object]], comma: bool = False) -> None:
    """Write rows with every digit of their numbers.

    Cells are parted by commas and numbers have points, or, if they have a ``comma``, semicolons.
    """
    writer = csv.writer(text, delimiter=";" if comma else ",", lineterminator="\n")
    writer.writerows([_with_comma(cell) for cell in row] if comma else row for row in rows)


def _with_comma(cell: object) -> object:
    return cell if isinstance(cell, str) else repr(cell).replace(".", ",")


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Return rows as CSV with points in numbers."""
    text = StringIO()
    write_csv(text, rows)
    return text.getvalue()


def aligned(
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    left: Collection[int] = (),
    width: int = 0,
    indent: str = "  ",
) -> Iterator[str]:
    """Rows of texts below their heads as lines, in columns of some ``width`` at least; those of
    ``left`` begin at the left. A column without any text has no head.
    """
    columns = [list(cells) for cells in zip_longest(heads, *rows, fillvalue="")]
    columns = [cells if any(cells[1:]) else [""] * len(cells) for cells in columns]
    widths = [max(width, *map(len, cells)) for cells in columns]
    for row in zip(*columns, strict=True):
        words = [
            f"{word:{'<' if k in left else '>'}{width}}"
            for k, (word, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield f"{indent}{'  '.join(words)}".rstrip()

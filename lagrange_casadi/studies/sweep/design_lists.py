"""A list of designs from CSV: a head of parameters' names, which may have units, and a line a
design.
"""

from __future__ import annotations

import math
import os
from array import array
from collections.abc import Collection, Sequence

import numpy as np

from ...base.arguments import public
from ...base.csv_table import Row, Table
from ...base.units import typed
from ...errors import DeclarationError
from .axes import Listed, check_known, not_parameter


@public
def read_designs(path: str | os.PathLike[str], parameters: Collection[str] | None = None) -> Listed:
    """Read a list of designs from CSV, for :func:`.sweep`.

    The first line names parameters; every other line has the values of a design. Cells are
    separated as :func:`.read_rows` says. Values may have a unit, as ``30 deg``, or the head has
    that of its column, as ``l [mm]``.

    Parameters
    ----------
    path
        The file.
    parameters
        Names of a mechanism's parameters, with which the first line is compared before any number
        is read; by default the sweep compares them.

    Returns
    -------
    Listed
        The designs.

    Raises
    ------
    PathError
        If there is no such file.
    DeclarationError
        For a wrong name or cell, with its line and column.
    """
    table = Table.read(path, "a first line of parameters' names")
    head, names = table.head, table.names
    _check_head(head, names)
    if parameters is not None:
        check_known(names, parameters, head.where)
    values, lines, texts, units = array("d"), array("q"), array("b"), dict[str, str]()
    for row in table.rows:
        for name, column_unit, cell in zip(names, table.units, row.cells, strict=True):
            value, unit = typed(row.pointed(cell))
            if column_unit and not unit:
                value, unit = typed(f"{value} {column_unit}")
            values.append(value if unit else row.finite(name, cell))
            unit = unit or column_unit
            texts.append(bool(unit))
            if unit and units.setdefault(name, unit) != unit:
                raise DeclarationError(
                    f"{row.where}: {name}: expected a value in {units[name]}, got '{cell}'"
                )
        lines.append(row.line)
    if not lines:
        raise DeclarationError(f"{path}: no designs below its head {', '.join(head.cells)}")
    rows_of_values = np.array(values).reshape(-1, len(names))
    read = np.array(texts, bool).reshape(rows_of_values.shape)
    return Listed(names, rows_of_values, np.array(lines), str(path), units, read)


def _check_head(head: Row, names: Sequence[str]) -> None:
    for column, name in enumerate(names, 1):
        place = f"{head.where}, column {column}"
        if not name:
            raise DeclarationError(f"{place}: expected a parameter's name, got an empty cell")
        if not math.isnan(head.number(name)):
            raise DeclarationError(
                f"{place}: expected a parameter's name, got '{name}': put a line of names above the"
                " numbers"
            )
        if ":" in name:
            raise DeclarationError(f"{place}: {not_parameter(name)}")
        if names.index(name) != column - 1:
            raise DeclarationError(f"{place}: '{name}' is already column {names.index(name) + 1}")

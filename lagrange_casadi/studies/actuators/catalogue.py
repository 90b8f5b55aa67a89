"""A catalogue of motors, read from CSV."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path

from ...base.arguments import public
from ...base.csv_table import Row, Table
from ...base.units import Unit
from ...errors import DeclarationError
from .classes import CLASSES
from .motor import UNITS, Motor

_ROTARY = ("stall_torque", "rated_torque", "rated_speed", "peak_torque", "max_speed", "inertia")
_LINEAR = ("stall_force", "rated_force", "rated_speed", "peak_force", "max_speed", "mass")
_KNEE = ("knee_speed", "end_torque"), ("knee_speed", "end_force")
_LASTS = "time_constant"


@public
def read_motors(path: str | os.PathLike[str]) -> list[Motor]:
    """Read motors from a CSV file.

    Parameters
    ----------
    path : path
        A file with a motor in each row, and these columns in any order: name, stall_torque,
        rated_torque, peak_torque [N m], rated_speed, max_speed [1/min] and inertia [kg m^2]; of
        linear motors name, stall_force, rated_force, peak_force [N], rated_speed, max_speed [m/s]
        and mass [kg]. Optional are knee_speed with end_torque or end_force, and time_constant [s].
        Other units stand in the head, as ``inertia [kg cm^2]``. Cells are separated as
        :func:`.read_rows` describes. If there is no such file, ``"servo"`` and ``"induction"`` are
        classes of motors, whose numbers follow from a rule and are no maker's.

    Returns
    -------
    list of Motor
        The motors, in the order of the file.

    Raises
    ------
    PathError
        If the file cannot be read.
    DeclarationError
        For a column that is missing, or a row that is not a motor, with the number of its line.
    """
    if str(path) in CLASSES and not Path(path).exists():
        return CLASSES[str(path)].motors(str(path))
    classes = f"classes: {', '.join(CLASSES)}"
    table = Table.read(path, f"the columns name, {', '.join(_ROTARY)}", others=classes)
    linear = not {"stall_force", "rated_force", "peak_force"}.isdisjoint(table.names)
    needed, knee = (_LINEAR if linear else _ROTARY), _KNEE[linear]
    if sum(column in table.names for column in knee) == 1:
        raise DeclarationError(
            f"{table.head.where}: expected both columns {' and '.join(knee)}, or none"
        )
    names = (*needed, *knee, _LASTS)
    columns = dict(zip(names, (unit[linear] for unit in UNITS.values()), strict=True))
    units = table.units_of(
        {"name": "1"} | {name: columns[name] for name in needed},
        {name: columns[name] for name in (*knee, _LASTS)},
        {name: "rpm" if unit == "rad/s" else unit for name, unit in columns.items()},
    )
    del units["name"]
    return [
        _motor(row, name, cells, units, needed, knee, linear)
        for row, name, cells in table.named("motor")
    ]


def _motor(
    row: Row,
    name: str,
    cells: Mapping[str, str],
    units: dict[str, Unit],
    needed: tuple[str, ...],
    knee: tuple[str, str],
    linear: bool,
) -> Motor:
    zeros = (needed[-1], *knee)
    numbers = {
        column: row.positive(column, cells[column], unit, zero=column in zeros)
        for column, unit in units.items()
        if column in needed or cells[column]
    }
    stall, rated, rated_speed, peak, most, inertia = (numbers[column] for column in needed)
    if rated > stall or stall > peak or rated_speed > most:
        relation = f"{needed[1]} <= {needed[0]} <= {needed[3]}"
        raise DeclarationError(f"{row.where}: expected {relation}, and rated_speed <= max_speed")
    if (knee[0] in numbers) != (knee[1] in numbers):
        raise DeclarationError(f"{row.where}: expected both {' and '.join(knee)}, or none")
    if knee[0] in numbers and not (numbers[knee[0]] <= most and numbers[knee[1]] <= peak):
        raise DeclarationError(
            f"{row.where}: expected knee_speed <= max_speed, and {knee[1]} <= {needed[3]}"
        )
    limits = numbers.get(knee[0]), numbers.get(knee[1]), numbers.get(_LASTS, math.inf)
    main = stall, rated, rated_speed, peak, most, inertia
    return Motor(name, *main, *limits, linear=linear)

"""A catalogue of motors, read from CSV."""

from __future__ import annotations

import math
import os
from pathlib import Path

from ...base.arguments import public
from ...base.csv_rows import Row, headings, read_rows
from ...errors import DeclarationError
from .classes import CLASSES
from .motor import Motor

_RPM = math.tau / 60.0
_ROTARY = ("stall_torque", "rated_torque", "rated_speed", "peak_torque", "max_speed", "inertia")
_LINEAR = ("stall_force", "rated_force", "rated_speed", "peak_force", "max_speed", "mass")
_KNEE = ("knee_speed", "end_torque"), ("knee_speed", "end_force")
_LASTS = "time_constant"
_UNITS = {
    "torque": {"N m": 1.0, "N cm": 1e-2, "mN m": 1e-3},
    "force": {"N": 1.0, "kN": 1e3},
    "turning": {"1/min": _RPM, "rad/s": 1.0},
    "sliding": {"m/s": 1.0, "mm/s": 1e-3},
    "inertia": {"kg m^2": 1.0, "kg cm^2": 1e-4, "g cm^2": 1e-7},
    "mass": {"kg": 1.0, "g": 1e-3},
    "constant": {"s": 1.0, "min": 60.0},
}
"""The units that a column may have, by the last word of its name; the first is meant where none is
said.
"""


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
    rows = read_rows(path, f"the columns name, {', '.join(_ROTARY)}", names=classes)
    head = next(rows)
    names = [name for name, _ in headings(head.cells)]
    linear = any(name in names for name in ("stall_force", "rated_force", "peak_force"))
    needed, knee = (_LINEAR if linear else _ROTARY), _KNEE[linear]
    if missing := [column for column in ("name", *needed) if column not in names]:
        raise DeclarationError(
            f"{head.where}: it lacks the column '{missing[0]}'; expected name, {', '.join(needed)}"
        )
    if sum(column in names for column in knee) == 1:
        raise DeclarationError(f"{head.where}: expected both columns {' and '.join(knee)}, or none")
    if twice := [column for column in ("name", *needed, *knee, _LASTS) if names.count(column) > 1]:
        raise DeclarationError(f"{head.where}: the column '{twice[0]}' is listed twice")
    units = {
        column: _unit(head, column, unit, linear)
        for column, unit in headings(head.cells)
        if column in (*needed, *knee, _LASTS)
    }
    motors: dict[str, Motor] = {}
    for row in rows:
        motor = _motor(row, names, units, needed, knee, linear)
        if motor.name in motors:
            raise DeclarationError(f"{row.where}: motor '{motor.name}' is listed twice")
        motors[motor.name] = motor
    if not motors:
        raise DeclarationError(f"{head.where}: expected at least one motor below the heads")
    return list(motors.values())


def _unit(head: Row, column: str, unit: str, linear: bool) -> float:
    """SI unit of a column."""
    kind = column.rpartition("_")[2]
    units = _UNITS[("sliding" if linear else "turning") if kind == "speed" else kind]
    if unit and unit not in units:
        raise DeclarationError(
            f"{head.where}: column '{column}' cannot be in '{unit}'; valid: {', '.join(units)}"
        )
    return units[unit] if unit else next(iter(units.values()))


def _motor(
    row: Row,
    names: list[str],
    units: dict[str, float],
    needed: tuple[str, ...],
    knee: tuple[str, str],
    linear: bool,
) -> Motor:
    cells = dict(zip(names, row.cells, strict=True))
    if not cells["name"]:
        raise DeclarationError(f"{row.where}: a motor without a name")
    numbers: dict[str, float] = {}
    for column, unit in units.items():
        if column not in needed and not cells[column]:
            continue
        number = row.number(cells[column])
        if not number >= 0.0 or (number == 0.0 and column not in (needed[-1], *knee)):
            raise DeclarationError(
                f"{row.where}: {column} must be a positive number, got {cells[column]!r}"
            )
        numbers[column] = number * unit
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
    return Motor(cells["name"], *main, *limits, linear=linear)

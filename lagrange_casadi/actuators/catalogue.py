"""A catalogue of motors: read from CSV, checked against a duty, and the smallest that serves."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..declare.density import Array
from ..errors import DeclarationError, NoDesignError, PathError, one_line
from .duty import Duty

_RPM = math.tau / 60.0
_COLUMNS = ("name", "stall_torque", "rated_torque", "rated_speed", "peak_torque", "max_speed", "inertia")


@dataclass(frozen=True)
class Motor:
    """A motor: torques in N m, speeds in rad/s, the rotor's inertia in kg m^2.

    It bears ``stall_torque`` for ever at rest and ``rated_torque`` at its ``rated_speed``, linear between and on; ``peak_torque``
    for a short time, and no speed above ``max_speed``.
    """

    name: str
    stall_torque: float
    rated_torque: float
    rated_speed: float
    peak_torque: float
    max_speed: float
    inertia: float

    def lasting(self, speed: float | Array) -> Array:
        """The torque that it bears for ever at a speed [N m], zero where there is none."""
        fall = (self.stall_torque - self.rated_torque) / self.rated_speed
        return np.maximum(self.stall_torque - fall * np.abs(speed), 0.0)

    @property
    def rated_power(self) -> float:
        """At its rated speed [W]."""
        return self.rated_torque * self.rated_speed


@dataclass(frozen=True, eq=False)
class Choice:
    """A motor with a gear ratio and what it does: its ``duty``, and how much of its limits that takes, each 1 at most.

    ``refused`` says of each smaller motor why it does not serve.
    """

    motor: Motor
    duty: Duty
    heat: float
    torque: float
    speed: float
    refused: tuple[str, ...]

    @property
    def ratio(self) -> float:
        """The gear ratio."""
        return self.duty.ratio


def read_motors(path: str | Path) -> list[Motor]:
    """The motors of a CSV file with the columns name, stall_torque, rated_torque, peak_torque [N m], rated_speed, max_speed [1/min]
    and inertia [kg m^2], in any order and beside others; columns are parted by commas, semicolons or tabs.

    Raises :class:`.PathError` for a file that cannot be read, :class:`.DeclarationError` for a column that is missing, and for a
    line that is no motor, by its number.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise PathError(f"{path}: cannot be read as text: {one_line(error)}") from None
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not kept:
        raise DeclarationError(f"{path.name}: it has no motors; expected the columns {', '.join(_COLUMNS)}")
    delimiter = next((mark for mark in (";", "\t") if mark in kept[0][1]), ",")
    rows = [[cell.strip() for cell in row] for row in csv.reader([line for _, line in kept], delimiter=delimiter)]
    missing = [column for column in _COLUMNS if column not in rows[0]]
    if missing:
        raise DeclarationError(f"{path.name}: it lacks the column '{missing[0]}'; expected {', '.join(_COLUMNS)}")
    places = {column: rows[0].index(column) for column in _COLUMNS}
    motors = [_motor(f"{path.name}, line {number}", row, places) for (number, _), row in zip(kept[1:], rows[1:], strict=True)]
    if not motors:
        raise DeclarationError(f"{path.name}: it has no motors, only heads")
    return motors


def _motor(where: str, row: Sequence[str], places: dict[str, int]) -> Motor:
    if len(row) <= max(places.values()):
        raise DeclarationError(f"{where}: expected {max(places.values()) + 1} columns or more, got {len(row)}")
    numbers: dict[str, float] = {}
    for column in _COLUMNS[1:]:
        cell = row[places[column]]
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number) or number < 0.0 or (number == 0.0 and column != "inertia"):
            raise DeclarationError(f"{where}: {column} must be a positive number, got {cell!r}")
        numbers[column] = number * (_RPM if column.endswith("speed") else 1.0)
    motor = Motor(row[places["name"]], **numbers)
    if not motor.name:
        raise DeclarationError(f"{where}: a motor without a name")
    if motor.rated_torque > motor.stall_torque or motor.stall_torque > motor.peak_torque or motor.rated_speed > motor.max_speed:
        raise DeclarationError(f"{where}: expected rated_torque <= stall_torque <= peak_torque, and rated_speed <= max_speed")
    return motor


def select(motors: Iterable[Motor], duty: Callable[[float, float], Duty], *, ratios: Sequence[float] = (1.0,)) -> Choice:
    """The smallest motor that serves, by rated power, with the ratio that heats it least.

    ``duty(ratio, inertia)`` is what a ratio asks of a motor whose rotor has an inertia, as
    ``lambda ratio, inertia: duty_of(solution, "J", ratio=ratio, inertia=inertia)``. A motor serves where the root mean square of
    its torque is no more than it bears for ever at the mean speed, no torque is above its peak torque and no speed above its
    largest one.

    Raises :class:`.NoDesignError` where none serves, with the motor that comes nearest, and :class:`.DeclarationError` for none.
    """
    given = sorted(motors, key=lambda motor: (motor.rated_power, motor.name))
    if not given or not list(ratios):
        raise DeclarationError("select: expected motors, and ratios")
    refused: list[str] = []
    nearest: Choice | None = None
    for motor in given:
        tried = [_judged(motor, duty(float(ratio), motor.inertia), tuple(refused)) for ratio in ratios]
        serving = [choice for choice in tried if _worst(choice) <= 1.0]
        if serving:
            return min(serving, key=lambda choice: choice.heat)
        best = min(tried, key=_worst)
        refused.append(f"{motor.name}: {_told(best)}")
        nearest = best if nearest is None or _worst(best) < _worst(nearest) else nearest
    assert nearest is not None
    raise NoDesignError(f"no motor of {len(given)} serves; nearest comes {nearest.motor.name}: {_told(nearest)}")


def _judged(motor: Motor, duty: Duty, refused: tuple[str, ...]) -> Choice:
    lasting = float(motor.lasting(duty.mean_speed))
    heat = duty.rms_torque / lasting if lasting > 0.0 else math.inf
    return Choice(motor, duty, heat, duty.peak_torque / motor.peak_torque, duty.peak_speed / motor.max_speed, refused)


def _worst(choice: Choice) -> float:
    return max(choice.heat, choice.torque, choice.speed)


def _told(choice: Choice) -> str:
    """Which limit is broken most, and by how much."""
    shares = {"heat": choice.heat, "peak torque": choice.torque, "speed": choice.speed}
    what = max(shares, key=lambda name: shares[name])
    return f"{what} {100.0 * shares[what]:.3g} % of what it bears, with a ratio of {choice.ratio:g}"

"""Motions that a controller has recorded or will play: columns of a CSV file, in its units,
smoothed, as one smooth curve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from ..arguments import public
from ..base.arrays import Array
from ..base.csv_rows import read_rows
from ..base.units import UNITS, count, number
from ..errors import DeclarationError, NumberError, UnknownNameError, one_line
from .curves import Curve, curve
from .expressions import coordinates, scalar, symbols_of
from .motion import Motion
from .parts import Expression

_UNITS = UNITS["rad"] | UNITS["m"]
_TIMES = UNITS["s"]
_LEAST = 5
"""So many rows are needed at least for four pieces."""

_CLOSES = 6.0
"""Largest difference of the ends of a cycle, as a multiple of the noise."""

_SAME = 1e-9
"""Largest relative difference of the ends if nothing is smoothed."""

_FOURTH = 70.0
"""The variance of the fourth difference of noise, over that of the noise: 1 + 16 + 36 + 16 + 1."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Values over time as a file has them, times in s, values in their ``unit``, and how they are
    called.
    """

    name: str
    unit: str
    t: Array
    values: Array


@public
def read_samples(
    path: str | Path,
    *,
    value: str | int = 2,
    time: str | int = 1,
    unit: str = "rad",
    time_unit: str = "s",
    smoothing: float | str = 0.0,
    points: int | None = None,
    periodic: bool = False,
    period: float | None = None,
    advance: float = 0.0,
    ratio: Expression = 1.0,
    offset: Expression = 0.0,
    stretch: Expression = 1.0,
) -> Motion:
    """A motion through the values that a controller has recorded, or is to play, from a CSV file.

    Parameters
    ----------
    path
        The file. Columns are parted by semicolons, tabs or commas; where they are not parted by
        commas, a comma may be the decimal mark, in all numbers or in none. Lines that begin with
        ``#`` are passed over.
    value, time
        The columns of the values and of the times: by their name in the first line, or by their
        number, from 1.
    unit, time_unit
        The units in the file: ``rad``, ``deg``, ``turn``, or ``m``, ``cm``, ``mm``, ``um``; ``s``,
        ``ms`` or ``us``.
    smoothing
        The noise of the values, in their unit: the law is the least bent curve whose distance from
        them, in the root mean square, is so much. Zero passes through all of them; ``"estimated"``
        takes the noise from their fourth differences, which is right where times are even and noise
        is all that changes from one value to the next.
    points
        The curve is taken at so many even times, first and last included, and the law goes smoothly
        through these.
    periodic, period, advance
        Whether it goes on over and over. The last row then says again what the first says, or is
        ``advance`` beyond it [unit]. A file that leaves out that row needs the ``period`` [time
        unit].
    ratio, offset, stretch
        Numbers or expressions of parameters: the law is offset [rad or m] + ratio times the values,
        and takes ``stretch`` times as long.

    Notes ----- Raises :class:`.PathError` for a file that cannot be read,
    :class:`.DeclarationError` for a line that is no row of numbers, times that do not rise, and
    ends of a cycle that differ, and :class:`.UnknownNameError` for columns and units that are not.
    """
    path = Path(path)
    units = ((unit, _UNITS, "unit"), (time_unit, _TIMES, "time unit"))
    for name, valid, what in units:
        if name not in valid:
            raise UnknownNameError(what, str(name), valid, place=path.name)
    for what, setting in (("period", period), ("advance", advance)):
        _finite(f"{path.name}: {what}", 0.0 if setting is None else setting)
    words = ("ratio", "offset", "stretch")
    (ahead,), unit_in = coordinates(f"{path.name}: offset", [(offset, "")])
    each = zip(words, (ratio, ahead, stretch), strict=True)
    scales = [scalar(f"{path.name}: {word}", x, symbols_of(x), "parameter") for word, x in each]
    recording = _read(path, time, value, unit, _TIMES[time_unit])
    if periodic or period is not None:
        recording = _closed(
            recording, None if period is None else period * _TIMES[time_unit], advance
        )
    elif advance:
        raise DeclarationError(f"{path.name}: advance= needs periodic=True")
    noise = _noise(recording, smoothing)
    return _law(recording, noise, points, periodic or period is not None, advance, scales, unit_in)


def _finite(what: str, value: object) -> None:
    """Raise :class:`DeclarationError` for what is no finite number."""
    try:
        number(value)
    except NumberError as error:
        raise DeclarationError(f"{what}: {error}") from None


def _is_meant(cell: str) -> bool:
    """Return whether a cell that is no finite number is no word of a head either: ``nan``, ``1_0``,
    or digits of another script.
    """
    endless = cell.lower().lstrip("+-") in ("nan", "inf", "infinity")
    return endless or (any(map(str.isdigit, cell)) and not any(map(str.isalpha, cell)))


def _read(path: Path, time: str | int, value: str | int, unit: str, second: float) -> Recording:
    """The two columns of a file."""
    rows = read_rows(path, "columns of times and values")
    first = next(rows)
    unread = [cell for cell in first.cells if math.isnan(first.number(cell))]
    if meant := [cell for cell in unread if _is_meant(cell)]:
        raise DeclarationError(f"{first.where}: expected a finite number, got {meant[0]!r}")
    headed = bool(unread)
    wanted = [
        _column(path.name, column, first.cells if headed else (), len(first.cells))
        for column in (time, value)
    ]
    found: list[list[float]] = []
    for row in rows if headed else chain([first], rows):
        cells = [row.cells[column] for column in wanted]
        numbers = [row.number(cell) for cell in cells]
        for cell, found_number in zip(cells, numbers, strict=True):
            if math.isnan(found_number):
                raise DeclarationError(f"{row.where}: expected a finite number, got {cell!r}")
        if found and not numbers[0] > found[-1][0]:
            raise DeclarationError(
                f"{row.where}: times must increase, but {cells[0]} follows {found[-1][0]:g}"
            )
        found.append(numbers)
    if len(found) < _LEAST:
        raise DeclarationError(
            f"{path.name}: expected at least {_LEAST} rows of numbers, got {len(found)}"
        )
    t, values = np.array(found).T
    return Recording(path.name, unit, t * second, values)


def _column(place: str, column: str | int, heads: Sequence[str], many: int) -> int:
    if isinstance(column, str):
        if heads.count(column) != 1:
            raise UnknownNameError(
                "column", column, heads or [f"the numbers 1 to {many}"], place=place
            )
        return heads.index(column)
    if isinstance(column, bool) or not isinstance(column, int) or not 1 <= column <= many:
        raise DeclarationError(
            f"{place}: column {column!r} is not one of its {many} columns, numbered from 1"
        )
    return column - 1


def _closed(recording: Recording, period: float | None, advance: float) -> Recording:
    """A recording whose last row closes the cycle."""
    if period is None:
        return recording
    t, values = recording.t, recording.values
    end = t[0] + period
    if not t[-1] < end:
        lasts = f"its rows last {t[-1] - t[0]:.6g} s, but the period is {period:.6g} s"
        raise DeclarationError(f"{recording.name}: {lasts}; expected rows of exactly one period")
    return Recording(
        recording.name, recording.unit, np.append(t, end), np.append(values, values[0] + advance)
    )


def _noise(recording: Recording, smoothing: float | str) -> float:
    """The noise that is to be smoothed away, in the unit of the values."""
    if smoothing == "estimated":
        return float(np.sqrt(np.mean(np.diff(recording.values, 4) ** 2) / _FOURTH))
    if (
        isinstance(smoothing, bool)
        or not isinstance(smoothing, (int, float))
        or not 0.0 <= smoothing < math.inf
    ):
        raise DeclarationError(
            f"{recording.name}: smoothing expected the noise [{recording.unit}], a number of at"
            f" least 0, or 'estimated', got {smoothing!r}"
        )
    return float(smoothing)


def _law(
    recording: Recording,
    noise: float,
    points: int | None,
    periodic: bool,
    advance: float,
    scales: Sequence[Expression],
    unit_in: str,
) -> Motion:
    t, values, size = recording.t, recording.values, _UNITS[recording.unit]
    whole = float(t[-1] - t[0])
    climb = advance / whole
    level = values - climb * (t - t[0])
    if periodic:
        gap = float(level[-1] - level[0])
        if abs(gap) > max(_CLOSES * noise, _SAME * float(np.ptp(values))):
            beyond = f"{advance:g} {recording.unit} beyond the first" if advance else "the first"
            raise DeclarationError(
                f"{recording.name}: the last value of a periodic motion must be {beyond}, but it"
                f" is off by {gap:.6g} {recording.unit}; set advance=, or set period= if the last"
                " row of the period is missing"
            )
        level[-1] = level[0]
    found = _curve(recording.name, t, level, periodic, noise)
    if points is not None:
        count(f"{recording.name}: points", points, _LEAST)
        even = np.linspace(t[0], t[-1], points)
        found = _curve(recording.name, even, np.asarray(found(even)), periodic, 0.0)
    off = float(np.abs(np.asarray(found(t)) - level).max())
    ratio, offset, stretch = scales
    start, rate = float(t[0]), climb * size

    def graph(time: Expression) -> Expression:
        at = time if isinstance(stretch, float) and stretch == 1.0 else time / stretch
        value = size * found(at)
        if rate:
            value = value + rate * (at - start)
        value = value if isinstance(ratio, float) and ratio == 1.0 else ratio * value
        return value if isinstance(offset, float) and offset == 0.0 else offset + value

    every = f", resampled at {points} equally spaced times" if points else ""
    smoothed = f", smoothed by {noise:.3g} {recording.unit}" if noise else ""
    told = (
        f"{t.size} samples of {recording.name} from {t[0]:g} to {t[-1]:g}"
        f" s{', repeated' if periodic else ''}"
    )
    return Motion(
        graph,
        description=f"{told}{smoothed}{every}, at most {off:.3g} {recording.unit} off",
        unit=unit_in,
    )


def _curve(name: str, t: Array, values: Array, periodic: bool, noise: float) -> Curve:
    values = values.copy()
    if periodic:
        values[-1] = values[0]
    try:
        return curve(t.tolist(), values.tolist(), periodic=periodic, smoothing=noise)
    except DeclarationError as error:
        raise DeclarationError(f"{name}: {one_line(error)}") from None

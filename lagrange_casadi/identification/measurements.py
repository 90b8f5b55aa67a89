"""Measurements of a machine: motion and forces over time, with their noise, from a CSV file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import chain
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..arguments import NotNegative, Positive, public
from ..base.arrays import Array
from ..base.brief import Brief
from ..base.csv_rows import Row, headings, read_rows
from ..base.units import UNITS
from ..declare.curves import curve
from ..errors import DeclarationError, UnknownNameError
from .regressor import MOTION, DrivenMotion

_UNITS: dict[str, dict[str, float]] = {
    **UNITS,
    "rad/s": {"rad/s": 1.0, "deg/s": math.radians(1.0)},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": math.radians(1.0)},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0, "kN m": 1e3, "mN m": 1e-3},
    "W": {"W": 1.0, "kW": 1e3},
    "1": {"1": 1.0, "ustrain": 1e-6},
}
"""Units that a column may have, and their sizes, for each SI unit."""

_SIZES = {word: (unit, size) for unit, words in _UNITS.items() for word, size in words.items()}
_COUNTS = ("count", "counts")
_EMPTY = ("", "nan", "na", "n/a", "null", "-")
"""Cells of values that are missing."""

_QUANTUM = 1.0 / math.sqrt(12.0)
"""Root mean square of what rounding to whole counts leaves."""

_PART = 0.25
"""Largest step of an angle [turn] that is none from one turn to the next."""

_FEWEST = 8
_DECAY = math.sqrt(math.log(2.0)) / (2.0 * math.pi)
"""Width of a Gaussian kernel [s] times the frequency [Hz] at which it halves the power."""

_REACH = 4.0
"""Widths of a kernel beyond which its weight is nothing."""


@public
@dataclass(frozen=True, eq=False, repr=False)
class Measurements(Brief):
    """Columns over time.

    Parameters
    ----------
    t
        Increasing times (n,) [s]; they need not be even.
    columns
        Values (n,) in SI units, NaN if missing, by name: a driven coordinate, as ``J1``, and if
        measured its ``J1_rate`` and ``J1_acceleration``; and forces, as ``effort:J1``,
        ``reaction:A:fx``, ``section:rod:bending@0.5``, ``strain:rod:side +y@0.5``.
    noise
        Standard deviation of columns, in SI units, by name. That of a coordinate smooths it; that
        of a force weighs it. Forces that are not named have theirs estimated.
    name
        Name for messages.
    units
        Units in which columns were measured, by name, as ``deg`` or ``N m``. :func:`.identify`
        refuses a column whose unit is not one of its quantity.

    Raises
    ------
    DeclarationError
        For times that do not increase, columns of other lengths or without values, and noise that
        is negative.
    """

    t: Array
    columns: Mapping[str, Array]
    noise: Mapping[str, NotNegative] = field(default_factory=dict)
    name: str = "measurements"
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        t = np.asarray(self.t, float)
        if t.ndim != 1 or t.size < _FEWEST:
            raise DeclarationError(
                f"{self.name}: expected at least {_FEWEST} rows of measurements, got {t.size}"
            )
        if not (rising := np.diff(t) > 0.0).all():
            k = int(np.argmin(rising))
            raise DeclarationError(
                f"{self.name}: expected times that increase, got {t[k]:.9g} s and then"
                f" {t[k + 1]:.9g} s in rows {k + 1} and {k + 2}"
            )
        columns = {name: np.asarray(values, float) for name, values in self.columns.items()}
        for name, values in columns.items():
            if values.shape != t.shape:
                raise DeclarationError(
                    f"{self.name}: column '{name}': expected {t.size} values, one a time, got"
                    f" {values.size}"
                )
            if not np.isfinite(values).any():
                raise DeclarationError(f"{self.name}: column '{name}' has no values")
        if unknown := [name for name in self.noise if name not in columns]:
            raise UnknownNameError("column of noise=", unknown, columns, place=self.name)
        if wrong := [name for name, noise in self.noise.items() if not 0.0 <= noise < math.inf]:
            raise DeclarationError(
                f"{self.name}: noise of '{wrong[0]}': expected a number that is not negative, got"
                f" {self.noise[wrong[0]]:g}"
            )
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "columns", columns)

    def quantities(self, drives: Sequence[str]) -> tuple[str, ...]:
        """Return the names of the forces: the columns that are no motion of the drives, and whose
        names have a colon.

        Parameters
        ----------
        drives : sequence of str
            Names of the drives.

        Returns
        -------
        tuple of str
            Names of the other columns.
        """
        moving = {f"{drive}{end}" for drive in drives for end in MOTION}
        return tuple(name for name in self.columns if name not in moving and ":" in name)

    def motion(self, drives: Sequence[str], trim: float = 0.0) -> DrivenMotion:
        """Return coordinates, rates and accelerations of drives.

        What is not measured comes from the smoothing spline of the coordinate, at the distance of
        its noise from the points.

        Parameters
        ----------
        drives : sequence of str
            Names of the drives.
        trim : float
            Time at both ends that does not count [s]: NaN stands there.

        Returns
        -------
        DrivenMotion
            A column for each drive [rad or m, per second, per second squared].

        Raises
        ------
        UnknownNameError
            If a drive has no column.
        DeclarationError
            If a drive has too few values, or nothing is left.
        """
        parts = []
        for drive in drives:
            if drive not in self.columns:
                raise UnknownNameError("column of a drive", drive, self.columns, place=self.name)
            missing = np.full(self.t.size, np.nan)
            found = np.array([self.columns.get(f"{drive}{end}", missing) for end in MOTION])
            if self.noise.get(drive, 0.0) > 0.0:
                found[0] = np.nan
            if np.isnan(found).any():
                found = np.where(np.isnan(found), self._spline(drive), found)
            parts.append(found)
        d, rate, acceleration = np.array(parts).reshape(-1, 3, self.t.size).transpose(1, 2, 0)
        outside = (self.t < self.t[0] + trim) | (self.t > self.t[-1] - trim)
        if outside.all():
            raise DeclarationError(
                f"trim={trim:g}: expected less than half of the {np.ptp(self.t):g} s of {self.name}"
            )
        acceleration[outside] = np.nan
        return DrivenMotion(self.t, d, rate, acceleration)

    def cutoff(self, drive: str) -> float:
        """Return the frequency at which smoothing a drive's coordinate halves the power.

        The spline solves f + w f'''' = y with the weight w by which the jumps of its third
        derivative are its distances from the points.

        Parameters
        ----------
        drive : str
            Name of the drive.

        Returns
        -------
        float
            Frequency [Hz]; infinity without smoothing, 0 for a drive whose coordinate is a straight
            line within its noise.
        """
        if not self.noise.get(drive, 0.0) > 0.0:
            return math.inf
        known = np.isfinite(self.columns[drive])
        t, (smooth, _, bend) = self.t[known], self._spline(drive)[:, known]
        jumps = np.diff(np.diff(bend) / np.diff(t))[1:-1]
        if not jumps.any():
            return 0.0
        away = (self.columns[drive][known] - smooth)[2:-2]
        weight = float(jumps @ away / (jumps @ jumps)) * float(np.diff(t).mean())
        return float(((math.sqrt(2.0) - 1.0) / weight) ** 0.25 / math.tau)

    @cached_property
    def _spline(self) -> Callable[[str], Array]:
        """Coordinate, rate and acceleration (3, n) of the smoothing spline of a drive, built once,
        or of a straight line if that is near enough.
        """
        return cache(self._smoothed)

    def _smoothed(self, drive: str) -> Array:
        values = self.columns[drive]
        known = np.isfinite(values)
        if known.sum() < _FEWEST or not (known[0] and known[-1]):
            raise DeclarationError(
                f"{self.name}: column '{drive}': expected at least {_FEWEST} values, the first and"
                f" the last among them, got {int(known.sum())}"
            )
        noise = self.noise.get(drive, 0.0)
        for degree in (0, 1):
            line = np.polynomial.Polynomial.fit(self.t[known], values[known], degree)
            if np.mean((values - line(self.t))[known] ** 2) <= noise**2:
                return np.array([line(self.t), line.deriv()(self.t), 0.0 * self.t])
        found = curve(self.t[known].tolist(), values[known].tolist(), smoothing=noise)
        starts, cells = np.array(found.starts), np.array(found.cells)
        cell = np.clip(np.searchsorted(starts, self.t, side="right") - 1, 0, len(cells) - 1)
        u, (a, b, c, d) = self.t - starts[cell], cells[cell].T
        rate, bend = b + u * (2.0 * c + 3.0 * u * d), 2.0 * c + 6.0 * u * d
        return np.array([a + u * (b + u * (c + u * d)), rate, bend])


def check_units(measurements: Measurements, expected: Mapping[str, str]) -> None:
    """Raise :class:`.DeclarationError` for a column in a unit of another quantity than that of its
    ``expected`` SI unit.
    """
    for name, unit in expected.items():
        word = measurements.units.get(name, unit)
        if (_SIZES[word][0] if word in _SIZES else word) != unit:
            some = ", ".join(_UNITS.get(unit, [unit]))
            raise DeclarationError(
                f"{measurements.name}: column '{name}' is in {word}; expected {some}"
            )


@public
def read_measurements(
    path: str | Path,
    *,
    names: Mapping[str, str] | None = None,
    noise: Mapping[str, NotNegative] | None = None,
    counts_per_turn: Positive | None = None,
    time: str = "t",
) -> Measurements:
    """Read measurements from a CSV file.

    Parameters
    ----------
    path
        The file. Its first line has the names of the columns and their units, as ``J1 [deg]``,
        ``effort:J1 [N m]``, ``strain:rod:side +y@0.5 [ustrain]``, ``J1 [counts]``; units may
        also stand in a line of their own below the names. Empty cells and ``nan`` are missing
        values. An angle that begins again after each turn is made to go on.
    names
        Heads of the file, by the name that they are to have: ``{"J1": "position 1"}``. Columns
        that are not named here keep theirs, if none has it. The name of the times is ``t``.
    noise
        Standard deviations by name, in the units of the file. Of a column in counts it is by
        default that of rounding to whole counts, 0.29.
    counts_per_turn
        Counts of an encoder in one turn.
    time
        The head of the times.

    Returns
    -------
    Measurements
        Columns in SI units.

    Raises
    ------
    PathError
        For a file that cannot be read.
    DeclarationError
        For a cell that is no number, a unit that is none of time, and times that do not increase.
    UnknownNameError
        For names that the file does not have.
    """
    heads, rows = _opened(path)
    plain = [head for head, _ in heads]
    if twice := [head for head in plain if plain.count(head) > 1]:
        raise DeclarationError(f"{path}: expected one column '{twice[0]}', got {len(twice)}")
    chosen = {"t": time, **(names or {})}
    if chosen["t"] not in plain:
        raise UnknownNameError("column of times", chosen["t"], plain, place=str(path))
    if lost := [head for head in chosen.values() if head not in plain]:
        raise UnknownNameError("column", lost, plain, place=str(path))
    named = {head: name for name, head in chosen.items()}
    found: list[list[float]] = []
    for row in rows:
        found.append([])
        for cell in row.cells:
            value = math.nan if cell.lower() in _EMPTY else row.number(cell)
            if math.isnan(value) and cell.lower() not in _EMPTY:
                raise DeclarationError(f"{row.where}: expected a number, got {cell!r}")
            found[-1].append(value)
    columns: dict[str, Array] = {}
    deviations, units = {}, {}
    table = np.array(found, float).reshape(-1, len(heads)).T
    for (head, unit), values in zip(heads, table, strict=True):
        if head in chosen and head not in named:  # its name is that of another column
            continue
        name = named.get(head, head)
        size = _size(str(path), head, unit, counts_per_turn)
        columns[name] = size * values
        if unit:
            units[name] = "rad" if unit in _COUNTS else unit
        if units.get(name) in UNITS["rad"]:
            columns[name] = _going_on(columns[name])
        if name in (noise or {}):
            deviations[name] = size * dict(noise or {})[name]
        elif unit in _COUNTS:
            deviations[name] = size * _QUANTUM
    if unknown := [name for name in noise or {} if name not in columns]:
        raise UnknownNameError("column of noise=", unknown, columns, place=str(path))
    found_in = Measurements(columns.pop("t"), columns, deviations, Path(path).name, units)
    check_units(found_in, {"t": "s"})
    return found_in


def _opened(path: str | Path) -> tuple[list[tuple[str, str]], Iterator[Row]]:
    """Return names and units of columns, units from a row below the names if there is one, and the
    rows of a file.
    """
    rows = read_rows(path, "columns of times, motion and forces")
    first = next(rows)
    if not any(math.isnan(first.number(cell)) for cell in first.cells):
        raise DeclarationError(
            f"{first.where}: expected names of columns, as 't [s]', got {first.cells[0]!r}"
        )
    heads, below = headings(first.cells), next(rows, None)
    if below is None:
        return heads, rows
    words = [cell.strip("[]()") for cell in below.cells]
    if {"", "1"}.issuperset(words) or not {"", *_SIZES, *_COUNTS}.issuperset(words):
        return heads, chain([below], rows)
    return [(name, unit or word) for (name, unit), word in zip(heads, words, strict=True)], rows


def _size(path: str, head: str, unit: str, counts_per_turn: float | None) -> float:
    """Return the size of a unit of a column in SI units."""
    if unit in _COUNTS:
        if counts_per_turn is None:
            raise DeclarationError(
                f"{path}: column {head} is in counts; expected counts_per_turn=, a number above 0"
            )
        return math.tau / counts_per_turn
    return _SIZES[unit][1] if unit in _SIZES else 1.0


def _going_on(angle: Array) -> Array:
    """Return an angle that begins again after each turn as one that goes on; another as it is."""
    known = np.isfinite(angle)
    steps = np.abs(np.diff(angle[known])) / math.tau
    whole = np.abs(steps - 1.0) < _PART
    if whole.any() and (whole | (steps < _PART)).all():
        angle[known] = np.unwrap(angle[known])
    return angle


@dataclass(frozen=True, eq=False)
class Filter:
    """A low-pass filter without delay: means of neighbours, weighed by a Gaussian of their time.

    At ``cutoff`` [Hz] it halves the power. It is linear, so what holds between columns holds
    between filtered columns. Times need not be even.
    """

    t: Array
    cutoff: float

    def __call__(self, columns: Array, known: npt.NDArray[np.bool_]) -> Array:
        """Filter columns (n, k), of which only rows that are ``known`` (n,) count."""
        width = _DECAY / self.cutoff
        total, weights = np.zeros_like(columns), np.zeros(self.t.size)
        values = np.where(known[:, None], columns, 0.0)
        for shift in range(self.t.size):
            apart = self.t[shift:] - self.t[: self.t.size - shift]
            if apart.min() > _REACH * width:
                break
            weight = np.exp(-0.5 * (apart / width) ** 2)
            before, after = slice(0, self.t.size - shift), slice(shift, None)
            for here, there in [(before, after), (after, before)][: 1 + (shift > 0)]:
                total[here] += weight[:, None] * values[there]
                weights[here] += weight * known[there]
        return total / np.where(weights > 0.0, weights, 1.0)[:, None]

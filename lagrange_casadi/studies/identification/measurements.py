"""Measurements of a machine: motion and forces over time, with their noise, from a CSV file."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from operator import itemgetter
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...base.arguments import Duration, NotNegative, Positive, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.csv_table import Table, count_sizes
from ...base.units import Unit, differs, known
from ...errors import DeclarationError, check_known
from ...model.curves import curve, derivatives
from .regressor import MOTION, DrivenMotion

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
    first
        The time stamp of the first row, where that is time zero.

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
    first: str = ""

    def __post_init__(self) -> None:
        t = np.asarray(self.t, float)
        if t.ndim != 1 or t.size < _FEWEST:
            raise DeclarationError(
                f"{self.name}: expected at least {_FEWEST} rows of measurements, got {t.size}"
            )
        if not (rising := (np.diff(t) > 0.0) & np.isfinite(t[1:])).all():
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
        check_known("column of noise=", self.noise, columns, place=self.name)
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

    def motion(self, drives: Sequence[str], trim: Duration = 0.0) -> DrivenMotion:
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
            check_known("column of a drive", [drive], self.columns, place=self.name)
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
        if known.sum() < _FEWEST:
            raise DeclarationError(
                f"{self.name}: column '{drive}': expected at least {_FEWEST} values, got"
                f" {int(known.sum())}"
            )
        if not (known[0] and known[-1]):
            row = "last" if known[0] else "first"
            raise DeclarationError(
                f"{self.name}: column '{drive}' has no value in the {row} row; expected one in the"
                " first and in the last, between which it is smoothed"
            )
        noise = self.noise.get(drive, 0.0)
        for degree in (0, 1):
            line = np.polynomial.Polynomial.fit(self.t[known], values[known], degree)
            if np.mean((values - line(self.t))[known] ** 2) <= noise**2:
                return np.array([line(self.t), line.deriv()(self.t), 0.0 * self.t])
        found = curve(self.t[known].tolist(), values[known].tolist(), smoothing=noise)
        return derivatives(found, self.t)


@public
def read_measurements(
    path: str | Path,
    *,
    names: Mapping[str, str] | None = None,
    noise: Mapping[str, NotNegative] | None = None,
    counts_per_turn: Positive | Mapping[str, float] | None = None,
    time: str | Sequence[str] = "t",
) -> Measurements:
    """Read measurements from a CSV file.

    Parameters
    ----------
    path
        The file. Its first line has the names of the columns and their units, as ``J1 [deg]``,
        ``effort:J1 [N m]``, ``strain:rod:side +y@0.5 [ustrain]``, ``J1 [counts]``; units may
        also stand in a line of their own below the names. Empty cells and ``nan`` are missing
        values. An angle that begins again after each turn is made to go on. Columns of texts are
        passed over.
    names
        Read a drive's coordinate, or a force as effort:O, from the column of this head.

        Heads of the file, by the name that they are to have: ``{"J1": "position 1"}``. Columns that
        are not named here keep theirs, if none has it. The name of the times is ``t``.
    noise
        State the standard deviation of a column, in the unit of the file.

        Of a column in counts it is by default that of rounding to whole counts, 0.29.
    counts_per_turn
        Set the counts in one turn of all encoders, or of a column's.
    time
        The head of the times, or two heads, of seconds and of nanoseconds. Stamps since 1970 (in s,
        ms, us or ns) and those of ISO 8601 count from the first row.

    Returns
    -------
    Measurements
        Columns in SI units.

    Raises
    ------
    PathError
        For a file that cannot be read.
    DeclarationError
        For a cell that is no number, a unit that is none of time, times that do not increase, and
        a column in counts without a number for a turn.
    UnknownNameError
        For names that the file does not have, and ``counts_per_turn`` of columns that are not in
        counts.
    """
    path = Path(path)
    table = Table.recorded(path, "columns of times, motion and forces")
    if not table.names:
        raise DeclarationError(
            f"{path.name}: expected names of columns in the first line, as 't [s]', got numbers"
        )
    places = {name: table.place(head) for name, head in (names or {}).items() if name != "t"}
    at = table.times((names or {}).get("t", time))
    left = {*places.values(), *at, *table.texts}
    others = [head for k, head in enumerate(table.names) if head and k not in left]
    places |= {head: table.place(head) for head in others if head not in places}
    places = dict(sorted(places.items(), key=itemgetter(1)))

    units = {name: table.units[k] for name, k in places.items()}
    heads = {name: table.names[k] for name, k in places.items()}
    counts = count_sizes(path.name, heads, units, counts_per_turn)
    sizes = {name: (known(unit) or Unit()).factor for name, unit in units.items()}
    sizes |= counts
    units |= dict.fromkeys(counts, "rad")
    (t, *series), clock = table.columns(at, list(places.values()), table.units[at[0]], gaps=True)
    columns = {name: sizes[name] * values for name, values in zip(places, series, strict=True)}
    columns |= {
        name: _going_on(columns[name]) for name in places if not differs(units[name], "rad")
    }
    deviations = dict.fromkeys(counts, _QUANTUM) | dict(noise or {})
    return Measurements(
        t,
        columns,
        {name: sizes.get(name, 1.0) * deviation for name, deviation in deviations.items()},
        path.name,
        {name: unit for name, unit in {"t": table.units[at[0]], **units}.items() if unit},
        clock.first,
    )


def _going_on(angle: Array) -> Array:
    """Return an angle that begins again after each turn as one that goes on; another as it is."""
    known = np.isfinite(angle)
    steps = np.abs(np.diff(angle[known])) / math.tau
    whole = np.abs(steps - 1.0) < _PART
    if whole.any() and (whole | (steps < _PART)).all():
        angle[known] = np.unwrap(angle[known])
    return angle


def filtered(t: Array, cutoff: float, columns: Array, known: npt.NDArray[np.bool_]) -> Array:
    """Filter columns (n, ..., k) over times ``t`` (n,), of which only those count that are
    ``known`` (n, ...), by a low-pass filter without delay: means of neighbours, weighed by a
    Gaussian of their time.

    At ``cutoff`` [Hz] it halves the power. It is linear, so what holds between columns holds
    between filtered columns. Times need not be even.
    """
    width = _DECAY / cutoff
    values = np.where(known[..., None], columns, 0.0)
    total, weights = np.zeros_like(values), np.zeros(known.shape)
    for shift in range(t.size):
        apart = t[shift:] - t[: t.size - shift]
        if apart.min() > _REACH * width:
            break
        weight = np.exp(-0.5 * (apart / width) ** 2)
        before, after = slice(0, t.size - shift), slice(shift, None)
        for here, there in [(before, after), (after, before)][: 1 + (shift > 0)]:
            total[here] += (weight * values[there].T).T
            weights[here] += (weight * known[there].T).T
    return total / np.where(weights > 0.0, weights, 1.0)[..., None]

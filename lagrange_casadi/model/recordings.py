"""Motions that a controller has recorded or will play: columns of a CSV file, in its units,
smoothed, as one smooth curve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from ..base.arguments import Measured, public
from ..base.arrays import Array
from ..base.csv_table import Table, count_sizes, encoding_of, for_each
from ..base.space import require
from ..base.time_stamps import Clock
from ..base.units import Within, differs, known, quantity
from ..errors import DeclarationError, PathError, UnknownNameError, one_line
from .curves import Curve, curve
from .declared_parts import Expression
from .expressions import coordinates, parametric
from .motion_laws import Motion

_LEAST = 5
"""So many rows are needed at least for four pieces."""

_CLOSES = 6.0
"""Largest difference of the ends of a cycle, as a multiple of the noise."""

_SAME = 1e-9
"""Largest relative difference of the ends if nothing is smoothed."""

_LONGEST = 200
"""Lines of a header of OpenSim's, at most."""

_SLIDES = ("_tx", "_ty", "_tz")
"""Ends of the names of OpenSim's coordinates that are lengths; all others are angles."""

_FOURTH = 70.0
"""The variance of the fourth difference of noise, over that of the noise: 1 + 16 + 36 + 16 + 1."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Values over time as a file has them, times in s, values in their ``unit``, and how they are
    called, in the ``file``. ``size`` is the unit in rad or m, ``clock`` that by which times were
    read.
    """

    name: str
    unit: str
    t: Array
    values: Array
    size: float
    clock: Clock
    file: str


@public
def read_samples(
    path: str | Path,
    *,
    value: str | int = 2,
    time: str | int | Sequence[str | int] = 1,
    unit: str | None = None,
    time_unit: str | None = None,
    counts_per_turn: float | None = None,
    smoothing: float | str = 0.0,
    points: Annotated[int, Within(5)] | None = None,
    periodic: bool = False,
    period: Measured | None = None,
    advance: Measured = 0.0,
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
        number, from 1. Times may stand in two columns, of seconds and of nanoseconds. Stamps since
        1970 (in s, ms, us or ns) and those of ISO 8601 count from the first row.
    unit, time_unit
        The units in the file: ``rad``, ``deg``, ``turn``, or ``m``, ``cm``, ``mm``, ``um``, or
        ``counts``; ``s``, ``ms`` or another of time. By default those that the file states, as
        :func:`read_motion` reads them; without these, rad and s.
    counts_per_turn
        Counts of an encoder for a turn, for a column in ``counts``.
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

    Returns
    -------
    Motion
        The law, in rad or m.

    Raises
    ------
    PathError
        For a file that cannot be read.
    DeclarationError
        For a line that is no row of numbers, times that do not increase, and ends of a cycle that
        differ.
    UnknownNameError
        For unknown columns and units.
    """
    path = Path(path)
    (recording,) = _recordings(
        _table(path), {"value": value}, time, unit, time_unit, counts_per_turn
    )
    return _motion(
        replace(recording, name=path.name),
        smoothing=smoothing,
        points=points,
        periodic=periodic,
        period=period,
        advance=advance,
        scales=(ratio, offset, stretch),
    )


@public
def read_motion(
    path: str | Path,
    columns: Mapping[str, str | int] | Sequence[str] | None = None,
    *,
    time: str | int | Sequence[str | int] = 1,
    unit: str | Mapping[str, str] | None = None,
    time_unit: str | None = None,
    counts_per_turn: float | Mapping[str, float] | None = None,
    smoothing: float | str | Mapping[str, float | str] = 0.0,
    points: Annotated[int, Within(5)] | None = None,
    periodic: bool = False,
    period: Measured | None = None,
    advance: Measured | Mapping[str, Measured] = 0.0,
    ratio: Expression | Mapping[str, Expression] = 1.0,
    offset: Expression | Mapping[str, Expression] = 0.0,
    stretch: Expression = 1.0,
) -> dict[str, Motion]:
    """Motions of several joints from one table of recorded values: what ``Scene(m, motion)`` takes.

    Parameters
    ----------
    path
        A CSV file as :func:`read_samples` reads it, whose heads may have units: ``knee [deg]`` or
        ``knee (deg)``, or a row of units below the heads; or a motion of OpenSim (``.mot``,
        ``.sto``), whose header says if angles are in degrees.
    columns
        For each coordinate its column, by head without unit, or by number from 1; or the name of a
        joint in a log of ROS, with a head as ``/joint_states/NAME/position``, or with its name in a
        column ``name_0`` and its position in ``position_0``. A sequence names coordinates that are
        called as their columns; None takes all columns of numbers but the time.
    unit
        Units of values, for all or by coordinate, in place of those of the file: those of
        :func:`read_samples`, and ``counts``. Without either, rad.
    time_unit
        ``s``, ``ms`` or ``us``, in place of that of the file; without either, s.
    counts_per_turn
        Counts of an encoder for a turn, for columns in ``counts``.
    smoothing, advance, ratio, offset
        As of :func:`read_samples`, for all coordinates or by coordinate; noise and advance in the
        unit of the column. The counts of an encoder are rounded: their noise is 0.29 counts.
    time, points, periodic, period, stretch
        As of :func:`read_samples`, the same for all coordinates; the period in the unit of time.

    Returns
    -------
    dict
        A :class:`Motion` for each coordinate, in the order of ``columns``.

    Raises
    ------
    PathError
        For a file that cannot be read.
    UnknownNameError
        For columns, units and coordinates that are not there, with those that are.
    DeclarationError
        As :func:`read_samples`; and for counts without a number for a turn.
    """
    path = Path(path)
    table = _table(path)
    if columns is None:
        others = {*table.times(time), *table.texts}
        columns = [name for k, name in enumerate(table.names) if name and k not in others]
        if not columns:
            raise DeclarationError(
                f"{path.name}: the file has no column heads; name the columns with columns="
            )
    named = dict(columns) if isinstance(columns, Mapping) else {name: name for name in columns}
    if not named:
        raise DeclarationError(f"{path.name}: columns= expected at least one coordinate")
    recordings = _recordings(table, named, time, unit, time_unit, counts_per_turn)
    noises, advances, ratios, offsets = (
        for_each(path.name, named, f"coordinate of {word}=", value, usual)
        for word, value, usual in (
            ("smoothing", smoothing, 0.0),
            ("advance", advance, 0.0),
            ("ratio", ratio, 1.0),
            ("offset", offset, 0.0),
        )
    )
    return {
        name: _motion(
            recording,
            smoothing=noises[name],
            points=points,
            periodic=periodic,
            period=period,
            advance=advances[name],
            scales=(ratios[name], offsets[name], stretch),
        )
        for name, recording in zip(named, recordings, strict=True)
    }


def _table(path: Path) -> Table:
    """Read a table's heads, and its units: those that it states, or those of OpenSim."""
    skip, described = _header(path)
    table = Table.recorded(path, "columns of times and values", skip)
    if not skip:
        return table
    angle = "deg" if described.get("indegrees", "no").lower() == "yes" else "rad"
    units = ("s" if n == "time" else "m" if n.endswith(_SLIDES) else angle for n in table.names)
    return replace(table, units=tuple(units))


def _recordings(
    table: Table,
    named: Mapping[str, str | int],
    time: str | int | Sequence[str | int],
    unit: str | Mapping[str, str] | None,
    time_unit: str | None,
    counts_per_turn: float | Mapping[str, float] | None,
) -> list[Recording]:
    """Read columns by name."""
    path, at = table.path, table.times(time)
    places = {name: table.place(column) for name, column in named.items()}
    for name, k in places.items():
        if k in at:
            raise DeclarationError(
                f"{path.name}: column {named[name]!r} has times; expected one of values, of columns"
                f" {', '.join(table.names) or 'by number'}"
            )
    stated = for_each(path.name, named, "coordinate of unit=", unit, None)
    units = {name: stated[name] or table.units[k] or "rad" for name, k in places.items()}
    turns = count_sizes(path.name, named, units, counts_per_turn)
    (t, *series), clock = table.columns(at, [*places.values()], time_unit or table.units[at[0]])
    if t.size < _LEAST:
        raise DeclarationError(
            f"{path.name}: expected at least {_LEAST} rows of numbers, got {t.size}"
        )
    found = []
    for (name, word), values in zip(units.items(), series, strict=True):
        size = turns.get(name) or _known(path, named[name], word)
        called = f"{path.name}, column {named[name]}"
        found.append(Recording(called, word, t, values, size, clock, path.name))
    return found


def _known(path: Path, column: str | int, word: str) -> float:
    """The size of a unit of angles or lengths."""
    unit = known(word) if isinstance(word, str) else None
    if unit is None:
        raise UnknownNameError("unit", str(word), ("rad", "m", "counts"), place=path.name)
    if differs(word, "m") and (wrong := differs(word, "rad")):
        raise DeclarationError(f"{path.name}: column {column!r} is in {wrong} or a length [m]")
    return unit.factor


def _motion(
    recording: Recording,
    *,
    smoothing: float | str,
    points: int | None,
    periodic: bool,
    period: Measured | None,
    advance: Measured,
    scales: tuple[Expression, Expression, Expression],
) -> Motion:
    """The motion through a recording, with options of :func:`read_samples`: ``scales`` are ratio,
    offset and stretch.
    """
    ratio, offset, stretch = scales
    name = recording.name
    advance = quantity(f"{name}: advance", advance, recording.unit)
    if period is not None:
        each = 1.0 if isinstance(period, str) else recording.clock.unit.factor
        recording = _closed(recording, quantity(f"{name}: period", period, "s") * each, advance)
    elif advance and not periodic:
        raise DeclarationError(f"{name}: advance= needs periodic=True")
    (ahead,), unit_in = coordinates(f"{name}: offset", [(offset, "")])
    # A ratio may make turns of lengths, and radians may be a rule's usual unit.
    if not unit_in and isinstance(ratio, float) and ratio == 1.0:
        unit_in = (
            "m" if not differs(recording.unit, "m") else "" if recording.unit == "rad" else "rad"
        )
    ratio, stretch = parametric(f"{name}: ratio", ratio), parametric(f"{name}: stretch", stretch)
    noise, periodic = _noise(recording, smoothing), periodic or period is not None
    t, values, size = recording.t, recording.values, recording.size
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
        require(f"{recording.name}: points", (points,))
        even = np.linspace(t[0], t[-1], points)
        found = _curve(recording.name, even, np.asarray(found(even)), periodic, 0.0)
    off = float(np.abs(np.asarray(found(t)) - level).max())
    start, rate = float(t[0]), climb * size

    def graph(time: Expression) -> Expression:
        at = time / stretch
        return ahead + ratio * (size * found(at) + rate * (at - start))

    every = f", resampled at {points} equally spaced times" if points else ""
    smoothed = f", smoothed by {noise:.3g} {recording.unit}" if noise else ""
    clock = recording.clock
    since = f" since {clock.first}" if clock.first else ""
    described = (
        f"{t.size} samples of {recording.name} from {t[0]:g} to {t[-1]:g}"
        f" s{since}{', repeated' if periodic else ''}"
    )
    return Motion(
        graph,
        description=f"{described}{smoothed}{every}, at most {off:.3g} {recording.unit} from them",
        unit=unit_in,
        note=f"times of {recording.file} are stamps in {clock.words}: its first row, {clock.first},"
        " is t = 0"
        if clock.first
        else "",
    )


def _header(path: Path) -> tuple[int, dict[str, str]]:
    """The number of lines of a header as OpenSim writes it, and what it states by words in small
    letters; no lines for another file.
    """
    if path.suffix.lower() not in (".mot", ".sto"):
        return 0, {}
    described: dict[str, str] = {}
    try:
        with open(path, encoding=encoding_of(path)) as file:
            for count_read, line in zip(range(1, _LONGEST), file, strict=False):
                word, _, value = line.strip().partition("=")
                described[word.strip().lower()] = value.strip()
                if word.lower() == "endheader":
                    return count_read, described
    except (OSError, UnicodeError) as error:
        raise PathError(f"{path}: cannot be read as text: {one_line(error)}") from None
    raise DeclarationError(f"{path.name}: expected a header that ends in the line 'endheader'")


def _closed(recording: Recording, period: float, advance: float) -> Recording:
    """A recording with the row that closes the cycle."""
    t, values = recording.t, recording.values
    end = t[0] + period
    if not t[-1] < end:
        lasts = f"its rows last {t[-1] - t[0]:.6g} s, but the period is {period:.6g} s"
        raise DeclarationError(f"{recording.name}: {lasts}; expected rows of exactly one period")
    return replace(recording, t=np.append(t, end), values=np.append(values, values[0] + advance))


def _noise(recording: Recording, smoothing: float | str) -> float:
    """The noise that is to be smoothed away, in the unit of the values."""
    if smoothing == "estimated":
        return float(np.sqrt(np.mean(np.diff(recording.values, 4) ** 2) / _FOURTH))
    what = f"{recording.name}: smoothing"
    found = quantity(f"{what}: the noise, or 'estimated'", smoothing, recording.unit)
    if found < 0.0:
        raise DeclarationError(f"{what}: expected a number of at least 0, got {smoothing!r}")
    return found


def _curve(name: str, t: Array, values: Array, periodic: bool, noise: float) -> Curve:
    try:
        return curve(t.tolist(), values.tolist(), periodic=periodic, smoothing=noise)
    except DeclarationError as error:
        raise DeclarationError(f"{name}: {one_line(error)}") from None

"""Designs of a sweep: axes of parameter values, their product as a grid, or a list of designs; a
design is a number.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from ...base.arguments import LATER, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.units import Number, in_unit, numbers_in, quantity
from ...errors import (
    DeclarationError,
    NumberError,
    ParameterError,
    UnknownNameError,
    listed,
    shown,
)
from ...model.declared_parts import Parameter
from ...model.even_points import points
from ...model.limits import parameter_faults

Numbers = npt.NDArray[np.int64]

DESIGN = "design"
"""The axis of a list."""

RESULTS = (DESIGN, "status", "t", "xi")
"""Heads of a table's columns that are no parameters, beside those with a colon."""

_SHOWN, _ROOM = 20, 200


@public
@dataclass(frozen=True)
class Range:
    """``count`` values from ``start`` to ``stop``, both included: evenly spaced, or with ``log`` in
    equal ratios.

    Ends may be texts, as ``"30 deg"`` or ``"100 mm"``; ``unit`` is then what they are in.

    Raises :class:`DeclarationError` for a range that is empty, reversed or not finite, or a log
    range that does not begin above 0.
    """

    start: Annotated[float, LATER]
    stop: Annotated[float, LATER]
    count: int
    log: bool = False
    unit: str = field(default="", init=False, compare=False)
    given: tuple[Number, ...] = field(default=(), init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        try:
            ends, unit = numbers_in((self.start, self.stop))
        except NumberError:
            text = ":".join(
                shown(part) if not isinstance(part, str) else part
                for part in (self.start, self.stop, self.count)
            )
            raise DeclarationError(
                f"expected numbers for START and STOP and a whole COUNT, got {text}"
            ) from None
        read = {"start": ends[0], "stop": ends[1], "unit": unit, "given": (self.start, self.stop)}
        for name, value in read.items():
            object.__setattr__(self, name, value)
        if not (math.isfinite(self.start) and math.isfinite(self.stop)):
            raise DeclarationError(f"START and STOP must be finite, got {self}")
        if self.count < 1:
            raise DeclarationError(f"COUNT must be at least 1, got {self}: the range is empty")
        if self.stop < self.start:
            raise DeclarationError(f"STOP must be after START, got {self}: the range is reversed")
        if (self.stop == self.start) != (self.count == 1):
            raise DeclarationError(
                f"START and STOP must differ, and COUNT be 2 or more, got {self}; one value is"
                " written alone"
            )
        if self.log and self.start <= 0.0:
            raise DeclarationError(f"a log range must begin above 0, got {self}")

    def __str__(self) -> str:
        return f"{float(self.start)!r}:{float(self.stop)!r}:{self.count}" + (
            ":log" if self.log else ""
        )

    def at(self, numbers: Numbers) -> Array:
        """Values by number: those of :func:`.points`, or start (stop/start)^(i/(count - 1))."""
        if not self.log:
            return points((self.start, self.stop, self.count), numbers)
        values = self.start * (self.stop / self.start) ** (numbers / max(self.count - 1, 1))
        return np.asarray(np.where(numbers == self.count - 1, float(self.stop), values), float)

    def outside(self, low: float, high: float) -> str:
        """Values outside a range, in words; empty if there are none."""
        return (
            ""
            if low <= self.start and self.stop <= high
            else f"{self.start:.10g} to {self.stop:.10g}"
        )


@public
@dataclass(frozen=True)
class Values:
    """Values one by one; some may be texts, as ``"30 deg"`` or ``"100 mm"``, and ``unit`` is then
    what they are in.

    Raises :class:`DeclarationError` for none, for what is no finite number, and for one given
    twice.
    """

    values: Annotated[tuple[float, ...], LATER]
    unit: str = field(default="", init=False, compare=False)
    given: tuple[Number, ...] = field(default=(), init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        try:
            if isinstance(self.values, bytes | set | frozenset):
                raise TypeError
            given = tuple(self.values)
            numbers, unit = numbers_in(given)
        except (TypeError, ValueError):
            raise DeclarationError(f"expected numbers, got {shown(self.values)}") from None
        for name, value in {"values": numbers, "unit": unit, "given": given}.items():
            object.__setattr__(self, name, value)
        if not numbers:
            raise DeclarationError("expected at least one value, got none")
        if infinite := [number for number in numbers if not math.isfinite(number)]:
            raise DeclarationError(f"expected finite values, got {infinite[0]}")
        if len(set(numbers)) < len(numbers):
            twice = next(value for value in numbers if numbers.count(value) > 1)
            raise DeclarationError(f"the value {twice:g} is listed twice")

    def __str__(self) -> str:
        # Values of a range are described as the range, because they make the same sweep.
        if self.count > 1 and self.values[0] < self.values[-1]:
            same = Range(self.values[0], self.values[-1], self.count)
            if np.array_equal(same.at(np.arange(self.count)), self._array):
                return str(same)
        if len(self.values) <= _SHOWN:
            return ",".join(map(repr, self.values))
        return (
            f"{len(self.values)} values, SHA-256"
            f" {hashlib.sha256(self._array.tobytes()).hexdigest()}"
        )

    @property
    def count(self) -> int:
        """Number of values."""
        return len(self.values)

    def at(self, numbers: Numbers) -> Array:
        """Values by number."""
        return self._array[numbers]

    def outside(self, low: float, high: float) -> str:
        """The values that leave a range, in words."""
        return listed(
            (f"{value:.10g}" for value in self.values if not low <= value <= high), "", _ROOM
        )

    @cached_property
    def _array(self) -> Array:
        return np.array(self.values)


Axis = Range | Values


@public
@dataclass(frozen=True, eq=False)
class Grid:
    """The product of axes by the names of parameters; the last axis runs fastest.

    Raises :class:`DeclarationError` for none.
    """

    axes: Mapping[str, Axis]
    source: ClassVar[str] = ""

    def __post_init__(self) -> None:
        if not isinstance(self.axes, Mapping) or not self.axes:
            raise DeclarationError(
                f"grid: expected at least one axis, as in l=0.1:0.2:11, got {shown(self.axes)}"
            )
        object.__setattr__(
            self,
            "axes",
            MappingProxyType({name: _axis(name, axis) for name, axis in self.axes.items()}),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that are swept."""
        return tuple(self.axes)

    @property
    def dimensions(self) -> dict[str, int]:
        """The axes of what is kept, and their lengths."""
        return {name: axis.count for name, axis in self.axes.items()}

    @property
    def size(self) -> int:
        """Number of designs."""
        return math.prod(axis.count for axis in self.axes.values())

    def block(self, start: int, stop: int) -> Array:
        """The designs from ``start`` to before ``stop``, of shape (designs, names)."""
        places = np.unravel_index(np.arange(start, stop), tuple(self.dimensions.values()))
        columns = [axis.at(k) for axis, k in zip(self.axes.values(), places, strict=True)]
        return np.stack(columns, axis=1)

    def scale(self, name: str, start: int, stop: int) -> Array:
        """Values along one parameter's own dimension."""
        return self.axes[name].at(np.arange(start, stop, dtype=np.int64))

    def describe(self) -> dict[str, str]:
        """The axes in words, which differ for different grids."""
        return {name: str(axis) for name, axis in self.axes.items()}

    def outside(self, name: str, low: float, high: float) -> str:
        """The values of a parameter that leave a range, in words."""
        return self.axes[name].outside(low, high)

    @property
    def units(self) -> dict[str, str]:
        """The units of values that were given with a unit, by parameter."""
        return {name: axis.unit for name, axis in self.axes.items() if axis.unit}


@public
@dataclass(frozen=True, eq=False, repr=False)
class Listed(Brief):
    """A list of designs: ``rows`` (designs, names) of values; ``lines`` are the line numbers of
    the rows in a file ``source``.

    ``units`` are those of SI of values that were given with a unit, such as 30 deg for a parameter
    in rad; ``texts`` (designs, names) says which were, by default all.

    Raises :class:`DeclarationError` for no designs, no or repeated names, or values that are not
    finite.
    """

    names: tuple[str, ...]
    rows: Array
    lines: Numbers | None = None
    source: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    texts: npt.NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        rows = np.ascontiguousarray(self.rows, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != len(self.names) or not rows.size:
            raise DeclarationError(
                f"designs: expected values of shape (designs, {len(self.names)}), got {rows.shape}"
            )
        if len(set(self.names)) < len(self.names):
            raise DeclarationError(
                f"designs: a parameter is named twice in {', '.join(self.names)}"
            )
        if not np.isfinite(rows).all():
            row, column = (int(i) for i in np.argwhere(~np.isfinite(rows))[0])
            raise DeclarationError(
                f"designs: {self._where(row)}: {self.names[column]} must be finite, got"
                f" {rows[row, column]}"
            )
        object.__setattr__(self, "rows", rows)

    @property
    def dimensions(self) -> dict[str, int]:
        """The one axis of what is kept, and its length."""
        return {DESIGN: self.size}

    @property
    def size(self) -> int:
        """Number of designs."""
        return int(self.rows.shape[0])

    def block(self, start: int, stop: int) -> Array:
        """The designs from ``start`` to before ``stop``, of shape (designs, names)."""
        return self.rows[start:stop]

    def scale(self, name: str, start: int, stop: int) -> Array:
        """Values of one parameter, design by design."""
        return self.rows[start:stop, self.names.index(name)]

    def describe(self) -> dict[str, str]:
        """The list in words, which differ for different lists."""
        digest = hashlib.sha256(self.rows.tobytes()).hexdigest()
        return {DESIGN: f"{counted(self.size)} of {', '.join(self.names)}, SHA-256 {digest}"}

    def outside(self, name: str, low: float, high: float) -> str:
        """The values of a parameter that leave a range, in words, each with its place."""
        values = self.rows[:, self.names.index(name)]
        rows = np.flatnonzero(~((values >= low) & (values <= high)))
        return listed((f"{values[row]:.10g} in {self._where(int(row))}" for row in rows), "", _ROOM)

    def _where(self, row: int) -> str:
        return f"design {row}" if self.lines is None else f"line {self.lines[row]}"


Designs = Grid | Listed


AxisLike: TypeAlias = Axis | Number | Iterable[Number]
"""An axis, its values, or (start, stop, count)."""

DesignsLike: TypeAlias = Designs | Mapping[str, AxisLike]
"""Designs, or axes by the names of parameters."""


def designs_of(given: DesignsLike, parameters: Mapping[str, Parameter]) -> Designs:
    """Designs from a :class:`Grid`, a :class:`Listed`, or a mapping of names to axes, ranges as
    tuples, or values; those of texts in the units of ``parameters``.

    Raises :class:`DeclarationError` for texts in a unit of another kind.
    """
    # A grid makes axes of what else stands for them.
    found = given if isinstance(given, (Grid, Listed)) else Grid(cast(Mapping[str, Axis], given))
    units = {name: parameters[name].unit for name in found.units if name in parameters}
    if not units:
        return found
    return _read_grid(found, units) if isinstance(found, Grid) else _read_list(found, units)


def _read_grid(grid: Grid, units: Mapping[str, str]) -> Grid:
    """A grid with the values of some parameters in ``units``."""
    axes = dict(grid.axes)
    for name, unit in units.items():
        axis = axes[name]
        read = [quantity(f"grid of {name}", one, unit) for one in axis.given]
        axes[name] = (
            Values(tuple(read))
            if isinstance(axis, Values)
            else replace(axis, start=read[0], stop=read[1])
        )
    return Grid(axes)


def _read_list(designs: Listed, units: Mapping[str, str]) -> Listed:
    """A list with the values of some parameters in ``units``."""
    rows = designs.rows.copy()
    texts = np.ones(rows.shape, bool) if designs.texts is None else designs.texts
    for name, unit in units.items():
        column, place = designs.names.index(name), f"{designs.source}, column '{name}'"
        there = texts[:, column], column
        rows[there] = in_unit(place, rows[there], designs.units[name], unit)
    return replace(designs, rows=rows, units={})


def filled(values: Mapping[str, float], names: Sequence[str], rows: Array) -> Array:
    """Designs (n, parameters): ``rows`` (n, names) of some parameters among the values of all."""
    p: Array = np.tile(np.array(list(values.values())), (len(rows), 1))
    p[:, [list(values).index(name) for name in names]] = rows
    return p


def check_designs(
    designs: Designs, parameters: Mapping[str, Parameter], fixed: Mapping[str, float]
) -> None:
    """Raise for parameters that are none or set twice, and for values out of their ranges, all of
    them at once.
    """
    if designs.source:
        check_known(designs.names, parameters, f"{designs.source}, head")
    check_known([*designs.names, *fixed], parameters)
    for name in designs.names:
        if name in fixed:
            raise DeclarationError(f"parameter '{name}' is swept and set to {fixed[name]} as well")
    wrong = []
    for name in designs.names:
        parameter = parameters[name]
        if found := designs.outside(name, parameter.low, parameter.high):
            wrong.append(
                f"{name} = {found}, out of its range [{parameter.low:g}, {parameter.high:g}]"
            )
    if wrong and designs.source:
        wrong[0] = f"{designs.source}: {wrong[0]}"
    wrong += parameter_faults(parameters, fixed)
    if wrong:
        raise ParameterError("; ".join(wrong))


def check_known(names: Sequence[str], parameters: Collection[str], head_of: str = "") -> None:
    """Raise :class:`DeclarationError` for names that are no parameters', all of them at once.

    If the names are the first line of a file, ``head_of``, the message has their columns.
    """
    unknown = {column: name for column, name in enumerate(names, 1) if name not in parameters}

    def place(columns: Collection[int]) -> str:
        return (
            f"{head_of}, column{'s' if len(columns) > 1 else ''} {', '.join(map(str, columns))}"
            if head_of
            else ""
        )

    for column, name in unknown.items():
        if isinstance(name, str) and (name in RESULTS or ":" in name):
            raise DeclarationError(": ".join(filter(None, (place([column]), not_parameter(name)))))
    if unknown:
        raise UnknownNameError(
            "parameter", list(unknown.values()), parameters, place=place(unknown)
        )


def are_described(described: Mapping[str, str], values: Mapping[str, Array]) -> bool:
    """Return whether values of parameters are those that ``describe`` wrote."""
    if list(described) != list(values):
        return (
            Listed(tuple(values), np.stack(list(values.values()), axis=1)).describe() == described
        )
    return all(_are_along(words, values[name]) for name, words in described.items())


def _are_along(words: str, values: Array) -> bool:
    """Return whether values are those of an axis in words."""
    start, *rest = words.split(":")
    if not rest:
        return str(Values(tuple(values.tolist()))) == words
    even = Range(float(start), float(rest[0]), int(rest[1]), rest[2:] == ["log"])
    return np.array_equal(even.at(np.arange(even.count)), values)


def size_of(described: Mapping[str, str]) -> int:
    """Number of designs, from the words of ``describe``.

    Raises ``ValueError`` for other words.
    """
    return math.prod(_length(words) for words in described.values())


def counted(count: int, what: str = "design") -> str:
    """A count in words: 1 design, 12 000 designs."""
    return f"{grouped(count)} {what}{'s' if count != 1 else ''}"


def grouped(count: int) -> str:
    """A count in groups of three digits."""
    return f"{count:,}".replace(",", " ")


def not_parameter(name: str) -> str:
    """Say of a column's name that it is no parameter's."""
    return (
        f"'{name}' is a result of a sweep, not a parameter: take the results out; `lagrange-casadi"
        " table` writes the chosen columns"
    )


def _length(words: str) -> int:
    if found := re.match(r"([\d ]+) (designs?|values)\b", words):
        return int(found[1].replace(" ", ""))
    return int(words.split(":")[2]) if ":" in words else words.count(",") + 1


def _axis(name: str, given: AxisLike) -> Axis:
    """An axis, a tuple (start, stop, count) whose count is whole, or any other sequence of values;
    errors name the parameter.
    """
    try:
        if isinstance(given, (Range, Values)):
            return given
        if isinstance(given, tuple) and len(given) in (3, 4) and type(given[2]) is int:
            return Range(*given)
        if isinstance(given, np.ndarray) and given.dtype.kind in "iuf":
            return Values(tuple(np.atleast_1d(given).astype(float).tolist()))
        found: Any = [given] if isinstance(given, str) or not isinstance(given, Iterable) else given
        return Values(found)
    except DeclarationError as error:
        raise DeclarationError(f"grid of {name}: {error}") from None

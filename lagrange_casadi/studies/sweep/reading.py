"""A sweep's file, read: whole columns, columns at given values of parameters, or all designs in
turn, block by block.
"""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import h5py
import numpy as np
import numpy.typing as npt

from ...base.arguments import LATER, Outputs, public, texts
from ...base.methods import method
from ...base.packages import check_installed
from ...errors import (
    DeclarationError,
    PathError,
    StoreError,
    UnknownNameError,
    check_kind,
    check_known,
    listed,
    one_line,
    shown,
)
from ...model.description import Description
from ...results.store.attributes import described
from ...results.store.opening import SWEEP, VerifiedFile, kind_of, opened_file, verify
from ..checkpoint import Checkpoint
from .axes import DESIGN, counted
from .contents import contents
from .design_blocks import chunk_of, slabs
from .meanings import STATUS, Column
from .plan import Identity
from .selection import Selected, matches

if TYPE_CHECKING:
    import xarray

    from ...model.scene import Scene

_BLOCK = 1 << 15
Values = npt.NDArray[Any]


@public
@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """A finished sweep; arrays are read when they are asked for.

    A sweep has named columns over axes. ``dimensions`` are the axes of the designs and their
    lengths: the swept parameters of a grid, or ``design`` of a list. ``parameters`` are the units
    of what was swept. ``columns`` are what is kept of each design, by full name, with units;
    ``axes`` are the units of the axes that columns have beyond those of the designs, such as ``t``.
    ``chosen`` are the numbers along axes of the designs that :meth:`select` left. The whole file is
    compared with its seal when it is opened, and again only where it has changed since.
    """

    path: Path
    identity: Annotated[Identity, LATER]
    dimensions: Mapping[str, int]
    parameters: Mapping[str, str]
    axes: Mapping[str, str]
    columns: Mapping[str, Column]
    statuses: Mapping[int, tuple[str, str]]
    chosen: Mapping[str, npt.NDArray[np.int64]] = field(default_factory=dict)
    keeper: Any = None
    verified: VerifiedFile | None = None

    @classmethod
    def open(cls, path: str | Path) -> Sweep:
        """Open a file.

        Parameters
        ----------
        path : path
            File of a finished sweep.

        Returns
        -------
        Sweep
            The sweep; its arrays are read when they are asked for.

        Raises
        ------
        PathError
            If there is no file, or the sweep is not finished.
        StoreError
            If it is not the whole file of a sweep.
        """
        if not os.path.exists(path) and Checkpoint.of(Path(path), "sweep").begun:
            raise PathError(
                f"{path}: its sweep is not finished: `lagrange-casadi info` shows its progress"
            )
        return opened_sweep(path)

    def __repr__(self) -> str:
        return (
            f"<Sweep of {self.case}: {counted(self.size)} over {listed(self.parameters)};"
            f" {listed(self.columns)}>"
        )

    def _repr_html_(self) -> str:
        """Show axes, the number of designs with a result, and the range of columns in a
        notebook.
        """
        found: str = method("Sweep._repr_html_")(self)
        return found

    def report(self, path: str | os.PathLike[str], scene: Scene | None = None) -> None:
        """Write a page for browsers: maps, fronts and a table of the designs.

        Parameters
        ----------
        path : path
            The file, which ends in .html.
        scene : Scene, optional
            The scene that was swept; the page then shows the mechanism in motion too.

        Raises
        ------
        DeclarationError
            For another scene, for another ending, and if no column has one value for each design.
        LagrangeCasadiError
            If ``scene`` lacks ziglang.
        """
        method("Sweep.report")(self, path, scene)

    @property
    def case(self) -> str:
        """The mechanism's name."""
        return str(self.identity["case"])

    @property
    def case_file(self) -> Path | None:
        """The file or folder of the case that was swept, or its name if it comes with the package;
        None where the file does not say.
        """
        with self.opened() as file:
            reference = str(file.attrs.get("case_file", ""))
        if not reference or "\0" in reference:
            return None
        there = self.path.parent / reference
        return there if there.exists() else Path(reference)

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of the designs' axes, as far as they are selected."""
        return tuple(
            self.chosen[name].size if name in self.chosen else length
            for name, length in self.dimensions.items()
        )

    @property
    def size(self) -> int:
        """Number of selected designs."""
        return int(np.prod(self.shape, dtype=np.int64))

    def __getitem__(self, name: str) -> Values:
        """A column (designs' axes, its own axes), a parameter along its axis, ``t`` [s] or ``xi``
        of columns that have them, or the numbers ``design`` of a list.

        A design without a result is NaN. Raises :class:`UnknownNameError` for another name,
        :class:`StoreError` for a damaged file.
        """
        axes = self._axes(name)
        boxes = {axis: _box(numbers) for axis, numbers in self.chosen.items()}
        with self.opened() as file:
            values = self._read(file, name, boxes)
        for k, axis in enumerate(axes):
            numbers = self.chosen.get(axis)
            if numbers is not None and numbers.size != values.shape[k]:
                values = np.take(values, numbers - numbers[0], axis=k)
        return values

    def __iter__(self) -> Iterator[str]:
        """The names of all that it has, of which ``self[name]`` gives each: parameters, ``t`` and
        ``xi`` where columns have them, and columns.
        """
        yield from (*self.parameters, *self.axes, *self.columns)

    def column(self, name: str) -> Column:
        """Return the description of a column.

        Parameters
        ----------
        name : str
            Name of a column.

        Returns
        -------
        Column
            Its unit, its meaning and its axes.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        """
        self._check_known([name], self.columns)
        return self.columns[name]

    def select(self, **values: Selected) -> Sweep:
        """Return the designs with given values of parameters.

        An axis stays if one number is selected, of length one.

        Parameters
        ----------
        **values : float, str, list or tuple
            By parameter: a number of the grid, a list of such numbers, or a tuple (low, high), both
            included. Angles may be texts, as ``"30 deg"``.

        Returns
        -------
        Sweep
            The selected part; nothing is copied.

        Raises
        ------
        UnknownNameError
            For what was not swept.
        DeclarationError
            For anything else as value, and if no design has it; the message names the nearest.
        """
        chosen = dict(self.chosen)
        check_known("swept parameter", values, self.parameters)
        for name, wanted in values.items():
            (axis,) = self._axes(name)
            there = replace(self, chosen=chosen)[name]
            found = np.flatnonzero(matches(name, there, wanted, self.parameters[name]))
            before = chosen.get(axis)
            chosen[axis] = found if before is None else before[found]
        return replace(self, chosen=chosen)

    def part(self, axis: str, places: slice) -> Sweep:
        """Return the designs at some places along an axis.

        Parameters
        ----------
        axis : str
            Axis of the designs, of ``dimensions``.
        places : slice
            Places among those selected, as ``slice(None, None, 2)`` for every other one.

        Returns
        -------
        Sweep
            The part; its axis stays, if one place is left too.

        Raises
        ------
        UnknownNameError
            If there is no such axis.
        """
        check_known("axis of designs", [axis], self.dimensions)
        check_kind("places", places, "a slice", slice)
        numbers = self.chosen.get(axis, np.arange(self.dimensions[axis]))
        return replace(self, chosen={**self.chosen, axis: numbers[places]})

    def axes_of(self, names: Outputs) -> tuple[str, ...]:
        """Return the axes that columns share beyond those of the designs.

        Parameters
        ----------
        names : str or sequence of str
            Names of columns, parameters or axes; those without axes of their own fit all.

        Returns
        -------
        tuple of str
            Such as ``("t", "xi")``.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        DeclarationError
            If two columns have different axes.
        """
        names = names_in(names)
        self._check_known(names, [*self])
        found = {self.columns[name].axes: name for name in names if name in self.columns}
        (axes, first), *others = [item for item in found.items() if item[0]] or [((), "")]
        for other, name in others:
            every, else_every = (" and ".join(words) for words in (axes, other))
            raise DeclarationError(
                f"column '{first}' has a value for every {every}, '{name}' for every {else_every}:"
                " write a table for each"
            )
        return axes

    def unit(self, name: str) -> str:
        """Return the unit of a parameter, an axis or a column.

        Parameters
        ----------
        name : str
            Its name.

        Returns
        -------
        str
            Its unit.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        """
        return self.parameters.get(name) or self.axes.get(name) or self.column(name).unit

    def blocks(
        self, names: Sequence[str], along: Sequence[str] = ()
    ) -> Iterator[tuple[npt.NDArray[np.int64], dict[str, Values]]]:
        """Return the selected designs in turn, in blocks of rows.

        Parameters
        ----------
        names : str or sequence of str
            Names of columns.
        along : sequence of str
            Axes, as ``("t", "xi")``: a row is then a design at one place of these, and repeats what
            has no axes. By default a row is a design.

        Returns
        -------
        iterator of (numbers, values)
            Numbers of the designs (rows,), and by name the values (rows,) of columns, parameters
            and axes.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        DeclarationError
            For a column with other axes.
        """
        names, along = names_in(names), names_in(along)
        self.check_columns(names, along)
        return self._blocks(names, along)

    def design(self, number: int) -> dict[str, float]:
        """Return the values of the swept parameters of a design.

        Parameters
        ----------
        number : int
            Number of the design, from 0.

        Returns
        -------
        dict
            Values by parameter.

        Raises
        ------
        DeclarationError
            If there is no such design.
        """
        return self.values(number, [*self.parameters])

    def values(self, number: int, names: str | Sequence[str]) -> dict[str, float]:
        """Return columns or parameters of a design.

        Parameters
        ----------
        number : int
            Number of the design, from 0.
        names : str or sequence of str
            Their names.

        Returns
        -------
        dict
            One value by column.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        DeclarationError
            For a column with axes of its own, and if there is no such design.
        """
        names, dims = names_in(names), tuple(self.dimensions.values())
        self.check_columns(names)
        if not isinstance(number, (int, np.integer)) or not 0 <= number < math.prod(dims):
            raise DeclarationError(
                f"design {number}: expected a number from 0 to {math.prod(dims) - 1}"
            )
        places = dict(zip(self.dimensions, map(int, np.unravel_index(number, dims)), strict=True))
        with self.opened() as file:
            return {name: self._read(file, name, places).item() for name in names}

    def counts(self) -> dict[int, int]:
        """Number of designs with each status, by its number; ``statuses`` has the words."""
        found = dict.fromkeys(self.statuses, 0)
        for _, values in self.blocks([STATUS]):
            for status, count in zip(*np.unique(values[STATUS], return_counts=True), strict=True):
                found[int(status)] = found.get(int(status), 0) + int(count)
        return found

    def to_xarray(self, names: Sequence[str] | None = None) -> xarray.Dataset:
        """Return columns as an ``xarray.Dataset`` over the parameters, with units.

        Parameters
        ----------
        names : sequence of str, optional
            The columns; by default all.

        Returns
        -------
        xarray.Dataset
            The columns by name.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        LagrangeCasadiError
            If xarray is not installed.
        """
        check_installed("xarray", "to_xarray")
        import xarray

        kept = [self.column(name) for name in (self.columns if names is None else names_in(names))]
        over = {axis for column in kept for axis in column.axes}
        units = dict.fromkeys(self.dimensions, "1") | dict(self.parameters)
        units |= {axis: unit for axis, unit in self.axes.items() if axis in over}
        coordinates = {
            name: (self._axes(name), self[name], {"units": unit}) for name, unit in units.items()
        }
        data = {}
        for column in kept:
            words = {"units": column.unit, "long_name": column.long_name}
            data[column.name] = (self._axes(column.name), self[column.name], words)
        return xarray.Dataset(data, coordinates, {"case": self.case})

    @cached_property
    def description(self) -> Description:
        """The mechanism as a file describes it, swept parameters at their defaults."""
        return described(self.identity["mechanism"])

    def check_columns(self, names: Sequence[str], along: Sequence[str] = ()) -> None:
        """Raise for columns that are none or have other axes than these.

        Parameters
        ----------
        names : str or sequence of str
            Names of columns.
        along : sequence of str
            The axes that columns may have.

        Raises
        ------
        UnknownNameError
            If there is no such column or axis.
        DeclarationError
            For other axes, and for an axis with the name of a parameter.
        """
        for axis in along:
            check_known("axis", [axis], self.axes)
            if axis in self.parameters:
                raise DeclarationError(
                    f"parameter '{axis}' has the name of an axis: rows cannot go along both"
                )
        self._check_known(names, [*self.parameters, *self.columns, *along])
        for name in names:
            axes = self.columns[name].axes if name in self.columns else ()
            if axes and axes != tuple(along):
                raise DeclarationError(
                    f"column '{name}' has a value for every {' and '.join(axes)}, not one a design"
                )

    def _check_known(self, names: Sequence[str], among: Collection[str]) -> None:
        """Raise for names that are not ``among`` some of a sweep's."""
        unknown = [name for name in names if name not in among]
        for axis in (name for name in unknown if name in self.axes):
            column = next(name for name, kept in self.columns.items() if axis in kept.axes)
            raise DeclarationError(
                f"'{axis}' is no column but an axis: it needs a column over {axis}, as {column} is"
            )
        if unknown:
            raise UnknownNameError(
                "column",
                unknown,
                [*self.parameters, *self.columns],
                f"`lagrange-casadi info {self.path}`",
            )

    def _axes(self, name: str) -> tuple[str, ...]:
        """All axes of a parameter, an axis or a column, those of the designs first."""
        if name in self.parameters:
            return (name if name in self.dimensions else DESIGN,)
        if name in self.axes or name in self.dimensions:
            return (name,)
        return (*self.dimensions, *self.column(name).axes)

    def _read(self, file: h5py.File, name: str, where: Mapping[str, int | slice]) -> Values:
        """A parameter, an axis or a column, at places along some of its axes.

        Raises :class:`StoreError` that names what is damaged.
        """
        place = f"grid/{name}" if name in self.parameters else name.replace(":", "/")
        try:
            return np.asarray(
                file[place][tuple(where.get(axis, slice(None)) for axis in self._axes(name))]
            )
        except (OSError, RuntimeError) as error:
            raise StoreError(f"{self.path}: {name}: damaged: {one_line(error)}") from None

    def _blocks(
        self, names: Sequence[str], along: Sequence[str]
    ) -> Iterator[tuple[npt.NDArray[np.int64], dict[str, Values]]]:
        dims = tuple(self.dimensions.values())
        with self.opened() as file:
            lengths = {axis: file[axis].size for axis in along}
            rows = math.prod(lengths.values())
            for start, stop, where in slabs(dims, chunk_of(dims, _BLOCK // rows)):
                places = dict(zip(self.dimensions, where, strict=True))
                numbers = np.arange(start, stop)
                left = self._left(numbers)
                shape = {axis: place.stop - place.start for axis, place in places.items()} | lengths
                found = {}
                for name in names:
                    values, axes = self._read(file, name, places), self._axes(name)
                    own = [length if axis in axes else 1 for axis, length in shape.items()]
                    whole = np.broadcast_to(values.reshape(own), [*shape.values()])
                    found[name] = whole.reshape(numbers.size, rows)[left].ravel()
                yield np.repeat(numbers[left], rows), found

    def _left(self, numbers: npt.NDArray[np.int64]) -> slice | npt.NDArray[np.bool_]:
        """Selected designs."""
        if not self.chosen:
            return slice(None)
        places = np.unravel_index(numbers, tuple(self.dimensions.values()))
        by_axis = dict(zip(self.dimensions, places, strict=True))
        kept = [np.isin(by_axis[axis], chosen) for axis, chosen in self.chosen.items()]
        return np.asarray(np.logical_and.reduce(kept))

    def opened(self) -> AbstractContextManager[h5py.File]:
        """Open its file to read. Raises what :meth:`open` does."""
        return opened_file(self.path, SWEEP, self.verified)


@public
def is_sweep(path: str | Path) -> bool:
    """Return whether a path is that of a sweep's file, whole or not."""
    return kind_of(path) == SWEEP


def _box(numbers: npt.NDArray[np.int64]) -> slice:
    """Numbers that are evenly spaced, or the box around others."""
    steps = np.unique(np.diff(numbers))
    return slice(int(numbers[0]), int(numbers[-1]) + 1, int(steps[0]) if steps.size == 1 else 1)


def opened_sweep(
    path: str | Path, verified: VerifiedFile | None = None, keeper: object = None
) -> Sweep:
    """A sweep, compared with its seal unless its file was ``verified`` already.

    ``keeper`` is kept alive as long as the sweep.

    Raises :class:`StoreError` for what is not a whole file of a sweep.
    """
    verified = verified if verified and verified.is_at(path) else verify(path)
    with opened_file(path, SWEEP, verified) as file:
        return Sweep(Path(path), **contents(file), keeper=keeper, verified=verified)


def names_in(given: str | Sequence[str]) -> list[str]:
    """Names, of which one may stand alone. Raises :class:`DeclarationError` for what is none."""
    found = [given] if isinstance(given, str) else texts(given)
    if found is None:
        raise DeclarationError(f"columns: expected a name, or a list of names, got {shown(given)}")
    return found

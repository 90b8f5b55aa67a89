"""A sweep's file, read: whole columns, columns at given values of parameters, or all designs in
turn, block by block.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import h5py
import numpy as np
import numpy.typing as npt

from ...base.arguments import LATER, Count, Index, Outputs, public, texts
from ...base.arrays import Array
from ...base.brief import listed
from ...base.methods import method
from ...errors import (
    DeclarationError,
    LagrangeCasadiError,
    PathError,
    StoreError,
    UnknownNameError,
    one_line,
    shown,
)
from ...model.description import Description
from ...results.store.attributes import described
from ...results.store.opening import SWEEP, VerifiedFile, kind_of, opened_file, verify
from ..checkpoint import Checkpoint
from .axes import DESIGN, counted
from .blocks import chunk_of, slabs
from .contents import KeptColumn, contents
from .meanings import CYCLE, OVER, STATUS, Meanings
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

    ``dimensions`` are the axes of the designs and their lengths: the swept parameters of a grid, or
    ``design`` of a list. ``columns`` are what is kept of each design, by full name, with units.
    ``parameters`` are the units of what was swept, and ``chosen`` the numbers along axes that
    :meth:`select` left. The whole file is compared with its seal when it is opened, and again only
    where it has changed since.
    """

    path: Path
    identity: Annotated[Identity, LATER]
    dimensions: Mapping[str, int]
    parameters: Mapping[str, str]
    columns: Mapping[str, KeptColumn]
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
        _refuse_unfinished(path)
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
        """A column (designs' axes, its own axes), a parameter along its axis, or ``t`` [s] or
        ``xi`` of columns that have them.

        A design without a result is NaN. Raises :class:`UnknownNameError` for another name,
        :class:`StoreError` for a damaged file.
        """
        if name not in self.parameters and name not in self._over:
            self.column(name)
        with self.opened() as file:
            if name in self.parameters:
                return self._cut(file["grid"][name], (self._axis(name),))
            if name in self._over:
                return _taken(file[name])
            return self._cut(
                file[name.replace(":", "/")], (*self.dimensions, *self.columns[name].axes)
            )

    def __iter__(self) -> Iterator[str]:
        """The names of all that it has, of which ``self[name]`` gives each: parameters, ``t`` and
        ``xi`` where columns have them, and columns.
        """
        yield from (*self.parameters, *self._over, *self.columns)

    def column(self, name: str) -> KeptColumn:
        """Return the description of a column.

        Parameters
        ----------
        name : str
            Name of a column.

        Returns
        -------
        KeptColumn
            Its unit, its meaning and its axes.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        """
        if name not in self.columns:
            raise self._unknown([name])
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
        if unknown := [name for name in values if name not in self.parameters]:
            raise UnknownNameError("swept parameter", unknown, self.parameters)
        for name, wanted in values.items():
            axis = self._axis(name)
            there = replace(self, chosen=chosen)[name]
            found = np.flatnonzero(matches(name, there, wanted, self.parameters[name]))
            before = chosen.get(axis)
            chosen[axis] = found if before is None else before[found]
        return replace(self, chosen=chosen)

    def thinned(self, axis: str, stride: Count) -> Sweep:
        """Return every n-th of the selected designs along an axis.

        Parameters
        ----------
        axis : str
            Axis of the designs, of ``dimensions``.
        stride : int
            The n, at least 1.

        Returns
        -------
        Sweep
            The thinned part.

        Raises
        ------
        UnknownNameError
            If there is no such axis.
        """
        numbers = self._along(axis)
        return replace(self, chosen={**self.chosen, axis: numbers[::stride]})

    def at_number(self, axis: str, number: Index) -> Sweep:
        """Return the designs at one place along an axis.

        Parameters
        ----------
        axis : str
            Axis of the designs, of ``dimensions``.
        number : int
            Place among those selected, from 0.

        Returns
        -------
        Sweep
            The part with an axis of length one.

        Raises
        ------
        UnknownNameError
            If there is no such axis.
        """
        numbers = self._along(axis)
        return replace(self, chosen={**self.chosen, axis: numbers[number : number + 1]})

    def _along(self, axis: str) -> npt.NDArray[np.int64]:
        """The numbers that are selected along an axis of the designs.

        Raises :class:`UnknownNameError`.
        """
        if axis not in self.dimensions:
            raise UnknownNameError("axis of designs", axis, self.dimensions)
        return self.chosen.get(axis, np.arange(self.dimensions[axis]))

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
        if unknown := [
            name for name in names if name not in (*self.parameters, *self.columns, *self._over)
        ]:
            raise self._unknown(unknown)
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
        return self.parameters.get(name) or self._units.get(name) or self.column(name).unit

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
        places = dict(zip(self.dimensions, self._place(number), strict=True))
        with self.opened() as file:
            return {
                name: float(_taken(file["grid"][name], places.get(name, number)))
                for name in self.parameters
            }

    def values(self, number: int, names: str | Sequence[str]) -> dict[str, float]:
        """Return columns of a design.

        Parameters
        ----------
        number : int
            Number of the design, from 0.
        names : str or sequence of str
            Names of columns.

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
        names, place = names_in(names), self._place(number)
        self.check_columns(names)
        with self.opened() as file:
            return {name: _taken(file[name.replace(":", "/")], place).item() for name in names}

    def _place(self, number: int) -> tuple[int, ...]:
        dims = tuple(self.dimensions.values())
        if not isinstance(number, (int, np.integer)) or not 0 <= number < math.prod(dims):
            raise DeclarationError(
                f"design {number}: expected a number from 0 to {math.prod(dims) - 1}"
            )
        return tuple(int(i) for i in np.unravel_index(number, dims))

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
        try:
            import xarray
        except ImportError:
            raise LagrangeCasadiError(
                "to_xarray needs xarray; install it with: pip install xarray"
            ) from None
        kept = [self.column(name) for name in (self.columns if names is None else names_in(names))]
        data = {
            k.name: (
                (*self.dimensions, *k.axes),
                self[k.name],
                {"units": k.unit, "long_name": k.long_name},
            )
            for k in kept
        }
        coordinates = {
            name: (name if name in self.dimensions else DESIGN, self[name], {"units": unit})
            for name, unit in self.parameters.items()
        }
        if DESIGN in self.dimensions:
            coordinates[DESIGN] = (
                DESIGN,
                self.chosen.get(DESIGN, np.arange(self.dimensions[DESIGN])),
                {"units": "1"},
            )
        for axis, unit in self._units.items():
            if any(axis in k.axes for k in kept):
                coordinates[axis] = (axis, self[axis], {"units": unit})
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
            if axis not in self._over:
                raise UnknownNameError("axis", axis, self._over)
            if axis in self.parameters:
                raise DeclarationError(
                    f"parameter '{axis}' has the name of an axis: rows cannot go along both"
                )
        if unknown := [
            name for name in names if name not in (*self.parameters, *self.columns, *along)
        ]:
            raise self._unknown(unknown)
        for name in names:
            if name in self.parameters or name in along:
                continue
            axes = self.column(name).axes
            if axes and axes != tuple(along):
                raise DeclarationError(
                    f"column '{name}' has a value for every {' and '.join(axes)}, not one a design"
                )

    @cached_property
    def meanings(self) -> Meanings:
        """Meanings of columns and axes, by their names."""
        times = self.identity["t"]
        joint = times[3] if len(times) > 3 else ""
        shared = not joint and not any(isinstance(bound, str) for bound in times[:2])
        axis = next(
            (name for name in (OVER, CYCLE) if name in self._over), "t" if shared else CYCLE
        )
        return Meanings.of(self.description, axis, joint)

    @cached_property
    def _units(self) -> dict[str, str]:
        """The units of the axes of columns, those of instants first."""
        return {axis: self.meanings.of_axis(axis)[0] for axis in ("t", OVER, CYCLE, "xi")}

    @cached_property
    def _over(self) -> dict[str, str]:
        """The axes of columns, each with a column over it."""
        return {axis: kept.name for kept in list(self.columns.values())[::-1] for axis in kept.axes}

    def _unknown(self, names: Sequence[str]) -> DeclarationError:
        """Names that are no column's."""
        for name in names:
            if name in self._over:
                return DeclarationError(
                    f"'{name}' is no column but an axis: it needs a column over {name}, as"
                    f" {self._over[name]} is"
                )
        return UnknownNameError(
            "column",
            names,
            [*self.parameters, *self.columns],
            f"`lagrange-casadi info {self.path}`",
        )

    def _blocks(
        self, names: Sequence[str], along: Sequence[str]
    ) -> Iterator[tuple[npt.NDArray[np.int64], dict[str, Values]]]:
        dims = tuple(self.dimensions.values())
        with self.opened() as file:
            places = (
                dict(
                    zip(
                        along,
                        np.meshgrid(*(_taken(file[axis]) for axis in along), indexing="ij"),
                        strict=True,
                    )
                )
                if along
                else {}
            )
            lengths = next((place.shape for place in places.values()), ())
            rows = math.prod(lengths)
            for start, stop, where in slabs(dims, chunk_of(dims, _BLOCK // rows)):
                numbers = np.arange(start, stop)
                remaining = self._left(numbers)
                shape = (numbers[remaining].size, *lengths)
                found = {}
                for name in names:
                    if name in places:
                        values = places[name][None]
                    elif name in self.parameters:
                        values = _along(
                            file["grid"][name], name, list(self.dimensions), dims, where
                        )[remaining]
                    else:
                        values = _taken(file[name.replace(":", "/")], where)
                        values = values.reshape(
                            numbers.size, *(lengths if self.columns[name].axes else ())
                        )[remaining]
                    values = values.reshape(*values.shape, *(1,) * (len(shape) - values.ndim))
                    found[name] = np.broadcast_to(values, shape).reshape(-1)
                yield np.repeat(numbers[remaining], rows), found

    def _left(self, numbers: npt.NDArray[np.int64]) -> slice | npt.NDArray[np.bool_]:
        """Selected designs."""
        if not self.chosen:
            return slice(None)
        places = dict(
            zip(
                self.dimensions,
                np.unravel_index(numbers, tuple(self.dimensions.values())),
                strict=True,
            )
        )
        kept: npt.NDArray[np.bool_] = np.all(
            [np.isin(places[axis], chosen) for axis, chosen in self.chosen.items()], axis=0
        )
        return kept

    def _axis(self, parameter: str) -> str:
        return parameter if parameter in self.dimensions else DESIGN

    def _cut(self, dataset: h5py.Dataset, axes: Sequence[str]) -> Values:
        """Selected part of a dataset: evenly spaced numbers are read, else the box around them, cut
        in memory.
        """
        numbers = [self.chosen.get(axis) for axis in axes]
        values = _taken(dataset, tuple(_box(n) for n in numbers))
        for axis, n in enumerate(numbers):
            if n is not None and n.size != values.shape[axis]:
                values = np.take(values, n - n[0], axis=axis)
        return values

    def opened(self) -> AbstractContextManager[h5py.File]:
        """Open its file to read. Raises what :meth:`open` does."""
        return _opened(self.path, self.verified)


@public
def is_sweep(path: str | Path) -> bool:
    """Return whether a path is that of a sweep's file, whole or not."""
    return kind_of(path) == SWEEP


def _taken(dataset: h5py.Dataset, where: int | slice | tuple[int | slice, ...] = ()) -> Values:
    """Contents of a dataset. Raises :class:`StoreError` that names its column."""
    try:
        return np.asarray(dataset[where])
    except (OSError, RuntimeError) as error:
        name = dataset.name.strip("/").removeprefix("grid/").replace("/", ":")
        raise StoreError(f"{dataset.file.filename}: {name}: damaged: {one_line(error)}") from None


def _box(numbers: npt.NDArray[np.int64] | None) -> slice:
    if numbers is None:
        return slice(None)
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
    with _opened(path, verified) as file:
        return Sweep(Path(path), **contents(file), keeper=keeper, verified=verified)


def names_in(given: str | Sequence[str]) -> list[str]:
    """Names, of which one may stand alone. Raises :class:`DeclarationError` for what is none."""
    found = [given] if isinstance(given, str) else texts(given)
    if found is None:
        raise DeclarationError(f"columns: expected a name, or a list of names, got {shown(given)}")
    return found


def _along(
    dataset: h5py.Dataset,
    name: str,
    axes: list[str],
    dims: tuple[int, ...],
    where: tuple[int | slice, ...],
) -> Array:
    """A parameter's values of the designs of a slab, flat."""
    if name not in axes:
        return _taken(dataset, where[0])
    axis = axes.index(name)
    both = zip(where, dims, strict=True)
    kept = [
        len(range(*place.indices(length))) if isinstance(place, slice) else 1
        for place, length in both
    ]
    shape = [1] * len(dims)
    shape[axis] = kept[axis]
    return np.broadcast_to(np.reshape(_taken(dataset, where[axis]), shape), kept).ravel()


def _opened(path: str | Path, verified: VerifiedFile | None) -> AbstractContextManager[h5py.File]:
    return opened_file(path, SWEEP, verified)


def _refuse_unfinished(path: str | Path) -> None:
    """Raise :class:`PathError` where there are parts, and no file yet."""
    if not os.path.exists(path) and Checkpoint.of(Path(path), "sweep").begun:
        raise PathError(
            f"{path}: its sweep is not finished: `lagrange-casadi info` shows its progress"
        )

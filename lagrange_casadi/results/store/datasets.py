"""The datasets of the file of a run, as they are written and as they must be."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import h5py
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...engine.instants.beyond_equilibrium import held_outputs
from ..derivatives import derivatives
from ..histories import Histories
from ..section_laws import SectionLaw
from ..solution import Solution
from .dataset_words import place_of, say, unlike, without_scale
from .scales import LARGE, Scales
from .untrusted import check_chunks, check_dataset

AXES = ("t", "xi")
"""The scales of a file, by their names at its root."""

OVER = "over"
"""The coordinate by which instants were asked for, beside their times: an auxiliary coordinate, as
CF calls it.
"""

_CHUNK_BYTES = 1 << 20
_BLOCK_BYTES = 1 << 23
_GRID_TOLERANCE = 1e-12
_BESIDE = ("units", "error_estimate", "DIMENSION_LIST", "CLASS", "NAME", "REFERENCE_LIST")
"""Attributes that a dataset may have beside those of what it holds."""

_KNOWN = ("motion", "pose", "certificate")
"""Groups of what is known at rest too."""


@dataclass(frozen=True, eq=False)
class Grid:
    """A section force of a law over ratios ``xi``, which is made where rows (t,) are asked for: it
    need not fit into memory.
    """

    law: SectionLaw
    force: str
    xi: Array

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of instants and of ratios."""
        return self.law.coefficients["n0"].size, self.xi.size

    def __getitem__(self, rows: slice) -> Array:
        return self.law.during(rows).on_grid(self.force, self.xi)


@dataclass(frozen=True, eq=False)
class Stored:
    """A dataset at a ``place`` with its ``values`` over ``axes``, in a ``unit``; ``words`` are what
    else the file says about it.

    ``open`` (t,) marks instants at which it may be no number.
    """

    place: str
    axes: tuple[str, ...]
    unit: str
    words: Mapping[str, str]
    values: Array | Grid
    open: npt.NDArray[np.bool_] | None = None
    error: float | None = None

    def write(self, file: h5py.File, scales: Scales, breathe: Callable[[], None]) -> None:
        """Create the dataset, and fill it block by block."""
        shape, is_scale = self.values.shape, self.axes == (self.place,)
        width = tuple(min(size, _CHUNK_BYTES // 8) for size in shape[1:])
        height = min(shape[0], max(1, _CHUNK_BYTES // (8 * math.prod(width))))
        dataset = file.create_dataset(
            self.place,
            shape,
            np.float64,
            chunks=(height, *width),
            fletcher32=True,
            fillvalue=np.nan,
            **(LARGE if is_scale else {}),
        )
        say(dataset, self.unit, self.words)
        if self.error is not None:
            dataset.attrs["error_estimate"] = self.error
        if is_scale:
            dataset.make_scale(self.place)
        else:
            scales.attach(dataset, self.axes)
        for block in self._blocks(height):
            breathe()
            dataset[block] = self.values[block]

    def faults(self, file: h5py.File, solution: Histories) -> Iterator[str]:
        """Yield the faults of the dataset in a file, a line each."""
        dataset = file[self.place]
        check_dataset(dataset, self.values.shape)
        check_chunks(dataset)
        gap, finite = 0.0, True
        for block in self._blocks(1):
            stored, known = dataset[block], self.values[block]
            sound = np.isfinite(stored)
            if self.open is not None:
                rests = self.open[block].reshape(-1, *[1] * (stored.ndim - 1))
                sound |= rests & np.isnan(stored)
            finite = finite and bool(sound.all())
            with np.errstate(invalid="ignore"):
                gap = float(np.fmax.reduce(np.abs(stored - known), axis=None, initial=gap))
        if not finite:
            yield f"{self.place}: values that are not finite"
        if gap and gap > _GRID_TOLERANCE * abs(solution.peak(self.place.replace("/", ":")).value):
            yield f"{self.place}: differs from its law by {gap:.3g} {self.unit}"
        yield from unlike(dataset, self.unit, self.words)
        if strange := dataset.attrs.keys() - {*self.words, *_BESIDE}:
            yield f"{self.place}: {min(strange)} is not in the schema"
        if not dataset.is_scale:
            yield from without_scale(dataset, self.axes)

    def _blocks(self, height: int) -> Iterator[slice]:
        """Rows, a multiple of a height, that are at hand together."""
        height *= max(1, _BLOCK_BYTES // (8 * height * math.prod(self.values.shape[1:])))
        return (slice(i, i + height) for i in range(0, self.values.shape[0], height))


def datasets_of(solution: Solution, grids: Iterable[str]) -> Iterator[Stored]:
    """All datasets of a solution, with section grids of the links ``grids``."""
    yield Stored("t", ("t",), "s", {"long_name": "time"}, solution.t)
    yield Stored("xi", ("xi",), "1", {"long_name": "place along a link, ratio xi/l"}, solution.xi)
    if over := solution.over:
        words = {"long_name": over.long_name, "joint": over.joint}
        yield Stored(OVER, ("t",), over.unit, words, over.values)
    every: dict[Output, Array | Grid] = {**solution.outputs, **held_outputs(solution.holding)}
    every |= {Output("certificate", "", name): x for name, x in solution.certificate.items()}
    every |= {
        Output("section", link, force): Grid(solution.section(link).law, force, solution.xi)
        for link in grids
        for force in solution.table.forces
    }
    for output, values in every.items():
        known = output.group in _KNOWN and solution.determined(output)
        yield Stored(
            place_of(output),
            output.quantity.axes,
            solution.unit(output),
            output.meant(solution.table).attributes,
            values,
            None if known else solution.resting | (not solution.determined(output)),
            solution.errors.get(str(output)),
        )
    for found in derivatives(solution, solution.sensitivities):
        axes, place = found.output.quantity.axes, place_of(found.name)
        yield Stored(place, axes, found.unit, found.attributes, found.values, solution.resting)

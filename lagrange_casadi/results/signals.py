"""The quantities of a scene as curves over time, at any times, by CasADi's virtual machine: what
the search for peaks is handed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Flags
from ..base.quantities import Output
from ..engine.codegen.peak_search import Curves, Listed, Peaks, Samples
from ..engine.instants.backends import Interpreter, peak_search
from ..engine.sharpness import Sharpness, bent
from ..model.link_density import NumericDensity
from .section_laws import law_of
from .vector_sizes import size_of

_BLOCK = 4096


class Along(Protocol):
    """Quantity with several curves, or with those of a whole link: the columns it is made of, by
    their keys.
    """

    @property
    def columns(self) -> Mapping[Output, int]:
        """The columns."""

    def curves(self, columns: Array) -> tuple[Array, Array]:
        """Ratios and values, each (curves, t), from the graph's columns (columns, t)."""


@dataclass(frozen=True, eq=False)
class SectionForce:
    """A section force of a link: the columns of the outputs that its law is made of, and how its
    mass lies.
    """

    force: str
    link: str
    columns: Mapping[Output, int]
    length: float
    density: NumericDensity

    def curves(self, columns: Array) -> tuple[Array, Array]:
        """Ratios and values, each (curves, t): see :meth:`.Pieces.curves`."""
        outputs = {output: columns[k] for output, k in self.columns.items()}
        return law_of(self.link, outputs, self.length, self.density).pieces(self.force).curves()


Quantity: TypeAlias = "tuple[int, ...] | Along"
"""A column, some that are the components of a vector whose size is meant, or what is known along a
link, as a section force.
"""


@dataclass(frozen=True, eq=False)
class Signals:
    """Quantities of a graph, interpreted for parameters ``p`` over instants ``t``, with iterated
    coordinates ``z`` there.

    ``turned`` are, by the number of an angle that loops set, its values at the instants, which show
    its turns.
    """

    interpreter: Interpreter
    sharpness: Sharpness
    quantities: Sequence[Quantity]
    t: Array
    p: Array
    z: Array
    turned: Mapping[int, Array] = field(default_factory=dict)

    def peaks(
        self,
        units: Sequence[int],
        scales: Sequence[float] = (),
        listed: Listed | None = None,
    ) -> Peaks:
        """The peaks of the quantities over all times between the first instant and the last.

        ``units`` numbers the units of all, and ``scales`` gives for each unit how large others are
        that have it. ``listed`` says which local peaks are reported too. Raises
        :class:`.CompilerError` where there is no compiler.
        """
        search = peak_search()
        samples = self.samples(self.t, self.z, np.arange(self.t.size))
        first = self.columns(self.t[:1], self.z[:, :1])
        with np.errstate(all="ignore"):
            counts = [len(values) for _, values in self.curves(first, np.zeros(1, int))]
        quantities = tuple(q for q, count in enumerate(counts) for _ in range(count))
        columns = [
            one if isinstance(one, tuple) else one.columns.values() for one in self.quantities
        ]
        sharpness = self.sharpness
        curves = Curves(
            quantities,
            tuple(units),
            sharpness.watches,
            sharpness.dependence(columns),
            sharpness.knots,
            tuple(scales),
        )
        hiding = bent(self.interpreter.program, sharpness, self.t, self.p)
        with np.errstate(all="ignore"):
            return search.peaks(self, curves, self.t, samples, hiding, listed)

    def at(self, t: Array) -> Samples:
        """All curves at times; NaN where iterated loops do not close."""
        near = self.near(t)
        z, failed = self.closed(t, near)
        found = self.samples(t, z, near)
        return found._replace(values=np.where(failed, np.nan, found.values))

    def near(self, t: Array) -> npt.NDArray[np.intp]:
        """The instants that are nearest to times."""
        step = (self.t[-1] - self.t[0]) / max(self.t.size - 1, 1) or 1.0
        return np.asarray(np.clip(np.round((t - self.t[0]) / step), 0, self.t.size - 1), np.intp)

    def closed(self, t: Array, near: npt.NDArray[np.intp]) -> tuple[Array, Flags]:
        """The iterated coordinates at times next to instants (z, t), and where the loops do not
        close.
        """
        z = self.z[:, near]
        self.interpreter.close(t, self.p, z)
        failed = np.asarray(np.isnan(z).any(axis=0))
        return np.where(failed, self.z[:, near], z), failed

    def samples(self, t: Array, z: Array, near: npt.NDArray[np.intp]) -> Samples:
        """All curves at times next to instants, at which the iterated coordinates are known."""
        blocks = [slice(start, start + _BLOCK) for start in range(0, t.size, _BLOCK)]
        parts = [self._samples(t[block], z[:, block], near[block]) for block in blocks]
        return Samples(*(np.concatenate(rows, axis=1) for rows in zip(*parts, strict=True)))

    def _samples(self, t: Array, z: Array, near: npt.NDArray[np.intp]) -> Samples:
        columns = self.columns(t, z)
        motion = self.interpreter.program.motion(t[None], self.p)
        watched = self.sharpness.watched(t[None], *motion, z, self.p).full()
        with np.errstate(all="ignore"):
            places, values = (
                np.concatenate(rows) for rows in zip(*self.curves(columns, near), strict=True)
            )
        return Samples(values, places, watched)

    def columns(self, t: Array, z: Array) -> Array:
        """The graph's columns at times, (columns, t), with the iterated coordinates known."""
        return self.interpreter.columns(t, self.p, z)

    def curves(self, columns: Array, near: npt.NDArray[np.intp]) -> list[tuple[Array, Array]]:
        """Curves of each quantity: see :meth:`curves_of`."""
        return [self.curves_of(q, columns, near) for q in range(len(self.quantities))]

    def curves_of(self, q: int, columns: Array, near: npt.NDArray[np.intp]) -> tuple[Array, Array]:
        """Curves of a quantity by its number, as ratios and values (curves, t), from the graph's
        columns (columns, t).
        """
        quantity = self.quantities[q]
        if not isinstance(quantity, tuple):
            return quantity.curves(columns)
        rows = columns[list(quantity)]
        values = rows[0] if len(rows) == 1 else size_of(rows)
        if q in self.turned:
            values = values + math.tau * np.round((self.turned[q][near] - values) / math.tau)
        return np.full((1, values.size), np.nan), values[None]

"""Columns of a sweep: their names, units and axes, and how they are taken from an engine's outcome.

A column's full name is ``kind:quantity`` (``peak:section:rod:bending``, ``peak_t:effort:O``,
``rms:effort:O``), the quantity named as everywhere; the same with slashes is its place in the file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ...arithmetic.scalars import column
from ...base.arrays import Array, Operand
from ...base.quantities import Output
from ...base.status import Status
from ...base.tables import Table, table_of
from ...base.vocabulary import KEEPS, Keep
from ...declare.density import Density
from ...declare.wanted_names import SENSITIVITY
from ...equations.model_data import ModelData
from ...equations.program import Program
from ...errors import DeclarationError, UnknownNameError
from ...instants.laws import law_of
from ...instants.section_law import SectionLaw
from ...instants.statistics import of_counted
from ..designs.energy import DriveEnergy
from ..designs.engine import DesignEngine
from ..designs.outcome import Outcome
from .chunks import encoded
from .column import MISSING, Column
from .instant_axis import InstantAxis
from .meanings import ERROR, FLUCTUATION, LEAST, LIFE, MASS, STATUS, TIMES, Meanings
from .strength import Kept

KINDS = (
    STATUS,
    "peak",
    "peak_t",
    "peak_over",
    "peak_xi",
    ERROR,
    "mean",
    "rms",
    FLUCTUATION,
    SENSITIVITY,
    "peak_at",
    "history",
    LEAST,
    LIFE,
    MASS,
)
"""Kinds of columns, in the order in which they are listed."""

_MEANS = ("mean", "rms")

_MOST, _BYTES, _SECONDS = 1 << 14, 1 << 24, 1.0
_AT_HAND = 1 << 22
_GRID_COST = 5e-10
"""Seconds of a section force at an instant and a ratio."""

_FLUCTUATION_COST = 3e-3
"""Seconds of a fluctuation of energy."""

_SLOPES_COST = 3e-4
"""Seconds of the derivatives of a design's peaks."""


def check_keep(keep: str) -> None:
    """Raise :class:`UnknownNameError` for what cannot be kept."""
    if keep not in KEEPS:
        raise UnknownNameError("choice of what to keep", str(keep), KEEPS)


@dataclass(frozen=True, eq=False)
class Harvest:
    """An engine, and what is kept of its outcomes: ``axis`` is that of the instants, ``xi`` the
    ratios kept, none where empty.

    By the ``whole`` graph designs are looked at closely.

    ``safety`` and ``life`` are the links of which these are kept. By the parameters ``by`` the
    derivatives of peaks are kept too, and with ``fluctuation`` that of the energy of drives.
    """

    engine: DesignEngine
    whole: Program
    keep: Keep
    axis: InstantAxis
    xi: Array
    safety: tuple[str, ...] = ()
    life: tuple[str, ...] = ()
    by: tuple[str, ...] = ()
    fluctuation: bool = False

    def __post_init__(self) -> None:
        check_keep(self.keep)
        if self.fluctuation and not self.engine.drives:
            raise DeclarationError(
                "fluctuation: only efforts of joints whose motion is given have a fluctuation of"
                " energy, and none is in wanted=; add effort"
            )
        if self.xi.size and not self._links:
            raise DeclarationError("xi: ratios apply to section forces, and none is in wanted=")
        if self.keep == "laws" and not self._links:
            raise DeclarationError(
                "keep laws: laws describe section forces, and none is in wanted="
            )

    @property
    def data(self) -> ModelData:
        """Data of the mechanism."""
        return self.engine.program.data

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """All columns, in the order of :meth:`evaluate`."""
        engine, over = self.engine, self.axis.name
        names = {STATUS: tuple[str, ...]()}
        names |= {
            f"{kind}:{quantity}": ()
            for quantity in self._quantities
            for kind in self._of_peaks(quantity)
        }
        names |= {f"{kind}:{name}": () for name in engine.efforts for kind in _MEANS}
        names |= {f"{FLUCTUATION}:{name}": () for name in self._drives}
        for parameter in self.by:
            names |= {f"{SENSITIVITY}:{parameter}:peak:{name}": () for name in engine.quantities}
            names |= {
                f"{SENSITIVITY}:{parameter}:{kind}:{name}": ()
                for kind in _MEANS
                for name in engine.efforts
            }
        sections = [
            f"section:{link}:{force}"
            for link in self._links
            for force in self._table.forces
            if self.xi.size
        ]
        names |= {f"peak_at:{name}": ("xi",) for name in sections}
        names |= {f"history:{name}": (over,) for name in self._series}
        if self._own_times:
            names[TIMES] = (over,)
        if self.keep == "histories":
            names |= {f"history:{name}": (over, "xi") for name in sections}
        names |= dict.fromkeys(self.strength.columns, ())
        lengths, meanings = {over: self.axis.values.size, "xi": self.xi.size}, self.meanings
        found = []
        for name, axes in names.items():
            unit, words = meanings.of_column(name, names)
            indeterminate = self.strength.columns.get(
                name, name.partition(":")[2] in engine.indeterminate
            )
            words |= {"missing": MISSING} if indeterminate else {}
            found.append(
                Column(
                    name,
                    unit,
                    words,
                    axes,
                    tuple(lengths[axis] for axis in axes),
                    "|i1" if name == STATUS else "<f8",
                )
            )
        return tuple(found)

    @property
    def meanings(self) -> Meanings:
        """Meanings of columns and axes."""
        units = {name: parameter.unit for name, parameter in self.data.parameters.items()}
        return Meanings(
            self._table,
            self.data.kinds,
            units,
            self.axis.name,
            self.axis.joint,
            self.axis.drive_unit,
        )

    @property
    def block(self) -> int:
        """Number of designs of a block: about a second of a core's work, within memory and a
        reader's chunk.
        """
        grids = len(self._table.forces) * len(self._links) * self.axis.values.size * self.xi.size
        seconds = self.engine.cost + grids * _GRID_COST + (_SLOPES_COST if self.by else 0.0)
        seconds += _FLUCTUATION_COST * len(self._drives)
        return max(
            1,
            min(
                _MOST,
                int(_SECONDS / seconds),
                _BYTES // sum(column.width for column in self.columns),
            ),
        )

    def chunks(self, p: Array, capacity: int) -> list[bytes]:
        """The columns of designs ``p`` (designs, parameters) as chunks of the file that have room
        for so many.
        """
        whole = [np.zeros((capacity, *column.lengths), column.dtype) for column in self.columns]
        for start in range(0, len(p), self._piece):
            some = slice(start, min(start + self._piece, len(p)))
            for into, values in zip(whole, self.evaluate(p[some]), strict=True):
                into[some] = values
        self._check_closely(p, whole)
        return [encoded(values) for values in whole]

    def _check_closely(self, p: Array, whole: Sequence[Operand]) -> None:
        """Take one of the designs that have a result, and mark it
        where it fails its certificate.
        """
        there = np.flatnonzero(whole[0][: len(p)] == Status.OK)
        if not there.size:
            return
        chosen = int(there[there.size // 2])
        if self.engine.failures(p[chosen], self.whole):
            whole[0][chosen] = Status.UNCERTIFIED
            for column in whole[1:]:
                column[chosen] = np.nan

    def evaluate(self, p: Array) -> list[Operand]:
        """The columns of designs ``p`` (designs, parameters), each of shape (designs, its own
        axes).
        """
        outcome = self.engine.evaluate(p, threads=1, histories=self._histories)
        found: list[Any] = [outcome.status.astype(np.int8, copy=False)]
        for k, output in enumerate(self._quantities):
            found += [outcome.value[:, k], outcome.t[:, k]]
            if self.axis.joint:
                assert outcome.over is not None
                found.append(outcome.over[:, k])
            if output.group == "section":
                found.append(outcome.xi[:, k])
            if outcome.error is not None:
                found.append(outcome.error[:, k])
        for k in range(len(self.engine.efforts)):
            found += [outcome.mean[:, k], outcome.rms[:, k]]
        found += self._fluctuations(outcome, p)
        if self.by:
            peaks, means = self.engine.slopes_at(p, outcome), self.engine.mean_slopes_at(p, outcome)
            for number in map(list(self.data.parameters).index, self.by):
                found += [*np.moveaxis(peaks[:, :, number], 1, 0)]
                found += [
                    means[:, k, e, number]
                    for k in range(len(_MEANS))
                    for e in range(len(self.engine.efforts))
                ]
        largest, whole = self._along_links(outcome, p)
        found += largest
        if self._series:
            assert outcome.series is not None
            rows = {name: k for k, name in enumerate(self.engine.columns)}
            found += [outcome.series[:, rows[name]] for name in self._series]
        if self._own_times:
            assert outcome.times is not None
            found.append(np.where((outcome.status == Status.OK)[:, None], outcome.times, np.nan))
        if self.strength.columns:
            found_there = (outcome.status, outcome.value, outcome.series, p)
            return found + whole + self.strength.evaluate(*found_there)
        return found + whole

    @property
    def _table(self) -> Table:
        """Table of quantities."""
        return table_of(self.data.space)

    @cached_property
    def strength(self) -> Kept:
        """Strength results of links that are kept."""
        engine = self.engine
        indeterminate = {
            output.part
            for output in map(Output.of, engine.indeterminate)
            if output.group == "section"
        }
        made = (engine.quantities, engine.columns)
        return Kept(self.engine.program, self.safety, self.life, *made, indeterminate)

    @property
    def _histories(self) -> bool:
        """True if whole histories must be evaluated."""
        return self.keep != "peaks" or bool(self.xi.size) or self.strength.histories

    @property
    def _piece(self) -> int:
        """Number of designs that are evaluated at once: so few that their outcome is still in the
        processor's cache when it is taken apart.
        """
        series = 8 * len(self.engine.columns) * self.axis.values.size if self._histories else 0
        capacity = _BYTES if self._histories else _AT_HAND
        return max(1, capacity // (series + sum(column.width for column in self.columns)))

    @property
    def _own_times(self) -> bool:
        """True if the times of each design's instants are kept."""
        return self.keep != "peaks" and self.axis.name != "t"

    @cached_property
    def _quantities(self) -> tuple[Output, ...]:
        return tuple(map(Output.of, self.engine.quantities))

    @cached_property
    def _links(self) -> tuple[str, ...]:
        return tuple(
            dict.fromkeys(output.part for output in self._quantities if output.group == "section")
        )

    @cached_property
    def _series(self) -> tuple[str, ...]:
        """The engine's columns that are kept whole."""
        if self.keep == "peaks":
            return ()
        return tuple(
            name
            for name in self.engine.columns
            if self.keep == "histories" or Output.of(name).along
        )

    @property
    def _drives(self) -> tuple[Output, ...]:
        """The efforts of which the fluctuation of energy is kept."""
        return self.engine.drives if self.fluctuation else ()

    def _fluctuations(self, outcome: Outcome, p: Array) -> list[Array]:
        """The fluctuation of energy of each drive, (designs,)."""
        found = []
        for drive in self._drives:
            energy, column = DriveEnergy(self.engine, drive), np.full(len(p), np.nan)
            for k in np.flatnonzero(outcome.status == Status.OK):
                column[k] = energy.fluctuation(p[k])
            found.append(column)
        return found

    def _of_peaks(self, quantity: Output) -> list[str]:
        """The kinds of columns of the peak of a quantity."""
        over = ["peak_over"] if self.axis.joint else []
        xi = ["peak_xi"] if quantity.group == "section" else []
        return ["peak", "peak_t", *over, *xi, *([ERROR] if self.engine.sampled else [])]

    def _along_links(self, outcome: Outcome, p: Array) -> tuple[list[Array], list[Array]]:
        """Largest values over the instants of each link and force, (designs, xi), and, if they are
        kept, all, (designs, t, xi).
        """
        if not self.xi.size:
            return [], []
        series = outcome.series
        assert series is not None
        largest, whole = [], []
        for link in self._links:
            mass_properties = LinkProperties.of(self.data, link, self.engine.provenance.precision)
            every = enumerate(map(Output.of, self.engine.columns))
            rows = {output: k for k, output in every if output.along and output.part == link}
            with np.errstate(all="ignore"):  # of designs that have no result
                moving = of_counted(series[:, list(rows.values())])
                laws = mass_properties.law(
                    {output: moving[:, k] for k, output in enumerate(rows)}, p
                )
                basis = laws.basis(self.xi)
                found = (laws.largest(force, basis) for force in self._table.forces)
                largest += [
                    np.where((outcome.status == Status.OK)[:, None], one, np.nan) for one in found
                ]
            if self.keep == "histories":
                grids = np.full(
                    (len(self._table.forces), len(p), self.axis.values.size, self.xi.size), np.nan
                )
                for i in np.flatnonzero(outcome.status == Status.OK):
                    law = mass_properties.law(
                        {output: series[i, k] for output, k in rows.items()}, p[i]
                    )
                    law.on_grids(self._table.forces, self.xi, grids[:, i], threads=1)
                whole += list(grids)
        return largest, whole


@dataclass(frozen=True, eq=False)
class LinkProperties:
    """A link's length and density over the parameters, without deriving either anew for each
    design.

    Laws are made of what was evaluated in a ``precision``.
    """

    link: str
    density: Density
    numbers: Any
    precision: str

    @classmethod
    def of(cls, data: ModelData, name: str, precision: str) -> LinkProperties:
        """Make it for a link."""
        length, density = data.mass_properties(name, data.symbols)
        cells = [c for cell in density.cells for c in cell]
        numbers = ca.Function("matter", [data.symbols], [ca.densify(column([length, *cells]))])
        return cls(name, density, numbers, precision)

    def law(self, members: Mapping[Output, Array], p: Array) -> SectionLaw:
        """The law from its coefficients and loads, (t,), of a design (parameters,).

        Or the laws of n designs: members are (n, t), length and density (n, 1).
        """
        length, *cells = (
            self.numbers(p.T).full()[..., None]
            if p.ndim > 1
            else self.numbers(p).full().ravel().tolist()
        )
        rest = iter(cells)
        density = self.density.at(lambda _: next(rest), length)
        return law_of(self.link, members, length, density, self.precision)

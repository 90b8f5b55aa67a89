"""Columns of a sweep: what is asked of its designs, the names, units and axes of columns, and how
they are taken from an engine's outcome.

A column's full name is ``kind:quantity`` (``peak:section:rod:bending``, ``peak_t:effort:O``,
``rms:effort:O``), the quantity named as everywhere; the same with slashes is its place in the file.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Json, Operand, as_json
from ...base.quantities import Output, parts_along
from ...base.status import Status
from ...base.tables import table_of
from ...base.vocabulary import Keep
from ...engine.identity import sources
from ...engine.model_data import ModelData
from ...engine.program import Program
from ...errors import DeclarationError
from ...model.even_points import EvenPoints, points
from ...model.times import Timing
from ...model.wanted_names import SENSITIVITY
from ...results.section_laws import law_for
from ...results.statistics import of_counted
from ..designs.energy import DriveEnergy
from ..designs.engine import DesignEngine
from ..designs.outcome import Outcome
from .chunks import encoded
from .meanings import ERROR, FLUCTUATION, STATUS, TIMES, Column, InstantAxis, Meanings
from .sweep_strength import Kept

MISSING = "NaN for designs for which it is indeterminate, by equilibrium or by friction at rest"
"""Attribute ``missing`` of a column that may lack a number for a design with a result."""

_MEANS = ("mean", "rms")
_PEAKS = {"peak": "value", "peak_t": "t", "peak_over": "over", "peak_xi": "xi", ERROR: "error"}
"""Field of :class:`.Outcome` of each kind of columns on peaks."""

_MOST, _BYTES, _SECONDS = 1 << 14, 1 << 24, 1.0
_AT_HAND = 1 << 22
_GRID_COST = 5e-10
"""Seconds of a section force at an instant and a ratio."""

_FLUCTUATION_COST = 3e-3
"""Seconds of a fluctuation of energy."""

_SLOPES_COST = 3e-4
"""Seconds of the derivatives of a design's peaks."""


@dataclass(frozen=True, eq=False)
class Harvest:
    """Columns that are kept of an ``engine``'s outcomes, whatever the designs are. A worker that is
    sent the fields makes another one.

    By the ``whole`` graph designs are looked at closely. Section forces are kept at ``ratios``.
    ``safety`` and ``life`` are the links of which these are kept, ``by`` the parameters by which
    derivatives are, and with ``fluctuation`` that of the energy of drives is.
    """

    engine: DesignEngine
    whole: Program
    ratios: EvenPoints | None
    keep: Keep
    safety: tuple[str, ...]
    life: tuple[str, ...]
    by: tuple[str, ...]
    fluctuation: bool

    def __post_init__(self) -> None:
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

    @property
    def timing(self) -> Timing:
        """Timing of the instants."""
        return self.engine.times.timing

    @cached_property
    def axis(self) -> InstantAxis:
        """Axis of the instants."""
        return InstantAxis.of(self.data, self.timing)

    @cached_property
    def xi(self) -> Array:
        """Ratios at which section forces are kept, none where empty."""
        return np.zeros(0) if self.ratios is None else points(self.ratios)

    @cached_property
    def signature(self) -> dict[str, Json]:
        """Inputs of a design's numbers beside its parameters, wherever it is evaluated."""
        program, made = self.engine.program, self.engine.provenance
        words = {
            "versions": {**made.versions, "zlib": zlib.ZLIB_RUNTIME_VERSION},
            "sources": sources(),
            "backend": made.backend,
            "precision": made.precision,
            "compiler": made.compiler,
            "flags": made.flags,
            "rung": made.method + (", sampled peaks" if self.engine.sampled else ""),
            "wanted": asdict(program.wanted)
            | ({SENSITIVITY: self.by} if self.by else {})
            | ({FLUCTUATION: True} if self.fluctuation else {}),
            "t": self.timing.words(program.data.symbols),
            "xi": self.ratios,
            "keep": self.keep,
            "scene": program.identity or "cannot be identified",
        }
        return cast(dict[str, Json], as_json(words))

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """All columns, in the order of :meth:`evaluate`."""
        lengths = {self.axis.name: self.axis.values.size, "xi": self.xi.size}
        found = []
        for name, (axes, *_) in self._kept.items():
            unit, words = self.meanings.of_column(name, self._kept)
            if self.strength.columns.get(name, name.partition(":")[2] in self.engine.indeterminate):
                words["missing"] = MISSING
            sizes, dtype = tuple(map(lengths.__getitem__, axes)), "|i1" if name == STATUS else "<f8"
            found.append(Column(name, unit, words, axes, sizes, dtype))
        return tuple(found)

    @cached_property
    def _kept(self) -> dict[str, tuple[tuple[str, ...], str, tuple[int, ...]]]:
        """The axes of each column, and its place in a :class:`_Batch`: table and numbers."""
        engine, over, keep = self.engine, self.axis.name, self.keep
        found: dict[str, tuple[tuple[str, ...], str, tuple[int, ...]]] = {
            STATUS: ((), "status", ())
        }
        for k, quantity in enumerate(map(Output.of, engine.quantities)):
            along = quantity.group == "section"
            there = {"peak_over": self.timing.joint, "peak_xi": along, ERROR: engine.sampled}
            for kind, field in _PEAKS.items():
                if there.get(kind, True):
                    found[f"{kind}:{quantity}"] = (), field, (k,)
        for k, name in enumerate(engine.efforts):
            found |= {f"{kind}:{name}": ((), kind, (k,)) for kind in _MEANS}
        for k, drive in enumerate(self._drives):
            found[f"{FLUCTUATION}:{drive}"] = (), "fluctuations", (k,)
        for parameter in self.by:
            p, begin = list(self.data.parameters).index(parameter), f"{SENSITIVITY}:{parameter}"
            for k, name in enumerate(engine.quantities):
                found[f"{begin}:peak:{name}"] = (), "slopes", (p, k)
            for mean, kind in enumerate(_MEANS):
                for k, name in enumerate(engine.efforts):
                    found[f"{begin}:{kind}:{name}"] = (), "mean_slopes", (p, mean, k)
        sections = [f"section:{link}:{force}" for link in self._links for force in self._forces]
        sections = sections if self.xi.size else []
        for k, name in enumerate(sections):
            found[f"peak_at:{name}"] = ("xi",), "along_links", (0, k)
        for k, name in enumerate(engine.columns):
            if keep == "histories" or (keep == "laws" and Output.of(name).along):
                found[f"history:{name}"] = (over,), "series", (k,)
        if keep != "peaks" and over != "t":
            found[TIMES] = (over,), "instants", ()
        if keep == "histories":
            for k, name in enumerate(sections):
                found[f"history:{name}"] = (over, "xi"), "along_links", (1, k)
        for k, name in enumerate(self.strength.columns):
            found[name] = (), "strength", (k,)
        return found

    @property
    def meanings(self) -> Meanings:
        """Meanings of columns and axes."""
        return Meanings(self.data.content, self.timing.joint, self.timing.shared)

    @property
    def block(self) -> int:
        """Number of designs of a block: about a second of a core's work, within memory and a
        reader's chunk.
        """
        grids = len(self._forces) * len(self._links) * self.axis.values.size * self.xi.size
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
        batch = _Batch(self, p, outcome)
        return [batch.column(table, numbers) for _, table, numbers in self._kept.values()]

    @property
    def _forces(self) -> tuple[str, ...]:
        """Section forces."""
        return table_of(self.data.space).forces

    @cached_property
    def strength(self) -> Kept:
        """Strength results of links that are kept."""
        return Kept(self.engine, self.safety, self.life)

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

    @cached_property
    def _links(self) -> tuple[str, ...]:
        sections = (one for one in map(Output.of, self.engine.quantities) if one.group == "section")
        return tuple(dict.fromkeys(one.part for one in sections))

    @property
    def _drives(self) -> tuple[Output, ...]:
        """The efforts of which the fluctuation of energy is kept."""
        return self.engine.drives if self.fluctuation else ()


@dataclass(frozen=True, eq=False)
class _Batch:
    """Designs ``p`` (designs, parameters) after their evaluation: tables of columns, by the numbers
    of these first. Each is made when a column is taken from it.
    """

    harvest: Harvest
    p: Array
    outcome: Outcome

    def column(self, table: str, numbers: tuple[int, ...]) -> Operand:
        """The column of some numbers in a table: of the outcome, or of what is made of that."""
        if not hasattr(type(self), table):
            place = slice(None), *numbers
            return np.asarray(getattr(self.outcome, table)[place])
        found: Any = getattr(self, table)
        for number in numbers:
            found = found[number]
        return np.asarray(found)

    @property
    def instants(self) -> Array:
        """Instants of each design."""
        assert self.outcome.times is not None
        return np.asarray(np.where(self._valid[:, None], self.outcome.times, np.nan))

    @cached_property
    def fluctuations(self) -> Array:
        """The fluctuation of energy of each drive, (drives, designs)."""
        engine = self.harvest.engine
        energies = [DriveEnergy(engine, drive) for drive in engine.drives]
        return self._each(
            (len(energies),), lambda k: [energy.fluctuation(self.p[k]) for energy in energies]
        )

    @cached_property
    def slopes(self) -> Array:
        """Derivatives of peaks, (parameters, quantities, designs)."""
        engine, p, found = self.harvest.engine, self.p, self.outcome
        return self._each(
            (p.shape[1], found.value.shape[1]),
            lambda k: engine.gradient(p[k], found.value[k], found.t[k], found.xi[k]).slopes.T,
        )

    @cached_property
    def mean_slopes(self) -> Array:
        """Derivatives of means and of root mean squares, (parameters, 2, efforts, designs)."""
        engine, mean = self.harvest.engine, self.outcome.mean
        return self._each(
            (self.p.shape[1], 2, mean.shape[1]),
            lambda k: np.where(
                np.isnan(mean[k]), np.nan, np.transpose(engine.mean_slopes(self.p[k]), (2, 0, 1))
            ),
        )

    def _each(self, size: tuple[int, ...], of: Callable[[int], npt.ArrayLike]) -> Array:
        """An array (..., designs) of what is found ``of`` each design with a result, else NaN."""
        found = np.full((len(self.p), *size), np.nan)
        for k in np.flatnonzero(self._valid).tolist():
            found[k] = of(k)
        return np.moveaxis(found, 0, -1)

    @cached_property
    def strength(self) -> list[Array]:
        """Columns on the strength of links."""
        return self.harvest.strength.evaluate(self.outcome, self.p)

    @cached_property
    def along_links(self) -> tuple[list[Array], list[Array]]:
        """Largest values over the instants of each link and force, (designs, xi), and, if they are
        kept, all, (designs, t, xi).
        """
        harvest, p, xi, series = self.harvest, self.p, self.harvest.xi, self.outcome.series
        engine, forces = harvest.engine, harvest._forces
        assert series is not None
        largest, whole = [], []
        for link in harvest._links:
            law = partial(law_for, harvest.data, link, precision=engine.provenance.precision)
            numbers = {Output.of(name): k for k, name in enumerate(engine.columns)}
            rows = parts_along(numbers, link)
            with np.errstate(all="ignore"):  # of designs that have no result
                moving = of_counted(series[:, list(rows.values())])
                laws = law({output: moving[:, k] for k, output in enumerate(rows)}, p)
                basis = laws.basis(xi)
                found = (laws.largest(force, basis) for force in forces)
                largest += [np.where(self._valid[:, None], one, np.nan) for one in found]
            if harvest.keep == "histories":
                grids = np.full((len(forces), len(p), harvest.axis.values.size, xi.size), np.nan)
                for i in np.flatnonzero(self._valid):
                    alone = law({output: series[i, k] for output, k in rows.items()}, p[i])
                    alone.on_grids(forces, xi, grids[:, i], threads=1)
                whole += list(grids)
        return largest, whole

    @property
    def _valid(self) -> npt.NDArray[np.bool_]:
        """True for designs with a result."""
        return np.asarray(self.outcome.status == Status.OK)

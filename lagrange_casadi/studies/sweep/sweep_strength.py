"""Strength results of a sweep: least factors of safety, lives, and masses.

Utilisation against yielding and buckling comes from the engine. Fatigue follows from whole
histories, as of a solution (:mod:`.strength.fibres`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output, parts_along
from ...engine.model_data import ModelData
from ...model.mass_properties import ALL
from ...results.statistics import counted
from ...results.strength.fatigue import Score, damage_score, lacking, use_score
from ...results.strength.fibres import maxima
from ...results.strength.member import Member
from ..designs.engine import DesignEngine
from ..designs.outcome import Outcome
from .meanings import LEAST, LIFE, MASS, WAYS

_ENDLESS = 0.999
"""Utilisation up to which nothing wears: what is found of it is nearer to the largest."""

_MANY = 8192
"""Number of instants of designs that are looked at together, if none has a load that travels along
the link: their stresses stay near a processor.
"""


@dataclass(frozen=True, eq=False)
class Kept:
    """Links with strength results by an ``engine``: those whose ``safety`` is wanted, and those
    whose ``life`` is.
    """

    engine: DesignEngine
    safety: tuple[str, ...]
    life: tuple[str, ...]

    @property
    def data(self) -> ModelData:
        """Data of the program."""
        return self.engine.program.data

    @property
    def histories(self) -> bool:
        """True if whole histories must be evaluated."""
        return any(self._tires(link) for link in self.safety) or bool(self.life)

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The links of which something is kept, in the order of declaration."""
        return tuple(
            name for name in self.data.content.bodies if name in (*self.safety, *self.life)
        )

    @cached_property
    def columns(self) -> Mapping[str, bool]:
        """The names of the columns, in the order of :meth:`evaluate`, and which may lack numbers
        where there is a result.
        """
        outputs = map(Output.of, self.engine.indeterminate)
        indeterminate = {output.part for output in outputs if output.group == "section"}
        found = {
            f"{LEAST}:{mode}:{link}": link in indeterminate
            for link in self._rated
            for mode in ("safety", *self._ways(link))
        }
        found |= {f"{LIFE}:{link}": link in indeterminate for link in self._lives}
        return found | {f"{MASS}:{part}": False for part in (*self.links, ALL) if self.links}

    def evaluate(self, outcome: Outcome, p: Array) -> list[Array]:
        """The columns of designs ``p`` (n, parameters) by their outcome."""
        there = np.flatnonzero(outcome.status == 0)
        tired = {
            link: self._tired(link, there, outcome.series, p)
            for link in self.links
            if self._tires(link)
        }
        found: list[Array] = []
        for link in self._rated:
            kept = [f"utilisation:{link}:{mode}" for mode in self._ways(link) if mode != "fatigue"]
            shares = [np.abs(outcome.value[:, self.engine.quantities.index(name)]) for name in kept]
            shares += [tired[link][0]] if link in tired else []
            with np.errstate(divide="ignore"):
                found.append(1.0 / np.max(shares, axis=0))
                found += [1.0 / share for share in shares]
        found += [tired[link][1] for link in self._lives]
        masses = np.atleast_2d(self._masses(p.T).full())
        return found + [np.where(outcome.status == 0, row, np.nan) for row in masses]

    def _ways(self, link: str) -> list[str]:
        known = [
            mode for mode in WAYS[:2] if f"utilisation:{link}:{mode}" in self.engine.quantities
        ]
        return known + (["fatigue"] if self._tires(link) else [])

    @property
    def _rated(self) -> list[str]:
        """The links of which something is known that may fail."""
        return [link for link in self.safety if self._ways(link)]

    @property
    def _lives(self) -> list[str]:
        return [link for link in self.life if self._tires(link)]

    def _tires(self, link: str) -> bool:
        return link in self.data.content.materials and not lacking(
            self.data.content.materials[link]
        )

    def _tired(
        self, link: str, there: npt.NDArray[np.int64], series: Array | None, p: Array
    ) -> tuple[Array, Array]:
        """Utilisation against fatigue, and the life in cycles, of every design."""
        share, lives = np.full(len(p), np.nan), np.full(len(p), np.nan)
        assert series is not None
        numbers = {Output.of(name): k for k, name in enumerate(self.engine.columns)}
        material, outputs = self.data.content.materials[link], parts_along(numbers, link)
        members = series[:, [*outputs.values()]]
        counts = np.array([counted(members[k]) for k in there])
        for moving in np.unique(counts, axis=0):
            if not moving.any():
                continue
            some = there[(counts == moving).all(axis=1)]
            values = dict(zip(outputs, np.moveaxis(members[..., moving], 1, 0), strict=True))
            largest = partial(self._largest, link, p, values)
            share[some] = largest(some, use_score(material))
            if link in self.life:
                lives[some] = math.inf
                worn = some[(share[some] > _ENDLESS) | (not material.endless)]
                with np.errstate(divide="ignore"):
                    lives[worn] = 1.0 / np.maximum(largest(worn, damage_score(material)), 0.0)
        return share, lives

    def _largest(
        self,
        link: str,
        p: Array,
        law: Mapping[Output, Array],
        designs: npt.NDArray[np.int64],
        score: Score,
    ) -> Array:
        """The largest score (designs,) of designs by number, among all parameters and members of a
        ``law``.
        """
        found, many = np.empty(designs.size), max(1, _MANY // next(iter(law.values())).shape[1])
        for start in range(0, designs.size, many):
            some = designs[start : start + many]
            for (layout, _), alike in self._member(link, p, law, some).alike.items():
                member = replace(self._member(link, p, law, some[alike]), layout=layout)
                found[start + np.array(alike)] = [few[0].score for few in maxima(member, score)]
        return found

    def _member(
        self, link: str, p: Array, law: Mapping[Output, Array], some: npt.NDArray[np.int64]
    ) -> Member:
        values = {output: rows[some] for output, rows in law.items()}
        return Member.of_designs(self.data, link, p[some], values)

    @cached_property
    def _masses(self) -> ca.Function:
        p = self.data.symbols
        found = [self.data.mass(part, p) for part in (*self.links, ALL)]
        return ca.Function("masses", [p], [ca.densify(ca.vertcat(*found))])

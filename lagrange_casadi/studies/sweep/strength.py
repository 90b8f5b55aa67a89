"""Strength results of a sweep: least factors of safety, lives, and masses.

Utilisation against yielding and buckling comes from the engine. Fatigue follows from whole
histories: where stations stand still, of all designs at once (:mod:`...strength.fibres`), else of
one design after another, as of a solution.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...beams.beam import beam_from_numbers
from ...declare.masses import ALL
from ...equations.model_data import ModelData
from ...instants.statistics import counted
from ...strength.fatigue import damage_score, factor_score, lacking
from ...strength.fibres import FibreStresses
from ...strength.member import Member
from ...strength.stress import Stress
from ...strength.worst import FEW, worst
from .link_properties import LinkProperties
from .meanings import LEAST, LIFE, MASS, WAYS

_NUMBERS = 1 << 19
"""Stresses that are at hand at once, of as many designs as have no more: so many stay in the memory
next to a processor.
"""

_CRITERION = "goodman"

_ENDLESS = 0.9
"""Utilisation at places up to which nothing wears between them: of a polynomial of degree 5 they
miss less than the rest.
"""


@dataclass(frozen=True, eq=False)
class Kept:
    """Links with strength results: those whose ``safety`` is wanted, and those whose ``life`` is.

    ``series`` names what is evaluated over time, in a ``precision``; ``indeterminate`` the links
    that lack it for some designs.
    """

    data: ModelData
    safety: tuple[str, ...]
    life: tuple[str, ...]
    quantities: tuple[str, ...]
    series: tuple[str, ...]
    precision: str
    indeterminate: Collection[str] = ()

    @property
    def histories(self) -> bool:
        """True if whole histories must be evaluated."""
        return any(self._tires(link) for link in self.safety) or bool(self.life)

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The links of which something is kept, in the order of declaration."""
        return tuple(
            name
            for name in self.data.template.content["bodies"]
            if name in (*self.safety, *self.life)
        )

    @cached_property
    def columns(self) -> Mapping[str, bool]:
        """The names of the columns, in the order of :meth:`evaluate`, and which may lack numbers
        where there is a result.
        """
        found = {
            f"{LEAST}:{way}:{link}": link in self.indeterminate
            for link in self._rated
            for way in ("safety", *self._ways(link))
        }
        found |= {f"{LIFE}:{link}": link in self.indeterminate for link in self._lives}
        return found | {f"{MASS}:{part}": False for part in (*self.links, ALL) if self.links}

    def evaluate(
        self,
        status: npt.NDArray[np.int8],
        value: Array,
        series: Array | None,
        times: Array,
        p: Array,
    ) -> list[Array]:
        """The columns of designs ``p``: ``value`` (n, quantities) are peaks, ``series`` (n,
        outputs, t), ``times`` (n, t).
        """
        there = np.flatnonzero(status == 0)
        tired = {
            link: self._tired(link, there, series, times, p)
            for link in self.links
            if self._tires(link)
        }
        found: list[Array] = []
        for link in self._rated:
            kept = [f"utilisation:{link}:{way}" for way in self._ways(link) if way != "fatigue"]
            shares = [np.abs(value[:, self.quantities.index(name)]) for name in kept]
            shares += [tired[link][0]] if link in tired else []
            with np.errstate(divide="ignore"):
                found.append(1.0 / np.max(shares, axis=0))
                found += [1.0 / share for share in shares]
        found += [tired[link][1] for link in self._lives]
        masses = np.atleast_2d(self._masses(p.T).full())
        return found + [np.where(status == 0, row, np.nan) for row in masses]

    def _ways(self, link: str) -> list[str]:
        known = [way for way in WAYS[:2] if f"utilisation:{link}:{way}" in self.quantities]
        return known + (["fatigue"] if self._tires(link) else [])

    @property
    def _rated(self) -> list[str]:
        """The links of which something is known that may fail."""
        return [link for link in self.safety if self._ways(link)]

    @property
    def _lives(self) -> list[str]:
        return [link for link in self.life if self._tires(link)]

    def _tires(self, link: str) -> bool:
        return link in self.data.materials and not lacking(self.data.materials[link])

    def _tired(
        self, link: str, there: npt.NDArray[np.int64], series: Array | None, times: Array, p: Array
    ) -> tuple[Array, Array]:
        """Utilisation against fatigue, and the life in cycles, of every design."""
        share, lives = np.full(len(p), np.nan), np.full(len(p), np.nan)
        assert series is not None
        if not there.size:
            return share, lives
        fatigue = self._fatigue[link]
        names = {name: k for k, name in enumerate(self.series)}
        chosen = [names[str(member)] for member in fatigue.members]
        members = series[there][:, chosen]
        counts = np.array([counted(own) for own in members])
        for moving in np.unique(counts, axis=0):
            if moving.any():
                alike = (counts == moving).all(axis=1)
                self._count(
                    link,
                    there[alike],
                    members[alike][..., moving],
                    (series, times, moving, p),
                    names,
                    share,
                    lives,
                )
        return share, lives

    def _count(
        self,
        link: str,
        there: npt.NDArray[np.int64],
        members: Array,
        whole: tuple[Array, Array, npt.NDArray[np.bool_], Array],
        names: Mapping[str, int],
        share: Array,
        lives: Array,
    ) -> None:
        """Fill in utilisations and lives of designs that are ``there``, of which the same instants
        count.
        """
        (series, times, moving, p), fatigue, material = (
            whole,
            self._fatigue[link],
            self.data.materials[link],
        )
        stands = fatigue.stands(members)
        some, standing = there[stands], members[stands]
        many = max(
            1, _NUMBERS // (fatigue.rows.nnz_out(0) // len(fatigue.members) * members.shape[2])
        )
        for start in range(0, some.size, many):
            few = slice(start, start + many)
            share[some[few]] = fatigue.histories(standing[few], p[some[few]]).utilisation(material)
        for i in there.tolist():
            endless = share[i] <= _ENDLESS and material.endless
            if np.isnan(share[i]) or (link in self.life and not endless):
                found, cycles = self._slowly(
                    link, series[i][:, moving], times[min(i, len(times) - 1)][moving], p[i], names
                )
                share[i] = found if np.isnan(share[i]) else share[i]
                lives[i] = cycles
            else:
                lives[i] = math.inf

    def _slowly(
        self, link: str, series: Array, t: Array, p: Array, names: Mapping[str, int]
    ) -> tuple[float, float]:
        """Strength results of one design, as of a solution."""
        members = {member: series[names[str(member)]] for member in self._fatigue[link].members}
        beam = beam_from_numbers(self.data.at(p)["bodies"][link]["beam"])
        law = LinkProperties.of(self.data, link, self.precision).law(members, p)
        member = Member(link, beam, law, t, np.linspace(0.0, 1.0, FEW), self.data.space)
        stress, material = Stress(member), beam.material
        (least, *_), *_ = worst(stress, factor_score(material, _CRITERION))
        if link not in self.life or (least >= 1.0 and material.endless):
            return 1.0 / least if least else math.inf, math.inf
        (damage, *_), *_ = worst(stress, damage_score(material, _CRITERION))
        return 1.0 / least if least else math.inf, -1.0 / damage if damage else math.inf

    @cached_property
    def _fatigue(self) -> dict[str, FibreStresses]:
        found = {}
        for name in self.links:
            members = [
                output
                for output in map(Output.of, self.series)
                if output.along and output.part == name
            ]
            found[name] = FibreStresses.of(self.data, name, members)
        return found

    @cached_property
    def _masses(self) -> ca.Function:
        p = self.data.symbols
        found = [self.data.mass(part, p) for part in (*self.links, ALL)]
        return ca.Function("masses", [p], [ca.densify(ca.vertcat(*found))])

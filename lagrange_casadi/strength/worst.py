"""Worst places along a link, and fibres, for fatigue: of one solution, and of many designs at once.

Each part between load points is looked at at places that are near each other for the polynomials
that stresses are there, and then at ever nearer ones beside local maxima. A swing is smooth along
such a part, and the worst of several has no kink upward, so what is found is nearer to the largest
than 1e-6 of it. Where a load travels along the link, stresses jump where it is at an instant: such
places are looked at from both sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..equations.fibre_stresses import FibrePart, FibreStresses, numbers_of
from ..equations.strength import followed, places_along
from .fatigue import Histories, Score
from .member import Member

_BESIDE = 0.95
"""Fraction of the largest score for which a local maximum may be the largest."""

_FINER, _TRAVELLING = 2, 8
"""Factors of the number of places of a part: where loads stand still, and where one travels."""

_LARGE = 700.0
"""Logarithm of a number that is large, and of which there are squares."""

_PASSED, _ASIDE = 200, 2e-6
"""Number of places that a load passes, of which each is looked at at least, and how far to their
sides.
"""

_NUMBERS = 1 << 19
"""Stresses that are at hand at once: so many stay in the memory next to a processor."""


@dataclass(frozen=True, eq=False)
class Maximum:
    """Local maximum of a score along a fibre, at a place ``x`` from 0 to 1 of a part of a link."""

    value: tuple[float, ...]
    part: FibrePart
    fibre: int
    x: float

    @property
    def name(self) -> str:
        """Name of the fibre."""
        return self.part.fibres[self.fibre]


@dataclass(frozen=True, eq=False)
class LinkHistories:
    """A link of n designs over time: the ``members`` of its section law (n, members, t), and its
    ``numbers`` (n, numbers).

    Loads along it stand ``still`` in all of the designs; else one may travel.
    """

    stresses: FibreStresses
    members: Array
    numbers: Array
    still: bool = True

    @classmethod
    def of(cls, member: Member) -> LinkHistories:
        """Make them for a link of a solution, all of whose instants count."""
        outputs, law = member.law.outputs(member.link), member.law
        stresses = FibreStresses.of(outputs, member.link, law.density, member.beam)
        members = np.array([[outputs[output] for output in stresses.members]])
        numbers = np.array([numbers_of(law.length, law.density, member.beam)], float)
        return cls(stresses, members, numbers, bool(stresses.stands(members)[0]))

    @cached_property
    def parts(self) -> tuple[FibrePart, ...]:
        """Parts of the link, and sides of its notches."""
        return self.stresses.parts(still=self.still)

    def places(self, part: FibrePart) -> Array:
        """Places from 0 to 1 at which a part is looked at; where a load travels, those of the first
        design.
        """
        if part.notch:
            return np.zeros(1)
        if self.still:
            return np.array(places_along(part.degree, _FINER))
        (low,), (width,) = part.ends(self.members[:1], self.numbers[:1])
        passed = np.unique(self.members[0, self.stresses.places])
        passed = passed[:: 1 + passed.size // _PASSED, None] + np.array([-_ASIDE, _ASIDE])
        inside = (passed.ravel() - low) / width
        even = np.array(places_along(part.degree, _TRAVELLING))
        return np.union1d(even, inside[(inside > 0.0) & (inside < 1.0)])

    def ratio(self, maximum: Maximum) -> float:
        """The ratio xi/l of a place in the first design."""
        low, width = maximum.part.ends(self.members[:1], self.numbers[:1])
        return float(low[0] + width[0] * maximum.x)

    def at(self, part: FibrePart, x: Array) -> Histories:
        """The stresses at places (n, places) of a part, one design after another."""
        values = part.at(self.members, self.numbers, x, still=self.still)
        return Histories.of(values.reshape(-1, *values.shape[2:]), part.sheared, part.axes)

    def history(self, maximum: Maximum) -> Array:
        """The stresses (3, t) of the first design at a place."""
        first = replace(self, members=self.members[:1], numbers=self.numbers[:1])
        return first.at(maximum.part, np.array([[maximum.x]])).at(0, maximum.fibre)

    def maxima(self, score: Score, beside: float = _BESIDE) -> Iterator[list[Maximum]]:
        """The local maxima of each design, the largest first, down to a fraction ``beside`` of
        it.
        """
        many = self._many if self.still else 1
        for start in range(0, len(self.members), many):
            few = slice(start, start + many)
            some = replace(self, members=self.members[few], numbers=self.numbers[few])
            yield from some._maxima(score, beside)

    @property
    def _many(self) -> int:
        """Number of designs that are looked at together."""
        largest = max(part.count * self.places(part).size for part in self.parts)
        return max(1, _NUMBERS // (largest * self.members.shape[2]))

    def worst(self, score: Score) -> Maximum:
        """The largest of the first design."""
        return next(self.maxima(score))[0]

    def _maxima(self, score: Score, beside: float) -> list[list[Maximum]]:
        best: list[tuple[float, ...]] = [()] * len(self.members)
        sampled = [self._sampled(part, score, best) for part in self.parts]
        found: list[list[Maximum]] = [[] for _ in best]
        least = np.array([beside * value[-1] for value in best])
        for part, values in zip(self.parts, sampled, strict=True):
            size = values[..., -1]
            edge = np.full_like(size[:, :1], -np.inf)
            higher = (size > np.concatenate([edge, size[:, :-1]], axis=1)) & (
                size >= np.concatenate([size[:, 1:], edge], axis=1)
            )
            near = higher & (size >= least[:, None, None])
            for fibres in (part.plain, part.sheared):
                designs, places, index = np.nonzero(near[:, :, fibres])
                if designs.size:
                    maxima = _Followed(
                        self.of_designs(designs),
                        part,
                        fibres[index],
                        score,
                        [best[i] for i in designs],
                    ).maxima(values[designs, places, fibres[index]], self.places(part)[places])
                    for i, maximum in zip(designs.tolist(), maxima, strict=True):
                        found[i].append(maximum)
        return [sorted(one, key=lambda maximum: maximum.value, reverse=True) for one in found]

    def _wide(self, part: FibrePart) -> npt.NDArray[np.bool_]:
        """Designs in which a part is some of the link, not nothing between two load points at one
        place.
        """
        wide = part.ends(self.members, self.numbers)[1] > 0.0
        return np.asarray(wide | (part.notch is not None))

    def of_designs(self, designs: npt.NDArray[Any]) -> LinkHistories:
        """The same of some of the designs."""
        return replace(self, members=self.members[designs], numbers=self.numbers[designs])

    def _sampled(self, part: FibrePart, score: Score, best: list[tuple[float, ...]]) -> Array:
        """Scores (n, places, fibres, numbers) of a part, lower than any where they cannot be above
        ``best``, which they raise.
        """
        (n, _, t), places = self.members.shape, self.places(part)
        there = np.flatnonzero(self._wide(part))
        some, found = self.of_designs(there), list[Array]()
        step = max(1, _NUMBERS // (n * part.count * t))
        for start in range(0, places.size, step):
            x = np.tile(places[start : start + step], (there.size, 1))
            designs = np.repeat(there, x.shape[1])
            values, counted = _scores(some.at(part, x), score, designs, best)
            values[~counted] = -np.inf
            found.append(values.reshape(*x.shape, *values.shape[1:]))
        values = np.concatenate(found, axis=1)
        every = np.full((n, *values.shape[1:]), -np.inf)
        every[there] = values
        return every


def _scores(
    histories: Histories,
    score: Score,
    designs: npt.NDArray[np.intp],
    best: list[tuple[float, ...]],
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Scores (n, fibres, numbers) of histories, each of one of some designs, and which of them are
    no mere bounds: where they can be above the ``best`` of a design, which they raise.
    """
    found = score.bound(histories)
    counted = np.zeros(found.shape[:2], bool)
    if score.exact:
        counted[:, histories.plain] = True
        most = np.full(len(best), -np.inf)
        np.maximum.at(most, designs, np.where(counted, found[..., 0], -np.inf).max(axis=1))
        best[:] = [max(one, (value,)) for one, value in zip(best, most.tolist(), strict=True)]
    rows, fibres = np.nonzero(~counted)
    order = np.lexsort(found[rows, fibres].T[::-1])[::-1]
    for row, fibre in zip(rows[order].tolist(), fibres[order].tolist(), strict=True):
        i = int(designs[row])
        if not best[i] or tuple(found[row, fibre].tolist()) > best[i]:
            value = score.of(histories.at(row, fibre))
            found[row, fibre], counted[row, fibre] = value, True
            best[i] = max(best[i], value)
    return found, counted


@dataclass(frozen=True, eq=False)
class _Followed:
    """Local maxima of a part, one of a fibre in each of ``histories``, that are followed."""

    histories: LinkHistories
    part: FibrePart
    fibres: npt.NDArray[np.intp]
    score: Score
    best: list[tuple[float, ...]]

    def maxima(self, values: Array, places: Array) -> list[Maximum]:
        """The maxima, from ``values`` (n, numbers) at ``places`` on."""
        part, rows = self.part, np.arange(len(values))
        found = [
            Maximum(tuple(value), part, fibre, x)
            for value, fibre, x in zip(
                values.tolist(), self.fibres.tolist(), places.tolist(), strict=True
            )
        ]
        wears = values[:, 0] > 0.0

        def guide(x: Array) -> Array:
            chosen = self.histories.at(part, x[:, None]).of_fibres(self.fibres)
            numbers, counted = _scores(chosen, self.score, rows, self.best)
            for k in np.flatnonzero(counted[:, 0]).tolist():
                if (value := tuple(numbers[k, 0].tolist())) > found[k].value:
                    found[k] = replace(found[k], value=value, x=float(x[k]))
            if numbers.shape[2] == 1:
                return numbers[:, 0, 0]
            with np.errstate(divide="ignore"):
                sizes = np.log(np.where(wears, numbers[:, 0, 0], numbers[:, 0, -1]))
            return np.clip(sizes, -_LARGE, _LARGE)

        if part.notch is None:
            with np.errstate(invalid="ignore"):
                followed(guide, places, 1.0 / (2 * (self.histories.places(part).size - 1)))
        return found

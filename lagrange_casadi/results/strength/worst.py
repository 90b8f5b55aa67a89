"""Worst places along a link, and fibres, for fatigue: of one solution, and of many designs at once.

Each part between load points is looked at at places that are near each other for the polynomials
that stresses are there. From local maxima the widest swing is followed, between its two instants,
to where it is worst; there all are counted. What is found is nearer to the largest than 1e-5 of it.
Where a load travels along the link, stresses jump where it is at an instant: such places are looked
at from both sides.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...engine.fibre_stresses import FibrePart, FibreStresses, numbers_of
from ...engine.strength import followed, places_along
from .fatigue import Histories, Score, cycle_squares, widest
from .member import Member

_MISSED = 0.02
"""Fraction of a score by which its local maximum is above it at the places that are looked at, at
most where these do not suffice.
"""

_LEAST, _TRAVELLING = 8, 8
"""Degree for which parts have places at least, and the factor of their number where a load travels.
"""

_HUGE = 1e300

_PASSED, _ASIDE = 200, 2e-6
"""Number of places that a load passes, of which each is looked at at least, and how far to their
sides.
"""

_MANY = 16
"""Number of designs, and of candidates, that are evaluated together."""

_NUMBERS = 1 << 19
"""Stresses that are at hand at once: so many stay in the memory next to a processor."""


@dataclass(frozen=True, eq=False)
class Maximum:
    """Local maximum of a score along a fibre, at a place ``x`` from 0 to 1 of a part of a link."""

    value: tuple[float, ...]
    x: float
    part: FibrePart
    fibre: int

    @property
    def name(self) -> str:
        """Name of the fibre."""
        return self.part.fibres[self.fibre]


class _Candidate(NamedTuple):
    """A fibre at a place of a part by their numbers, in a design, with a bound on its score."""

    bound: tuple[float, ...]
    part: int
    design: int
    place: int
    fibre: int


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
        return cls(stresses, members, numbers, bool(stresses.is_still(members)[0]))

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
            return np.array(places_along(max(_LEAST, part.degree)))
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

    def at(
        self, part: FibrePart, x: Array, fibres: npt.NDArray[np.intp] | None = None
    ) -> Histories:
        """The stresses at places (n, places) of a part, one design after another; of all fibres, or
        of one in each design, which are all sheared or all not.
        """
        chosen = None if fibres is None else part.stresses_of(fibres)
        values = part.at(self.members, self.numbers, x, still=self.still, chosen=chosen)
        values, sheared = values.reshape(-1, *values.shape[2:]), part.sheared
        if chosen is not None:
            sheared = np.arange(min(1, chosen.shape[1] - 1))
        return Histories.of(values, sheared, part.axes)

    def history(self, maximum: Maximum) -> Array:
        """The stresses (3, t) of the first design at a place."""
        first = replace(self, members=self.members[:1], numbers=self.numbers[:1])
        return first.at(maximum.part, np.array([[maximum.x]])).at(0, maximum.fibre)

    def maxima(self, score: Score, beside: float = 1.0) -> Iterator[list[Maximum]]:
        """The local maxima of each design that may be the largest, which comes first; also those
        down to a fraction ``beside`` of it.
        """
        many = _MANY if self.still else 1
        for start in range(0, len(self.members), many):
            few = slice(start, start + many)
            some = replace(self, members=self.members[few], numbers=self.numbers[few])
            yield from some._maxima(score, beside)

    def worst(self, score: Score) -> Maximum:
        """The largest of the first design."""
        return next(self.maxima(score))[0]

    def _maxima(self, score: Score, beside: float) -> list[list[Maximum]]:
        best: list[tuple[float, ...]] = [()] * len(self.members)
        sampled = [self._bounds(part, score) for part in self.parts]
        if score.exact:
            for part, values in zip(self.parts, sampled, strict=True):
                most = values[:, :, part.plain, 0].max(axis=(1, 2), initial=-np.inf).tolist()
                best[:] = [max(one, (value,)) for one, value in zip(best, most, strict=True)]
        self._count(sampled, score, best)
        found: list[list[Maximum]] = [[] for _ in best]
        least = np.array([beside * value[-1] for value in best])
        # Those with normal stress alone cost less to follow, and leave out others.
        for sheared, (part, values) in itertools.product(
            (False, True), zip(self.parts, sampled, strict=True)
        ):
            fibres = part.sheared if sheared else part.plain
            size = values[:, :, fibres, -1]
            higher = _local_maxima(size) & (_promised(size) >= least[:, None, None])
            designs, places, index = np.nonzero(higher)
            if designs.size:
                some = self.of_designs(designs)
                maxima = _Followed(some, part, fibres[index], score).maxima(
                    values[designs, places, fibres[index]], self.places(part)[places]
                )
                for i, maximum in zip(designs.tolist(), maxima, strict=True):
                    found[i].append(maximum)
                    best[i] = max(best[i], maximum.value)
        return [sorted(one, key=lambda maximum: maximum.value, reverse=True) for one in found]

    def _wide(self, part: FibrePart) -> npt.NDArray[np.bool_]:
        """Designs in which a part is some of the link, not nothing between two load points at one
        place.
        """
        wide = part.ends(self.members, self.numbers)[1] > 0.0
        return np.asarray(wide | (part.notch is not None))

    def of_designs(self, designs: npt.NDArray[Any]) -> LinkHistories:
        """Return the histories of some of the designs."""
        return replace(self, members=self.members[designs], numbers=self.numbers[designs])

    def _bounds(self, part: FibrePart, score: Score) -> Array:
        """Bounds on scores (n, places, fibres, numbers) of a part."""
        (n, _, t), places = self.members.shape, self.places(part)
        there = np.flatnonzero(self._wide(part))
        some, found = self.of_designs(there), list[Array]()
        step = max(1, _NUMBERS // (n * part.count * t))
        for start in range(0, places.size, step):
            x = np.tile(places[start : start + step], (there.size, 1))
            values = score.bound(some.at(part, x))
            found.append(values.reshape(*x.shape, *values.shape[1:]))
        values = np.concatenate(found, axis=1)
        every = np.full((n, *values.shape[1:]), -np.inf)
        every[there] = values
        return every

    def _count(self, sampled: list[Array], score: Score, best: list[tuple[float, ...]]) -> None:
        """Put scores in the place of bounds that are above the ``best`` of a design, which they
        raise, from the largest on; and in that of others less than any.
        """
        least = np.array([value[0] if value else -np.inf for value in best])[:, None, None]
        found: list[_Candidate] = []
        for number, (part, values) in enumerate(zip(self.parts, sampled, strict=True)):
            fibres = part.sheared if score.exact else np.arange(len(part.fibres))
            bounds = values[:, :, fibres]
            above = bounds[..., 0] >= least
            for i, j, k in np.argwhere(above).tolist():
                found.append(
                    _Candidate(tuple(bounds[i, j, k].tolist()), number, i, j, int(fibres[k]))
                )
            values[:, :, fibres] = np.where(above[..., None], bounds, -np.inf)
        found.sort(reverse=True)
        for start in range(0, len(found), _MANY):
            some = found[start : start + _MANY]
            histories = self._histories([one for one in some if one.bound > best[one.design]])
            for one in some:
                value = (-math.inf,) * len(one.bound)
                if one.bound > best[one.design]:
                    value = score.of(histories[one])
                    best[one.design] = max(best[one.design], value)
                sampled[one.part][one.design, one.place, one.fibre] = value

    def _histories(self, candidates: list[_Candidate]) -> dict[_Candidate, Array]:
        """The stresses (3, t) of candidates: those of one part, sheared or not, at a time."""
        found: dict[_Candidate, Array] = {}
        groups: dict[tuple[int, bool], list[_Candidate]] = {}
        for one in candidates:
            sheared = one.fibre in self.parts[one.part].sheared
            groups.setdefault((one.part, sheared), []).append(one)
        for (number, _), group in groups.items():
            part = self.parts[number]
            designs, places, fibres = np.array([one[2:] for one in group]).T
            there = self.of_designs(designs).at(part, self.places(part)[places, None], fibres)
            found.update((one, there.at(k, 0)) for k, one in enumerate(group))
        return found


def _beside(sizes: Array) -> tuple[Array, Array]:
    """Neighbours of sizes (n, places, fibres), lower than any beyond the ends."""
    edge = np.full_like(sizes[:, :1], -np.inf)
    return (
        np.concatenate([edge, sizes[:, :-1]], axis=1),
        np.concatenate([sizes[:, 1:], edge], axis=1),
    )


def _local_maxima(sizes: Array) -> npt.NDArray[np.bool_]:
    """Find sizes (n, places, fibres) that are not below their neighbours; of equals the first."""
    before, after = _beside(sizes)
    return np.asarray((sizes > before) & (sizes >= after))


def _promised(sizes: Array) -> Array:
    """Return bounds on local maxima, by twice the height of a parabola through neighbours above
    them, or by :data:`_MISSED`.
    """
    before, after = _beside(sizes)
    with np.errstate(invalid="ignore", divide="ignore"):
        gain = (after - before) ** 2 / (8.0 * (2.0 * sizes - before - after))
    sizes = np.maximum(sizes, -_HUGE)
    most = _MISSED * np.abs(sizes)
    return sizes + np.where(np.isfinite(gain), np.minimum(2.0 * gain, most), most)


@dataclass(frozen=True, eq=False)
class _Followed:
    """Local maxima of a part, one of a fibre in each of ``histories``, that are followed.

    The widest swing goes between two instants. These are kept while the place moves; all are
    counted where the swing is largest.
    """

    histories: LinkHistories
    part: FibrePart
    fibres: npt.NDArray[np.intp]
    score: Score

    def maxima(self, values: Array, places: Array) -> list[Maximum]:
        """The maxima, from ``values`` (n, numbers) at ``places`` on."""
        found, part = places.copy(), self.part
        if part.notch is None:
            cycles, most = self._cycles(places), np.full(len(places), -np.inf)

            def guide(x: Array) -> Array:
                sizes = self._guide(cycles, x)
                better = sizes > most
                found[better], most[better] = x[better], sizes[better]
                return sizes

            with np.errstate(invalid="ignore"):
                followed(guide, places, 1.0 / (2 * (self.histories.places(part).size - 1)))
        there = self._values(self.histories, found)
        return [
            Maximum(*max((tuple(old), x), (tuple(new), y)), part, fibre)
            for old, x, new, y, fibre in zip(
                values.tolist(),
                places.tolist(),
                there.tolist(),
                found.tolist(),
                self.fibres.tolist(),
                strict=True,
            )
        ]

    def _cycles(self, places: Array) -> LinkHistories:
        """The histories at the two instants of the widest swing at each place alone."""
        members, chosen = self.histories.members, self._at(self.histories, places)
        ends = [list(widest(chosen.at(k, 0))) for k in range(len(members))]
        pairs = [one[:, pair] for one, pair in zip(members, ends, strict=True)]
        return replace(self.histories, members=np.array(pairs))

    def _guide(self, cycles: LinkHistories, x: Array) -> Array:
        """Return the scores of cycles at places."""
        chosen = self._at(cycles, x)
        values = np.zeros((3, len(x), 2))
        values[0] = chosen.normal[:, 0]
        if chosen.sheared.size:
            values[[1 + axis for axis in chosen.axes]] = np.moveaxis(chosen.shears[:, :, 0], 1, 0)
        amplitude, mean = cycle_squares(values[..., 0], values[..., 1])
        return np.asarray(self.score.swing(np.sqrt(amplitude), np.sqrt(mean)))

    def _at(self, histories: LinkHistories, x: Array) -> Histories:
        return histories.at(self.part, x[:, None], self.fibres)

    def _values(self, histories: LinkHistories, x: Array) -> Array:
        """Scores (n, numbers) at places."""
        chosen = self._at(histories, x)
        if self.score.exact and not chosen.sheared.size:
            return np.asarray(self.score.bound(chosen)[:, 0])
        return np.array([self.score.of(chosen.at(k, 0)) for k in range(len(x))])

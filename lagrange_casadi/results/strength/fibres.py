"""Search for the worst place of a link by fatigue, along the fibres of its cross-sections, of one
solution or of many designs at once.

Between two marks stresses are polynomials of the place (:meth:`.Cell.stresses`). The history of a
place is a mean of the histories of their ordinates, with weights from 0 to 1, and bounds on scores
are convex in stresses. So no place is above the largest bound of an ordinate. Strips with lower
bounds are left out, others are halved, until no place may be above what was found by more than a
part in 1e9. Where a bound is no score, swings are counted at few places, and where the widest swing
of the worst of these is largest.

A load that travels along the link divides it at all places where it is at an instant.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.bernstein import EIGHTHS, eighths, halves, value
from ...engine.section_function import SIDES, Side
from ...engine.section_stress import concentration, notch_factor
from ...model.beams.beam import Notch
from .fatigue import Score, widest
from .member import CLOSE, Cell, Member

_HALVED = 24
"""Number of times that a strip is halved at most."""

_PLACES = (1.0 - np.cos(np.pi * np.arange(9) / 8)) / 2
"""Places of a strip at which swings are counted."""

_NARROW = 1.0 / 64.0
"""Length of a strip, as a ratio xi/l, of which nothing but the ends needs to be looked at."""

_MISSED = 0.04
"""Fraction by which the maximum of a score may be above the largest at these places."""

_NUMBERS = 1 << 22
"""Ordinates that are at hand at once."""


@dataclass(frozen=True, eq=False)
class Strips:
    """Fibres between two marks of designs, by numbers: the ``fibre``, the ``design``, and the
    ratios ``low`` and ``high``, each (strips,).

    ``ordinates`` (degree + 1, k, strips, t) are those of normal stress alone, or of shear stresses
    along y and z too.
    """

    cell: Cell
    side: Side
    notch: Notch | None
    ordinates: Array
    fibre: npt.NDArray[np.intp]
    design: npt.NDArray[np.intp]
    low: Array
    high: Array

    @classmethod
    def of(
        cls, cell: Cell, low: Array, high: Array, side: Side = "tip", notch: Notch | None = None
    ) -> Iterator[Strips]:
        """Make them of parts of a cell from ``low`` to ``high``, each (parts, 1), or (parts, n, 1)
        of n designs: of fibres with normal stress alone, then of others.
        """
        forces = [
            concentration(notch, name) * force
            for name, force in zip(cell.member.forces, cell.forces(low, high, side), strict=True)
        ]
        for sheared in (False, True):
            fibres = cell.alone(sheared=sheared)
            ordinates = cell.stresses(forces, low, high, fibres)[:, : cell.components(fibres)]
            # Axes of fibres, of parts, and of designs.
            shape = ordinates.shape[2:-1]
            begins, ends = (np.broadcast_to(end[..., 0], shape) for end in (low, high))
            some = np.ones(shape, bool) if notch else ends > begins
            index, _, *designs = np.nonzero(some)
            design = designs[0] if designs else np.zeros_like(index)
            fibre = np.array(fibres, np.intp)[index]
            stresses = ordinates[:, :, some]
            yield cls(cell, side, notch, stresses, fibre, design, begins[some], ends[some])

    @property
    def places(self) -> Array:
        """Places (places, 1) at which swings are counted: the ends of narrow strips, one of a
        notch.
        """
        narrow = np.max(self.high - self.low, initial=0.0) <= _NARROW
        return _PLACES[: 1 if self.notch else None : len(_PLACES) - 1 if narrow else 1, None]

    def at(self, strips: npt.NDArray[np.intp], x: Array) -> Array:
        """Stresses (3, places, m, t) of m strips by their numbers at places ``x`` (places, m) from
        0, the end towards the tip, to 1.
        """
        values = value(self.ordinates[:, :, strips], x[:, None, :, None])
        found = np.zeros((3, len(x), *values.shape[2:]))
        found[: values.shape[1]] = np.moveaxis(values, 1, 0)
        return found


@dataclass(frozen=True, eq=False)
class Maximum:
    """The largest ``score`` along a fibre between two marks: the ``strip`` by its number, and a
    place ``x`` from 0, the end towards the tip, to 1.
    """

    score: float
    strips: Strips
    strip: int
    x: float

    @property
    def ends(self) -> tuple[float, float]:
        """The ratios of the marks."""
        return float(self.strips.low[self.strip]), float(self.strips.high[self.strip])

    @property
    def xi(self) -> float:
        """The ratio of the place."""
        low, high = self.ends
        return high - (high - low) * self.x

    @property
    def fibre(self) -> str:
        """The name of the fibre."""
        return str(self.strips.cell.names[self.strips.fibre[self.strip]])

    @property
    def history(self) -> Array:
        """The stresses (3, t)."""
        return self.strips.at(np.array([self.strip]), np.array([[self.x]]))[:, 0, 0]


def maxima(member: Member, score: Score, beside: float = 1.0) -> list[list[Maximum]]:
    """The maxima of each design that are at least ``beside`` times the first, its largest."""
    best = np.full(member.shape[:-1] or 1, -np.inf)
    found: list[list[Maximum]] = [[] for _ in best]
    for strips in _strips(member):
        scores, places = (
            _largest(strips.ordinates, score.bound, strips.design, best, beside)
            if score.exact and len(strips.ordinates[0]) == 1
            else _counted(strips, score, best, beside)
        )
        higher = np.isfinite(scores) & (scores >= beside * best[strips.design])
        for k in np.flatnonzero(higher).tolist():
            maximum = Maximum(float(scores[k]), strips, k, float(places[k]))
            found[int(strips.design[k])].append(maximum)
    return [
        sorted((one for one in some if one.score >= beside * most), key=lambda one: -one.score)
        for some, most in zip(found, best.tolist(), strict=True)
    ]


def worst(member: Member, score: Score) -> Maximum:
    """The largest maximum of a link of one solution."""
    return maxima(member, score)[0][0]


def sampled(member: Member) -> Iterator[tuple[Notch | None, Array]]:
    """Stresses (n, 3, t) at places of all fibres of a link of one solution, beside a notch or none,
    part after part.
    """
    for strips in _strips(member):
        for k in range(strips.design.size):
            yield strips.notch, np.moveaxis(strips.at(np.array([k]), strips.places)[:, :, 0], 0, 1)


def _strips(member: Member) -> Iterator[Strips]:
    """The strips of all fibres, those beside notches last. In each part those that have normal
    stress alone come first: they cost less, and leave out others.
    """
    member = replace(member, accuracy=CLOSE)
    ends = member.pieces[0].ends
    ends = ends[..., :1] if member.still.all() else np.unique(ends)[:, None]
    for cell in member.cells:
        low, high = cell.parts(ends)
        size = 3 * len(cell.names) * (cell.degree + member.degree + 1) * low[0].size * member.t.size
        few = max(1, _NUMBERS // size)
        for start in range(0, len(low), few):
            yield from Strips.of(cell, low[start : start + few], high[start : start + few])
    for notch, side in itertools.product(member.beam.notches, SIDES):
        at = np.full_like(ends[:1], notch.at)
        cell = member.cell_at(notch.at, side)
        yield from Strips.of(cell, at, at, side, notch_factor(notch))


def _counted(strips: Strips, score: Score, best: Array, beside: float) -> tuple[Array, Array]:
    """The scores of strips (strips,) by counting swings, -inf of those that are not looked at, and
    their places from 0 to 1; what is below ``beside`` times the ``best`` of a design, which they
    raise, may be less than its maximum.
    """
    scores, places = np.full(strips.design.size, -np.inf), np.zeros(strips.design.size)
    bounds = score.bound(np.moveaxis(strips.ordinates, 1, 0)).max(axis=0)
    x, order = strips.places, np.argsort(-bounds, kind="stable")
    few = max(1, _NUMBERS // (3 * len(x) * strips.ordinates.shape[-1]))
    for start in range(0, order.size, few):
        some = order[start : start + few]
        some = some[bounds[some] > _more(beside * best[strips.design[some]], CLOSE)]
        histories = strips.at(some, x)
        shares = score.bound(histories[: strips.ordinates.shape[1]])
        for k in np.argsort(-shares.max(axis=0), kind="stable").tolist():
            strip, design = some[k], strips.design[some[k]]
            floor = beside * best[design]
            if bounds[strip] > _more(floor, CLOSE):
                most = _most(score, histories[:, :, k], shares[:, k], float(_more(floor, -_MISSED)))
                scores[strip], places[strip] = most[0], x[most[1], 0]
                best[design] = max(best[design], scores[strip])
    if not strips.notch:
        _near(strips, score, best, beside, scores, places)
    return scores, places


def _more(floor: Array, share: float) -> Array:
    """Scores above others by a share of their size; -inf of none."""
    return np.asarray(floor * (1.0 + share * np.sign(floor)))


def _near(
    strips: Strips, score: Score, best: Array, beside: float, scores: Array, places: Array
) -> None:
    """Raise scores and places of strips to those where their widest swing is largest."""
    near = np.flatnonzero(scores > _more(beside * best[strips.design], -_MISSED))
    if not near.size:
        return
    histories = strips.at(near, places[None, near])[:, 0]
    instants = np.array([widest(histories[:, k]) for k in range(near.size)])
    ends = np.take_along_axis(strips.ordinates[:, :, near], instants[None, None], -1)
    _, x = _largest(ends, score.of_swing, np.arange(near.size), np.full(near.size, -np.inf))
    histories = strips.at(near, x[None])[:, 0]
    for k, strip in enumerate(near.tolist()):
        if x[k] != places[strip] and (found := score.of(histories[:, k])) > scores[strip]:
            scores[strip], places[strip] = found, x[k]
            best[strips.design[strip]] = max(best[strips.design[strip]], found)


def _most(score: Score, histories: Array, bounds: Array, floor: float) -> tuple[float, int]:
    """The largest score of histories (3, places, t) whose ``bounds`` are above a floor, else -inf,
    and the number of its place.
    """
    most, at = -np.inf, 0
    for k in np.argsort(-bounds, kind="stable").tolist():
        if bounds[k] <= max(most, floor):
            break
        most, at = max((most, at), (score.of(histories[:, k]), k))
    return most, at


def _largest(
    c: Array,
    size: Callable[[Array], Array],
    design: npt.NDArray[np.intp],
    best: Array,
    beside: float = 1.0,
) -> tuple[Array, Array]:
    """The largest of a convex size of stresses along strips (strips,), and its places from 0 to 1.

    ``size`` is a function of the extremes over t of stresses (k, ..., t). It raises the ``best`` of
    a design, and is followed where it may be above ``beside`` times that.
    """
    found, places = np.full(design.size, -np.inf), np.zeros(design.size)
    strip, start, width = np.repeat(np.arange(design.size), 8), np.tile(EIGHTHS, design.size), 0.125
    c = eighths(c)
    for _ in range(_HALVED):
        sizes = size(np.moveaxis(c, 1, 0))
        for values, place in ((sizes[0], start), (sizes[-1], start + width)):
            np.maximum.at(found, strip, values)
            higher = values == found[strip]
            places[strip[higher]] = place[higher]
        np.maximum.at(best, design, found)
        floor = np.fmax(found, beside * best[design])[strip]
        some = np.flatnonzero(sizes.max(axis=0) > floor * (1.0 + CLOSE))
        if not some.size:
            break
        width /= 2.0
        c = np.concatenate(halves(_outermost(c[:, :, some])), axis=2)
        strip = np.tile(strip[some], 2)
        start = np.concatenate([start[some], start[some] + width])
    return found, places


def _outermost(c: Array) -> Array:
    """Ordinates (n + 1, k, strips, few) at the instants, of all (n + 1, k, strips, t), at which a
    stress may be the smallest or the largest somewhere in a strip.
    """
    low, high = c.min(axis=0), c.max(axis=0)
    some = (high >= low.max(axis=-1, keepdims=True)) | (low <= high.min(axis=-1, keepdims=True))
    some = some.any(axis=0)
    order = np.argsort(~some, axis=-1, kind="stable")[:, : some.sum(axis=-1).max()]
    return np.take_along_axis(c, order[None, None], -1)

"""Section forces of a link as polynomials between places along it, with steps at load points.

In each cell, between breaks of the density and ends of loads along the link, what acts on a link
per unit of the ratio u = xi/l is a polynomial: p and l u p of its mass, p being the mass per unit
of u, and l s^j of a load along it, s = (end - u)/width. A force is the integral of these from the
section to the tip, and a moment is l times the integral of the force: one rule serves densities,
loads along the link and couples of slices. What acts at a load point is a step: sections on its
base side carry constant + slope (station - u).

Polynomials are in Bernstein's form (:mod:`.base.bernstein`), of x that is 0 at the tip's end of a
cell and 1 at its base's end: nothing cancels near the tip. Instants are the last axis.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.bernstein import of_powers, product, raised, value, within, zeros
from ..engine.instants.grids import Functions, Load
from ..engine.section_function import Side, edge
from ..model.link_density import NumericDensity
from .vector_sizes import size_of

_FEW = 1 << 12
"""Ratios up to which functions along a link are kept."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Functions of a :class:`Basis` at ratios ``u``, of forces and of moments: a row each, (terms,
    u...), or of n designs (terms, n, u).
    """

    u: Array
    functions: tuple[Functions, Functions]


@dataclass(frozen=True, eq=False)
class Basis:
    """Functions along links of n designs of which section forces are combined: ordinates (degree +
    1, terms, n, cells) in cells between ``breaks`` (n, cells + 1).

    The first of ``ordinates`` are of forces: by a unit at the tip, by p and l u p, and by powers of
    each load along the link. The second are of moments: by a unit at the tip, and by each of the
    first. ``slopes`` are the derivatives of both by x, which are known and no differences. Numbers
    of one link, not of designs, are ``single``.
    """

    breaks: Array
    ordinates: tuple[Array, Array]
    slopes: tuple[Array, Array]
    single: bool

    @classmethod
    def of(
        cls,
        length: Array | float,
        density: NumericDensity,
        spans: Sequence[tuple[Array | float, Array | float]] = (),
        powers: Sequence[int] = (),
    ) -> Basis:
        """Make it for a link whose loads along it have ``spans``, width and end, and so many
        ``powers``. Of n designs, lengths, coefficients and spans are (n, 1).
        """
        l = np.reshape(length, (-1, 1))
        ends = [(np.reshape(end, (-1, 1)), np.reshape(width, (-1, 1))) for width, end in spans]
        marks = [np.clip(u, 0.0, 1.0) for end, width in ends for u in (end - width, end)]
        breaks = np.hstack([np.zeros((len(l), 1)) + mark for mark in (*density.breaks, *marks)])
        breaks = np.sort(breaks, axis=1)
        breaks = breaks[:, np.append(True, (np.diff(breaks, axis=1) > 0.0).any(axis=0))]
        base, tip = breaks[:, :-1], breaks[:, 1:]
        line, middle, wide = np.stack([tip, base]), (tip + base) / 2.0, tip - base
        degree = max(*map(len, density.cells), *(many - 1 for many in powers), 1)
        mass = np.zeros((degree, *tip.shape))
        for low, high, cell in zip(density.breaks, density.breaks[1:], density.cells, strict=False):
            terms = [np.reshape(coefficient, (-1, 1)) for coefficient in cell]
            inside = (low < middle) & (middle < high)
            mass += inside * raised(of_powers(terms, line), degree - 1)
        acts = [raised(mass, degree), product(mass, l * line)]
        widths = [wide, wide]
        for (end, width), many in zip(ends, powers, strict=True):
            inside = (end - width < middle) & (middle < end)
            # A load's own begin is exactly where s is 1: a load may be shorter than the rounding of
            # its place.
            begin = np.where(base == end - width, 1.0, (end - base) / width)
            s = np.stack([(end - tip) / width, begin])
            for power in range(many):
                acts.append(inside * raised(of_powers([0.0] * power + [l], s), degree))
                widths.append(width * (s[1] - s[0]))
        rates = np.stack(acts, axis=1) * np.stack(widths)
        force = _integrals(rates)
        bending = l * wide * force
        moment = _integrals(bending)
        return cls(breaks, (force, moment), (rates, bending), np.ndim(length) == 0)

    def along(self, ordinates: Array) -> Array:
        """Ordinates (degree + 1, n, cells) with cells before designs, and an axis for instants;
        of one link without designs.
        """
        found = np.swapaxes(ordinates, 1, 2)
        return (found[..., 0] if self.single else found)[..., None]

    def at(self, u: Array) -> Rows:
        """The functions at ratios of any shape, or of several designs (k,)."""
        if self.single and u.ndim == 1 and u.size <= _FEW:
            return _kept(self, u.tobytes())
        return self.rows(u)

    def rows(self, u: Array) -> Rows:
        """The functions at ratios, made anew."""
        design, ratios = np.arange(len(self.breaks))[:, None], u.reshape(-1)
        cell = (self.breaks[:, None, 1:-1] <= ratios[:, None]).sum(axis=-1)
        base, tip = self.breaks[design, cell], self.breaks[design, cell + 1]
        x = (tip - ratios) / np.where(tip > base, tip - base, 1.0)
        found = [value(c[:, :, design, cell], x[None, None])[0] for c in self.ordinates]
        if self.single:
            found = [rows.reshape(len(rows), *u.shape) for rows in found]
        force, moment = map(Functions, found)
        return Rows(u, (force, moment))


@functools.lru_cache(maxsize=64)
def _kept(basis: Basis, u: bytes) -> Rows:
    """Functions along a link at few ratios."""
    found = basis.rows(np.frombuffer(u))
    for functions in found.functions:
        functions.rows.setflags(write=False)  # shared by all who ask for them
    return found


basis_of = functools.lru_cache(maxsize=64)(Basis.of)
"""The basis of a link in numbers, kept."""


def _integrals(rates: Array) -> Array:
    """A unit at the tip, and integrals to there of derivatives by x (n, terms, designs, cells)."""
    many = len(rates)
    found = np.zeros((many + 1, 1 + rates.shape[1], *rates.shape[2:]))
    found[:, 0] = 1.0
    np.cumsum(rates / many, axis=0, out=found[1:, 1:])
    beyond = found[-1, 1:, :, :0:-1].cumsum(axis=-1)[..., ::-1]
    found[:, 1:, :, :-1] += beyond
    return found


@dataclass(frozen=True, eq=False)
class Component:
    """A section force that is no resultant: its part by what acts at the ``tip`` (t,), ordinates of
    all others (degree + 1, cells, t) and of their derivative by x, and steps at load points.
    """

    tip: Array
    ordinates: Array
    slope: Array
    steps: Sequence[Load]


@dataclass(frozen=True, eq=False)
class Pieces:
    """A section force of a link at t instants, or the size of several: their ``components``, in
    cells between ``breaks`` (cells + 1, 1).

    Of n designs all arrays have an axis for these before that of the instants. ``slack`` is that of
    :func:`.edge`.
    """

    breaks: Array
    components: Sequence[Component]
    slack: float

    def at(self, u: Array, side: Side = "tip") -> Array:
        """Values at ratios (t, ...), on a side of load points."""
        ratios, found = u.reshape(len(u), -1).T, list[Array]()
        cell, tip, wide = self._cells(ratios, side)
        x, beyond = (tip - ratios)[None] / wide, edge(ratios, self.slack, side)
        for one in self.components:
            values = value(self._chosen(one.ordinates, cell), x)[0] + one.tip
            for station, constant, by in one.steps:
                values += np.where(beyond < station, constant + by * (station - ratios), 0.0)
            found.append(values.T.reshape(u.shape))
        return size_of(found)

    def _cells(self, ratios: Array, side: Side) -> tuple[npt.NDArray[np.intp], Array, Array]:
        """The cells in which ratios are; their ends towards the tip, and widths."""
        cell = np.zeros(ratios.shape, np.intp)
        for place in self.breaks[1:-1]:
            cell += place <= ratios if side == "tip" else place < ratios
        breaks = self.breaks.reshape(len(self.breaks), -1)
        design = np.arange(breaks.shape[1])[:, None]
        base, tip = breaks[cell, design], breaks[cell + 1, design]
        return cell, tip, tip - base

    def _chosen(self, ordinates: Array, cell: npt.NDArray[np.intp]) -> Array:
        """Ordinates (degree + 1, k, t) in a cell (k, t) at every instant."""
        if len(self.breaks) == 2:
            return ordinates
        rest = np.ogrid[tuple(slice(size) for size in ordinates.shape[2:])]
        places: tuple[Any, ...] = (slice(None), cell, *rest)
        return np.asarray(ordinates[places])

    @property
    def ends(self) -> Array:
        """Ends (parts + 1, t) of the parts between breaks and load points; (parts + 1, 1) if there
        is no load point.
        """
        steps = self.components[0].steps
        if not steps:
            return self.breaks
        marks = np.clip([place for place, *_ in steps], 0.0, 1.0)
        return np.sort(np.concatenate([self.breaks + 0.0 * marks[0], marks]), axis=0)

    def parts(
        self, low: Array, high: Array, side: Side = "tip", *, slope: bool = False
    ) -> list[Array]:
        """Ordinates (degree + 1, parts, t) of each component, or of its derivative by x, in parts
        from ``low`` to ``high`` (parts, t), none of which has a break or a load point inside.

        A part without width is a place, of which a ``side`` is meant.
        """
        cell, tip, wide = self._cells((low + high) / 2.0, side)
        start, stop = (np.clip((tip - end) / wide, 0.0, 1.0) for end in (high, low))
        whole, beyond = not start.any() and np.all(stop == 1.0), edge(low, self.slack, side)
        found = []
        for one in self.components:
            c = self._chosen(one.slope if slope else one.ordinates, cell)
            c = c if whole else within(c, start, stop)
            c = c * (stop - start) if slope else c + one.tip
            line = np.linspace(0.0, 1.0, len(c)).reshape(-1, *(1,) * low.ndim)
            for station, constant, by in one.steps:
                rise = by * (high - low)
                step = rise if slope else constant + by * (station - high) + line * rise
                c += np.where(beyond < station, step, 0.0)
            found.append(c)
        return found

    def reached(self, sizes: Sequence[Callable[[Array], Array]]) -> tuple[Array, Array]:
        """Ratios at which each of some ``sizes`` of the force is largest, and its values there:
        (sizes, t).
        """
        u, values = (rows.reshape(-1, rows.shape[-1]) for rows in self._candidates()[:2])
        best = [_highest(size(values), u, values) for size in sizes]
        return np.array([place for place, _ in best]), np.array([found for _, found in best])

    def curves(self) -> tuple[Array, Array]:
        """Ratios among which the force is largest in size at every instant, and its values there,
        (k, t): each a smooth curve over time, as long as no load point passes another one, and no
        turn of a resultant comes or goes.

        They are the ends of each part, and zeros of the slope: of a parabola a maximum and then a
        minimum, else the two largest turns, in order. If there is one turn it is both. Without a
        turn both are the larger end of a resultant; of any other force a place that is nearer to
        that end at which the slope is smaller, for a turn comes in at an end where the slope is
        zero.
        """
        u, values, turns, slope, parts = self._candidates()
        if len(turns) > 2:
            single, (low, high) = len(parts) == 1, u[:2]
            chosen = turns != 0.0 if single else turns > 0.0
            heights = np.where(chosen, np.abs(values[2:]), -np.inf)
            order = np.argsort(-heights, axis=0, kind="stable")[:2]
            order[1] = np.where(chosen.sum(axis=0) > 1, order[1], order[0])
            both = np.abs(slope[0]) + np.abs(slope[-1])
            rest = np.where(values[0] > values[1], 1.0, 0.0)
            if single:
                rest = np.divide(np.abs(slope[0]), both, np.full(both.shape, 0.5), where=both > 0.0)
            x = (high - np.take_along_axis(u[2:], order, 0)) / np.where(high > low, high - low, 1.0)
            x = np.sort(np.where(chosen.any(axis=0), x, rest), axis=0)
            u = np.concatenate([u[:2], high - (high - low) * x])
            values = np.concatenate([values[:2], size_of(value(c, x) for c in parts)])
        return u.reshape(-1, u.shape[-1]), values.reshape(-1, u.shape[-1])

    def _candidates(self) -> tuple[Array, Array, Array, Array, list[Array]]:
        """Ratios and values (2 + n, parts, t) among which the force is smallest and largest in each
        part: at its end towards the base, at that towards the tip, and at n places, all zeros of
        the slope among them; :attr:`.Zeros.turns` of these (n, parts, t), where a maximum is 1; the
        ordinates of the slope, of a resultant of half that of its square; and those of the
        components.
        """
        low, high = self.ends[:-1], self.ends[1:]
        parts, slopes = self.parts(low, high), self.parts(low, high, slope=True)
        slope = slopes[0] if len(parts) == 1 else np.asarray(sum(map(product, parts, slopes)))
        found = zeros(slope)
        u = np.empty((2 + len(found.places), *slope.shape[1:]))
        u[0], u[1] = low, high
        u[2:] = high - (high - low) * found.places
        values = (np.concatenate([c[-1:], c[:1], value(c, found.places)]) for c in parts)
        return u, size_of(values), found.turns, slope, parts


def _highest(sizes: Array, u: Array, values: Array) -> tuple[Array, Array]:
    """The ratio and the value (t,) of the largest size among all (k, t), the first of equals."""
    most, place, found = sizes[0], u[0], values[0]
    for size, other, one in zip(sizes[1:], u[1:], values[1:], strict=True):
        higher = size > most
        most, place = np.where(higher, size, most), np.where(higher, other, place)
        found = np.where(higher, one, found)
    return place, found

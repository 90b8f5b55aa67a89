"""Stresses in a link of a solution, over time, along it, and at the fibres of its cross-section.

They are linear in section forces (:mod:`.engine.stress`), so between two marks they are
polynomials of xi, or products of these with smooth functions of the cross-section, which are
replaced by polynomials that agree to 1e-13.

The largest of sqrt(s^2 + k t^2) along a link is sought among all summits of its square. How far a
square may rise between the places at which it is looked at is bounded by Ehlich and Zeller,
*Schwankung von Polynomen zwischen Gitterpunkten*, Math. Zeitschrift 86 (1964): where nothing can be
above what was found, nothing is sought.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from ...base.arguments import Share, public
from ...base.arrays import Array, Operand
from ...base.brief import Brief
from ...base.interpolation import interpolation
from ...engine.stress import KINDS, concentration, squared
from ...errors import DeclarationError, UnknownNameError, shown
from ...model.beams.beam import Notch
from ..section_law import Side
from .member import Cell, Member

_SAMPLES, _GLANCES, _BLOCK = 8, 4, 1 << 21
_BESIDE, _STEPS = 0.9, 40
"""Fraction of the largest value for which a local maximum may be the largest, and the number of
steps to it.

And steps of the golden section: where a summit is to 1e-9, it is to 1e-18.
"""
_SIDES: tuple[Side, Side] = ("base", "tip")


@dataclass(frozen=True)
class StressPeak:
    """The stress that is largest in size, with its sign [Pa], and where: time [s], ratio xi/l, and
    the fibre's name.

    ``notch`` says whether it is the stress at a notch, its factors included. Where a peak between
    the instants cannot be determined, ``value`` is NaN, and ``least`` the largest size that was
    found.
    """

    kind: str
    value: float
    t: float
    xi: float
    fibre: str
    notch: bool = False
    least: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Largest(Brief):
    """The stress largest in size along a link and over its fibres at every instant, each (t,):
    value, ratio xi/l, fibre's name.
    """

    value: Array
    xi: Array
    fibre: tuple[str, ...]


@public
@dataclass(frozen=True, eq=False)
class Stress:
    """The stresses in a link, nominal but where notches are said.

    Kinds are ``normal``, positive in tension; ``shear``, its size; ``von_mises`` and ``tresca``,
    never negative. Methods raise :class:`.UnknownNameError` for any other.
    """

    member: Member

    def __repr__(self) -> str:
        return (
            f"<Stress in '{self.member.link}': {self.member.t.size} instants,"
            f" {len(self.member.cells[0].names)} fibres>"
        )

    def grid(self, kind: str, xi: Array | None = None) -> Array:
        """Return a stress over ratios: the largest in size of all fibres, on the tip's side.

        Parameters
        ----------
        kind : {"normal", "shear", "von_mises", "tresca"}
            The stress.
        xi : array (n,), optional
            Ratios xi/l from 0 to 1; by default those of the solution.

        Returns
        -------
        array (t, n)
            The stress [Pa].

        Raises
        ------
        DeclarationError
            If a ratio is out of 0 to 1.
        """
        weights = _weights(kind)
        u = self.member.xi if xi is None else np.atleast_1d(xi)
        if u.ndim != 1 or not ((u >= 0.0) & (u <= 1.0)).all():
            raise DeclarationError(
                f"stress: expected a row of ratios xi/l from 0 to 1, got {shown(xi)}"
            )
        found = np.empty((self.member.t.size, u.size))
        for cell in self.member.cells:
            inside = np.flatnonzero((u >= cell.low) & ((u < cell.high) | (cell.high == 1.0)))
            factors = cell.factors(u[inside])
            for start in range(
                0,
                inside.size,
                width := max(1, _BLOCK // (3 * len(cell.names) * self.member.t.size)),
            ):
                chosen = inside[start : start + width]
                forces = self.member.at(
                    np.broadcast_to(u[chosen], (self.member.t.size, chosen.size))
                )
                values = np.einsum("cfkn,ktn->cftn", factors[..., start : start + width], forces)
                squares = squared(values, weights)
                best = np.argmax(squares, axis=0)[None]
                square, normal = (np.take_along_axis(a, best, 0)[0] for a in (squares, values[0]))
                found[:, chosen] = _signed(kind, square, normal)
        return found

    def at(self, xi: Share, side: Side = "tip", notch: Notch | None = None) -> Array:
        """Return the stresses of all fibres at a ratio.

        Parameters
        ----------
        xi : float
            Ratio xi/l, from 0 to 1.
        side : {"base", "tip"}
            Side of a step of the cross-section or of a station, if the ratio is one.
        notch : Notch, optional
            A notch whose factors are included.

        Returns
        -------
        array (3, fibres, t)
            Normal stress, and shear stress along y and z [Pa].
        """
        cell = self.member.cell_at(xi, side)
        forces = self.member.at(np.full((self.member.t.size, 1), xi), side, self._scale(notch))
        return np.asarray(
            np.einsum("cfk,kt->cft", cell.factors(np.array([xi]))[..., 0], forces[..., 0])
        )

    def fibres(self, xi: Share, side: Side = "tip") -> tuple[str, ...]:
        """Return the names of the fibres at a ratio.

        Parameters
        ----------
        xi : float
            Ratio xi/l, from 0 to 1.
        side : {"base", "tip"}
            Side of a step of the cross-section or of a station, if the ratio is one.

        Returns
        -------
        tuple of str
            Their names, in the order of :meth:`at`.
        """
        return self.member.cell_at(xi, side).names

    def largest(self, kind: str) -> Largest:
        """Return a stress that is largest in size along the link, at every instant.

        Parameters
        ----------
        kind : {"normal", "shear", "von_mises", "tresca"}
            The stress.

        Returns
        -------
        Largest
            Value [Pa], ratio and fibre, exact whatever the grid of xi; NaN at instants that do not
            count.
        """
        moving = self.member.counted
        values, places, fibres = zip(
            *(stress._largest(kind) for stress in Stress(moving)._blocks()), strict=True
        )
        value = np.concatenate(values)
        place = np.concatenate(places)
        names = list(itertools.chain.from_iterable(fibres))
        if moving is self.member:
            return Largest(value, place, tuple(names))
        found, place_names = np.full((2, self.member.t.size), np.nan), [""] * self.member.t.size
        for k, at in enumerate(np.searchsorted(self.member.t, moving.t).tolist()):
            found[:, at], place_names[at] = (value[k], place[k]), names[k]
        return Largest(found[0], found[1], tuple(place_names))

    def peak(self, kind: str, *, notches: bool = False) -> StressPeak:
        """Return the largest stress over all instants that count.

        Parameters
        ----------
        kind : {"normal", "shear", "von_mises", "tresca"}
            The stress.
        notches : bool
            True for the stresses at notches alone, their factors included.

        Returns
        -------
        StressPeak
            The value [Pa] with its sign, its time, ratio and fibre.

        Raises
        ------
        DeclarationError
            If notches are wanted, and the beam has none.
        """
        moving = Stress(self.member.counted)
        if notches:
            _weights(kind)
            self._require_notches()
            return max(
                (moving._at_notch(kind, notch) for notch in self.member.beam.notches),
                key=lambda peak: abs(peak.value),
            )
        best: StressPeak | None = None
        for stress in moving._blocks():
            found = stress._highest(kind, 0.0 if best is None else abs(best.value))
            if best is None or (found is not None and abs(found.value) > abs(best.value)):
                best = found
        assert best is not None
        return best

    def largest_at_notches(self, kind: str) -> Array:
        """Return the size of a stress at notches, their factors included.

        Parameters
        ----------
        kind : {"normal", "shear", "von_mises", "tresca"}
            The stress.

        Returns
        -------
        array (t,)
            The largest of all notches [Pa].

        Raises
        ------
        DeclarationError
            If the beam has no notches.
        """
        weights = _weights(kind)
        self._require_notches()
        each = [
            self.at(notch.at, side, notch) for notch in self.member.beam.notches for side in _SIDES
        ]
        return np.asarray(
            np.sqrt(np.max([squared(values, weights).max(axis=0) for values in each], axis=0))
        )

    def _require_notches(self) -> None:
        if not self.member.beam.notches:
            raise DeclarationError(f"the beam of link '{self.member.link}' has no notches")

    def _highest(self, kind: str, floor: float) -> StressPeak | None:
        """The peak of a few instants; None where it is not above a floor.

        A coarse look leaves out instants that have it not.
        """
        rows = [part for cell in self.member.cells for part in self._parts(cell)]
        sampled = [part.sampled(_weights(kind), _GLANCES) for part in rows]
        least = np.max([squares.max(axis=(1, 2)) for squares, _ in sampled], axis=0)
        most = np.max([squares.max(axis=(1, 2)) * bound for squares, bound in sampled], axis=0)
        chosen = np.flatnonzero((most >= least.max()) & (most >= floor**2))
        if not chosen.size:
            return None
        near = Stress(self.member.during(chosen))
        value, place, fibre = near._largest(kind)
        k = int(np.argmax(np.abs(value)))
        return StressPeak(kind, float(value[k]), float(near.member.t[k]), float(place[k]), fibre[k])

    def _at_notch(self, kind: str, notch: Notch) -> StressPeak:
        found = []
        for side in _SIDES:
            values = self.at(notch.at, side, notch)
            squares = squared(values, _weights(kind))
            fibre, k = np.unravel_index(int(np.argmax(squares)), squares.shape)
            value = float(_signed(kind, squares[fibre, k], values[0, fibre, k]))
            found.append(
                StressPeak(
                    kind,
                    value,
                    float(self.member.t[k]),
                    notch.at,
                    self.fibres(notch.at, side)[fibre],
                    True,
                )
            )
        return max(found, key=lambda peak: abs(peak.value))

    def _scale(self, notch: Notch | None) -> Array:
        return np.array([concentration(notch, force) for force in self.member.forces])

    def _blocks(self) -> Iterator[Stress]:
        """The stresses over few instants after another."""
        member = self.member
        each = sum(
            (_SAMPLES * (member.degree + cell.degree) + 1) * len(cell.names)
            for cell in member.cells
        )
        height = max(1, _BLOCK // (each * (len(member.marks) + 1)))
        for start in range(0, member.t.size, height):
            yield (
                self
                if height >= member.t.size
                else Stress(member.during(slice(start, start + height)))
            )

    def _largest(self, kind: str) -> tuple[Array, Array, list[str]]:
        """Values, ratios and fibres at every instant."""
        weights, count = _weights(kind), self.member.t.size
        rows = [part for cell in self.member.cells for part in self._parts(cell)]
        sampled = [part.sampled(weights, _SAMPLES) for part in rows]
        floor = np.max([squares.max(axis=(1, 2)) for squares, _ in sampled], axis=0)
        value, place, fibre = np.full(count, -1.0), np.zeros(count), np.zeros(count, int)
        names: list[tuple[str, ...]] = []
        signs = np.zeros(count)
        for number, (part, (squares, bound)) in enumerate(zip(rows, sampled, strict=True)):
            names.append(part.cell.names)
            t, f = np.nonzero(squares.max(axis=2) * bound >= floor[:, None])
            if t.size:
                square, u, sign = part.maxima(t, f, weights)
                order = np.lexsort((square, t))
                last = order[np.append(np.diff(t[order]) != 0, True)]
                better = last[square[last] > value[t[last]]]
                at = t[better]
                value[at] = square[better]
                place[at] = u[better]
                signs[at] = sign[better]
                fibre[at] = number * 1000 + f[better]
        labels = [names[k // 1000][k % 1000] for k in fibre.tolist()]
        return _signed(kind, value, signs), place, labels

    def _parts(self, cell: Cell) -> Iterator[_Part]:
        """The parts of a cell between two marks."""
        still = np.zeros_like(self.member.t)
        marks = [np.clip(mark, cell.low, cell.high) for mark in self.member.marks]
        inner = np.sort(np.stack([still + cell.low, *marks, still + cell.high]), axis=0)
        for low, high in itertools.pairwise(inner):
            if np.any(high > low):
                yield _Part(self.member, cell, low, high)


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of a link between two marks (t,), on which stresses are polynomials of a degree."""

    member: Member
    cell: Cell
    low: Array
    high: Array

    @property
    def degree(self) -> int:
        return self.member.degree + self.cell.degree

    @cached_property
    def coefficients(self) -> Array:
        """Coefficients of Chebyshev's polynomials: (3, fibres, t, degree + 1)."""
        nodes, weights = interpolation(self.degree)
        u = self.low[:, None] + (self.high - self.low)[:, None] * (nodes + 1.0) / 2
        return np.asarray(np.sum(self._factors(u) * self.member.at(u), axis=2) @ weights)

    def _factors(self, u: Array) -> Array:
        """Factors of a cell of one cross-section, the same everywhere; between marks that do not
        move, at all instants.
        """
        if not self.cell.degree:
            return self.cell.factors(np.full((1, 1), self.cell.low))
        return self.cell.factors(u if np.ptp(self.low) or np.ptp(self.high) else u[:1])

    def sampled(self, weights: tuple[float, float], samples: int) -> tuple[Array, float]:
        """The squares (t, fibres, looks), both ends among them, and how many times higher they may
        be in between.
        """
        places = _places(self.degree, samples)
        values = self.coefficients @ chebyshev.chebvander(places, self.degree).T
        # A square is not negative: it is bounded about half of what is largest.
        factor = (1.0 + 1.0 / math.cos(math.pi * self.degree / (places.size - 2))) / 2
        return np.moveaxis(squared(values, weights), 0, 1), factor

    def maxima(
        self, t: Operand, f: Operand, weights: tuple[float, float]
    ) -> tuple[Array, Array, Array]:
        """The largest squares at some instants and fibres, their ratios, and the sign of the normal
        stress there.
        """
        square, x, sign = maxima(self.coefficients[:, f, t], weights)
        return square, self.low[t] + (self.high - self.low)[t] * (x + 1.0) / 2, sign


def _places(degree: int, samples: int) -> Array:
    """Places at which squares, of twice the degree, are sampled: so many Chebyshev nodes for each
    degree, and both ends.
    """
    return np.concatenate([[-1.0], chebyshev.chebpts1(max(samples * degree, 8)), [1.0]])


def maxima(c: Array, weights: tuple[float, float]) -> tuple[Array, Array, Array]:
    """The largest square of stresses from -1 to 1, where it is, and the sign of the normal stress
    there, each (n,).

    ``c`` (3, n, degree + 1) are coefficients of Chebyshev's polynomials of normal stress, and of
    shear stress along y and along z. In the angle whose cosine the place is, a square of degree n
    bends by no more than n^2 times its largest value (Bernstein's inequality), so beside its summit
    it was looked at where it is lower by a twelfth at most. From every such place that is higher
    than its neighbours it is followed upward, between these.
    """
    degree = c.shape[-1] - 1
    places = _places(degree, _SAMPLES)
    squares = squared(c @ chebyshev.chebvander(places, degree).T, weights)
    edge = np.full((len(squares), 1), -1.0)
    higher = (squares >= np.hstack([edge, squares[:, :-1]])) & (
        squares >= np.hstack([squares[:, 1:], edge])
    )
    rows, k = np.nonzero(higher & (squares >= _BESIDE * squares.max(axis=1, keepdims=True)))
    coefficients = np.moveaxis(c[:, rows], 2, 0)

    def square(x: Array) -> Array:
        return np.asarray(
            squared(
                np.stack(
                    [chebyshev.chebval(x, coefficients[:, n], tensor=False) for n in range(3)]
                ),
                weights,
            )
        )

    x = _uphill(square, places[np.maximum(k - 1, 0)], places[np.minimum(k + 1, places.size - 1)])
    found, sampled = square(x), squares[rows, k]
    x, found = np.where(found >= sampled, x, places[k]), np.maximum(found, sampled)
    order = np.lexsort((found, rows))
    last = order[np.append(np.diff(rows[order]) != 0, True)]
    return (
        found[last],
        x[last],
        np.sign(chebyshev.chebval(x[last], coefficients[:, 0, last], tensor=False)),
    )


def _uphill(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Place of the maximum of a function between two places, between which it has one: by the
    golden section.
    """
    golden = (math.sqrt(5.0) - 1.0) / 2
    inner, outer = high - golden * (high - low), low + golden * (high - low)
    at_inner, at_outer = function(inner), function(outer)
    for _ in range(_STEPS):
        left = at_inner >= at_outer
        low, high = np.where(left, low, inner), np.where(left, outer, high)
        kept, at_kept = np.where(left, inner, outer), np.where(left, at_inner, at_outer)
        fresh = np.where(left, high - golden * (high - low), low + golden * (high - low))
        at_fresh = function(fresh)
        inner, outer = np.where(left, fresh, kept), np.where(left, kept, fresh)
        at_inner, at_outer = np.where(left, at_fresh, at_kept), np.where(left, at_kept, at_fresh)
    return (low + high) / 2


def _weights(kind: str) -> tuple[float, float]:
    if kind not in KINDS:
        raise UnknownNameError("kind of stress", kind, KINDS)
    return KINDS[kind]


def _signed(kind: str, square: Array, normal: Array) -> Array:
    size = np.sqrt(np.maximum(square, 0.0))
    return np.where(normal < 0.0, -size, size) if kind == "normal" else size

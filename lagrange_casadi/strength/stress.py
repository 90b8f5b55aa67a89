"""Stresses in a link, over time, along it, and at the fibres of its cross-section.

s = N/A + a y + b z with a Iz + b Iyz = -Mz and a Iyz + b Iy = My, for any axes; shear stresses are those of :mod:`..beams`. In a
planar mechanism bending is about z. All are linear in section forces, so between two marks they are polynomials of xi, or products
of these with smooth functions of the cross-section, which are replaced by polynomials that agree to 1e-13.

The largest of sqrt(s^2 + k t^2) along a link is sought among the zeros of the slope of its square. How far a square may rise
between the places at which it is looked at is bounded by Ehlich and Zeller, *Schwankung von Polynomen zwischen Gitterpunkten*,
Math. Zeitschrift 86 (1964): where nothing can be above what was found, nothing is sought.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ..beams.beam import Notch
from ..declare.density import Array
from ..errors import UnknownNameError
from ..instants.section_law import Side
from ..summits.polynomials import interpolation
from .member import Cell, Member

KINDS = {"normal": (1.0, 0.0), "shear": (0.0, 1.0), "von_mises": (1.0, 3.0), "tresca": (1.0, 4.0)}
"""Of each kind of stress the weights of s^2 and t^2 in its square."""

_LOOKS, _GLANCES, _BLOCK = 8, 4, 1 << 21
_SIDES: tuple[Side, Side] = ("base", "tip")


@dataclass(frozen=True)
class StressPeak:
    """The stress that is largest in size, with its sign [Pa], and where: time [s], ratio xi/l, and the fibre's name.

    ``notch`` tells whether it is the stress at a notch, its factors included.
    """

    kind: str
    value: float
    t: float
    xi: float
    fibre: str
    notch: bool = False


@dataclass(frozen=True, eq=False)
class Largest:
    """The stress largest in size along a link and over its fibres at every instant, each (t,): value, ratio xi/l, fibre's name."""

    value: Array
    xi: Array
    fibre: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Stress:
    """The stresses in a link, nominal but where notches are said.

    Kinds are ``normal``, positive in tension; ``shear``, its size; ``von_mises`` and ``tresca``, never negative. Methods raise
    :class:`.UnknownNameError` for any other.
    """

    member: Member

    def __repr__(self) -> str:
        return f"<Stress in '{self.member.link}': {self.member.t.size} instants, {len(self.member.cells[0].names)} fibres>"

    def grid(self, kind: str, xi: Array | None = None) -> Array:
        """A stress (t, xi) over ratios, by default those of the solution: the largest in size of all fibres, on the tip's side."""
        weights = _weights(kind)
        u = self.member.xi if xi is None else np.asarray(xi, float)
        found = np.empty((self.member.t.size, u.size))
        for cell in self.member.cells:
            inside = np.flatnonzero((u >= cell.low) & ((u < cell.high) | (cell.high == 1.0)))
            factors = cell.factors(u[inside])
            for start in range(0, inside.size, width := max(1, _BLOCK // (3 * len(cell.names) * self.member.t.size))):
                chosen = inside[start : start + width]
                forces = self.member.at(np.broadcast_to(u[chosen], (self.member.t.size, chosen.size)))
                values = np.einsum("cfkn,ktn->cftn", factors[..., start : start + width], forces)
                squares = _square(values, weights)
                best = np.argmax(squares, axis=0)[None]
                square, normal = (np.take_along_axis(a, best, 0)[0] for a in (squares, values[0]))
                found[:, chosen] = _signed(kind, square, normal)
        return found

    def at(self, xi: float, side: Side = "tip", notch: Notch | None = None) -> Array:
        """The stresses at a ratio: (3, fibres, t), normal, and shear along y and z, with the factors of a notch where given."""
        cell = self.member.cell_at(xi, side)
        forces = self.member.at(np.full((self.member.t.size, 1), xi), side, None if notch is None else self._scale(notch))
        return np.asarray(np.einsum("cfk,kt->cft", cell.factors(np.array([xi]))[..., 0], forces[..., 0]))

    def fibres(self, xi: float, side: Side = "tip") -> tuple[str, ...]:
        """The names of the fibres at a ratio."""
        return self.member.cell_at(xi, side).names

    def largest(self, kind: str) -> Largest:
        """A stress largest in size at every instant, exactly along the link, whatever the grid of xi."""
        values, places, fibres = zip(*(stress._largest(kind) for stress in self._blocks()), strict=True)
        return Largest(np.concatenate(values), np.concatenate(places), tuple(itertools.chain.from_iterable(fibres)))

    def peak(self, kind: str, *, notches: bool = False) -> StressPeak:
        """The largest over all instants too; where ``notches`` are asked for, their stresses and theirs alone."""
        if notches:
            return max((self._at_notch(kind, notch) for notch in self.member.beam.notches), key=lambda peak: abs(peak.value))
        best: StressPeak | None = None
        for stress in self._blocks():
            found = stress._highest(kind, 0.0 if best is None else abs(best.value))
            if best is None or (found is not None and abs(found.value) > abs(best.value)):
                best = found
        assert best is not None
        return best

    def _highest(self, kind: str, floor: float) -> StressPeak | None:
        """The peak of a few instants; None where it is not above a floor. A coarse look leaves out instants that have it not."""
        rows = [part for cell in self.member.cells for part in self._parts(cell)]
        looked = [part.looked(_weights(kind), _GLANCES) for part in rows]
        least = np.max([squares.max(axis=(1, 2)) for squares, _ in looked], axis=0)
        most = np.max([squares.max(axis=(1, 2)) * bound for squares, bound in looked], axis=0)
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
            squares = _square(values, _weights(kind))
            fibre, k = np.unravel_index(int(np.argmax(squares)), squares.shape)
            value = float(_signed(kind, squares[fibre, k], values[0, fibre, k]))
            found.append(StressPeak(kind, value, float(self.member.t[k]), notch.at, self.fibres(notch.at, side)[fibre], True))
        return max(found, key=lambda peak: abs(peak.value))

    def _scale(self, notch: Notch) -> Array:
        return np.array([_factor(notch, force) for force in self.member.forces])

    def _blocks(self) -> Iterator[Stress]:
        """The stresses over few instants after another."""
        member = self.member
        each = sum((_LOOKS * (member.degree + cell.degree) + 1) * len(cell.names) for cell in member.cells)
        height = max(1, _BLOCK // (each * (len(member.marks) + 1)))
        for start in range(0, member.t.size, height):
            yield self if height >= member.t.size else Stress(member.during(slice(start, start + height)))

    def _largest(self, kind: str) -> tuple[Array, Array, list[str]]:
        """Values, ratios and fibres at every instant."""
        weights, count = _weights(kind), self.member.t.size
        rows = [part for cell in self.member.cells for part in self._parts(cell)]
        looked = [part.looked(weights, _LOOKS) for part in rows]
        floor = np.max([squares.max(axis=(1, 2)) for squares, _ in looked], axis=0)
        value, place, fibre = np.full(count, -1.0), np.zeros(count), np.zeros(count, int)
        names: list[tuple[str, ...]] = []
        signs = np.zeros(count)
        for number, (part, (squares, bound)) in enumerate(zip(rows, looked, strict=True)):
            names.append(part.cell.names)
            t, f = np.nonzero(squares.max(axis=2) * bound >= floor[:, None])
            if t.size:
                square, u, sign = part.summits(t, f, weights)
                order = np.lexsort((square, t))
                last = order[np.append(np.diff(t[order]) != 0, True)]
                better = last[square[last] > value[t[last]]]
                at = t[better]
                value[at], place[at], signs[at], fibre[at] = square[better], u[better], sign[better], number * 1000 + f[better]
        told = [names[k // 1000][k % 1000] for k in fibre.tolist()]
        return _signed(kind, value, signs), place, told

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
        """Of Chebyshev's polynomials: (3, fibres, t, degree + 1)."""
        nodes, weights = interpolation(self.degree)
        u = self.low[:, None] + (self.high - self.low)[:, None] * (nodes + 1.0) / 2
        return np.asarray(np.sum(self._factors(u) * self.member.at(u), axis=2) @ weights)

    def _factors(self, u: Array) -> Array:
        """Of a cell of one cross-section, the same everywhere; between marks that stand still, at all instants."""
        if not self.cell.degree:
            return self.cell.factors(np.full((1, 1), self.cell.low))
        return self.cell.factors(u if np.ptp(self.low) or np.ptp(self.high) else u[:1])

    def looked(self, weights: tuple[float, float], looks: int) -> tuple[Array, float]:
        """The squares (t, fibres, looks), both ends among them, and how many times higher they may be in between."""
        degree = 2 * self.degree
        count = max(looks * degree // 2, 8)
        places = np.concatenate([[-1.0], chebyshev.chebpts1(count), [1.0]])
        values = self.coefficients @ chebyshev.chebvander(places, self.degree).T
        # A square is not negative: it is bounded about half of what is largest.
        factor = (1.0 + 1.0 / math.cos(math.pi * degree / (2 * count))) / 2
        return np.moveaxis(_square(values, weights), 0, 1), factor

    def summits(self, t: Any, f: Any, weights: tuple[float, float]) -> tuple[Array, Array, Array]:
        """The largest squares at some instants and fibres, their ratios, and the sign of the normal stress there."""
        c = self.coefficients[:, f, t]
        nodes, fit = interpolation(2 * self.degree)
        at_nodes = c @ chebyshev.chebvander(nodes, self.degree).T
        slopes = np.asarray(chebyshev.chebder((_square(at_nodes, weights) @ fit).T, axis=0)).T
        places = np.concatenate([np.full((t.size, 1), -1.0), _roots(slopes), np.full((t.size, 1), 1.0)], axis=1)
        basis = np.moveaxis(chebyshev.chebvander(places, self.degree), 2, 0)
        values = np.einsum("cpd,dpn->cpn", c, basis)
        squares = _square(values, weights)
        best = np.argmax(squares, axis=1)[:, None]
        x, square, normal = (np.take_along_axis(a, best, 1)[:, 0] for a in (places, squares, values[0]))
        return square, self.low[t] + (self.high - self.low)[t] * (x + 1.0) / 2, np.sign(normal)


def _roots(c: Array) -> Array:
    """Real parts, kept from -1 to 1, of all zeros of series of Chebyshev's polynomials (n, degree + 1): (n, degree).

    They are eigenvalues of the colleague matrix (Good, *The colleague matrix*, Quart. J. Math. 12, 1961). Of a leading coefficient
    that is nothing beside the others, a little is made: it moves no zero within by more than rounding.
    """
    degree = c.shape[1] - 1
    if degree < 1:
        return np.zeros((len(c), 0))
    size = np.abs(c).max(axis=1)
    lead = np.where(np.abs(c[:, -1]) > 1e-16 * size, c[:, -1], np.where(size > 0.0, 1e-16 * size, 1.0))
    if degree == 1:
        return np.clip(-c[:, :1] / lead[:, None], -1.0, 1.0)
    matrix = np.zeros((len(c), degree, degree))
    matrix[:, np.arange(degree - 1), np.arange(1, degree)] = 0.5
    matrix[:, np.arange(1, degree), np.arange(degree - 1)] = 0.5
    matrix[:, 0, 1] = 1.0
    matrix[:, -1] -= c[:, :-1] / (2.0 * lead[:, None])
    return np.clip(np.linalg.eigvals(matrix).real, -1.0, 1.0)


def _factor(notch: Notch, force: str) -> float:
    return notch.axial if force == "axial" else notch.bending if force.startswith("bending") else notch.shear


def _weights(kind: str) -> tuple[float, float]:
    if kind not in KINDS:
        raise UnknownNameError("kind of stress", kind, KINDS)
    return KINDS[kind]


def _square(values: Array, weights: tuple[float, float]) -> Array:
    return np.asarray(weights[0] * values[0] ** 2 + weights[1] * (values[1] ** 2 + values[2] ** 2))


def _signed(kind: str, square: Array, normal: Array) -> Array:
    size = np.sqrt(np.maximum(square, 0.0))
    return np.where(normal < 0.0, -size, size) if kind == "normal" else size

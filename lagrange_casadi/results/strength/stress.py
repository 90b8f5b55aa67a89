"""Stresses in a link of a solution, over time, along it, and at the fibres of its cross-section.

They are linear in section forces (:mod:`.engine.section_stress`), so between two marks they are
polynomials of xi, or products of these with smooth functions of the cross-section, which are
replaced by polynomials that agree to 1e-13.

No polynomial is above its ordinates. So a part, a fibre or an instant is left out if there these
are below what was found at ends of parts. In others the square of sqrt(s^2 + k t^2) is largest at
an end, or at a zero of its slope.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arguments import Share, public
from ...base.arrays import Array
from ...base.bernstein import product, slope, value, zeros
from ...base.brief import Brief
from ...engine.section_function import SIDES, Side
from ...engine.section_stress import KINDS, concentration, squared
from ...errors import DeclarationError, check_known, shown
from ...model.beams.beam import Notch
from .member import Member

_BLOCK = 1 << 21


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
        u = self.member.xi if xi is None else np.atleast_1d(xi)
        if u.ndim != 1 or not ((u >= 0.0) & (u <= 1.0)).all():
            raise DeclarationError(
                f"stress: expected a row of ratios xi/l from 0 to 1, got {shown(xi)}"
            )
        found = np.empty((self.member.t.size, u.size))
        for cell in self.member.cells:
            inside = np.flatnonzero((u >= cell.low) & ((u < cell.high) | (cell.high == 1.0)))
            size = 3 * len(cell.names) * self.member.t.size * inside.size
            for chosen in np.array_split(inside, 1 + size // _BLOCK):
                forces = self.member.at(
                    np.broadcast_to(u[chosen], (self.member.t.size, chosen.size))
                )
                values = np.einsum("cfkn,ktn->cftn", cell.factors(u[chosen]), forces)
                _, found[:, chosen] = _of_fibres(kind, values)
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
        forces = self.member.at(np.full((self.member.t.size, 1), xi), side)[..., 0]
        scale = [concentration(notch, force) for force in self.member.forces]
        factors = cell.factors(np.array([xi]))[..., 0] * scale
        return np.asarray(np.einsum("cfk,kt->cft", factors, forces))

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
        found = Stress(self.member.counted)._along(kind)
        at = np.flatnonzero(self.member.counts)
        value, xi = np.full((2, self.member.t.size), np.nan)
        value[at], xi[at] = found.value, found.xi
        names = dict(zip(at.tolist(), found.fibre, strict=True))
        return Largest(value, xi, tuple(names.get(k, "") for k in range(self.member.t.size)))

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
        found = moving._at_notches(kind) if notches else moving._along(kind, peak=True)
        k = int(np.argmax(np.abs(found.value)))
        return StressPeak(
            kind,
            float(found.value[k]),
            float(moving.member.t[k]),
            float(found.xi[k]),
            found.fibre[k],
            notches,
        )

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
        return np.abs(self._at_notches(kind).value)

    def _at_notches(self, kind: str) -> Largest:
        """The stress that is largest in size at notches, at every instant."""
        if not self.member.beam.notches:
            raise DeclarationError(f"the beam of link '{self.member.link}' has no notches")
        every = [*itertools.product(self.member.beam.notches, SIDES)]
        stresses = [self.at(notch.at, side, notch) for notch, side in every]
        names = [self.fibres(notch.at, side) for notch, side in every]
        places = np.repeat([notch.at for notch, _ in every], [*map(len, names)])
        best, value = _of_fibres(kind, np.concatenate(stresses, axis=1))
        fibres = np.array([*itertools.chain.from_iterable(names)], object)[best]
        return Largest(value, places[best], tuple(fibres.tolist()))

    def _blocks(self) -> Iterator[Stress]:
        """The stresses over few instants after another."""
        member = self.member
        each = sum((2 * (member.degree + c.degree) + 1) * len(c.names) for c in member.cells)
        parts = len(member.law.loads) + member.law.functions.breaks.shape[1]
        height = max(1, _BLOCK // (each * parts))
        for start in range(0, member.t.size, height):
            yield (
                self
                if height >= member.t.size
                else Stress(member.during(slice(start, start + height)))
            )

    def _along(self, kind: str, *, peak: bool = False) -> Largest:
        """The stress that is largest in size along the link, at every instant; or if only the
        ``peak`` is sought, less at others.
        """
        found, floor = [], 0.0 if peak else None
        for block in self._blocks():
            found.append(block._largest(kind, floor))
            if floor is not None:
                floor = max(floor, float(np.max(found[-1][0] ** 2)))
        values, places, names = zip(*found, strict=True)
        fibre = tuple(itertools.chain.from_iterable(names))
        return Largest(np.concatenate(values), np.concatenate(places), fibre)

    def _largest(self, kind: str, floor: float | None) -> tuple[Array, Array, list[str]]:
        """Values, ratios and fibres at every instant; with a ``floor``, of squares, 0 where the
        value is below that, or not the peak.
        """
        weights, count, names = _weights(kind), self.member.t.size, list[str]()
        parts = [*self._parts()]
        ends = [squared(np.moveaxis(part[-1][[0, -1]], 1, 0), weights) for part in parts]
        least = np.max([squares.max(axis=(0, 1, 2)) for squares in ends], axis=0)
        if floor is not None:
            least = np.full(count, max(floor, least.max()))
        best, place, signs = np.full(count, -1.0), np.zeros(count), np.zeros(count)
        fibre = np.zeros(count, int)
        for names_here, low, high, stresses in parts:
            bound = squared(np.abs(stresses).max(axis=0), weights)
            f, p, t = np.nonzero(bound >= least)
            normal, *shears = np.moveaxis(stresses[:, :, f, p, t], 1, 0)
            c = weights[0] * product(normal, normal)
            c += weights[1] * sum(product(shear, shear) for shear in shears)
            inner = zeros(slope(c)).places
            x = np.concatenate([np.ones((1, t.size)), np.zeros((1, t.size)), inner])
            values = value(c, x)
            k = np.argmax(values, axis=0)[None]
            x, values = (np.take_along_axis(rows, k, 0)[0] for rows in (x, values))
            order = np.lexsort((values, t))
            last = order[np.append(np.diff(t[order]) != 0, True)] if t.size else order
            higher = last[values[last] > best[t[last]]]
            at, x, f, p = t[higher], x[higher], f[higher], p[higher]
            best[at], fibre[at] = values[higher], len(names) + f
            place[at] = high[p, at] - (high - low)[p, at] * x
            signs[at] = value(stresses[:, 0, f, p, at], x[None])[0]
            names += names_here
        return _signed(kind, best, signs), place, [names[k] for k in fibre.tolist()]

    def _parts(self) -> Iterator[tuple[tuple[str, ...], Array, Array, Array]]:
        """The parts of the link between two marks, in each cell of its cross-section: the names of
        fibres, begins and ends (parts, t), and stresses, ordinates (degree + 1, 3, fibres, parts,
        t).
        """
        for cell in self.member.cells:
            low, high = cell.parts(self.member.pieces[0].ends)
            stresses = cell.stresses(cell.forces(low, high), low, high)
            low, high = (np.broadcast_to(end, stresses.shape[3:]) for end in (low, high))
            yield cell.names, low, high, stresses


def _weights(kind: str) -> tuple[float, float]:
    check_known("kind of stress", [kind], KINDS)
    return KINDS[kind]


def _of_fibres(kind: str, stresses: Array) -> tuple[npt.NDArray[np.intp], Array]:
    """The stress that is largest in size of all fibres, whose stresses are (3, fibres, ...): the
    fibre's number, and the value.
    """
    squares = squared(stresses, _weights(kind))
    best = np.argmax(squares, axis=0)
    square, normal = (np.take_along_axis(rows, best[None], 0)[0] for rows in (squares, stresses[0]))
    return best, _signed(kind, square, normal)


def _signed(kind: str, square: Array, normal: Array) -> Array:
    size = np.sqrt(np.maximum(square, 0.0))
    return np.where(normal < 0.0, -size, size) if kind == "normal" else size

"""What a sweep keeps of the strength of links: least factors of safety, lives, and masses.

Utilisation against yielding and buckling comes from the engine. Fatigue follows from whole histories. Where stations stand still,
the stresses of fibres at fixed ratios are a matrix times what the section law is made of. Of a history of normal stress alone the
swing from its smallest to its largest value is the worst by Goodman's rule; of one with shear stress that is bounded, and what may
be worse than all that is known is counted, as :mod:`..strength.fatigue` does it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...beams.beam import Notch
from ...beams.material import Material
from ...declare.masses import ALL, mass_of
from ...declare.mechanism import Mechanism
from ...declare.parts import Link
from ...equations.checks import Column
from ...equations.strength import FORCES, Loaded
from ...instants.statistics import counted
from ...strength.fatigue import FEW, damage_score, factor, factor_score, felt, loaded, strengths
from ...strength.fatigue import worst as search
from ...strength.member import Member
from ...strength.stress import Stress
from .matter import Matter
from .meanings import LEAST, LIFE, MASS, WAYS

_NEAR = 1e-9
_NUMBERS = 1 << 19
"""Stresses that are at hand at once, of as many designs as have no more: so many stay in the memory next to a processor."""

_EVENLY = 33
"""Ratios that are looked at: half as many as of one solution."""

_CRITERION = "goodman"


@dataclass(frozen=True, eq=False)
class Fatigue:
    """The stresses of a link's fibres as a function of what its law is made of.

    ``rows(members, p)`` is their matrix: the normal stresses of all places and fibres, then the shear stresses of those that are
    ``sheared``, along one of ``axes`` after the other (0 is y, 1 is z), for in a plane there are none along z; ``still`` are the
    members that it depends on.
    """

    members: tuple[Output, ...]
    still: npt.NDArray[np.intp]
    rows: Any
    sheared: npt.NDArray[np.intp]
    axes: tuple[int, ...]

    @classmethod
    def of(cls, mechanism: Mechanism, link: Link, members: Sequence[Output]) -> Fatigue:
        """That of a link whose law is made of ``members``."""
        symbols = ca.SX.sym("members", len(members))
        columns: dict[Column, Any] = dict(zip(members, ca.vertsplit(symbols), strict=True))
        body = Loaded(mechanism, link, columns)
        normal, shears = list[Any](), list[list[Any]]()
        for cell, u, middle, notch in _places(body, link):
            forces = {place: body.force_at(name, u, middle) * _scale(notch, name) for name, place in FORCES[body.space].items()}
            p = body.properties(cell, u)
            for fibre in body.alone[cell]:
                values = [
                    ca.SX(sum(number * forces[k] for k, number in enumerate(row) if k in forces)) for row in p.rows(p.fibres[fibre])
                ]
                normal.append(values[0])
                shears.append(values[1:])
        sheared = [k for k, pair in enumerate(shears) if not (pair[0].is_zero() and pair[1].is_zero())]
        axes = tuple(axis for axis in (0, 1) if not all(shears[k][axis].is_zero() for k in sheared))
        every = ca.vertcat(*normal, *(shears[k][axis] for axis in axes for k in sheared))
        # Stresses are linear in forces, not in where these act.
        acting = [k for k, member in enumerate(members) if not _is_place(member)]
        slopes = ca.SX(every.numel(), len(members))
        slopes[:, acting] = ca.jacobian(every, symbols[acting])
        still = [k for k in range(len(members)) if ca.depends_on(slopes, symbols[k])]
        # Rows of the matrix one after another, as numbers lie in memory.
        found = ca.Function("rows", [symbols, mechanism.symbols], [ca.vec(ca.densify(slopes.T))], {"cse": True})
        return cls(tuple(members), np.array(still, np.intp), found, np.array(sheared, np.intp), axes)

    def stands(self, members: Array) -> npt.NDArray[np.bool_]:
        """Of which designs, whose members are (n, members, t), the matrix is the same at all instants."""
        return np.asarray((np.ptp(members[:, self.still], axis=2) <= _NEAR).all(axis=1))

    def stresses(self, members: Array, p: Array) -> tuple[Array, Array]:
        """Of designs whose members are (n, members, t): normal stresses (n, places, t), shear stresses (n, axes, sheared, t)."""
        n, k, t = members.shape
        matrix = self._matrices(members[:, :, 0], p).reshape(n, -1, k)
        found = np.matmul(matrix, np.ascontiguousarray(members))
        first = found.shape[1] - len(self.axes) * self.sheared.size
        return found[:, :first], found[:, first:].reshape(n, len(self.axes), self.sheared.size, t)

    @property
    def places(self) -> int:
        """How many places and fibres there are."""
        return int(self.rows.numel_out(0) // len(self.members) - len(self.axes) * self.sheared.size)

    def history(self, normal: Array, shears: Array, place: int) -> Array:
        """Normal stress, shear along y and along z (3, t) at a place, of a design's (places, t) and (axes, sheared, t)."""
        found = np.zeros((3, normal.shape[1]))
        found[0] = normal[place]
        for column in np.flatnonzero(self.sheared == place):
            found[[1 + axis for axis in self.axes]] = shears[:, column]
        return found

    def _matrices(self, members: Array, p: Array) -> Array:
        """The numbers of ``rows`` for designs (n, ...), through memory that CasADi itself reads and writes: by far the fastest."""
        buffer, evaluate = self.rows.buffer()
        given, found = [np.zeros(members.shape[1]), np.zeros(p.shape[1])], np.empty((len(p), self.rows.nnz_out(0)))
        row = np.empty(found.shape[1])
        for number, values in enumerate(given):
            buffer.set_arg(number, values.data)
        buffer.set_res(0, row.data)
        for i in range(len(p)):
            given[0][:], given[1][:] = members[i], p[i]
            evaluate()
            found[i] = row
        return found


@dataclass(frozen=True, eq=False)
class Kept:
    """What is kept of the strength of links: those whose ``safety`` is wanted, and those whose ``life`` is.

    ``series`` names what is evaluated over time, in a ``precision``; ``doubtful`` the links that lack it for some designs.
    """

    mechanism: Mechanism
    safety: tuple[str, ...]
    life: tuple[str, ...]
    quantities: tuple[str, ...]
    series: tuple[str, ...]
    precision: str
    doubtful: Collection[str] = ()

    @property
    def histories(self) -> bool:
        """Whether whole histories must be evaluated."""
        return any(self._tires(link) for link in self.safety) or bool(self.life)

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The links of which something is kept, in the order of declaration."""
        return tuple(name for name in self.mechanism.links if name in (*self.safety, *self.life))

    @cached_property
    def columns(self) -> Mapping[str, bool]:
        """The names of the columns, in the order of :meth:`evaluate`, and which may lack numbers where there is a result."""
        found = {f"{LEAST}:{way}:{link}": link in self.doubtful for link in self._judged for way in ("safety", *self._ways(link))}
        found |= {f"{LIFE}:{link}": link in self.doubtful for link in self._lives}
        return found | {f"{MASS}:{part}": False for part in (*self.links, ALL) if self.links}

    def evaluate(self, status: npt.NDArray[np.int8], value: Array, series: Array | None, times: Array, p: Array) -> list[Array]:
        """The columns of designs ``p``: ``value`` (n, quantities) are peaks, ``series`` (n, outputs, t), ``times`` (n, t)."""
        there = np.flatnonzero(status == 0)
        tired = {link: self._tired(link, there, series, times, p) for link in self.links if self._tires(link)}
        found: list[Array] = []
        for link in self._judged:
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
    def _judged(self) -> list[str]:
        """The links of which something is known that may fail."""
        return [link for link in self.safety if self._ways(link)]

    @property
    def _lives(self) -> list[str]:
        return [link for link in self.life if self._tires(link)]

    def _tires(self, link: str) -> bool:
        beam = self.mechanism.links[link].beam
        return beam is not None and tires(beam.material)

    def _tired(self, link: str, there: Any, series: Array | None, times: Array, p: Array) -> tuple[Array, Array]:
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
                self._count(link, there[alike], members[alike][..., moving], (series, times, moving, p), names, share, lives)
        return share, lives

    def _count(
        self, link: str, there: Any, members: Array, whole: tuple[Any, ...], names: Mapping[str, int], share: Array, lives: Array
    ) -> None:
        """Fill in utilisations and lives of designs that are ``there``, of which the same instants count."""
        (series, times, moving, p), fatigue, beam = whole, self._fatigue[link], self.mechanism.links[link].beam
        assert beam is not None
        stands = fatigue.stands(members)
        some, standing = there[stands], members[stands]
        many = max(1, _NUMBERS // (fatigue.rows.nnz_out(0) // len(fatigue.members) * members.shape[2]))
        for start in range(0, some.size, many):
            few = slice(start, start + many)
            share[some[few]] = worst(fatigue, *fatigue.stresses(standing[few], p[some[few]]), beam.material)
        for i in there.tolist():
            endless = share[i] <= 1.0 and beam.material.endless
            if np.isnan(share[i]) or (link in self.life and not endless):
                found, cycles = self._slowly(link, series[i][:, moving], times[min(i, len(times) - 1)][moving], p[i], names)
                share[i] = found if np.isnan(share[i]) else share[i]
                lives[i] = cycles
            else:
                lives[i] = math.inf

    def _slowly(self, link: str, series: Array, t: Array, p: Array, names: Mapping[str, int]) -> tuple[float, float]:
        """The same of one design, as of a solution."""
        mechanism, own = self.mechanism, self.mechanism.links[link]
        values = dict(zip(mechanism.parameters, p.tolist(), strict=True))
        members = {member: series[names[str(member)]] for member in self._fatigue[link].members}
        assert own.beam is not None
        beam = own.beam.mapped(lambda _, x: mechanism.number(x, values))
        law = Matter.of(mechanism, link, self.precision).law(members, p)
        member = Member(link, beam, law, t, np.linspace(0.0, 1.0, FEW), mechanism.space)
        stress, material = Stress(member), beam.material
        (least, *_), *_ = search(stress, factor_score(material, _CRITERION))
        if link not in self.life or (least >= 1.0 and material.endless):
            return 1.0 / least if least else math.inf, math.inf
        (damage, *_), *_ = search(stress, damage_score(material, _CRITERION))
        return 1.0 / least if least else math.inf, -1.0 / damage if damage else math.inf

    @cached_property
    def _fatigue(self) -> dict[str, Fatigue]:
        found = {}
        for name in self.links:
            members = [output for output in map(Output.of, self.series) if output.along and output.part == name]
            found[name] = Fatigue.of(self.mechanism, self.mechanism.links[name], members)
        return found

    @cached_property
    def _masses(self) -> Any:
        mechanism = self.mechanism
        found = [mass_of(mechanism, part) for part in (*self.links, ALL)]
        return ca.Function("masses", [mechanism.symbols], [ca.densify(ca.vertcat(*found))])


def tires(material: Material) -> bool:
    """Whether fatigue of a material can be told by Goodman."""
    return material.endurance is not None and material.ultimate is not None


def worst(fatigue: Fatigue, normal: Array, shears: Array, material: Material) -> Array:
    """Utilisation against fatigue of designs (n,), one over the least factor by Goodman: see :meth:`Fatigue.stresses`."""
    bound, known = bounds(normal, shears, fatigue.sheared, material)
    best = known.max(axis=1)
    for i in np.flatnonzero(bound.max(axis=1) > best):
        for k in np.argsort(-bound[i], kind="stable").tolist():
            if bound[i, k] <= best[i]:
                break
            if k in fatigue.sheared:
                swings = loaded(fatigue.history(normal[i], shears[i], k))
                best[i] = max(best[i], float(np.max(1.0 / factor(swings.amplitude, swings.mean, material, _CRITERION))))
    return np.asarray(best)


def bounds(normal: Array, shears: Array, sheared: npt.NDArray[np.intp], material: Material) -> tuple[Array, Array]:
    """Bounds on the utilisation of places of designs, and what is known of it at least, each (n, places)."""
    endurance, strength = strengths(material, _CRITERION)
    high, low = normal.max(axis=2), normal.min(axis=2)
    bound = (high - low) / (2 * endurance) + np.maximum((high + low) / 2, 0.0) / strength
    known = bound.copy()
    known[:, sheared] = 0.0
    if sheared.size:
        square = 3.0 * np.sum(np.ptp(shears, axis=3) ** 2, axis=1)
        size = 3.0 * np.max(np.sum(shears**2, axis=1), axis=2)
        high, low = high[:, sheared], low[:, sheared]
        swing, middle = (high - low) ** 2, np.maximum((high + low) / 2, 0.0)
        whole = np.sqrt(swing + square) / (2 * endurance) + np.sqrt(middle**2 + size) / strength
        # A smaller swing has a larger mean. Where shear is most of it, or means count for much, no more is known than this.
        wide = 2.0 * square if strength >= math.sqrt(2.0) * endurance else swing + square
        other = np.sqrt(wide) / (2 * endurance) + np.sqrt(np.maximum(high, 0.0) ** 2 + size) / strength
        bound[:, sheared] = np.maximum(whole, other)
    return bound, known


def _is_place(member: Output) -> bool:
    """Whether it is where something acts on a link, not how much."""
    return member.member == "station" or (member.group == "spread" and member.power is None)


def _places(body: Loaded, link: Link) -> Iterator[tuple[int, Any, Any, Notch | None]]:
    """Cells of the cross-section, ratios and the sides of them that are meant, and notches: those of :mod:`..strength.fatigue`."""
    breaks = body.course.breaks

    def cell_of(u: float, side: int) -> int:
        inside = [k for k, (a, b) in enumerate(itertools.pairwise(breaks)) if a <= u <= b]
        return inside[-1] if side > 0 else inside[0]

    for u in np.linspace(0.0, 1.0, _EVENLY).tolist():
        yield cell_of(u, 1), u, None, None
    for u, side in itertools.product(breaks, (-1, 1)):
        yield cell_of(u, side), u, u + side * _NEAR, None
    for mark, side, cell in itertools.product(body.marks, (-1, 1), range(len(breaks) - 1)):
        u = ca.fmin(ca.fmax(ca.SX(mark), breaks[cell]), breaks[cell + 1])
        yield cell, u, u + side * _NEAR, None
    for notch, side in itertools.product(link.beam.notches if link.beam else (), (-1, 1)):
        yield cell_of(notch.at, side), notch.at, notch.at + side * _NEAR, felt(notch)


def _scale(notch: Notch | None, force: str) -> float:
    if notch is None:
        return 1.0
    return notch.axial if force == "axial" else notch.bending if force.startswith("bending") else notch.shear

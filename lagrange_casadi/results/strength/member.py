"""A link as a part that may fail: its section law, and what it is made of, in numbers."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.bernstein import interpolation, product, value, within
from ...base.brief import Brief
from ...engine.section_function import Side
from ...engine.stress import FORCES, CrossSections
from ...engine.two_force_links import unaimed
from ...errors import DeclarationError, check_kind
from ...model.beams.beam import Beam
from ..laws import SectionLaw
from ..solution import Solution
from ..statistics import counted

_EXACT, _DEGREES, _NARROW = 1e-13, (0, 4, 8, 12), 2.0**-12
"""Tolerance of a polynomial for the factors of forces, its degrees, and the length of a part of a
link too short to cut.
"""

_TWIST = 1e-9


@dataclass(frozen=True, eq=False)
class Cell:
    """A part of a link, from one ratio to another, on which its cross-section is smooth.

    ``degree`` is that of polynomials that give what stresses take of section forces there.
    """

    low: float
    high: float
    member: Member
    index: int
    degree: int

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its fibres."""
        return self.member.cross.fibres(self.index).names

    def stresses(self, forces: Sequence[Array], low: Array, high: Array) -> Array:
        """Ordinates (n + 1, 3, fibres, parts, t) of stresses in parts of the cell from ``low`` to
        ``high`` (parts, t), by those of the section forces there, each (degree + 1, parts, t).
        """
        nodes, weights = interpolation(self.degree)
        wide = self.high - self.low
        factors = np.tensordot(weights, self.factors(self.high - wide * nodes), (1, 3))
        start, stop = (self.high - high) / wide, (self.high - low) / wide
        size = self.degree + len(forces[0]), 3, len(self.names), *forces[0].shape[1:]
        found = np.zeros(size)
        for k, force in enumerate(forces):
            for component in np.flatnonzero(factors[..., k].any(axis=(0, 2))):
                factor = factors[:, component, :, k, None, None]
                factor = within(factor, start, stop) if self.degree else factor
                found[:, component] += product(factor, force[:, None])
        return found

    def factors(self, u: Array) -> Array:
        """Factors of stresses, normal and along y and along z, by each force at ratios ``u``: (3,
        fibres, forces, u...).
        """
        return self.member.cross.factors(self.index, u)


@dataclass(frozen=True, eq=False, repr=False)
class Member(Brief):
    """A link of a solution with its beam, whose numbers are those of the solution's parameters."""

    link: str
    beam: Beam
    law: SectionLaw
    t: Array
    xi: Array
    space: bool

    @classmethod
    def of(cls, solution: Solution, link: str, *, spun: bool = False) -> Member:
        """A link of a solution; ``spun`` if what is asked of it is the same however a bar is turned
        about its line.

        Raises :class:`.DeclarationError` where the link has no beam, its sections were not wanted,
        equilibrium leaves its forces open, its cross-section bears torsion of which its stiffness
        is not known, or it is a bar whose cross-section is not round and has no declared direction.
        """
        check_kind("strength", solution, "a Solution", Solution)
        law, body = solution.section(link).law, solution.description.bodies[link]
        if not body.beam:
            having = ", ".join(solution.description.beams)
            raise DeclarationError(
                f"link '{link}' has no beam=; links with a beam: {having or 'none'}"
            )
        space = solution.description.space
        if indeterminate := [
            force for force in FORCES[space] if not solution.determined(f"section:{link}:{force}")
        ]:
            names = " and ".join(indeterminate)
            raise DeclarationError(
                f"link '{link}': equilibrium does not determine {names}, so its strength is not"
                " evaluated"
            )
        member = cls(link, body.beam, law, solution.t, solution.xi, space)
        member._check_torsion()
        two_force_links = solution.description.bars
        aimed = solution.description.beside
        if link in two_force_links and link not in aimed and not (spun or member.beam.round):
            raise DeclarationError(unaimed(link))
        return member

    @cached_property
    def counted(self) -> Member:
        """Member at the instants that count: see :func:`.counted`.

        Raises :class:`.DeclarationError` where none does.
        """
        counts = counted(np.moveaxis(self.at(np.tile([0.0, 1.0], (self.t.size, 1))), 1, 2))
        if counts.all():
            return self
        if not counts.any():
            raise DeclarationError(
                f"link '{self.link}': friction is at rest at all instants, so its strength is"
                " indeterminate"
            )
        return self.during(np.flatnonzero(counts))

    @cached_property
    def cross(self) -> CrossSections:
        """Cross-sections."""
        return CrossSections(self.beam, self.space)

    @property
    def forces(self) -> tuple[str, ...]:
        """The names of the section forces that stresses are made of."""
        return self.cross.forces

    def at(self, u: Array, side: Side = "tip", scale: Array | None = None) -> Array:
        """The section forces at ratios ``u`` (t, n), each times its ``scale``: (forces, t, n)."""
        values = np.stack([self.law.at(force, u, side) for force in self.forces])
        return values if scale is None else values * scale[:, None, None]

    def during(self, instants: slice | npt.NDArray[np.generic]) -> Member:
        """Member at some of the instants, a slice or their numbers."""
        return Member(
            self.link, self.beam, self.law.during(instants), self.t[instants], self.xi, self.space
        )

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """Parts of the link, in order along it."""
        breaks = self.beam.course.breaks
        return tuple(
            c for k, (a, b) in enumerate(itertools.pairwise(breaks)) for c in self._cells(k, a, b)
        )

    @property
    def degree(self) -> int:
        """The degree along the link of its section forces, between two marks."""
        return len(self.law.functions.moment) - 1

    @property
    def marks(self) -> list[Array]:
        """Ratios (t,) between which section forces are polynomials: stations, ends of loads, and
        breaks of the density.
        """
        still = np.zeros_like(self.t)
        breaks = [still + ratio for ratio in self.law.functions.breaks[0, 1:-1]]
        return [*(np.clip(load.station, 0.0, 1.0) for load in self.law.loads), *breaks]

    @cached_property
    def edges(self) -> Array:
        """Ratios (t, m) from 0 to 1 between which strains are smooth, in order at every instant."""
        still = np.zeros_like(self.t)
        fixed = [0.0, 1.0, *(cell.high for cell in self.cells[:-1])]
        return np.sort(np.stack([*self.marks, *(still + ratio for ratio in fixed)], axis=1), axis=1)

    @property
    def strain_degree(self) -> int:
        """The degree of polynomials that give strains between two edges."""
        changing = max(cell.degree for cell in self.cells)
        return self.degree + (changing + 6 if changing else 0)

    def index_at(self, u: Array) -> npt.NDArray[np.intp]:
        """The numbers of the parts of the beam, between breaks of its cross-section, in which
        ratios are.
        """
        inner = np.array(self.beam.course.breaks[1:-1])
        return np.searchsorted(inner, u, side="right")

    def cell_at(self, u: float, side: Side) -> Cell:
        """The part in which a ratio is; at a border that on one of its sides."""
        inside = [c for c in self.cells if c.low <= u <= c.high]
        return inside[-1] if side == "tip" else inside[0]

    def _cells(self, index: int, low: float, high: float) -> Iterator[Cell]:
        """A part as one cell, or where no polynomial gives what it should, cut in halves."""
        first, last = self.beam.course.cells[index]
        for degree in _DEGREES if first is not last else _DEGREES[:1]:
            nodes, weights = interpolation(degree)
            finer = np.linspace(0.0, 1.0, 2 * degree + 3)
            here, there = (
                np.moveaxis(self.cross.factors(index, low + (high - low) * x), -1, 0)
                for x in (nodes, finer)
            )
            values = value(np.tensordot(weights, here, 1), finer[:, None, None, None])
            # Of each force its own unit.
            size = np.abs(there).max(axis=(0, 1, 2))
            if np.all(np.abs(values - there) <= _EXACT * size) or (
                high - low < _NARROW and degree == _DEGREES[-1]
            ):
                yield Cell(low, high, self, index, degree)
                return
        middle = (low + high) / 2
        yield from self._cells(index, low, middle)
        yield from self._cells(index, middle, high)

    def _check_torsion(self) -> None:
        if not self.space or self.cross.properties(0, 0.0).torsion is not None:
            return
        ends = np.zeros((self.t.size, 1)) + np.linspace(0.0, 1.0, 9)
        twist, bending = (
            float(np.fmax.reduce(np.abs(self.law.at(force, ends)), axis=None))
            for force in ("torsion", "bending")
        )
        if twist > _TWIST * (twist + bending):
            kind = self.beam.course.cells[0][0].kind
            how = "use beams.given with its properties, torsion included, or beams.analysed"
            raise DeclarationError(
                f"link '{self.link}' carries torsion, and there is no formula for a {kind}; {how}"
            )

"""A link as a part that may fail: its section law, and what it is made of, in numbers."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.bernstein import interpolated, nodes, product, raised, value, within
from ...base.brief import Brief
from ...base.quantities import Output
from ...base.tables import table_of
from ...engine.model_data import ModelData
from ...engine.section_function import Side
from ...engine.section_stress import CrossSections
from ...engine.two_force_links import unaimed
from ...errors import DeclarationError
from ...model.beams.beam import Beam
from ...model.beams.properties import Properties
from ..histories import Histories
from ..pieces import Pieces
from ..section_laws import SectionLaw, law_for
from ..statistics import counted

_DEGREE, _NARROW = 12, 2.0**-12
"""Degree of polynomials for the factors of forces where the cross-section changes, and the length
of a part of a link too short to cut.
"""

CLOSE = 1e-9
"""Accuracy that is enough for fatigue."""

_TWIST = 1e-9

_STILL = 1e-9
"""Change of a place of a load, as a ratio xi/l, up to which it stands still."""


Span = tuple[float, float, int, int]
"""A part of a link: the first four numbers of a :class:`Cell`."""

Layout = tuple[Span, ...]
"""The parts of a link, in order along it."""


@dataclass(frozen=True, eq=False)
class Cell:
    """A part of a link, from one ratio to another, on which its cross-section is smooth: the number
    ``index`` of the part between two breaks of the cross-section.

    ``degree`` is that of polynomials that give what stresses take of section forces there.
    """

    low: float
    high: float
    index: int
    degree: int
    member: Member

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its fibres."""
        return self.member.cross.fibres(self.index).names

    @cached_property
    def polynomials(self) -> Array:
        """Ordinates (degree + 1, 3, fibres, forces, n) of :meth:`factors`; a shear stress along z
        alone has the place of one along y, for its size counts.
        """
        u = (self.high - (self.high - self.low) * nodes(self.degree))[:, None]
        found = interpolated(np.moveaxis(self.factors(u), 3, 0))
        turned = np.flatnonzero(~found[:, 1].any(axis=(0, 2, 3)))
        found[:, 1, turned], found[:, 2, turned] = found[:, 2, turned], 0.0
        return found

    def alone(self, *, sheared: bool) -> list[int]:
        """The fibres that are like no other one, with shear stresses or without."""
        shear = np.any(self.polynomials[:, 1:], axis=(0, 1, 3, 4))
        return [k for k in self.member.cross.fibres(self.index).alone if shear[k] == sheared]

    def components(self, fibres: Sequence[int]) -> int:
        """The number of components that stresses of some fibres have: normal stress, and shear
        stresses along y and along z.
        """
        every = self.polynomials[:, :, fibres].any(axis=(0, 2, 3, 4))
        return 1 + int(np.max(np.flatnonzero(every), initial=0))

    def parts(self, ends: Array) -> tuple[Array, Array]:
        """Cut parts of the link between ``ends`` (parts + 1, ...) to the cell: the begins and the
        ends of those that are in it, each (parts, ...).
        """
        inside = np.clip(ends, self.low, self.high)
        some = np.diff(inside, axis=0).reshape(len(ends) - 1, -1).any(axis=1)
        return inside[:-1][some], inside[1:][some]

    def forces(self, low: Array, high: Array, side: Side = "tip") -> list[Array]:
        """Ordinates (degree + 1, parts, t) of each section force in parts of the cell from ``low``
        to ``high`` (parts, t), on a side of places.
        """
        found = [pieces.parts(low, high, side) for pieces in self.member.pieces]
        return [raised(c, self.member.degree) for (c,) in found]

    def stresses(
        self,
        forces: Sequence[Array],
        low: Array,
        high: Array,
        fibres: Sequence[int] | slice = slice(None),
    ) -> Array:
        """Ordinates (n + 1, 3, fibres, parts, t) of the stresses of some fibres, by those of the
        section :meth:`forces`.
        """
        wide = self.high - self.low
        start, stop = (self.high - high) / wide, (self.high - low) / wide
        factors, many = self.polynomials[:, :, fibres], len(forces[0])
        rows = [np.moveaxis(force, 0, -2) for force in forces]
        unit = np.eye(many).reshape(many, *(1,) * low.ndim, many)
        shape = (self.degree + many, forces[0].shape[-1])
        found = np.zeros((*factors.shape[1:3], *forces[0].shape[1:-1], *shape))
        for component, factor in enumerate(np.moveaxis(factors, 1, 0)):
            some = np.flatnonzero(factor.any(axis=(0, 1, 3))).tolist()
            # Axes of parts, of designs, and of instants.
            taken = [factor[:, :, k, None, :, None] for k in some]
            taken = taken if low.ndim > 2 else [one[..., 0] for one in taken]
            taken = [within(one, start, stop) for one in taken] if self.degree else taken
            if self.degree and low.shape[-1] == 1:
                # The same at all instants: one matrix from ordinates of forces.
                matrices = [np.moveaxis(product(one, unit), 0, -2) for one in taken]
                if some:
                    matrix = np.concatenate(matrices, axis=-1)
                    found[component] = matrix @ np.concatenate([rows[k] for k in some], axis=-2)
            else:
                for one, k in zip(taken, some, strict=True):
                    found[component] += np.moveaxis(product(one, forces[k][:, None]), 0, -2)
        return np.moveaxis(found, -2, 0)

    def factors(self, u: Array) -> Array:
        """Factors of stresses, normal and along y and along z, by each force at ratios ``u``: (3,
        fibres, forces, u...).
        """
        return self.member.cross.factors(self.index, u)


@dataclass(frozen=True, eq=False, repr=False)
class Member(Brief):
    """A link of a solution with its beam, whose numbers are those of the solution's parameters; or
    of n designs, each with its own numbers, at t instants (n, t).

    ``accuracy`` is that of polynomials for the factors of forces. ``layout`` are its parts, if
    they are known.
    """

    link: str
    beam: Beam
    law: SectionLaw
    t: Array
    xi: Array
    space: bool
    accuracy: float = 1e-13
    layout: Layout = ()

    @classmethod
    def of(cls, solution: Histories, link: str, *, spun: bool = False) -> Member:
        """A link of a solution; ``spun`` if what is asked of it is the same however a bar is turned
        about its line.

        Raises :class:`.DeclarationError` where the link has no beam, its sections were not wanted,
        equilibrium leaves its forces open, its cross-section bears torsion of which its stiffness
        is not known, or it is a bar whose cross-section is not round and has no declared direction.
        """
        law, body = solution.section(link).law, solution.description.bodies[link]
        if not body.beam:
            having = ", ".join(solution.description.beams)
            raise DeclarationError(
                f"link '{link}' has no beam=; links with a beam: {having or 'none'}"
            )
        space = solution.description.space
        if indeterminate := [
            force
            for force in table_of(space).sections
            if not solution.determined(f"section:{link}:{force}")
        ]:
            names = " and ".join(indeterminate)
            raise DeclarationError(
                f"link '{link}': equilibrium does not determine {names}, so its strength is not"
                " evaluated"
            )
        member = cls(link, body.beam, law, solution.t, solution.xi, space)
        member._check_torsion()
        bar = link in solution.description.bars and link not in solution.description.beside
        if bar and not (spun or member.beam.round):
            raise DeclarationError(unaimed(link))
        return member

    @classmethod
    def of_designs(
        cls, data: ModelData, link: str, p: Array, outputs: Mapping[Output, Array]
    ) -> Member:
        """A link of n designs with parameters ``p`` (n, parameters), by ``outputs``, each (n, t),
        among which are those that its law is made of: as accurate as fatigue needs.
        """
        beam = data.template.each(data.content.beams[link], p)
        t = np.arange(next(iter(outputs.values())).shape[-1], dtype=float)
        law = law_for(data, link, outputs, p)
        return cls(link, beam, law, t, np.zeros(0), data.space, CLOSE)

    @cached_property
    def counts(self) -> npt.NDArray[np.bool_]:
        """True at the instants that count (t,): see :func:`.counted`."""
        return counted(np.moveaxis(self.at(np.tile([0.0, 1.0], (self.t.size, 1))), 1, 2))

    @cached_property
    def counted(self) -> Member:
        """Member at the instants that count.

        Raises :class:`.DeclarationError` where none does.
        """
        counts = self.counts
        if counts.all():
            return self
        if not counts.any():
            raise DeclarationError(
                f"link '{self.link}': friction is at rest at all instants, so its strength is"
                " indeterminate"
            )
        return self.during(np.flatnonzero(counts))

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of designs, if it is of some, and that of instants."""
        return self.law.coefficients["n0"].shape

    @property
    def still(self) -> npt.NDArray[np.bool_]:
        """True, of each design if it is of some, where no load moves along it."""
        return np.asarray(np.all(np.ptp(self.pieces[0].ends, axis=-1) <= _STILL, axis=0))

    @cached_property
    def cross(self) -> CrossSections:
        """Cross-sections."""
        return CrossSections(self.beam, self.space)

    @property
    def forces(self) -> tuple[str, ...]:
        """The names of the section forces that stresses are made of."""
        return self.cross.forces

    @cached_property
    def pieces(self) -> list[Pieces]:
        """These forces as polynomials along the link."""
        return [self.law.pieces(force) for force in self.forces]

    def at(self, u: Array, side: Side = "tip") -> Array:
        """The section forces at ratios ``u`` (t, n): (forces, t, n)."""
        return np.stack([self.law.at(force, u, side) for force in self.forces])

    def during(self, instants: slice | npt.NDArray[np.generic]) -> Member:
        """Member at some of the instants, a slice or their numbers."""
        return replace(self, law=self.law.during(instants), t=self.t[instants])

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """Parts of the link, in order along it; designs must have the same ones."""
        layout = self.layout or next(iter(self.alike))[0]
        return tuple(Cell(*span, self) for span in layout)

    @cached_property
    def alike(self) -> dict[tuple[Layout, int], list[int]]:
        """The numbers of designs that have the same layout, and no load that moves along them; of
        another one its own number stands by its layout.
        """
        many = self.shape[0] if len(self.shape) > 1 else 1
        layouts: list[list[Span]] = [[] for _ in range(many)]
        for k, (low, high) in enumerate(itertools.pairwise(self.beam.course.breaks)):
            for span, designs in self._spans(k, low, high, np.arange(many)):
                for design in designs.tolist():
                    layouts[design].append(span)
        still = np.broadcast_to(self.still, many).tolist()
        found: dict[tuple[Layout, int], list[int]] = {}
        for k, layout in enumerate(layouts):
            found.setdefault((tuple(layout), -1 if still[k] else k), []).append(k)
        return found

    @property
    def degree(self) -> int:
        """The degree along the link of its section forces, between two marks."""
        return len(self.law.functions.ordinates[1]) - 1

    @cached_property
    def edges(self) -> Array:
        """Ratios (t, m) from 0 to 1 between which strains are smooth, in order at every instant:
        stations, ends of loads, and breaks of the density and of the cross-section.
        """
        cuts = [*(cell.high for cell in self.cells[:-1]), *self.law.functions.breaks[0, 1:-1]]
        fixed = np.tile([0.0, 1.0, *cuts], (self.t.size, 1))
        load_points = [np.clip(load.station, 0.0, 1.0) for load in self.law.loads]
        return np.sort(np.column_stack([fixed, *load_points]), axis=1)

    @property
    def strain_degree(self) -> int:
        """The degree of polynomials that give strains between two edges."""
        return self.degree + max(cell.degree for cell in self.cells)

    def properties(self, u: Array) -> Iterator[tuple[npt.NDArray[np.bool_], Properties]]:
        """The properties of cross-sections at ratios, of each part of the beam between breaks:
        which ratios are in the part, as marks, and the properties at these.
        """
        index = np.searchsorted(np.array(self.beam.course.breaks[1:-1]), u, side="right")
        for cell in np.unique(index).tolist():
            here = index == cell
            yield here, self.cross.properties(cell, u[here])

    def cell_at(self, u: float, side: Side) -> Cell:
        """The part in which a ratio is; at a border that on one of its sides."""
        inside = [c for c in self.cells if c.low <= u <= c.high]
        return inside[-1] if side == "tip" else inside[0]

    def _spans(
        self, index: int, low: float, high: float, designs: npt.NDArray[np.intp]
    ) -> Iterator[tuple[Span, npt.NDArray[np.intp]]]:
        """A part as one span, or where no polynomial gives what it should, cut in halves: with the
        designs for which it is so.
        """
        first, last = self.beam.course.cells[index]
        if first is last:
            yield (low, high, index, 0), designs
            return

        def factors(x: Array) -> Array:
            found = self.cross.factors(index, low + (high - low) * x[:, None])
            return np.moveaxis(found[:, self.cross.fibres(index).alone], 3, 0)

        # The ends, and places between nodes.
        x = (1.0 - np.cos(np.pi * np.arange(_DEGREE + 2) / (_DEGREE + 1))) / 2.0
        expected = factors(x)
        # Of each force, and of each design, its own unit.
        most = self.accuracy * np.abs(expected).max(axis=(0, 1, 2))
        values = value(interpolated(factors(nodes(_DEGREE))), x.reshape(-1, 1, 1, 1, 1))
        fits = np.all(np.abs(values - expected) <= most, axis=(0, 1, 2, 3)) | (high - low < _NARROW)
        some = np.broadcast_to(fits, self.shape[:-1] or 1)[designs]
        if some.any():
            yield (low, high, index, _DEGREE), designs[some]
        if not some.all():
            middle = (low + high) / 2
            yield from self._spans(index, low, middle, designs[~some])
            yield from self._spans(index, middle, high, designs[~some])

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

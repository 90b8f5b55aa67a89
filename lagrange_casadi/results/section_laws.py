"""The section law of a link as numbers: the coefficients of its section forces over time, and what
acts on it at load points (:mod:`.loads`); and the same from outputs.

In space a link has two planes of bending, each like that of a planar link, and torsion, which only
the ends, load points and couples of slices change.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..base.arrays import Array, Instants, Operand, during
from ..base.bernstein import raised
from ..base.brief import Brief
from ..base.quantities import Output, parts_along
from ..base.tables import PLANE, SPACE, Table
from ..engine.instants import grids
from ..engine.model_data import ModelData
from ..engine.section_function import SIDES, Side, edge
from ..model.limits import END
from ..model.link_density import NumericDensity
from .link_loads import DistributedLoad, PointLoad, distributed_load
from .pieces import Basis, Component, Pieces, Rows, basis_of
from .vector_sizes import most

_BLOCK = 1 << 15
"""Parts of links, at all instants, that are looked at together."""


@dataclass(frozen=True, eq=False, repr=False)
class SectionLaw(Brief):
    """Section forces of one link: ``coefficients`` by name, each (t,); length [m], density, loads
    at load points, and ``distributed_loads``.

    The coefficients are the seven of a planar mechanism or the twelve of a spatial one;
    :attr:`table` says which. ``slack`` is the distance of a load point from a section, as a ratio
    to the length, up to which it is at the section: see :func:`.edge`.
    """

    length: float
    density: NumericDensity
    coefficients: Mapping[str, Array]
    loads: tuple[PointLoad, ...] = ()
    distributed_loads: tuple[DistributedLoad, ...] = ()
    slack: float = END["double"]

    @cached_property
    def table(self) -> Table:
        """Table of the forces, and of the terms of each."""
        return PLANE if PLANE.law[-1] in self.coefficients else SPACE

    @cached_property
    def functions(self) -> Basis:
        """The functions along the link of which its forces are combined; loads along the link are
        where they are at the first instant.
        """
        powers = tuple([load.powers for load in self.distributed_loads])
        if isinstance(self.length, float):
            spans = tuple(
                [(float(load.width[0]), float(load.end[0])) for load in self.distributed_loads]
            )
            return basis_of(self.length, self.density, spans, powers)
        ends = [(load.width[..., :1], load.end[..., :1]) for load in self.distributed_loads]
        return Basis.of(self.length, self.density, ends, powers)

    def basis(self, xi: Array) -> Rows:
        """The functions along the link at ratios ``xi`` of any shape; they serve every force, and
        the law at any instants.
        """
        return self.functions.at(np.asarray(xi, dtype=float))

    def on_grid(self, force: str, xi: Array) -> Array:
        """A force at every instant and every ratio ``xi``, of shape (t, xi); at a station, on its
        tip side.

        One thread a core shares a grid that is worth it; the bits do not depend on it. Raises
        :class:`SizeError` where there is less memory than that.
        """
        out = grids.empty(f"a grid of {force}", (self.coefficients["n0"].size, xi.size))
        self.on_grids((force,), xi, out[None])
        return out

    def on_grids(
        self,
        forces: Sequence[str],
        xi: Array,
        out: Array,
        threads: int | None = None,
    ) -> None:
        """Fill ``out`` (forces, t, xi) with the grids that :meth:`on_grid` gives, by one call."""
        rows = self.basis(xi)
        grids.fill([self._sum(force, rows) for force in forces], rows.u, out, threads, self.slack)

    def largest(self, force: str, rows: Rows) -> Array:
        """Largest size of a force over the instants, (n, xi), for n laws whose members are (n, t),
        length and density (n, 1).

        It has its sign, the positive one where both are as large, and is NaN of a law that is not
        finite throughout.
        """
        return grids.largest(self._sum(force, rows), rows.u, self.slack)

    def during(self, instants: Instants) -> SectionLaw:
        """The law at some of the instants."""
        return replace(
            self,
            coefficients=during(self.coefficients, instants),
            loads=during(self.loads, instants),
            distributed_loads=during(self.distributed_loads, instants),
        )

    def at(self, force: str, xi: Operand, side: Side = "tip") -> Array:
        """A force at ratios of shape (t, ...), one row an instant; ``side`` says which value is
        meant at a station.
        """
        return self.pieces(force).at(np.asarray(xi, dtype=float), side)

    def of(self, link: str, outputs: Mapping[Output, Array]) -> SectionLaw:
        """The law of the same link by other numbers, among ``outputs``."""
        return replace(law_of(link, outputs, self.length, self.density), slack=self.slack)

    def changed(self, changes: SectionLaw, xi: Array) -> Iterator[tuple[str, Array]]:
        """Change of each force that is no resultant, (t, n), or with load points, also at each of
        them and from both sides, (sides, t, n + load points).

        ``changes`` has the changes of the law's numbers in their places; ``xi`` (n,) are ratios. A
        section sees what it saw before the change: that a load point moves is no change by itself.
        """
        now = self.coefficients["n0"]
        load_points = [np.clip(load.station, 0.0, 1.0) for load in self.loads]
        u = np.stack([*(np.full_like(now, ratio) for ratio in xi), *load_points], axis=-1)
        # Mostly no place moves, and one instant's functions serve all.
        at = u[0] if (u == u[0]).all() else u
        moved = replace(
            self,
            distributed_loads=tuple(
                replace(load, width=load.width + change.width, end=load.end + change.end)
                for load, change in zip(
                    self.distributed_loads, changes.distributed_loads, strict=True
                )
            ),
        )
        rows, others = self.basis(at), moved.basis(at)
        beyond = np.stack([edge(u, self.slack, side) for side in SIDES])
        for force in self.table.sections:
            gap: Array = np.zeros(u.shape)
            for term, change in zip(self._terms(force), changes._terms(force), strict=True):
                after = term.of(others)
                gap += change.column[:, None] * after
                gap += term.column[:, None] * (after - term.of(rows))
            for load, shift in zip(self._steps(force), changes._steps(force), strict=True):
                station, _, slope = (values[:, None] for values in load)
                going, more, steeper = (values[:, None] for values in shift)
                carried = more + steeper * (station + going - u) + slope * going
                gap = gap + np.where(beyond < station, carried, 0.0)
            yield force, gap

    def bound(self, force: str, xi: Array) -> float:
        """The largest size that a force may have at ratios ``xi`` if coefficients and loads have
        any sign.
        """
        rows, found = self.basis(xi), list[float]()
        for part in self._parts(force):
            terms = self._terms(part)
            size = np.asarray(sum(abs(term.column)[:, None] * abs(term.of(rows)) for term in terms))
            for _, constant, slope in self._steps(part):
                size = size + (np.abs(constant) + np.abs(slope))[:, None]
            found.append(most(size))
        return math.hypot(*found)

    def extreme(self, force: str) -> tuple[Array, Array]:
        """The ratio at which a force is largest in size, and the force there, at every instant,
        both of shape (t,).
        """
        places, values = self.reached(force, [np.abs])
        return places[0], values[0]

    def reached(
        self,
        force: str,
        sizes: Sequence[Callable[[Array], Array]] = (np.negative, np.positive, np.abs),
    ) -> tuple[Array, Array]:
        """Places along a link at which a force is smallest, largest, and largest in size, or at
        which other ``sizes`` of it are largest, and its values: (3, t).

        They are sought over few instants after another, so that these stay at hand.
        """
        height = max(1, _BLOCK // (len(self.functions.breaks[0]) + len(self.loads)))
        starts = range(0, self.coefficients["n0"].size, height)
        found = [self.during(slice(i, i + height)).pieces(force).reached(sizes) for i in starts]
        places, values = (np.concatenate(rows, axis=-1) for rows in zip(*found, strict=True))
        return places, values

    def pieces(self, force: str) -> Pieces:
        """A force as polynomials along the link."""
        components = [self._component(part) for part in self._parts(force)]
        return Pieces(self.functions.along(self.functions.breaks[None])[0], components, self.slack)

    def _component(self, force: str) -> Component:
        """A force that is no resultant."""
        first, *others = self._terms(force)
        basis, steps = self.functions, self._steps(force)
        cells = basis.breaks.shape[1] - 1, *first.column.shape
        if not others:
            return Component(first.column, np.zeros((1, *cells)), np.zeros((1, *cells)), steps)
        degree = len(basis.ordinates[first.moment]) - 1
        ordinates, slope = np.zeros((degree + 1, *cells)), np.zeros((degree, *cells))
        for term in others:
            rows = basis.ordinates[term.moment][:, term.row]
            ordinates += raised(basis.along(rows), degree) * term.column
            rates = basis.slopes[term.moment][:, term.row - 1]
            slope += raised(basis.along(rates), degree - 1) * term.column
        return Component(first.column, ordinates, slope, steps)

    def _parts(self, force: str) -> tuple[str, ...]:
        """The forces whose size a force is, or itself."""
        return self.table.parts("section", force)

    def _sum(self, force: str, rows: Rows) -> grids.Sum:
        """Terms of a force, or of all that it is the size of, one after another."""
        if force in self._kept:
            columns, moment = self._kept[force]
            return columns, rows.functions[moment]
        parts = self._parts(force)
        terms = [self._terms(part) for part in parts]
        columns = grids.Columns(
            [one.column for of_part in terms for one in of_part],
            [step for part in parts for step in self._steps(part)],
            len(parts),
        )
        moment = terms[0][0].moment
        if self.distributed_loads:
            return columns, grids.Functions(np.stack([one.of(rows) for one in terms[0]]))
        own = {id(values) for values in self.coefficients.values()}
        if all(id(row) in own for row in columns.arrays):
            self._kept[force] = columns, moment
        return columns, rows.functions[moment]

    @cached_property
    def _kept(self) -> dict[str, tuple[grids.Columns, bool]]:
        """Columns of forces that consist of arrays of this law, which stay where they are, and
        whether they are those of a bending moment.
        """
        return {}

    def _terms(self, force: str) -> list[Term]:
        """The terms of a force that is no resultant, that of the tip first.

        Of loads along the link each force has its own direction, with the arm of a moment, and
        couples of slices without.
        """
        members = self.table.sections[force]
        moment, sign = bool(members.arm), members.arm or 1
        law = [self.coefficients[name] for name in members.coefficients]
        found = [
            Term(column if sign > 0 or not row else -column, moment, row)
            for row, column in enumerate(law)
        ]
        first = 3
        for load in self.distributed_loads:
            across = load.terms.get(members.distributed, ())
            found += [
                Term(sign * column, moment, first + moment + j) for j, column in enumerate(across)
            ]
            couples = load.terms.get(members.couple, ())
            found += [Term(column, False, first + j) for j, column in enumerate(couples)]
            first += load.powers
        return found

    def _steps(self, force: str) -> list[grids.Load]:
        """Steps of a force that is no resultant, one of each load point."""
        members, found = self.table.sections[force], []
        for load in self.loads:
            constant = load.acts[members.acting]
            slope = np.zeros_like(constant)
            if members.arm:
                across = load.acts[self.table.sections[members.shear].acting]
                slope = members.arm * across * self.length
            found.append((load.station, constant, slope))
        return found


@dataclass(frozen=True, eq=False)
class Term:
    """A number over time, ``column``, and the row of the functions along a link that goes with it:
    of those of a moment, or of a force.
    """

    column: Array
    moment: bool
    row: int

    def of(self, rows: Rows) -> Array:
        """The function at ratios."""
        return np.asarray(rows.functions[self.moment].rows[self.row])


def law_of(
    link: str,
    outputs: Mapping[Output, Array],
    length: float,
    density: NumericDensity,
    precision: str = "double",
) -> SectionLaw:
    """The law of a link of a length [m] and a density, by those of ``outputs`` that go into it,
    evaluated in a precision.

    Raises ``ValueError`` where a load along the link is not whole.
    """
    found: dict[str, dict[str, dict[str, Array]]] = {"law": {}, "station": {}, "spread": {}}
    terms: dict[str, dict[str, dict[int, Array]]] = {}
    for output, values in parts_along(outputs, link).items():
        if output.power is None:
            found[output.group].setdefault(output.load_point, {})[output.member] = values
        else:
            load = terms.setdefault(output.load_point, {})
            load.setdefault(output.member, {})[output.power] = values
    law, points, ends = found["law"].get("", {}), found["station"], found["spread"]
    return SectionLaw(
        length,
        density,
        law,
        tuple(PointLoad(name, acts.pop("station"), acts) for name, acts in points.items()),
        tuple(distributed_load(name, ends.get(name, {}), of) for name, of in terms.items()),
        END["single" if precision == "single" else "double"],
    )


def law_for(
    data: ModelData,
    link: str,
    outputs: Mapping[Output, Array],
    p: Array,
    precision: str = "double",
) -> SectionLaw:
    """The law of a link by outputs (t,), as of :func:`law_of`, for parameters ``p`` (parameters,).

    Or the laws of n designs (n, parameters): outputs and the laws' members are (n, t), length and
    density (n, 1).
    """
    content = data.content.bodies[link].length_and_density
    length, density = data.template.each(content, p)
    if p.ndim > 1:
        length = np.zeros((len(p), 1)) + np.reshape(length, (-1, 1))
    return law_of(link, outputs, length, density, precision)


def made_of(outputs: Iterable[Output], link: str, force: str, table: Table = PLANE) -> list[Output]:
    """The outputs, among others, that a force of a link is made of;
    without the places of stations.
    """
    terms = [table.sections[part] for part in table.parts("section", force)]
    coefficients = {name for of in terms for name in of.coefficients}
    members = {of.acting for of in terms} | {
        table.sections[of.shear].acting for of in terms if of.arm
    }
    return [
        output
        for output in parts_along(dict.fromkeys(outputs), link)
        if output.member in (members if output.load_point else coefficients)
    ]

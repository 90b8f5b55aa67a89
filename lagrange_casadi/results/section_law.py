"""The section law of a link as numbers: its forces at any ratio xi/l, and where along the link they
peak.

With u = xi/l the forces are those of the material beyond the section, whose moments :mod:`.density`
gives, and of what acts on the link beyond it: at the tip (n0, f0, m0), at stations in between, each
seen by the sections on its base side, and along the link (:mod:`.loads`). In space a link has two
planes of bending, each like that of a planar link, and torsion, which nothing but the ends and
stations changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Instants, Operand, during
from ..base.brief import Brief
from ..base.quantities import Output
from ..base.space import require
from ..base.tables import PLANE, SPACE, Table
from ..engine.instants import grids
from ..engine.section_function import SIDES, Side, edge
from ..model.density import NumericDensity
from ..model.limits import END
from .basis import Basis
from .loads import AnyPointLoad, DistributedLoad, PointLoad
from .sizes import growth_of_size, size_of, slope_of_size
from .turning import StationaryPoints, stationary_points, zeros_of_shear, zeros_of_uniform_shear

__all__ = ["Basis", "SectionLaw", "Side", "PointLoad"]

_BLOCK = 1 << 15


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
    loads: tuple[AnyPointLoad, ...] = ()
    distributed_loads: tuple[DistributedLoad, ...] = ()
    slack: float = END["double"]

    @cached_property
    def table(self) -> Table:
        """Table of the forces, and of the terms of each."""
        return PLANE if PLANE.law[-1] in self.coefficients else SPACE

    def _parts(self, force: str) -> tuple[str, ...]:
        """The forces whose size a force is, or itself."""
        return self.table.parts("section", force)

    def basis(self, xi: Array) -> Basis:
        """The functions along the link at ratios ``xi`` of any shape; they serve every force, and
        the law at any instants.
        """
        return Basis(np.asarray(xi, dtype=float), self.length, self.density, self.distributed_loads)

    def on_grid(
        self, force: str, xi: Array | Basis, out: Array | None = None, threads: int | None = None
    ) -> Array:
        """A force at every instant and every ratio ``xi``, of shape (t, xi), in ``out`` where
        given; at a station, on its tip side.

        Where several forces are wanted, a :meth:`basis` of the ratios serves all. By default one
        thread a core shares a grid that is worth it; the bits do not depend on it. Raises
        :class:`SizeError` where there is less memory than that.
        """
        size = (self.coefficients["n0"].size, xi.u.size if isinstance(xi, Basis) else xi.size)
        if out is None:
            require(f"a grid of {force}", size)
            out = grids.empty(f"a grid of {force}", size)
        self.on_grids((force,), xi, out[None], threads)
        return out

    def on_grids(
        self,
        forces: Sequence[str],
        xi: Array | Basis,
        out: Array,
        threads: int | None = None,
    ) -> None:
        """Fill ``out`` (forces, t, xi) with the grids that :meth:`on_grid` gives, by one call."""
        basis = xi if isinstance(xi, Basis) else self.basis(xi)
        sums = [self._sum(force, basis) for force in forces]
        grids.fill(sums, basis.u, out, threads, self.slack)

    def largest(self, force: str, basis: Basis) -> Array:
        """Largest size of a force over the instants, (n, xi), for n laws whose members are (n, t),
        length and density (n, 1).

        It has its sign, the positive one where both are as large, and is NaN of a law that is not
        finite throughout.
        """
        return grids.largest(self._sum(force, basis), basis.u, self.slack)

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
        u = np.asarray(xi, dtype=float)
        if len(parts := self._parts(force)) > 1:
            return size_of(self.at(part, u, side) for part in parts)
        values = self._smooth(force, u)
        for load in self.loads:
            load_point = _column(load.station, u)
            values = values + self._beyond(force, load, u, edge(u, self.slack, side) < load_point)
        return values

    def outputs(self, link: str) -> dict[Output, Array]:
        """The numbers in it, as outputs of a link."""
        found = {Output("law", link, name): values for name, values in self.coefficients.items()}
        for load in self.loads:
            for member in self.table.place_first:
                found[Output("station", link, member, load.name)] = getattr(load, member)
        for distributed in self.distributed_loads:
            found |= distributed.outputs(link)
        return found

    def of(self, link: str, outputs: Mapping[Output, Array]) -> SectionLaw:
        """The law of the same link with other numbers in it, (..., t)."""
        coefficients = {name: outputs[Output("law", link, name)] for name in self.coefficients}
        loads = tuple(
            type(load)(
                load.name,
                *(
                    outputs[Output("station", link, member, load.name)]
                    for member in self.table.place_first
                ),
            )
            for load in self.loads
        )
        return replace(
            self,
            coefficients=coefficients,
            loads=loads,
            distributed_loads=tuple(s.of(link, outputs) for s in self.distributed_loads),
        )

    def changed(self, changes: SectionLaw, xi: Array) -> dict[str, tuple[Array, Array]]:
        """Change of every force with its coefficients, loads and load points, and the sum of the
        sizes of all its terms.

        ``changes`` has the changes in the places of the numbers, each (..., t). They are looked at
        at ratios ``xi`` (n,) and at every station, from both sides: (..., t, n + stations, sides).
        The sizes are (t, n + stations, sides). A section sees what it saw before the change: that a
        station moves is no change by itself.
        """
        load_points = [np.clip(load.station, 0.0, 1.0) for load in self.loads]
        u = np.stack(
            [*(np.full_like(self.coefficients["n0"], ratio) for ratio in xi), *load_points], axis=-1
        )
        crossed = [
            [edge(u, self.slack, side) < load.station[:, None] for side in SIDES]
            for load in self.loads
        ]
        basis, found = self.basis(u), {}
        for force in self.table.sections:
            columns, functions = self._terms(force, basis)
            rows = functions.rows
            gaps = sum(
                change[..., None] * row
                for change, row in zip(changes._terms(force, basis)[0], rows, strict=False)
            )
            sizes = sum(
                np.abs(column[:, None] * row) for column, row in zip(columns, rows, strict=False)
            )
            terms = self.table.sections[force]
            for distributed, moving in zip(
                self.distributed_loads, changes.distributed_loads, strict=True
            ):
                gaps = gaps + (terms.arm or 1) * distributed.moved(
                    terms.distributed, moving, u, self.length, arm=bool(terms.arm)
                )
                gaps = gaps + distributed.moved(terms.couple, moving, u, self.length, arm=False)
            gaps, sizes = (
                np.repeat(values[..., None], len(SIDES) if self.loads else 1, axis=-1)
                for values in (gaps, sizes)
            )
            for load, change, there in zip(self.loads, changes.loads, crossed, strict=True):
                load_point, constant, slope = (
                    values[:, None] for values in self._acting(force, load)
                )
                moved, more, steeper = (values[..., None] for values in self._acting(force, change))
                gap = more + steeper * (load_point + moved - u) + slope * moved
                size = np.abs(constant) + np.abs(slope * (load_point - u))
                for k, visible in enumerate(there):
                    gaps[..., k] += np.where(visible, gap, 0.0)
                    sizes[..., k] += np.where(visible, size, 0.0)
            found[force] = gaps, sizes
        for force in self.table.forces:
            if len(parts := self._parts(force)) > 1:
                values = [
                    np.stack([self.at(part, u, side) for side in SIDES[: gaps.shape[-1]]], axis=-1)
                    for part in parts
                ]
                gap = growth_of_size(values, [found[part][0] for part in parts])
                found[force] = gap, size_of(found[part][1] for part in parts)
        return found

    def along(self, force: str, xi: npt.ArrayLike, side: Side = "tip") -> Array:
        """The derivative of a force by the ratio, at ratios of shape (t, ...)."""
        u = np.asarray(xi, dtype=float)
        if len(parts := self._parts(force)) > 1:
            return slope_of_size(
                [self.at(part, u, side) for part in parts],
                [self.along(part, u, side) for part in parts],
            )
        terms = self.table.sections[force]
        # No part of the link is beyond its ends.
        part = np.clip(u + (1e-12 if side == "tip" else -1e-12), 1e-12, 1.0 - 1e-12)
        if terms.arm:
            bent = terms.arm * self.at(terms.shear, u, side) + self._turned(force, u, part)
            return np.asarray(-self.length * bent)
        return self._falling(force, u, part)

    def _falling(self, force: str, u: Array, middle: Array) -> Array:
        """The derivative of a force that has no arm, where loads along the link act that act at the
        ``middle`` of its part.
        """
        terms = self.table.sections[force]
        if len(terms.coefficients) == 1:
            return np.asarray(-self.length * self._turned(force, u, middle))
        first, second = (_column(self.coefficients[name], u) for name in terms.coefficients[1:])
        slope = -self.density.at(u) * (first + self.length * u * second)
        return np.asarray(
            slope
            - sum(
                self.length * distributed.here(terms.distributed, u, middle)
                for distributed in self.distributed_loads
            )
        )

    def _turned(self, force: str, u: Array, middle: Array) -> Array:
        """The couple per length that the rotary inertia of slices puts into a moment."""
        couple, found = self.table.sections[force].couple, np.zeros(u.shape)
        for distributed in self.distributed_loads:
            if couple in distributed.terms:
                found = found + distributed.here(couple, u, middle)
        return found

    def rate(self, force: str, rates: SectionLaw, xi: Array, side: Side = "tip") -> Array:
        """The time derivative of a force at ratios of shape (t, ...) that stand still, or, at a
        station, move with it.

        ``rates`` has the time derivatives of coefficients, loads and stations in their places.
        """
        u = np.asarray(xi, dtype=float)
        if len(parts := self._parts(force)) > 1:
            return slope_of_size(
                [self.at(part, u, side) for part in parts],
                [self.rate(part, rates, u, side) for part in parts],
            )
        # Loads along the link grow where they are.
        distributed_loads = tuple(
            replace(distributed, terms=change.terms)
            for distributed, change in zip(
                self.distributed_loads, rates.distributed_loads, strict=True
            )
        )
        values = replace(rates, loads=(), distributed_loads=distributed_loads).at(force, u, side)
        passing = np.zeros(u.shape)
        for load, change in zip(self.loads, rates.loads, strict=True):
            load_point, _, slope = (_column(values, u) for values in self._acting(force, load))
            going, more, steeper = (_column(values, u) for values in self._acting(force, change))
            # A station that moves takes its force's arm with it.
            crossed = edge(u, self.slack, side) < load_point
            values = values + np.where(
                crossed, more + slope * going + steeper * (load_point - u), 0.0
            )
            passing = np.where(u == load_point, going, passing)
        return values + passing * self.along(force, u, side) if self.loads else values

    def bound(self, force: str, xi: Array) -> float:
        """The largest size that a force may have at ratios ``xi`` where coefficients and loads have
        any sign.
        """
        if len(parts := self._parts(force)) > 1:
            return math.hypot(*(self.bound(part, xi) for part in parts))
        bare = replace(self, distributed_loads=())
        columns, functions = bare._terms(force, bare.basis(xi))
        size = sum(
            np.abs(column)[:, None] * np.abs(row)
            for column, row in zip(columns, functions.rows, strict=False)
        )
        for distributed in self.distributed_loads:
            size = size + distributed.bound(
                self.table.sections[force].distributed,
                self.length,
                arm=bool(self.table.sections[force].arm),
            )
            size = size + distributed.bound(
                self.table.sections[force].couple, self.length, arm=False
            )
        for load in self.loads:
            _, constant, slope = self._acting(force, load)
            size = size + (np.abs(constant) + np.abs(slope))[:, None]
        return float(np.max(size, initial=0.0))

    def extreme(self, force: str) -> tuple[Array, Array]:
        """The ratio at which a force is largest in size, and the force there, at every instant,
        both of shape (t,).
        """
        blocks = [block._extreme(force) for block in self._blocks(force)]
        return np.concatenate([place for place, _ in blocks]), np.concatenate(
            [value for _, value in blocks]
        )

    def reached(self, force: str) -> tuple[Array, Array]:
        """Places along a link at which a force is smallest, largest, and largest in size as by
        :meth:`extreme`, and its values: (3, t).
        """
        blocks = [block._reached(force) for block in self._blocks(force)]
        return np.concatenate([place for place, _ in blocks], axis=1), np.concatenate(
            [value for _, value in blocks], axis=1
        )

    def _blocks(self, force: str) -> list[SectionLaw]:
        """The law over few instants after another, so that what is sought at them stays at hand."""
        many = len(self._parts(force)) > 1 or self.distributed_loads
        iterations = (2 * self._highest + 4) * len(self.density.cells) if many else 1
        height = (
            max(1, _BLOCK // (iterations * (len(self._marked) + 1))) if iterations > 1 else _BLOCK
        )
        return [
            self.during(slice(i, i + height))
            for i in range(0, self.coefficients["n0"].size, height)
        ]

    def _reached(self, force: str) -> tuple[Array, Array]:
        places, values = self._marks(force, all_rotations=True)
        columns = np.stack(
            [
                np.argmin(values, axis=1),
                np.argmax(values, axis=1),
                np.argmax(np.abs(values), axis=1),
            ]
        )
        every = np.arange(len(values))
        return places[every, columns], values[every, columns]

    def _extreme(self, force: str) -> tuple[Array, Array]:
        places, values = self.curves(force)
        best = np.argmax(np.abs(values), axis=1)[:, None]
        return np.take_along_axis(places, best, 1)[:, 0], np.take_along_axis(values, best, 1)[:, 0]

    def curves(self, force: str) -> tuple[Array, Array]:
        """Ratios among which a force is largest in size at every instant, and the force there, both
        of shape (t, k).

        They are those of the base, the tip, every station, once for each of its sides, and between
        two stations that at which the force turns along the link, or else the end that is next to
        that; of a resultant its two largest summits there. So each is a smooth curve over time, as
        long as no station passes another one and no summit of a resultant comes or goes. Where
        loads act along the link, stations are also where these begin and end and where the density
        jumps, and every force is looked at as resultants are.
        """
        return self._marks(force, all_rotations=False)

    def _marks(self, force: str, *, all_rotations: bool) -> tuple[Array, Array]:
        """The same; or of a resultant wherever it turns, its smallest sizes too."""
        still = np.zeros_like(self.coefficients["n0"])
        load_points = self._marked
        places = np.stack(
            [still, still + 1.0, *(load_point for load_point in load_points for _ in range(2))],
            axis=1,
        )
        values = self.at(force, places)
        values[:, 3::2] = self.at(force, places[:, 3::2], side="base")
        inner = np.sort(np.stack([still, *load_points, still + 1.0], axis=1), axis=1)
        low, high = inner[:, :-1], inner[:, 1:]
        beyond = [edge(low, self.slack) < load.station[:, None] for load in self.loads]

        def within(name: str, u: Array) -> Array:
            if len(parts := self._parts(name)) > 1:
                return size_of(within(part, u) for part in parts)
            masks = (mask.reshape(mask.shape + (1,) * (u.ndim - mask.ndim)) for mask in beyond)
            after = (
                self._beyond(name, load, u, mask)
                for load, mask in zip(self.loads, masks, strict=True)
            )
            return np.asarray(self._smooth(name, u) + sum(after))

        parts = self._parts(force)
        if len(parts) == 1 and not self.distributed_loads:
            found = self._turning(force, within, low, high)
        elif (
            force in self.table.sections
            and len(self.table.sections[force].coefficients) == 1
            and not self._thick
        ):
            found = []
        else:
            iterations = self._turns_of_size(parts, within, low, high)
            found = (
                list(np.moveaxis(iterations.places, -1, 0))
                if all_rotations
                else iterations.maxima(np.abs(within(force, iterations.places)))
            )
        return np.hstack([places, *found]), np.hstack(
            [values, *(within(force, place) for place in found)]
        )

    @property
    def _marked(self) -> list[Array]:
        """Ratios of the places at which something begins or ends to act between base and tip, each
        (t,).
        """
        marks = [
            *(load.station for load in self.loads),
            *(mark for distributed in self.distributed_loads for mark in distributed.marks),
        ]
        if self.distributed_loads:
            marks += [np.full_like(self.coefficients["n0"], jump) for jump in self.density.jumps]
        return [np.clip(mark, 0.0, 1.0) for mark in marks]

    def _sum(self, force: str, basis: Basis) -> grids.Sum:
        """Terms of a force, or of all that it is the size of, one after another."""
        if force in self._kept:
            columns, bends = self._kept[force]
            return columns, basis.functions[bends]
        parts = self._parts(force)
        terms = [self._terms(part, basis) for part in parts]
        columns = grids.Columns(
            [column for of_part, _ in terms for column in of_part],
            [self._acting(part, load) for part in parts for load in self.loads],
            len(parts),
        )
        own = {id(values) for values in self.coefficients.values()}
        if all(id(row) in own for row in columns.arrays):
            self._kept[force] = columns, bool(self.table.sections[parts[0]].arm)
        return columns, terms[0][1]

    @cached_property
    def _kept(self) -> dict[str, tuple[grids.Columns, bool]]:
        """Columns of forces that consist of arrays of this law, which stay where they are, and
        whether they are those of a bending moment.
        """
        return {}

    @property
    def _thick(self) -> bool:
        """True if slices have rotary inertia."""
        return any(
            couple in distributed.terms
            for distributed in self.distributed_loads
            for couple in self.table.couples
        )

    def _terms(self, force: str, basis: Basis) -> tuple[list[Array], grids.Functions]:
        terms = self.table.sections[force]
        columns = [self.coefficients[name] for name in terms.coefficients]
        return basis.of(terms, columns, self.distributed_loads)

    def _smooth(self, force: str, u: Array) -> Array:
        columns, functions = self._terms(force, self.basis(u))
        return np.asarray(
            sum(
                _column(column, u) * row
                for column, row in zip(columns, functions.rows, strict=False)
            )
        )

    def _acting(self, force: str, load: AnyPointLoad) -> grids.Load:
        terms = self.table.sections[force]
        constant = getattr(load, terms.acting)
        if not terms.arm:
            return load.station, constant, np.zeros_like(constant)
        return (
            load.station,
            constant,
            terms.arm * getattr(load, self.table.sections[terms.shear].acting) * self.length,
        )

    def _beyond(self, force: str, load: AnyPointLoad, u: Array, crossed: Operand) -> Array:
        load_point, constant, slope = (_column(values, u) for values in self._acting(force, load))
        return np.where(crossed, constant + slope * (load_point - u), 0.0)

    def _turning(
        self, force: str, within: Callable[[str, Array], Array], low: Array, high: Array
    ) -> list[Array]:
        """Place between two load points at which the force's derivative along the link is zero, or
        nearest to zero: for a bending moment, first where the shear rises through zero, then where
        it falls.
        """
        terms, l = self.table.sections[force], self.length
        if len(terms.coefficients) == 1:
            return []
        constant, first, second = (self.coefficients[name] for name in terms.coefficients[-3:])
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            turning = -first / (second * l)
            if terms.arm and self.density.uniform and not self.loads:
                zeros = zeros_of_uniform_shear(constant, first, second, self.density.cells[0][0], l)
                return [
                    np.clip(np.where(np.isnan(zero), 0.0, zero)[:, None], 0.0, 1.0)
                    for zero in zeros
                ]
        middle = np.clip(np.where(np.isnan(turning), 0.0, turning)[:, None], low, high)
        if not terms.arm:
            return [middle]
        rises = ~np.signbit(second)[:, None]
        return zeros_of_shear(lambda u: within(terms.shear, u), low, middle, high, rises)

    def _turns_of_size(
        self, parts: tuple[str, ...], within: Callable[[str, Array], Array], low: Array, high: Array
    ) -> StationaryPoints:
        """Extrema of a force, or of the square of a resultant: of a shear force, the zeros of V'.

        V' = 0, of a bending one where M . M' = 0.

        Of a uniform link with no load along it that is a cubic or a quintic. A density is a factor
        of V' then, and left out.
        """
        bends, middle = bool(self.table.sections[parts[0]].arm), (low + high) / 2

        def slope(part: str, u: Array) -> Array:
            terms = self.table.sections[part]
            if bends and not self._thick:
                return -terms.arm * within(terms.shear, u)
            if bends:
                return -terms.arm * within(terms.shear, u) - self._turned(part, u, middle)
            if self.distributed_loads:
                return self._falling(part, u, middle)
            first, second = (_column(self.coefficients[name], u) for name in terms.coefficients[1:])
            return np.asarray(-(first + self.length * u * second))

        def change(u: Array) -> Array:
            with np.errstate(all="ignore"):
                if len(parts) == 1:
                    return slope(parts[0], u)
                return np.asarray(sum(within(part, u) * slope(part, u) for part in parts))

        return stationary_points(
            change,
            low,
            high,
            self.density.breaks,
            self._degree(parts, bends=bends),
            signed=len(parts) == 1,
        )

    def _degree(self, parts: tuple[str, ...], *, bends: bool) -> int:
        """Degree of the polynomial that is zero at extrema: for shear forces one more than their
        slope, for bending moments two.
        """
        if len(parts) == 1:
            return self._highest + bends
        return (
            2 * self._highest + 3
            if bends
            else 2 * self._highest + 1
            if self.distributed_loads
            else self._highest + 2
        )

    @property
    def _highest(self) -> int:
        """The degree of the slope of a shear force, between two stations and in a cell of the
        density.
        """
        return max(
            *map(len, self.density.cells),
            *(distributed.powers - 1 for distributed in self.distributed_loads),
            0,
        )


def _column(values: Array, like: Array) -> Array:
    """A row an instant, shaped to go with an array whose first axis is time."""
    return values.reshape((-1,) + (1,) * (like.ndim - 1))

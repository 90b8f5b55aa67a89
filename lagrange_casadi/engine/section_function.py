"""The forces inside a link as one function of the ratio xi/l: ``section(law, acting, matter, xi)``.

``law`` are the coefficients of the link's law, in the order of :attr:`.Table.law`. ``acting`` is
what acts on it: of each load point the members of :attr:`.Table.place_first`, then of each load
along it ``width``, ``end`` and, power by power, its coefficients. ``matter`` is what parameters say
of the link (:meth:`.ModelData.mass_properties`): its length, and the coefficients of its density
per unit of the ratio. The result are the forces of :attr:`.Table.forces`, resultants last.

A section carries what acts beyond its :func:`edge`. Of a load along the link
(:mod:`.distributed_loads`) the section at u carries, with x = (end - u)/width kept from 0 to 1, L =
l width and a = l max(end - width - u, 0), of each coefficient

    c_j L x^(j+1)/(j+1)                              of a force,
    c_j L x^(j+1)/(j+1) (L x/(j+2) + a)              of a moment.

Each is a product, so nothing cancels: not where the load ends, and not of a short load.

Own outputs, derivatives, stresses and exported C come from here; numbers from
:mod:`.results.pieces`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import casadi as ca

from ..base.arrays import Expression, Operand
from ..base.quantities import Column, Output, parts_along
from ..base.scalars import graph
from ..base.tables import Table, Terms, table_of
from ..model.beams.properties import larger, smaller
from ..model.link_density import Density
from .distributed_loads import distributed_loads_of
from .mobility import load_points_of

Side = Literal["base", "tip"]
SIDES: tuple[Side, ...] = ("tip", "base")


def edge(ratio: Operand, slack: float, side: Side = "tip") -> Operand:
    """The ratio beyond which a section at a ``ratio`` carries what acts at load points; of numbers,
    arrays or expressions.

    A load point that is less than ``slack`` away is at the section, which then has two values. On
    the tip's side it does not carry what acts there, on the base's side it does. At the ends of a
    link there is one value: a section at the tip carries what acts at the tip, and no section
    carries what acts at the base.
    """
    return smaller(ratio + slack, 1.0 - slack) if side == "tip" else larger(ratio - slack, slack)


@dataclass(frozen=True, eq=False)
class Place:
    """A place along a link, as an expression; ``side`` says which value is meant where something
    acts: at a ``station``.
    """

    ratio: Any
    load_point: str = ""
    side: Side = "tip"


@dataclass(frozen=True, eq=False)
class Section:
    """The section forces of a link as expressions of ``columns``, among which are its law and what
    acts on it.
    """

    link: str
    table: Table
    columns: Mapping[Column, Any]
    length: Any
    density: Density

    @cached_property
    def load_points(self) -> tuple[str, ...]:
        """Load points of the link."""
        return load_points_of(self._outputs, self.link)

    @cached_property
    def marks(self) -> list[Place]:
        """Both sides of every load point, and where loads along the link begin and end: places that
        may move with parameters.
        """
        found = [
            Place(self._of("station", "station", name), name, side)
            for name in self.load_points
            for side in SIDES
        ]
        for name in self.distributed_loads:
            width, end = self._span(name)
            found += [Place(end), Place(end - width)]
        return found

    @cached_property
    def distributed_loads(self) -> dict[str, int]:
        """The loads along it, and how many powers each has."""
        return distributed_loads_of(self._outputs, self.link)

    def at(self, name: str, place: Place, slack: float) -> Expression:
        """A section force at a place."""
        return self.force(name, place.ratio, edge(place.ratio, slack, place.side))

    def force(self, name: str, ratio: ca.SX, beyond: ca.SX) -> Expression:
        """A section force at a ratio, with what acts at load points ``beyond`` a ratio."""
        if len(parts := self.table.parts("section", name)) > 1:
            return ca.sqrt(
                sum(part * part for part in (self.force(one, ratio, beyond) for one in parts))
            )
        terms = self.table.sections[name]
        law = (self._of("law", member) for member in terms.coefficients)
        total = sum(
            (column * row for column, row in zip(law, self._rows(terms, ratio), strict=True)),
            ca.SX(0),
        )
        total += sum(
            self._acting(terms, load_point, ratio, beyond) for load_point in self.load_points
        )
        return sum(self._distributed(terms, ratio), total)

    def _rows(self, terms: Terms, u: ca.SX) -> list[Expression]:
        """The functions along the link that go with the coefficients of a force."""
        t0, t1, t2 = self.density.tails(u, self.length)
        l = self.length
        if terms.arm:
            return [1, *(terms.arm * row for row in (l * (1 - u), l * t1, l * l * (u * t1 + t2)))]
        return [1, t0, l * (u * t0 + t1)][: len(terms.coefficients)]

    def _acting(
        self, terms: Terms, load_point: str, ratio: Expression, beyond: Expression
    ) -> Expression:
        """Action of a load point, if it is beyond a ratio."""
        place, value = (
            self._of("station", member, load_point) for member in ("station", terms.acting)
        )
        if terms.arm:
            across = self._of("station", self.table.sections[terms.shear].acting, load_point)
            value = value + across * (terms.arm * (self.length * (place - ratio)))
        return ca.if_else(ca.SX(beyond) < place, ca.SX(value), 0)

    def _distributed(self, terms: Terms, ratio: ca.SX) -> Iterator[Expression]:
        """The parts of a force by what acts along the link: loads by their arms, couples of slices
        without.
        """
        parts = ((terms.distributed, terms.arm or 1, bool(terms.arm)), (terms.couple, 1, False))
        for load, powers in self.distributed_loads.items():
            for direction, sign, arm in parts:
                if Output("spread", self.link, direction, load, 0) in self.columns:
                    terms_here = self._along(load, powers, direction, ratio, arm=arm)
                    yield sign * sum(terms_here, ca.SX(0))

    def _along(
        self, load: str, powers: int, direction: str, ratio: ca.SX, *, arm: bool
    ) -> Iterator[Expression]:
        """Terms of the force of a load that a section carries in a direction, or with ``arm`` of
        its moment, power by power.
        """
        width, end = self._span(load)
        x = ca.fmin(ca.fmax((end - ratio) / width, 0), 1)
        reach, lever = self.length * width, self.length * ca.fmax(end - width - ratio, 0)
        for power in range(powers):
            value = self._of("spread", direction, load, power)
            share = value * (reach * x ** (power + 1) / (power + 1))
            yield share * (reach * x / (power + 2) + lever) if arm else share

    def _span(self, load: str) -> tuple[Expression, Expression]:
        """Width and end of a load along the link."""
        return self._of("spread", "width", load), self._of("spread", "end", load)

    @property
    def _outputs(self) -> Iterator[Output]:
        return (column for column in self.columns if isinstance(column, Output))

    def _of(
        self, group: str, member: str, load_point: str = "", power: int | None = None
    ) -> Expression:
        return self.columns[Output(group, self.link, member, load_point, power)]


@dataclass(frozen=True)
class SectionInputs:
    """The outputs that a link's section forces are made of, in their order: its ``law``, and what
    is ``acting`` on it.
    """

    law: tuple[Output, ...]
    acting: tuple[Output, ...]

    @classmethod
    def of(cls, outputs: Iterable[Output], link: str) -> SectionInputs:
        """Make it for a link, among others; for a distributed load with its directions."""
        of_link = parts_along(dict.fromkeys(outputs), link)
        table = table_of(Output("law", link, "mx0") in of_link)
        acting = [
            Output("station", link, member, name)
            for name in load_points_of(of_link, link)
            for member in table.place_first
        ]
        for name, powers in distributed_loads_of(of_link, link).items():
            acting += [Output("spread", link, member, name) for member in ("width", "end")]
            members = dict.fromkeys(
                output.member
                for output in of_link
                if output.load_point == name and output.power is not None
            )
            acting += [
                Output("spread", link, member, name, power)
                for power in range(powers)
                for member in members
            ]
        return cls(tuple(Output("law", link, member) for member in table.law), tuple(acting))

    @property
    def table(self) -> Table:
        """Table of the forces, and of the terms of each."""
        return table_of(self.law[-1].member == "mx0")

    def alike(self) -> SectionInputs:
        """Form of a link and of loads whose names are numbers: links of one kind have one
        function.
        """
        numbers: dict[str, str] = {"": ""}
        law, acting = (
            tuple(
                Output(
                    one.group,
                    "",
                    one.member,
                    numbers.setdefault(one.load_point, str(len(numbers))),
                    one.power,
                )
                for one in outputs
            )
            for outputs in (self.law, self.acting)
        )
        return SectionInputs(law, acting)


def section(
    inputs: SectionInputs,
    breaks: Sequence[float],
    sizes: Sequence[int],
    slack: float,
    name: str,
) -> ca.Function:
    """``section(law, acting, matter, xi) -> forces`` of a link, whose density has so many
    coefficients in each cell.

    ``matter`` are its length and these coefficients, per unit of the ratio. The function has a
    ``name``.
    """
    law, acting = ca.SX.sym("law", len(inputs.law)), ca.SX.sym("acting", len(inputs.acting))
    mass_properties, xi = ca.SX.sym("matter", 1 + sum(sizes)), ca.SX.sym("xi")
    columns: dict[Column, Any] = dict(
        zip((*inputs.law, *inputs.acting), (*ca.vertsplit(law), *ca.vertsplit(acting)), strict=True)
    )
    length, *terms = ca.vertsplit(mass_properties)
    coefficients = iter(terms)
    density = Density(
        tuple(breaks),
        tuple(tuple(next(coefficients) for _ in range(size)) for size in sizes),
        per_length=False,
    )
    link = Section(inputs.law[0].part, inputs.table, columns, length, density)
    forces = ca.vertcat(*(link.at(force, Place(xi), slack) for force in inputs.table.forces))
    given = {"law": law, "acting": acting, "matter": mass_properties, "xi": xi}
    return graph(name, given, forces=forces)

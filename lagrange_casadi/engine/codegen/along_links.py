"""The C that makes the section forces of links curves over time: their numbers and tables for
``pieces.c``.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from ...base.arrays import Expression
from ...base.bernstein import of_powers, raised
from ...base.tables import PLANE, SPACE, Table, table_of
from .compiler import written


@dataclass(frozen=True)
class Along:
    """Columns of a link: its coefficients, its load points with the place first, and the
    distribution of its mass.

    The coefficients are those of a planar link, or those of a link in space. ``distributed_loads``
    have for each load the column of its width, that of its end, and for each direction those of the
    coefficients of all powers, -1 if there is none. ``marks`` are places at which these begin or
    end, a column or the difference of two, and places at which the density jumps, numbers. If
    slices are ``thick`` there are three more directions, of couples.
    """

    law: tuple[int, ...]
    load_points: tuple[tuple[int, ...], ...]
    breaks: tuple[float, ...]
    terms: int
    distributed_loads: tuple[tuple[int, ...], ...] = ()
    marks: tuple[tuple[int, ...] | float, ...] = ()
    thick: bool = False

    @property
    def table(self) -> Table:
        """Table of the link's forces."""
        return table_of(len(self.law) == len(SPACE.law))

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions of distributed loads."""
        return (*self.table.distributed, *(self.table.couples if self.thick else ()))

    @property
    def powers(self) -> tuple[int, ...]:
        """Number of powers of each distributed load."""
        return tuple((len(load) - 2) // len(self.directions) for load in self.distributed_loads)

    @property
    def degree(self) -> int:
        """Degree along the link of what acts on it, between two marks and two breaks."""
        return max(self.terms, *(many - 1 for many in self.powers), 1)

    @property
    def even(self) -> bool:
        """True if nothing but the link's own even mass acts between its ends, in a plane."""
        plain = self.table is PLANE and not self.parted and not self.distributed_loads
        return plain and len(self.breaks) == 2 and self.terms == 1

    @property
    def parted(self) -> int:
        """Number of marks, which divide the link: load points, and ends of distributed loads."""
        return len(self.load_points) + len(self.marks)

    @property
    def turns(self) -> tuple[int, ...]:
        """Number of places between two marks at which each section force is looked at, in the order
        of its table.
        """
        found = []
        for force in self.table.forces:
            terms = self.table.sections.get(force)
            plain = terms is not None and not terms.arm and not self.distributed_loads
            constant = terms is not None and len(terms.coefficients) == 1 and not self.thick
            found.append(0 if constant else 1 if plain else 2)
        return tuple(found)

    @property
    def places(self) -> tuple[tuple[int | str, ...], ...]:
        """Places along the link of each curve of each force: a row of places, ``BASE`` or ``TIP``.
        See ``pieces.c``.
        """
        parts, marks = self.parted + 1, self.rows - self.parted
        ends: tuple[int | str, ...] = (
            "BASE",
            "TIP",
            *(marks + k // 2 for k in range(2 * self.parted)),
        )
        firsts = itertools.accumulate(self.turns, initial=0)
        return tuple(
            (*ends, *range(first * parts, (first + many) * parts))
            for first, many in zip(firsts, self.turns, strict=False)
        )

    @property
    def rows(self) -> int:
        """Number of rows of places."""
        return sum(self.turns) * (self.parted + 1) + self.parted


def along(number: int, link: Along, into: str, offset: int) -> str:
    """Code for the curves of a link of columns y."""
    marks = [
        f"(lanes_real) {mark:.17g}"
        if isinstance(mark, float)
        else " - ".join(f"y[{column}]" for column in mark)
        for mark in link.marks
    ]
    marks = [f"y[{place}]" for place, *_ in link.load_points] + marks
    loads = [f"y[{column}]" for load_point in link.load_points for column in load_point]
    distributed = [
        f"y[{column}]" if column >= 0 else "0" for load in link.distributed_loads for column in load
    ]
    rooms, taken = "", ""
    for name, values in (
        ("law", [f"y[{column}]" for column in link.law]),
        ("loads", loads),
        ("spread", distributed),
        ("marks", [f"designs_kept({mark}, 0, 1)" for mark in marks]),
    ):
        rooms += f"{', ' if rooms else ''}{name}[{max(1, len(values))}]"
        taken += "".join(f"    {name}[{i}] = {value};\n" for i, value in enumerate(values))
    if link.even:
        return f"""  if (need >> {min(number, 63)} & 1) {{
    casadi_real law[{len(link.law)}];
{taken}    designs_even(matter + {offset}, law, {into});
  }}
"""
    table = link.table
    forces = [*table.sections]
    sizes = [table.parts("section", name) for name in table.forces[len(forces) :]]
    resultants = [f"{{{_listed(map(forces.index, parts))}}}" for parts in sizes]
    return f"""  if (need >> {min(number, 63)} & 1) {{
    static const designs_force forces[] = {{{_listed(_forces(link))}}};
    static const int sizes[][2] = {{{_listed(resultants or ["{0, 0}"])}}};
    static const int many[] = {{{_listed(link.turns)}}};
    static const int powers[] = {{{_listed(link.powers or [0])}}};
    casadi_real {rooms};
    const designs_link link = {{{len(forces)}, {len(sizes)}, forces, sizes, {len(link.breaks) - 1},
                               {link.terms}, {link.degree}, designs_breaks{number},
                               {len(link.load_points)}, {len(table.place_first)}, {link.parted},
                               {len(link.distributed_loads)}, {len(link.directions)}, powers,
                               matter + {offset}, law, loads, spread}};
{taken}    designs_along(&link, many, marks, {into});
  }}
"""


def _forces(link: Along) -> Iterator[str]:
    """The forces of a link that are no resultants, as ``designs_force`` has them."""
    table, directions = link.table, link.directions
    for terms in table.sections.values():
        numbers = (
            table.law.index(terms.coefficients[0]),
            int(len(terms.coefficients) > 1 and not terms.arm),
            table.place_first.index(terms.acting),
            directions.index(terms.distributed) if terms.distributed and not terms.arm else -1,
            directions.index(terms.couple) if terms.couple in directions else -1,
            [*table.sections].index(terms.shear) if terms.arm else -1,
            terms.arm,
        )
        yield f"{{{_listed(numbers)}}}"


def mass_properties_of(
    link: Along, length: Expression, cells: Sequence[Sequence[Expression]]
) -> list[Expression]:
    """Arguments of ``pieces.c`` for a link, from its length [m] and its cells [kg]: as many
    ordinates of each cell, from its end towards the tip on.
    """
    found = [length]
    for low, high, cell in zip(link.breaks, link.breaks[1:], cells, strict=False):
        line, units = np.array([high, low]), np.eye(len(cell))
        weights = [
            raised(of_powers([*unit[: j + 1]], line), link.terms - 1)
            for j, unit in enumerate(units)
        ]
        found += [
            sum(coefficient * weight[i] for coefficient, weight in zip(cell, weights, strict=True))
            for i in range(link.terms)
        ]
    return found


def pieces(links: Sequence[Along]) -> str:
    """The C of the section forces of all links."""
    degree = max([link.degree for link in links], default=1)
    most = max([len(link.table.forces) for link in links], default=1)
    # A resultant of moments has the highest: the slope of its square.
    highest = 2 * degree + 3 if most > len(PLANE.forces) else degree + 1
    numbers = {"DEGREE": highest, "ORDINATES": degree + 3, "FORCES": most, "ALL": most}
    numbers |= {"PIECES": sum(not link.even for link in links)}
    defines = "".join(f"#define DESIGNS_{name} {number}\n" for name, number in numbers.items())
    rows = [f"{{{_listed(comb(n, k) for k in range(n + 1))}}}" for n in range(highest + 2)]
    table = f"designs_binomial[][{highest + 2}] = {{{_listed(rows)}}}"
    return f"{defines}static const lanes_real {table};\n{written('pieces.c')}"


def _listed(values: Iterable[object]) -> str:
    return ", ".join(map(str, values))

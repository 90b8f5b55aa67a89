"""The C that makes the section forces of links curves over time: their numbers and tables for
``sections.c``.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...base.arrays import Expression
from ...base.interpolation import interpolation
from ...base.tables import SPACE
from ...model.density import shifted
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
    def space(self) -> bool:
        """True if the link is in space."""
        return len(self.law) == len(SPACE.law)

    @property
    def uniform(self) -> bool:
        """True if nothing but the link's own even mass acts between its ends."""
        return (
            not self.space
            and not self.load_points
            and not self.distributed_loads
            and len(self.breaks) == 2
            and self.terms == 1
        )

    @property
    def parted(self) -> int:
        """Number of places that divide the link: load points, and ends of distributed loads."""
        return len(self.load_points) + len(self.marks)

    @property
    def directions(self) -> int:
        """Number of directions of distributed loads."""
        return 6 if self.thick else 3 if self.space else 2

    @property
    def powers(self) -> tuple[int, ...]:
        """Number of powers of each distributed load."""
        return tuple(
            (len(distributed) - 2) // self.directions for distributed in self.distributed_loads
        )

    @property
    def places(self) -> tuple[tuple[int | str, ...], ...]:
        """Places along the link of each curve of each force: a row of places, ``BASE`` or ``TIP``.
        See ``sections.c``.
        """
        parts, load_points = self.parted + 1, self.parted
        iterations = self._turns
        ends: tuple[int | str, ...] = (
            "BASE",
            "TIP",
            *(sum(iterations) * parts + k for k in range(load_points) for _ in range(2)),
        )
        firsts = itertools.accumulate(iterations, initial=0)
        return tuple(
            (*ends, *range(first * parts, (first + many) * parts))
            for first, many in zip(firsts, iterations, strict=False)
        )

    @property
    def rows(self) -> int:
        """Number of rows of places."""
        return sum(self._turns) * (self.parted + 1) + self.parted

    @property
    def degrees(self) -> tuple[int, ...]:
        """Degrees of the polynomials that are zero at extrema of forces: see :mod:`.section_law`.

        In space first of the resultants of shear and of bending. With loads along the link of the
        axial force and the shear too, and of the bending moment.
        """
        highest = max([self.terms, *(many - 1 for many in self.powers)])
        sizes = (2 * highest + 1 if self.distributed_loads else highest + 2, 2 * highest + 3)
        return (sizes if self.space else ()) + (
            (highest, highest + 1) if self.distributed_loads else ()
        )

    @property
    def _turns(self) -> tuple[int, ...]:
        """Largest number of extrema of each section force between two load points, in the order of
        its table.
        """
        if self.distributed_loads:
            return (2, 2, 2, 2 if self.thick else 0, 2, 2, 2, 2) if self.space else (2, 2, 2)
        return (1, 1, 1, 0, 2, 2, 2, 2) if self.space else (1, 1, 2)


def along(number: int, link: Along, into: str, offset: int) -> str:
    """Code for the curves of a link of columns y."""
    loads = [f"y[{column}]" for load_point in link.load_points for column in load_point]
    for mark in link.marks:
        place = (
            f"(lanes_real) {mark:.17g}"
            if isinstance(mark, float)
            else " - ".join(f"y[{column}]" for column in mark)
        )
        loads += [place, *["0"] * (6 if link.space else 3)]
    distributed = [
        f"y[{column}]" if column >= 0 else "0" for load in link.distributed_loads for column in load
    ]
    taken = "".join(f"    law[{i}] = y[{column}];\n" for i, column in enumerate(link.law))
    taken += "".join(f"    loads[{i}] = {value};\n" for i, value in enumerate(loads))
    taken += "".join(f"    spread[{i}] = {value};\n" for i, value in enumerate(distributed))
    if link.uniform:
        inner = (
            f"    casadi_real law[7];\n{taken}    designs_uniform(matter + {offset}, law,"
            f" {into});\n"
        )
        return f"  if (need >> {min(number, 63)} & 1) {{\n{inner}  }}\n"
    sizes, room = f"{len(link.breaks) - 1}, {link.terms}, {link.parted}", ""
    nodes = [f"&designs_nodes{degree}" for degree in link.degrees]
    along_it = (
        f", {len(link.distributed_loads)}, {link.directions}, 1, powers, spread"
        if link.distributed_loads
        else ", 0, 0, 0, 0, 0"
    )
    along_it += f", 0, {int(link.thick)}, 0"
    if link.space:
        room = f", room[{_capacity(link)}]"
        call = f"designs_along_in_space(&link, nodes, marks, room, {into});"
        tables = f"    const designs_nodes* const nodes[] = {{{', '.join(nodes)}}};\n"
    elif link.distributed_loads:
        call, tables = f"designs_along_loaded(&link, {', '.join(nodes)}, marks, {into});", ""
    else:
        call, tables = f"designs_along(&link, marks, {into});", ""
    if link.distributed_loads:
        room += f", spread[{len(distributed)}]"
        tables += f"    const int powers[] = {{{', '.join(map(str, link.powers))}}};\n"
    inner = f"""    casadi_real law[{len(link.law)}], loads[{max(1, len(loads))}];
    casadi_real marks[{link.parted + 1}]{room};
{tables}    const designs_link link = {{{sizes}, designs_breaks{number}, matter + {offset},
                               law, loads{along_it}}};
{taken}    {call}
"""
    return f"  if (need >> {min(number, 63)} & 1) {{\n{inner}  }}\n"


def _capacity(link: Along) -> int:
    """Variables that both planes of a link in space need, and torsion of thick slices: a law,
    loads, values and places.
    """
    load_points, parts = link.parted, link.parted + 1
    iterations = 2 * parts if link.distributed_loads else parts
    return (3 if link.thick else 2) * (
        7 + 4 * load_points + 3 * (2 + 2 * load_points) + 4 * iterations + 4 * parts + load_points
    )


def mass_properties_of(
    link: Along, length: Expression, cells: Sequence[Sequence[Expression]]
) -> list[Expression]:
    """Arguments of ``sections.c`` for a link, from its length [m] and its cells [kg], filled up to
    as many terms.
    """
    if link.uniform:
        return [length, cells[0][0]]
    beyond: tuple[Any, Any, Any] = (0.0, 0.0, 0.0)
    found: list[list[Any]] = []
    for a, b, cell in reversed(list(zip(link.breaks, link.breaks[1:], cells, strict=False))):
        turned = [(-1) ** j * c for j, c in enumerate(shifted(cell, b))]
        turned += [0.0] * (link.terms - len(turned))
        found.append([*beyond, *turned])
        x = b - a
        rows_of_link = [
            sum(
                c
                * x ** (j + k + 1)
                * (math.factorial(j) * math.factorial(k) / math.factorial(j + k + 1))
                for j, c in enumerate(turned)
            )
            for k in range(3)
        ]
        beyond = (
            beyond[0] + rows_of_link[0],
            beyond[1] + x * beyond[0] + rows_of_link[1],
            beyond[2] + 2 * x * beyond[1] + x * x * beyond[0] + rows_of_link[2],
        )
    return [length, *(value for cell in reversed(found) for value in cell)]


def turning(links: Sequence[Along]) -> str:
    """The C of links in space and of links with loads along them, and its tables; nothing where
    there are none.
    """
    degrees = sorted({degree for link in links for degree in link.degrees})
    if not degrees:
        return ""
    files = ["turning.c", *(["sections_in_space.c"] if any(link.space for link in links) else [])]
    text = f"#define DESIGNS_DEGREE {degrees[-1]}\n\n{written(*files)}"
    for degree in degrees:
        nodes, weights = interpolation(degree)
        for name, values in (("nodes_at", nodes), ("weights", weights.ravel())):
            numbers = ", ".join(f"(lanes_real) {value:.17g}" for value in values.tolist())
            text += f"static const lanes_real designs_{name}{degree}[] = {{{numbers}}};\n"
        text += (
            f"static const designs_nodes designs_nodes{degree} = {{{degree},"
            f" designs_nodes_at{degree}, designs_weights{degree}}};\n"
        )
    return text

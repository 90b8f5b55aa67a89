"""The C that makes the section forces of links curves over time: their numbers and tables for ``sections.c``."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

from ..summits.polynomials import interpolation
from ..tables import SPACE


@dataclass(frozen=True)
class Along:
    """A link's part in the columns: its coefficients, what acts at each station, place first; and how its mass lies.

    The coefficients are those of a planar link, or those of a link in space.
    """

    law: tuple[int, ...]
    stations: tuple[tuple[int, ...], ...]
    breaks: tuple[float, ...]
    terms: int

    @property
    def space(self) -> bool:
        """Whether it is a link in space."""
        return len(self.law) == len(SPACE.law)

    @property
    def uniform(self) -> bool:
        """Whether nothing but its own even mass acts between its ends."""
        return not self.space and not self.stations and len(self.breaks) == 2 and self.terms == 1

    @property
    def places(self) -> tuple[tuple[int | str, ...], ...]:
        """Of each curve of each force, where along the link it is: a row of places, ``BASE`` or ``TIP``. See ``sections.c``."""
        parts, stations = len(self.stations) + 1, len(self.stations)
        turns = self._turns
        ends: tuple[int | str, ...] = ("BASE", "TIP", *(sum(turns) * parts + k for k in range(stations) for _ in range(2)))
        firsts = itertools.accumulate(turns, initial=0)
        return tuple((*ends, *range(first * parts, (first + many) * parts)) for first, many in zip(firsts, turns, strict=False))

    @property
    def rows(self) -> int:
        """How many rows of places there are."""
        return sum(self._turns) * (len(self.stations) + 1) + len(self.stations)

    @property
    def degrees(self) -> tuple[int, int]:
        """Of the polynomials that are zero where the resultants of shear and of bending turn: see :mod:`.section_law`."""
        return self.terms + 2, 2 * self.terms + 3

    @property
    def _turns(self) -> tuple[int, ...]:
        """Of each section force, in the order of its table: how often it may turn between two stations."""
        return (1, 1, 1, 0, 2, 2, 2, 2) if self.space else (1, 1, 2)


def along(number: int, link: Along, into: str, offset: int) -> str:
    """What makes the curves of a link of columns y."""
    loads = [column for station in link.stations for column in station]
    taken = "".join(f"    law[{i}] = y[{column}];\n" for i, column in enumerate(link.law))
    taken += "".join(f"    loads[{i}] = y[{column}];\n" for i, column in enumerate(loads))
    if link.space:
        inner = _along_in_space(number, link, taken, offset, into)
    elif link.uniform:
        inner = f"    casadi_real law[7];\n{taken}    designs_uniform(matter + {offset}, law, {into});\n"
    else:
        sizes = f"{len(link.breaks) - 1}, {link.terms}, {len(link.stations)}"
        inner = f"""    casadi_real law[7], loads[{max(1, len(loads))}], marks[{len(link.stations) + 1}];
    const designs_link link = {{{sizes}, designs_breaks{number}, matter + {offset}, law, loads}};
{taken}    designs_along(&link, marks, {into});
"""
    return f"  if (need >> {min(number, 63)} & 1) {{\n{inner}  }}\n"


def matter_of(link: Along, length: Any, cells: Sequence[Sequence[Any]]) -> list[Any]:
    """What ``sections.c`` takes for a link, of its length [m] and its cells [kg], filled up to as many terms: see there."""
    if link.uniform:
        return [length, cells[0][0]]
    beyond: tuple[Any, Any, Any] = (0.0, 0.0, 0.0)
    found: list[list[Any]] = []
    for a, b, cell in reversed(list(zip(link.breaks, link.breaks[1:], cells, strict=False))):
        turned = [
            (-1) ** j * sum(c * math.comb(n, j) * b ** (n - j) for n, c in enumerate(cell) if n >= j) for j in range(len(cell))
        ]
        turned += [0.0] * (link.terms - len(turned))
        found.append([*beyond, *turned])
        x = b - a
        own = [
            sum(
                c * x ** (j + k + 1) * (math.factorial(j) * math.factorial(k) / math.factorial(j + k + 1))
                for j, c in enumerate(turned)
            )
            for k in range(3)
        ]
        beyond = (
            beyond[0] + own[0],
            beyond[1] + x * beyond[0] + own[1],
            beyond[2] + 2 * x * beyond[1] + x * x * beyond[0] + own[2],
        )
    return [length, *(value for cell in reversed(found) for value in cell)]


def _along_in_space(number: int, link: Along, taken: str, offset: int, into: str) -> str:
    stations, parts = len(link.stations), len(link.stations) + 1
    ends = 2 + 2 * stations
    room = 2 * (7 + 4 * stations + 3 * ends + 8 * parts + stations)
    shear, bending = link.degrees
    sizes = f"{len(link.breaks) - 1}, {link.terms}, {stations}"
    return f"""    casadi_real law[12], loads[{max(1, 7 * stations)}], marks[{parts}], room[{room}];
    const designs_link link = {{{sizes}, designs_breaks{number}, matter + {offset}, law, loads}};
{taken}    designs_along_in_space(&link, &designs_nodes{shear}, &designs_nodes{bending}, marks, room, {into});
"""


def in_space(links: Sequence[Along]) -> str:
    """The C of links in space, and its tables; nothing where there are none."""
    degrees = sorted({degree for link in links if link.space for degree in link.degrees})
    if not degrees:
        return ""
    text = f"#define DESIGNS_DEGREE {degrees[-1]}\n"
    text += "\n" + resources.files(__package__).joinpath("sections_in_space.c").read_text()
    for degree in degrees:
        nodes, weights = interpolation(degree)
        for name, values in (("nodes_at", nodes), ("weights", weights.ravel())):
            numbers = ", ".join(f"(DESIGNS_REAL) {value:.17g}" for value in values.tolist())
            text += f"static const DESIGNS_REAL designs_{name}{degree}[] = {{{numbers}}};\n"
        text += (
            f"static const designs_nodes designs_nodes{degree} = {{{degree}, designs_nodes_at{degree}, designs_weights{degree}}};\n"
        )
    return text

"""The section laws of links in a page: the functions along each link, and which coefficients go with them.

The viewer sums them up as :class:`.SectionLaw` does, so that the force at every section of every instant takes few numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..instants.solution import Solution
from ..quantities import Output
from ..tables import Table
from .arrays import Arrays
from .words import what

RATIOS = 101
"""Equal ratios xi/l along a link at which the viewer knows its forces, both ends included."""


@dataclass(frozen=True)
class Force:
    """A section force of a link: ``parts`` are the forces whose size it is; any other is a sum of ``terms`` and of loads.

    A term is the number of a coefficient's array (t,), that of a function along the link (xi,), and a sign. ``acting`` is the
    member of what acts at stations that goes into it; of a moment with an ``arm`` of 1 or -1 so is that ``across``, times its
    distance.
    """

    name: str
    what: str
    unit: str
    open: bool
    parts: tuple[str, ...] = ()
    terms: tuple[tuple[int, int, int], ...] = ()
    acting: str = ""
    across: str = ""
    arm: int = 0


def section_entries(solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays) -> Iterator[dict[str, Any]]:
    """The links that have sections, each with its forces."""
    xi = np.linspace(0.0, 1.0, RATIOS)
    for link in solution.links_with_sections:
        law, table = solution.section(link).law, solution.table
        basis = law.basis(xi)

        def added(output: Output, chosen: npt.NDArray[np.intp] = chosen) -> int:
            return arrays.add(solution.outputs[output][chosen], str(output))

        columns = {name: added(Output("law", link, name)) for name in law.coefficients}
        of_force, of_moment = ([arrays.add(row) for row in rows] for rows in (basis.force, basis.bending))
        loads = [
            {"name": load.name} | {member: added(Output("station", link, member, load.name)) for member in table.station}
            for load in law.loads
        ]
        spread = {
            direction: [
                added(Output("spread", link, direction, load.name, power)) for load in law.spreads for power in range(load.powers)
            ]
            for direction in table.spread
        }
        forces = []
        for name in table.forces:
            output = Output("section", link, name)
            rows = of_moment if name in table.sections and table.sections[name].arm else of_force
            made = _made(name, table, columns, spread, rows)
            words = what(output, table), solution.unit(output), not solution.determined(output)
            forces.append(asdict(Force(name, *words, **made)))
        yield {"link": link, "length": law.length, "xi": arrays.add(xi), "forces": forces, "loads": loads}


def _made(
    name: str, table: Table, columns: Mapping[str, int], spread: Mapping[str, Sequence[int]], rows: Sequence[int]
) -> dict[str, Any]:
    """What a force is made of."""
    terms = table.sections.get(name)
    if terms is None:
        return {"parts": table.parts("section", name)}
    factors = [columns[coefficient] for coefficient in terms.coefficients] + list(spread.get(terms.spread, ()))
    signs = [1] + [terms.arm or 1] * (len(factors) - 1)
    summed = tuple(zip(factors, rows, signs, strict=False))
    across = table.sections[terms.shear].acting if terms.arm else ""
    return {"terms": summed, "acting": terms.acting, "across": across, "arm": terms.arm}

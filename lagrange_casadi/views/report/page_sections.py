"""The section laws of links in a page: the functions along each link, and which coefficients go
with them.

The viewer sums them up as :class:`.SectionLaw` does, so that the force at every section of every
instant takes few numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Json
from ...base.quantities import Output
from ...results.solution import Solution
from .array_block import Arrays
from .words import what

RATIOS = 101
"""Equal ratios xi/l along a link at which the viewer knows its forces, both ends included."""


def section_entries(
    solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays
) -> Iterator[dict[str, Json]]:
    """The links that have sections, each with its forces."""
    xi = np.linspace(0.0, 1.0, RATIOS)
    for link in solution.links_with_sections:
        law, table = solution.section(link).law, solution.table

        def added(output: Output, chosen: npt.NDArray[np.intp] = chosen) -> int:
            return arrays.add(solution.outputs[output][chosen], str(output))

        columns = {name: added(Output("law", link, name)) for name in law.coefficients}
        of_force, of_moment = (
            [arrays.add(row) for row in of.rows] for of in law.basis(xi).functions
        )
        loads = [
            {"name": load.name}
            | {
                member: added(Output("station", link, member, load.name))
                for member in table.load_point
            }
            for load in law.loads
        ]
        distributed = [
            {
                direction: [
                    added(Output("spread", link, direction, load.name, power))
                    for power in range(load.powers)
                ]
                for direction in load.terms
            }
            for load in law.distributed_loads
        ]
        yield {
            "link": link,
            "length": law.length,
            "slack": law.slack,
            "xi": arrays.add(xi),
            "forces": [
                _force(
                    solution,
                    Output("section", link, name),
                    columns,
                    distributed,
                    (of_force, of_moment),
                )
                for name in table.forces
            ],
            "loads": loads,
        }


def _force(
    solution: Solution,
    output: Output,
    columns: Mapping[str, int],
    distributed: Sequence[Mapping[str, Sequence[int]]],
    rows: tuple[Sequence[int], Sequence[int]],
) -> dict[str, Any]:
    """A section force, with ``parts``, the forces whose size it is; any other is a sum of ``terms``
    and of loads.

    A term is the number of a coefficient's array (t,), that of a function along the link (xi,), and
    a sign. ``acting`` is the member of what acts at stations that goes into it; of a moment with an
    ``arm`` of 1 or -1 so is that ``across``, times its distance.
    """
    table = solution.table
    terms = table.sections.get(output.member)
    made: dict[str, Any] = {
        "name": output.member,
        "what": what(output, table),
        "unit": solution.unit(output),
        "open": not solution.determined(output),
        "parts": (),
        "terms": (),
        "acting": "",
        "across": "",
        "arm": 0,
    }
    if terms is None:
        return made | {"parts": table.parts("section", output.member)}
    plain, sign = rows[1 if terms.arm else 0], terms.arm or 1
    own = [columns[coefficient] for coefficient in terms.coefficients]
    summed = [*zip(own, plain, [1, *(sign for _ in own[1:])], strict=False)]
    # After those of the law, a row for each power of each load; couples have no arm.
    first = 0
    for load in distributed:
        for direction, there, sense in (
            (terms.distributed, plain[4 if terms.arm else 3 :], sign),
            (terms.couple, rows[0][3:], 1),
        ):
            summed += [
                (factor, there[first + power], sense)
                for power, factor in enumerate(load.get(direction, ()))
            ]
        first += max(map(len, load.values()))
    across = table.sections[terms.shear].acting if terms.arm else ""
    made |= {"terms": tuple(summed), "acting": terms.acting, "across": across, "arm": terms.arm}
    return made

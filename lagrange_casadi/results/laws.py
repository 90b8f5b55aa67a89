"""The section law of a link from the outputs that it is made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..base.arrays import Array
from ..base.quantities import Output, parts_along
from ..base.tables import PLANE, Table
from ..model.density import NumericDensity
from ..model.limits import END
from .loads import distributed_load, point_load
from .section_law import SectionLaw


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
    law: dict[str, Array] = {}
    load_points: dict[str, dict[str, Array]] = {}
    ends: dict[str, dict[str, Array]] = {}
    terms: dict[str, dict[str, dict[int, Array]]] = {}
    for output, values in outputs.items():
        if not output.along or output.part != link:
            continue
        if output.group == "law":
            law[output.member] = values
        elif output.group == "station":
            load_points.setdefault(output.load_point, {})[output.member] = values
        elif output.power is None:
            ends.setdefault(output.load_point, {})[output.member] = values
        else:
            terms.setdefault(output.load_point, {}).setdefault(output.member, {})[output.power] = (
                values
            )
    loads = tuple(point_load(name, members) for name, members in load_points.items())
    distributed_loads = tuple(
        distributed_load(name, ends.get(name, {}), found) for name, found in terms.items()
    )
    return SectionLaw(
        length,
        density,
        law,
        loads,
        distributed_loads,
        END["single" if precision == "single" else "double"],
    )


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

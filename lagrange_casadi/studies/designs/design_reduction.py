"""Reduction of a design of a scene, as numbers of columns: the results that the emitted C keeps of
its instants.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arrays import Array
from ...base.quantities import AVERAGED, Output, compared
from ...base.scalars import column
from ...base.symbolic import symbolic
from ...base.tables import Table, table_of
from ...engine.codegen.along_links import Along, mass_properties_of
from ...engine.codegen.reduction import Reduction
from ...engine.codegen.stages import Stages, compensated, plain, stages_for
from ...engine.distributed_loads import distributed_loads_of
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.mobility import load_points_of
from ...engine.model_data import ModelData
from ...engine.program import Program
from ...engine.sharpness import Sharpness, with_watched
from ...engine.verdicts import Beside
from ...errors import DeclarationError
from ...results.section_laws import made_of


@symbolic
def stages_of(
    program: Program, method: EvaluationMethod, t: Array, *, alike: bool = True
) -> Stages:
    """Stages that evaluate all designs: in pairs if angles count many turns, or may for some
    parameters.

    ``alike`` says that all designs have the instants ``t``.
    """
    time, p = program.laws.motion.sx_in()
    if method.precision == "single" or (
        alike and not ca.depends_on(ca.vertcat(*program.laws.motion(time, p)), p)
    ):
        return stages_for(program, method.precision, t, program.data.defaults, closing=True)
    try:
        return compensated(program, "double", closing=True)
    except DeclarationError:
        return plain(program, closing=True)


@dataclass(frozen=True, eq=False)
class KeptOutputs:
    """The outputs of which something is kept of each design: peaks of ``quantities``, in ``units``,
    and means of ``efforts``, which are efforts and outputs of the user's own.

    Quantities are the wanted outputs, without angles that loops set, and sizes of reactions and
    loads; section forces come last. Which of them equilibrium leaves open is
    decided for each design. ``reduction`` is the same in numbers of columns, as C takes it;
    ``watched`` is the graph with what ``sharpness`` watches as further columns.
    """

    quantities: tuple[Output, ...]
    units: tuple[str, ...]
    efforts: tuple[Output, ...]
    reduction: Reduction
    sharpness: Sharpness
    watched: Program

    @classmethod
    @functools.lru_cache(maxsize=32)
    def of(cls, program: Program, method: EvaluationMethod) -> KeptOutputs:
        """Make the reduction of a scene's designs on a method."""
        data, at = program.data, program.outputs
        table = table_of(data.space)
        chosen: dict[Output, tuple[int, ...]] = {}
        for output, k in at.items():
            if output.along or output in program.loop_angles:
                continue
            members = table.reactions if output.group == "reaction" else ()
            if output.group == "load":
                members = (data.content.loads[output.part].size,)
            for member in members:
                size = Output(output.group, output.part, member)
                parts = [other for other in size.components(table) if other in at]
                if parts[:1] == [output] and len(parts) > 1:
                    chosen[size] = tuple(at[other] for other in parts)
            chosen[output] = (k,)
        links = [link for link in data.content.bodies if Output("law", link, "n0") in at]
        names = [
            *chosen,
            *(Output("section", link, force) for link in links for force in table.forces),
        ]
        if not names:
            raise DeclarationError("designs: no wanted output has a peak")
        units = tuple(output.unit(data.kinds) for output in names)
        efforts = tuple(name for name in names if name.group in AVERAGED)
        along = tuple(_along(data, link, at, table) for link in links)
        mass_properties, positive, margins = _mass_properties(program, links, along, method)
        rows = [
            {k for row in (link.law, *link.load_points, *link.distributed_loads) for k in row}
            - {-1}
            for link in along
        ]
        every = [*map(set, chosen.values()), *(row for row in rows for _ in table.forces)]
        sharpness = Sharpness.of(program, sorted({k for columns in every for k in columns}))
        checks = [(bound.column, bound.beside) for bound in program.bounds]
        doubted = {bound.column: number for number, bound in enumerate(program.bounds)}
        sizes: list[tuple[int, Beside]] = [
            (bound.size, "") for bound in program.bounds if bound.beside == "ROW"
        ]
        made = {
            name: made_of(at, name.part, name.member, table)
            if name.group == "section"
            else name.components(table)
            for name in names
        }
        indeterminate_checks = [
            (doubted[program.indeterminate[n]], k)
            for k, name in enumerate(names)
            for n in made[name]
            if n in program.indeterminate
        ]
        reduction = Reduction(
            quantities=tuple(chosen.values()),
            links=along,
            units=tuple(compared(units)),
            efforts=tuple(names.index(name) for name in efforts),
            checks=(*checks, *sizes),
            indeterminate_checks=tuple(indeterminate_checks),
            mass_properties=mass_properties,
            positive=positive,
            margins=margins,
            watches=sharpness.watches,
            knots=sharpness.knots,
            depends=sharpness.dependence(every),
            marks=data.corners.whole,
        )
        return cls(
            tuple(names), units, efforts, reduction, sharpness, with_watched(program, sharpness)
        )


def _along(data: ModelData, link: str, at: dict[Output, int], table: Table) -> Along:
    body = data.content.bodies[link]
    (_, density), sliced = body.length_and_density, bool(body.slices)
    load_points, distributed_loads = load_points_of(at, link), list[tuple[int, ...]]()
    marks: list[tuple[int, ...] | float] = []
    for name, powers in distributed_loads_of(at, link).items():
        width, end = (at[Output("spread", link, member, name)] for member in ("width", "end"))
        if name in data.partial:
            marks += [(end, width), (end,)]
        directions = (*table.distributed, *table.couples) if sliced else table.distributed
        terms = (
            at.get(Output("spread", link, member, name, power), -1)
            for member in directions
            for power in range(powers)
        )
        distributed_loads.append((width, end, *terms))
    if distributed_loads:
        marks += data.jumps[link]
    return Along(
        tuple(at[Output("law", link, member)] for member in table.law),
        tuple(
            tuple(at[Output("station", link, member, load_point)] for member in table.place_first)
            for load_point in load_points
        ),
        density.breaks,
        max(map(len, density.cells)),
        tuple(distributed_loads),
        tuple(marks),
        sliced,
    )


@symbolic
def _mass_properties(
    program: Program, links: list[str], along: tuple[Along, ...], method: EvaluationMethod
) -> tuple[ca.Function, int, int]:
    """Numbers of the parts for the reduction, and how many of them must be positive, and not
    negative.
    """
    data, symbols = program.data, program.data.symbols
    positive, others = data.margins[method.precision].in_order(symbols)
    positive = [data.extent(symbols), *positive]
    rest: list[Any] = []
    for link, part in zip(links, along, strict=True):
        length, density = data.mass_properties(link, symbols)
        rest += mass_properties_of(part, length, density.cells)
    rest += program.limits(method.precision, method.newton, positive[0])
    out = ca.densify(column(ca.SX(value) for value in (*positive, *others, *rest)))
    return (
        ca.Function("matter_of", [symbols], [out], {"cse": True}),
        len(positive),
        len(positive) + len(others),
    )

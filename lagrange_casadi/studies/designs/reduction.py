"""Reduction of a design of a scene, as numbers of columns: the results that the emitted C keeps of
its instants.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arrays import Array
from ...base.quantities import AVERAGED, Output, compared
from ...base.status import Status
from ...base.symbolic import symbolic
from ...base.tables import Table, table_of
from ...base.vocabulary import Precision
from ...codegen.designs import Reduction
from ...codegen.link_curves import Along, matter_of
from ...codegen.stages import Stages, compensated, plain, stages_for
from ...equations.mobility import stations_of
from ...equations.model_data import ModelData
from ...equations.program import Program
from ...equations.spreads import spreads_of
from ...errors import DeclarationError
from ...instants.laws import made_of
from ...instants.rules import NEAR, limit
from ...instants.rung import Rung
from ...summits.sharpness import Sharpness


@symbolic
def stages_of(graph: Program, rung: Rung, t: Array, *, alike: bool = True) -> Stages:
    """Stages that evaluate all designs: in pairs if angles count many turns, or may for some
    parameters.

    ``alike`` tells that all designs have the instants ``t``.
    """
    time, p = graph.laws.motion.sx_in()
    if rung.precision == "single" or (
        alike and not ca.depends_on(ca.vertcat(*graph.laws.motion(time, p)), p)
    ):
        return stages_for(graph, rung.precision, t, graph.data.defaults)
    try:
        return compensated(graph, "double")
    except DeclarationError:
        return plain(graph)


@dataclass(frozen=True, eq=False)
class KeptOutputs:
    """The outputs of which something is kept of each design: peaks of ``quantities``, in ``units``,
    and means of ``efforts``, which are efforts and outputs of the user's own.

    Quantities are the wanted outputs, without angles that loops set, and sizes of joints'
    reactions; the section forces of ``links`` come last. Which of them equilibrium leaves open is
    decided for each design. ``reduction`` is the same in numbers of columns, as C takes it.
    """

    quantities: tuple[Output, ...]
    units: tuple[str, ...]
    efforts: tuple[Output, ...]
    links: tuple[str, ...]
    reduction: Reduction
    sharpness: Sharpness

    @classmethod
    def of(cls, graph: Program, rung: Rung) -> KeptOutputs:
        """Make the reduction of a scene's designs on a rung."""
        data, at = graph.data, graph.outputs
        table = table_of(data.space)
        chosen: dict[Output, tuple[int, ...]] = {}
        for output, k in at.items():
            if output.along or output in graph.loop_angles:
                continue
            for member in table.reactions if output.group == "reaction" else ():
                size = Output("reaction", output.part, member)
                parts = [other for other in size.components(table) if other in at]
                if parts[:1] == [output] and len(parts) > 1:
                    chosen[size] = tuple(at[other] for other in parts)
            chosen[output] = (k,)
        links = [
            link for link in data.template.content["bodies"] if Output("law", link, "n0") in at
        ]
        names = [
            *chosen,
            *(Output("section", link, force) for link in links for force in table.forces),
        ]
        if not names:
            raise DeclarationError("designs: nothing is wanted that has a peak")
        units = tuple(output.unit(data.kinds) for output in names)
        efforts = tuple(name for name in names if name.group in AVERAGED)
        along = tuple(_along(data, link, at, table) for link in links)
        matter, positive, margins = _matter(data, links, along, rung.precision)
        columns = {column for columns in chosen.values() for column in columns}
        rows = [row for link in along for row in (link.law, *link.stations, *link.spreads)]
        columns |= {k for row in rows for k in row if k >= 0}
        sharpness = Sharpness.of(graph, sorted(columns))
        checks = _checks(graph, rung)
        doubted = {
            k: number for number, (k, kind, _) in enumerate(checks) if kind.startswith("OPEN")
        }
        made = {name: _made_of(graph, name, table) for name in names}
        doubts = [
            (doubted[graph.doubtful[n]], k)
            for k, name in enumerate(names)
            for n in made[name]
            if n in graph.doubtful
        ]
        reduction = Reduction(
            quantities=tuple(chosen.values()),
            links=along,
            units=tuple(compared(units)),
            efforts=tuple(names.index(name) for name in efforts),
            checks=tuple(checks),
            doubts=tuple(doubts),
            matter=matter,
            positive=positive,
            margins=margins,
            near=NEAR,
            statuses={status.name: int(status) for status in Status},
            watches=sharpness.watches,
            knots=sharpness.knots,
        )
        return cls(tuple(names), units, efforts, tuple(links), reduction, sharpness)


def _along(data: ModelData, link: str, at: dict[Output, int], table: Table) -> Along:
    density = data.template.content["bodies"][link]["density"]
    sliced = "slices" in density
    stations, spreads = stations_of(at, link), list[tuple[int, ...]]()
    marks: list[tuple[int, ...] | float] = []
    for name, powers in spreads_of(at, link).items():
        width, end = (at[Output("spread", link, member, name)] for member in ("width", "end"))
        if name in data.partial:
            marks += [(end, width), (end,)]
        directions = (*table.spread, *table.couples) if sliced else table.spread
        terms = (
            at.get(Output("spread", link, member, name, power), -1)
            for member in directions
            for power in range(powers)
        )
        spreads.append((width, end, *terms))
    if spreads:
        marks += data.jumps[link]
    return Along(
        tuple(at[Output("law", link, member)] for member in table.law),
        tuple(
            tuple(at[Output("station", link, member, station)] for member in table.place_first)
            for station in stations
        ),
        tuple(density["breaks"]),
        max(len(cell) for cell in density["cells"]),
        tuple(spreads),
        tuple(marks),
        sliced,
    )


def _made_of(graph: Program, quantity: Output, table: Table) -> list[Output]:
    """The outputs that a quantity is made of."""
    if quantity.group == "section":
        return made_of(graph.outputs, quantity.part, quantity.member, table)
    return list(quantity.components(table))


def _checks(graph: Program, rung: Rung) -> list[tuple[int, str, float]]:
    """Limits of a graph's columns for the emitted C; last are the sizes of the terms of rows."""
    found = [
        (bound.column, bound.kind, limit(graph, bound, rung.precision, rung.newton))
        for bound in graph.bounds
    ]
    return [
        *found,
        *((bound.size, "ROWSIZE", 0.0) for bound in graph.bounds if bound.kind == "ROW"),
    ]


@symbolic
def _matter(
    data: ModelData, links: list[str], along: tuple[Along, ...], precision: Precision
) -> tuple[ca.Function, int, int]:
    """Numbers of the parts for the reduction, and how many of them must be positive, and not
    negative.
    """
    symbols = data.symbols
    positive, others = data.margins[precision].in_order(symbols)
    positive = [data.extent(symbols), *positive]
    rest: list[Any] = []
    for link, part in zip(links, along, strict=True):
        length, density = data.matter(link, symbols)
        rest += matter_of(part, length, density.cells)
    out = ca.densify(
        ca.vertcat(ca.SX(0, 1), *(ca.SX(value) for value in (*positive, *others, *rest)))
    )
    return (
        ca.Function("matter_of", [symbols], [out], {"cse": True}),
        len(positive),
        len(positive) + len(others),
    )

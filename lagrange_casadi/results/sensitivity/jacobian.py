"""Total derivatives of the columns of a graph, by time, by the ratio xi/l and by the parameters:
CasADi functions of an instant and a place.

They are those at a time and a place that stand still. Driven coordinates change with the parameters
of their laws, closed forms are differentiated as they stand, and iterated coordinates change by the
implicit function theorem: where Phi(z, t, d, p) = 0 the step -Phi_z^-1 Phi of Newton's method has
the derivative of z by t, d and p for its own at fixed z. Nothing is differentiated through
iterations. Along the solution Phi stays 0, so that what is differentiated once more, with the
iterated coordinates going along, is exact too.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arrays import Expression
from ...base.quantities import Column, Output
from ...base.scalars import graph, inputs_of
from ...base.symbolic import Graphs, symbolic
from ...base.tables import table_of
from ...engine.model_data import ModelData
from ...engine.program import Program
from ...engine.reciprocals import differentiable
from ...engine.section_function import Place, Section
from ...engine.sharpness import Kind, Sharpness, Watch
from ...model.limits import END

SAME_PLACE = 1e-9
"""Distance from a load point, as a ratio to the length, within which a peak along a link is at
it.
"""

_DRIVEN = ("d", "d_rate", "d_acceleration")
"""Inputs of an instant that the motion gives."""

_SWITCHES = (Kind.SWITCH, Kind.STEP, Kind.ROOT, Kind.KNOT)


@dataclass(frozen=True, eq=False)
class PointFunction(Graphs):
    """``function(t, z, p, xi, value, moving, chosen) -> found`` of some quantities of a graph: the
    value, and its derivatives by time [1/s], by xi/l and by all parameters.

    ``chosen`` has a 1 for the quantity that is meant, and 0 for the others; behind the
    ``quantities`` it may be one of the ``switches``: see :class:`.Watch`. ``xi`` is the ratio at
    which a section force is meant; with ``moving`` it moves with the station that is there, on the
    side on which the force is nearer to ``value``.

    It is made backwards, from one quantity to all parameters, so it costs as much for many
    parameters as for one.
    """

    program: Program
    quantities: tuple[Output, ...]
    switches: tuple[Watch, ...]
    function: Any

    @classmethod
    @symbolic
    def of(
        cls, program: Program, quantities: Sequence[Output], sharpness: Sharpness | None = None
    ) -> PointFunction:
        """Make it for some quantities: columns of a graph, resultants of such, section forces; and
        the functions with kinks and jumps.

        Without a ``sharpness`` there is nothing of the latter.
        """
        watches = () if sharpness is None else sharpness.watches
        sharp = [k for k, watch in enumerate(watches) if watch.kind in _SWITCHES]
        instant = differentiable(program.instant)
        every = inputs_of(instant)
        t, _, rate, acceleration, _, p = inputs = [*every.values()]
        xi, value, moving = (ca.SX.sym(name) for name in ("xi", "value", "moving"))
        chosen = ca.SX.sym("chosen", len(quantities) + len(sharp))
        out = instant(*inputs)
        columns: dict[Column, Any] = {output: out[k] for output, k in program.outputs.items()}
        rows, weights = _rows(program.data, p, columns, quantities, xi, value, moving, chosen)
        if sharpness is not None and sharp:
            rows += ca.vertsplit(differentiable(sharpness.watched)(*inputs)[sharp])
            weights += ca.vertsplit(chosen[len(quantities) :])
        # The weights choose, and are not differentiated.
        held = ca.SX.sym("held", len(weights))
        adjoint = ca.jtimes(ca.vertcat(*rows), ca.vertcat(*inputs, xi), held, True)
        by_t, by_drives, by_p = _backwards(program, inputs, adjoint[:-1, :])
        by_t += ca.dot(ca.vertcat(rate, acceleration, program.laws.jerk()(t, p)), by_drives)
        found = ca.vertcat(ca.dot(held, ca.vertcat(*rows)), by_t, adjoint[-1], by_p)
        found = ca.substitute(found, held, ca.vertcat(*weights))
        driven = ca.vertcat(*(every.pop(name) for name in _DRIVEN))
        found = ca.substitute(found, driven, ca.vertcat(*program.motion(t, p)))
        every |= {"xi": xi, "value": value, "moving": moving, "chosen": chosen}
        return cls(
            program,
            tuple(quantities),
            tuple(watches[k] for k in sharp),
            graph("at_once", every, found=found),
        )

    @symbolic
    def further(self) -> ca.Function:
        """``at_once(t, z, p, xi, value, moving, chosen, way) -> found``: the derivatives that
        ``function`` has, and how they change along a ``way`` of time, xi/l and the parameters.

        Raises :class:`.DeclarationError` for a motion by samples whose knots are not known.
        """
        given = inputs_of(self.function)
        t, z, p, xi = (given[name] for name in ("t", "z", "p", "xi"))
        gradient = self.function(*given.values())[1:]
        direction = ca.SX.sym("way", 2 + p.numel())
        of, along = [t, xi, p], [direction[0], direction[1], direction[2:]]
        if self.program.newton is not None:
            step = self.program.newton.step(z, t, self.program.motion(t, p)[0], p)[0]
            along.append(ca.jtimes(step, ca.vertcat(t, p), ca.vertcat(direction[0], direction[2:])))
            of.append(z)
        change = ca.jtimes(gradient, ca.vertcat(*of), ca.vertcat(*along))
        return graph("at_once", given | {"way": direction}, found=ca.vertcat(gradient, change))


def total(program: Program, rows: Sequence[int], by: Sequence[int]) -> ca.Function:
    """``total(t, d, d_rate, d_acceleration, z, p) -> slopes``: of some ``rows`` of a graph by some
    parameters, by their numbers.

    ``slopes`` is (parameters, rows), dense. It is made forward, a sweep a parameter, unless there
    are fewer rows: then backwards, a sweep a row.
    """
    instant = differentiable(program.instant)
    given = inputs_of(instant)
    t, d, rate, acceleration, z, p = inputs = [*given.values()]
    out, of = instant(*inputs)[list(rows)], ca.vertcat(d, rate, acceleration, z, p)
    if len(by) > len(rows):
        adjoint = ca.jtimes(out, ca.vertcat(*inputs), ca.SX.eye(len(rows)), True)
        slopes = _backwards(program, inputs, adjoint)[2][list(by), :]
    else:
        seeds = ca.SX.eye(p.numel())[:, list(by)]
        moved = [ca.jtimes(part, p, seeds) for part in program.motion(t, p)]
        loops = ca.SX(0, len(by))
        if program.newton is not None:
            step = program.newton.step(z, t, d, p)[0]
            loops = ca.jtimes(step, ca.vertcat(d, p), ca.vertcat(moved[0], seeds))
        slopes = ca.jtimes(out, of, ca.vertcat(*moved, loops, seeds)).T
    return graph("total", given, slopes=slopes)


def section_slopes(
    data: ModelData, link: str, columns: Sequence[Output], by: Sequence[int]
) -> ca.Function:
    """``sections(columns, slopes, xi, p) -> changes``: those of all section forces of a link,
    (parameters, forces), at a ratio.

    ``columns`` are what goes into them, at an instant; ``slopes`` (parameters, columns) how that
    changes. At a station a force is that on its tip's side.
    """
    table, p = table_of(data.space), ca.SX.sym("p", len(data.parameters))
    values = ca.SX.sym("columns", len(columns))
    slopes = ca.SX.sym("slopes", len(by), len(columns))
    xi = ca.SX.sym("xi")
    section = data.section(link, dict(zip(columns, ca.vertsplit(values), strict=True)), p)
    values_here = {force: section.at(force, Place(xi), END["double"]) for force in table.sections}
    seeds = ca.vertcat(slopes.T, ca.SX.eye(p.numel())[:, list(by)])
    found = ca.jtimes(ca.vertcat(*values_here.values()), ca.vertcat(values, p), seeds)
    changes = dict(zip(values_here, ca.vertsplit(found), strict=True))
    rows = []
    for force in table.forces:
        parts = table.parts("section", force)
        weights = _weights([values_here[part] for part in parts])
        rows.append(sum(w * changes[part] for w, part in zip(weights, parts, strict=True)))
    given = {"columns": values, "slopes": slopes, "xi": xi, "p": p}
    return graph("at_once", given, changes=ca.vertcat(*rows).T)


def resultant(parts: Sequence[Expression]) -> Expression:
    """The size of what has these components, of one its value."""
    return parts[0] if len(parts) == 1 else ca.sqrt(sum(part * part for part in parts))


def _weights(parts: Sequence[Expression]) -> list[Expression]:
    """Derivatives of a resultant by its components: the resultant changes with the parts of changes
    along it.
    """
    if len(parts) == 1:
        return [1.0]
    size = resultant(parts)
    return [part / ca.if_else(size > 0.0, size, 1.0) for part in parts]


def _backwards(
    program: Program, inputs: Sequence[ca.SX], adjoint: Expression
) -> tuple[Expression, Expression, Expression]:
    """The derivatives by time, by the drives' coordinates, rates and accelerations, and in total by
    the parameters, of what has an ``adjoint``, (inputs, n), by the ``inputs`` of an instant.
    """
    t, d, _, _, z, p = inputs
    by_t, by_d, by_rate, by_acceleration, by_z, by_p = ca.vertsplit(adjoint, _ends(inputs))
    if program.newton is not None:
        step = program.newton.step(z, t, d, p)[0]
        more = ca.jtimes(step, ca.vertcat(t, d, p), by_z, True)
        more_t, more_d, more_p = ca.vertsplit(more, _ends([t, d, p]))
        by_t, by_d, by_p = by_t + more_t, by_d + more_d, by_p + more_p
    by_drives = ca.vertcat(by_d, by_rate, by_acceleration)
    driven = ca.vertcat(*program.motion(t, p))
    return by_t, by_drives, by_p + ca.jtimes(driven, p, by_drives, True)


def _ends(parts: Sequence[ca.SX]) -> list[int]:
    """First row of each of some parts that stand below each other, and the end of the last one."""
    return [0, *itertools.accumulate(part.numel() for part in parts)]


def _rows(
    data: ModelData,
    p: Expression,
    columns: dict[Column, Expression],
    quantities: Sequence[Output],
    xi: Expression,
    value: Expression,
    moving: Expression,
    chosen: ca.SX,
) -> tuple[list[Expression], list[Expression]]:
    """Rows of which a sum is the quantity that is meant, and their weights in it."""
    table = table_of(data.space)
    rows: list[Any] = []
    weights: list[Any] = []
    links: dict[str, Section] = {}

    def add(parts: Sequence[Expression], weight: Expression) -> None:
        rows.extend(parts)
        weights.extend(weight * values_here for values_here in _weights(parts))

    for k, quantity in enumerate(quantities):
        if quantity.group != "section":
            add(
                [columns[part] for part in quantity.components(table) if part in columns], chosen[k]
            )
            continue
        link = links.setdefault(quantity.part, data.section(quantity.part, columns, p))
        names, factor = table.parts("section", quantity.member), ca.SX(1.0)
        marks = link.marks
        here = {
            id(place): [link.at(name, place, END["double"]) for name in names] for place in marks
        }
        gaps = {key: ca.fabs(resultant(parts) - value) for key, parts in here.items()}
        for place in marks:
            nearer, gap = ca.SX(1.0), gaps[id(place)]
            for other in marks if place.load_point else ():
                if other.load_point == place.load_point and other is not place:
                    beside = gaps[id(other)]
                    nearer = gap < beside if place.side == "base" else gap <= beside
            taken = factor * moving * (ca.fabs(xi - place.ratio) <= SAME_PLACE) * nearer
            factor = factor - taken
            add(here[id(place)], chosen[k] * taken)
        add([link.at(name, Place(xi), END["double"]) for name in names], chosen[k] * factor)
    return rows, weights

"""Quantities at single points, a time and a ratio xi/l each, and their derivatives by all
parameters: one CasADi function.

The derivative is the total one, at a time that stands still. Driven coordinates change with the
parameters of their laws, closed forms are differentiated as they stand, and iterated coordinates
change by the implicit function theorem: where Phi(z, t, d, p) = 0 the step -Phi_z^-1 Phi of
Newton's method has the derivative of z by t, d and p for its own at fixed z. Nothing is
differentiated through iterations.

It is done backwards, from one quantity to all parameters, so it costs as much for many parameters
as for one. The time derivative comes with it; so does what a place that moves along a link adds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.quantities import Output
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..declare.limits import END
from ..equations.checks import Column
from ..equations.model_data import ModelData
from ..equations.program import Program
from ..equations.reciprocals import differentiable
from ..equations.section_function import Place, Section
from ..summits.sharpness import Kind, Sharpness, Watch

SAME_PLACE = 1e-9
"""Distance, as a ratio to the length, within which a peak along a link is at a load point."""

_DRIVES = ("d", "d_rate", "d_acceleration", "d_jerk")
_SWITCHES = (Kind.SWITCH, Kind.STEP, Kind.ROOT, Kind.KNOT)


@dataclass(frozen=True, eq=False)
class PointFunction(Graphs):
    """``function(t, z, p, xi, value, moving, chosen) -> (value, rate, slopes)`` of some quantities
    of a graph.

    ``chosen`` has a 1 for the quantity that is meant, and 0 for the others; behind the
    ``quantities`` it may be one of the ``switches``: see :class:`.Watch`. ``xi`` is the ratio at
    which a section force is meant; with ``moving`` it moves with the station that is there, on the
    side on which the force is nearer to ``value``. ``rate`` is the derivative by time [1/s],
    ``slopes`` (parameters,) are those by the parameters at that time. ``at_drives`` is the same
    function of the drives' coordinates, rates, accelerations and the rates of these, which are
    given too.
    """

    quantities: tuple[Output, ...]
    switches: tuple[Watch, ...]
    function: Any
    at_drives: Any

    @classmethod
    @symbolic
    def of(
        cls, graph: Program, quantities: Sequence[Output], sharpness: Sharpness | None = None
    ) -> PointFunction:
        """Make it for some quantities: columns of a graph, resultants of such, section forces; and
        the functions with kinks and jumps.

        Without a ``sharpness`` there is nothing of the latter.
        """
        watches = () if sharpness is None else sharpness.watches
        sharp = [k for k, watch in enumerate(watches) if watch.kind in _SWITCHES]
        inner = _at_drives(
            graph, quantities, None if sharpness is None else sharpness.watched, sharp
        )
        given = {inner.name_in(k): inner.sx_in(k) for k in range(inner.n_in())}
        t, p = (given[name] for name in ("t", "p"))
        given |= dict(
            zip(_DRIVES, [*graph.motion.call([t, p]), graph.laws.jerk()(t, p)], strict=True)
        )
        found = inner.call([given[inner.name_in(k)] for k in range(inner.n_in())])
        names = ["t", "z", "p", "xi", "value", "moving", "chosen"]
        every = [given[name] for name in names]
        made = ca.Function(
            "at_point", every, found, names, ["found", "rate", "slopes"], {"cse": True}
        )
        return cls(tuple(quantities), tuple(watches[k] for k in sharp), made, inner)


def _at_drives(
    graph: Program, quantities: Sequence[Output], watched: Any, sharp: Sequence[int]
) -> Any:
    """Function of given coordinates, rates, accelerations and jerks of the drives."""
    instant = differentiable(graph.instant)
    t, d, rate, acceleration, z, p = inputs = instant.sx_in()
    xi, value, moving, jerk = (
        ca.SX.sym(name, size)
        for name, size in (("xi", 1), ("value", 1), ("moving", 1), ("jerk", d.numel()))
    )
    chosen = ca.SX.sym("chosen", len(quantities) + len(sharp))
    out = instant(*inputs)
    columns: dict[Column, Any] = {output: out[k] for output, k in graph.outputs.items()}
    rows, weights = _rows(graph.data, p, columns, quantities, xi, value, moving, chosen)
    rows += ca.vertsplit(differentiable(watched)(*inputs)[list(sharp)]) if sharp else []
    weights += ca.vertsplit(chosen[len(quantities) :]) if sharp else []
    rows, weights = ca.vertcat(*rows), ca.vertcat(*weights)
    # The weights choose, and are not differentiated.
    held = ca.SX.sym("held", weights.numel())
    adjoint = ca.jtimes(rows, ca.vertcat(*inputs), held, True)
    by_t, by_d, by_rate, by_acceleration, by_z, by_p = ca.vertsplit(adjoint, _ends(inputs))
    if graph.newton is not None:
        step = graph.newton.step(z, t, d, p)[0]
        more = ca.jtimes(step, ca.vertcat(t, d, p), by_z, True)
        more_t, more_d, more_p = ca.vertsplit(more, _ends([t, d, p]))
        by_t, by_d, by_p = by_t + more_t, by_d + more_d, by_p + more_p
    in_time = (
        by_t + ca.dot(by_d, rate) + ca.dot(by_rate, acceleration) + ca.dot(by_acceleration, jerk)
    )
    driven = ca.vertcat(*graph.laws.motion(t, p))
    by_p = by_p + ca.jtimes(driven, p, ca.vertcat(by_d, by_rate, by_acceleration), True)
    found = [ca.dot(held, rows), in_time, by_p]
    found = [ca.densify(x) for x in ca.substitute(found, [held], [weights])]
    names = ["t", *_DRIVES, "z", "p", "xi", "value", "moving", "chosen"]
    every = [t, d, rate, acceleration, jerk, z, p, xi, value, moving, chosen]
    return ca.Function("at_drives", every, found, names, ["found", "rate", "slopes"], {"cse": True})


def _ends(parts: Sequence[Any]) -> list[int]:
    """First row of each of some parts that stand below each other, and the end of the last one."""
    ends = [0]
    for part in parts:
        ends.append(ends[-1] + part.numel())
    return ends


def _rows(
    data: ModelData,
    p: Any,
    columns: dict[Column, Any],
    quantities: Sequence[Output],
    xi: Any,
    value: Any,
    moving: Any,
    chosen: Any,
) -> tuple[list[Any], list[Any]]:
    """Rows of which a sum is the quantity that is meant, and their weights in it."""
    table = table_of(data.space)
    rows: list[Any] = []
    weights: list[Any] = []
    links: dict[str, Section] = {}

    def add(parts: Sequence[Any], weight: Any) -> None:
        """A quantity, or several of which it is the size: the slope of a size is that of what goes
        along it.
        """
        size = ca.sqrt(sum(part * part for part in parts)) if len(parts) > 1 else 1.0
        rows.extend(parts)
        weights.extend(
            [weight * part / ca.if_else(size > 0.0, size, 1.0) for part in parts]
            if len(parts) > 1
            else [weight]
        )

    for k, quantity in enumerate(quantities):
        if quantity.group != "section":
            add(
                [columns[part] for part in quantity.components(table) if part in columns], chosen[k]
            )
            continue
        link = links.setdefault(quantity.part, data.section(quantity.part, columns, p))
        names, left = table.parts("section", quantity.member), ca.SX(1.0)
        marks = link.marks
        here = {
            id(place): [link.at(name, place, END["double"]) for name in names] for place in marks
        }
        sizes = {key: resultant(parts) for key, parts in here.items()}
        for place in marks:
            twins = [
                other
                for other in marks
                if other.station == place.station and other is not place and place.station
            ]
            nearer = ca.SX(1.0)
            for twin in twins:
                own, others = (ca.fabs(sizes[id(each)] - value) for each in (place, twin))
                nearer = own < others if place.side == "base" else own <= others
            taken = left * moving * (ca.fabs(xi - place.ratio) <= SAME_PLACE) * nearer
            left = left - taken
            add(here[id(place)], chosen[k] * taken)
        add([link.at(name, Place(xi), END["double"]) for name in names], chosen[k] * left)
    return rows, weights


def resultant(parts: Sequence[Any]) -> Any:
    """The size of what has these components, of one its value."""
    return parts[0] if len(parts) == 1 else ca.sqrt(sum(part * part for part in parts))

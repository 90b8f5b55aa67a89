"""Outputs of the user's own: their expressions with what is found put in for the symbols of results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from ..base.quantities import Output
from ..base.tables import Table, table_of
from ..base.vocabulary import Precision
from ..declare.density import Density
from ..declare.limits import END
from ..declare.parts import Link
from ..declare.results import Asked
from ..errors import DeclarationError
from .checks import Column
from .kinematics import Kinematics
from .mobility import stations_of
from .multibody import Multibody, column
from .spreads import felt_along


def own_outputs(body: Multibody, solved: Kinematics, found: Mapping[Column, Any]) -> dict[Column, Any]:
    """The user's outputs as expressions of an instant, where ``found`` are the columns that they may be made of."""
    mechanism = body.mechanism
    asked = [asked for asked in mechanism.asked if any(asked in mechanism.outputs[name].made_of for name in body.own)]
    values = column(_value(mechanism.links, one, found, table_of(mechanism.space)) for one in asked)
    symbols = column(one.symbol for one in asked)
    placed = solved.evaluate(column(body.own.values()))
    return {
        Output("output", name): value
        for name, value in zip(body.own, ca.vertsplit(ca.substitute(placed, symbols, values)) if body.own else (), strict=True)
    }


def _value(links: Mapping[str, Link], asked: Asked, found: Mapping[Column, Any], table: Table) -> Any:
    if asked.output.group == "section":
        return section_force(links[asked.output.part], asked.output.member, asked.ratio, found, table)
    if asked.output not in found:
        drives = ", ".join(str(key.part) for key in found if isinstance(key, Output) and key.group == "effort")
        raise DeclarationError(
            f"an output is made of {asked.output}, and joint '{asked.output.part}' is no drive; drives: {drives}"
        )
    return found[asked.output]


def sight(ratio: Any, precision: Precision) -> Any:
    """From where on a section sees what acts at stations: see :func:`.grids.sight`, which has it in numbers."""
    return ca.fmin(ca.fmax(ratio, END[precision]), 1.0 - END[precision])


def section_force(link: Link, force: str, ratio: Any, found: Mapping[Column, Any], table: Table, middle: Any | None = None) -> Any:
    """A force of a link's law (:mod:`.mobility`) at a ratio; at a station, on its tip's side, or on that of a ``middle``."""
    assert isinstance(link.mass, Density)
    t0, t1, t2 = link.mass.tails(ratio, link.length)
    l = link.length

    def law(member: str) -> Any:
        return found[Output("law", link.name, member)]

    terms = table.sections[force]
    if terms.shear:
        first, *others = (law(name) for name in terms.coefficients)
        arms = (l * (1 - ratio), l * t1, l * l * (ratio * t1 + t2))
        parts = [first, *(coefficient * (terms.arm * arm) for coefficient, arm in zip(others, arms, strict=True))]
    else:
        parts = [law(name) * factor for name, factor in zip(terms.coefficients, (1, t0, l * (ratio * t0 + t1)), strict=False)]
    total = sum(parts[1:], ca.SX(parts[0]))
    for name in stations_of((key for key in found if isinstance(key, Output)), link.name):
        place, load = (found[Output("station", link.name, member, name)] for member in ("station", terms.acting))
        if terms.shear:
            across = found[Output("station", link.name, table.sections[terms.shear].acting, name)]
            load = load + across * (terms.arm * (l * (place - ratio)))
        at = ca.SX(ratio if middle is None else middle)
        # One graph serves both precisions.
        seen = sight(at, "single") < place
        total += ca.SX(load) if seen.is_one() else ca.SX(0) if seen.is_zero() else ca.if_else(seen, load, 0)
    return sum(felt_along(found, link.name, link.length, terms, ratio), total)

"""Outputs of the user's own: their expressions with what is found put in for the symbols of results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from ..base.quantities import Output
from ..base.tables import Table, table_of
from ..declare.density import Density
from ..declare.limits import END
from ..declare.parts import Link
from ..declare.results import Asked
from ..errors import DeclarationError
from .checks import Column
from .kinematics import Kinematics
from .multibody import Multibody, column
from .section_function import Place, Section


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
        link = links[asked.output.part]
        assert isinstance(link.mass, Density)
        section = Section(link.name, table, found, link.length, link.mass)
        # One graph serves both precisions.
        return section.at(asked.output.member, Place(asked.ratio), END["single"])
    if asked.output not in found:
        drives = ", ".join(str(key.part) for key in found if isinstance(key, Output) and key.group == "effort")
        raise DeclarationError(
            f"an output is made of {asked.output}, and joint '{asked.output.part}' is no drive; drives: {drives}"
        )
    return found[asked.output]

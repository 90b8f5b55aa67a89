"""Outputs of the user's own: their expressions with what is found put in for the symbols of results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from ..declare.density import Density
from ..declare.parts import Link
from ..declare.results import Asked
from ..errors import DeclarationError
from ..quantities import Output
from .checks import Column
from .kinematics import Kinematics
from .mobility import stations_of
from .multibody import Multibody, column


def own_outputs(body: Multibody, solved: Kinematics, found: Mapping[Column, Any]) -> dict[Column, Any]:
    """The user's outputs as expressions of an instant, where ``found`` are the columns that they may be made of."""
    mechanism = body.mechanism
    asked = [asked for asked in mechanism.asked if any(asked in mechanism.outputs[name].made_of for name in body.own)]
    values = column(_value(mechanism.links, one, found) for one in asked)
    symbols = column(one.symbol for one in asked)
    placed = solved.evaluate(column(body.own.values()))
    return {
        Output("output", name): value
        for name, value in zip(body.own, ca.vertsplit(ca.substitute(placed, symbols, values)) if body.own else (), strict=True)
    }


def _value(links: Mapping[str, Link], asked: Asked, found: Mapping[Column, Any]) -> Any:
    if asked.output.group == "section":
        return _section(links[asked.output.part], asked.output.member, asked.ratio, found)
    if asked.output not in found:
        drives = ", ".join(str(key.part) for key in found if isinstance(key, Output) and key.group == "effort")
        raise DeclarationError(
            f"an output is made of {asked.output}, and joint '{asked.output.part}' is no drive; drives: {drives}"
        )
    return found[asked.output]


def _section(link: Link, force: str, ratio: Any, found: Mapping[Column, Any]) -> Any:
    """A force of a link's law (:mod:`.mobility`) at a ratio; at a station, on its tip's side."""
    assert isinstance(link.mass, Density)
    t0, t1, t2 = link.mass.tails(ratio, link.length)
    l = link.length

    def law(member: str) -> Any:
        return found[Output("law", link.name, member)]

    if force == "bending":
        terms = [law("m0"), law("f0") * (l * (1 - ratio)), law("f1") * (l * t1), law("f2") * (l * l * (ratio * t1 + t2))]
    else:
        names = ("n0", "n1", "n2") if force == "axial" else ("f0", "f1", "f2")
        terms = [law(name) * factor for name, factor in zip(names, (1, t0, l * (ratio * t0 + t1)), strict=True)]
    total = sum(terms[1:], ca.SX(terms[0]))
    for name in stations_of((key for key in found if isinstance(key, Output)), link.name):
        place, n, f, m = (found[Output("station", link.name, member, name)] for member in ("station", "n", "f", "m"))
        load = {"axial": n, "shear": f, "bending": m + f * (l * (place - ratio))}[force]
        seen = ca.logic_or(ca.SX(ratio) < place, ca.logic_and(ca.SX(ratio) >= 1, place >= 1))
        total += ca.SX(load) if seen.is_one() else ca.SX(0) if seen.is_zero() else ca.if_else(seen, load, 0)
    return total

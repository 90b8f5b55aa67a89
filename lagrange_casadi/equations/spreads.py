"""What loads along a link add to its section forces: terms of their own, beside those of its matter.

A load acts up to ``end``, a ratio u = xi/l, on so much of the link as ``width`` says, with the value c_0 + c_1 s + c_2 s^2 + ...
per length, where s = (end - u)/width. With x = s kept from 0 to 1, L = l width and a = l max(end - width - u, 0), the section at u
feels of each coefficient

    c_j L x^(j+1)/(j+1)                              of a force,
    c_j L x^(j+1)/(j+1) (L x/(j+2) + a)              of a moment.

Each is a product, so nothing cancels: not where the load ends, and not of a short load.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import casadi as ca

from ..declare.parts import LineLoad, Link
from ..quantities import Output
from ..tables import table_of
from .checks import Column
from .multibody import Multibody


def spreads(multibody: Multibody, link: Link) -> dict[Column, Any]:
    """Of each load along a link where it ends, on how much of the link it acts, and its coefficients on the link's axes."""
    directions = table_of(multibody.mechanism.space).spread
    found: dict[Column, Any] = {}
    for part in multibody.applied:
        if part.spread is None or part.point.body is not link:
            continue
        load = multibody.mechanism.loads[part.source]
        assert isinstance(load, LineLoad)
        found[Output("spread", link.name, "width", load.name)] = ca.SX(load.width)
        found[Output("spread", link.name, "end", load.name)] = ca.SX(load.end)
        for power, components in enumerate(part.spread):
            for member, value in zip(directions, components, strict=False):
                found[Output("spread", link.name, member, load.name, power)] = ca.SX(value)
    return found


def spreads_of(outputs: Iterable[Output], link: str) -> dict[str, int]:
    """The loads along a link that outputs name, in their order, and how many powers each has."""
    found: dict[str, int] = {}
    for output in outputs:
        if output.group == "spread" and output.part == link:
            many = 0 if output.power is None else output.power + 1
            found[output.station] = max(found.get(output.station, 0), many)
    return found


def felt(outputs: Mapping[Column, Any], link: Link, load: str, powers: int, direction: str, ratio: Any, *, arm: bool) -> Any:
    """What a section at a ratio feels of a load along its link in a direction: the force, or with ``arm`` its moment."""

    def value(member: str, power: int | None = None) -> Any:
        return outputs[Output("spread", link.name, member, load, power)]

    width, end = value("width"), value("end")
    x = ca.fmin(ca.fmax((end - ratio) / width, 0), 1)
    reach, lever = link.length * width, link.length * ca.fmax(end - width - ratio, 0)

    def terms() -> Iterator[Any]:
        for power in range(powers):
            share = value(direction, power) * (reach * x ** (power + 1) / (power + 1))
            yield share * (reach * x / (power + 2) + lever) if arm else share

    return sum(terms(), ca.SX(0))

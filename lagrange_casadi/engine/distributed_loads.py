"""Distributed loads of a link as columns, which section forces are made of beside the link's mass
(:mod:`.section_function`).

A load acts up to ``end``, a ratio u = xi/l, on so much of the link as ``width`` says, with the
value c_0 + c_1 s + c_2 s^2 + ... per length, where s = (end - u)/width.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.quantities import Column, Output
from ..base.tables import table_of
from ..model.declared_parts import Link, Vector
from ..model.link_density import Density, shifted
from ..model.loads import LineLoad
from ..model.mechanism import Mechanism
from .multibody import Multibody


def distributed_loads(multibody: Multibody, link: Link) -> dict[Column, Expression]:
    """End, width and coefficients on the link's axes of each distributed load of a link."""
    directions = table_of(multibody.mechanism.space).distributed
    found: dict[Column, Any] = {}
    for part in multibody.applied:
        if part.distributed is None or part.point.body is not link:
            continue
        load = multibody.mechanism.loads[part.source]
        assert isinstance(load, LineLoad)
        found[Output("spread", link.name, "width", load.name)] = ca.SX(load.width)
        found[Output("spread", link.name, "end", load.name)] = ca.SX(load.end)
        for power, components in enumerate(part.distributed):
            for member, value in zip(directions, components, strict=False):
                found[Output("spread", link.name, member, load.name, power)] = ca.SX(value)
    return found


ROTARY = "rotary"
"""Name of the rotary inertia of slices among distributed loads, unless another load has this
name.
"""


def rotary(
    multibody: Multibody, link: Link, rate: Vector, angular: Vector
) -> dict[Column, Expression]:
    """The rotary inertia of a link's slices as couples along it, between each two places at which
    it may jump (d'Alembert).

    ``rate`` and ``angular`` are the link's angular velocity w and its change a, on its axes. Of
    second moments yy, zz, yz per length it is, per length,

        c_x = -yy (a_x + w_y w_z) + zz (w_y w_z - a_x) + yz (w_y^2 - w_z^2), c_y = -yz (w_x w_y -
        a_z) - zz (w_x w_z + a_y),    c_z = yy (w_x w_y - a_z) + yz (w_x w_z + a_y).
    """
    assert isinstance(link.mass, Density)
    slices = link.mass.slices
    if slices is None:
        return {}
    (x, y, z), (ax, ay, az) = rate, angular
    yz, xy, xz = y * z, x * y - az, x * z + ay
    found: dict[Column, Any] = {}
    names = _unnamed(multibody.mechanism, ROTARY)
    for name, (start, stop) in zip(names, itertools.pairwise(slices.breaks), strict=False):
        width = stop - start
        found[Output("spread", link.name, "width", name)] = ca.SX(width)
        found[Output("spread", link.name, "end", name)] = ca.SX(stop)
        # Polynomials of u = stop - width s as ones of s.
        cells = (
            [
                (-width) ** j * c
                for j, c in enumerate(shifted(moment.cell_at((start + stop) / 2), stop))
            ]
            for moment in slices.each
        )
        for power, (own_yy, own_zz, own_yz) in enumerate(
            itertools.zip_longest(*cells, fillvalue=0.0)
        ):
            couples = (
                own_zz * (yz - ax) - own_yy * (yz + ax) + own_yz * (y * y - z * z),
                -own_yz * xy - own_zz * xz,
                own_yy * xy + own_yz * xz,
            )
            for member, couple in zip(table_of(True).couples, couples, strict=True):
                found[Output("spread", link.name, member, name, power)] = ca.SX(couple)
    return found


def _unnamed(mechanism: Mechanism, word: str) -> Iterator[str]:
    """Names that nothing that acts has: a word, and the word with numbers."""
    taken = {*mechanism.joints, *mechanism.loads, *mechanism.constraints, *mechanism.rows}
    taken |= {*mechanism.drives}
    names = itertools.chain([word], (f"{word}_{k}" for k in itertools.count(2)))
    return (name for name in names if name not in taken)


def distributed_loads_of(outputs: Iterable[Output], link: str) -> dict[str, int]:
    """The loads along a link that outputs name, in their order, and how many powers each has."""
    found: dict[str, int] = {}
    for output in outputs:
        if output.group == "spread" and output.part == link:
            many = 0 if output.power is None else output.power + 1
            found[output.load_point] = max(found.get(output.load_point, 0), many)
    return found

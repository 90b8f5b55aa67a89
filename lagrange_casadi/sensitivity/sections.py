"""Derivatives of section forces by parameters: of a link's law, its length and its density, at
ratios xi/l that stand still.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from ..base.quantities import Output
from ..base.tables import table_of
from ..declare.limits import END
from ..equations.model_data import ModelData
from ..equations.section_function import Place


def section_slopes(data: ModelData, link: str, columns: Sequence[Output], by: Sequence[int]) -> Any:
    """``sections(columns, slopes, xi, p) -> changes``: those of all section forces of a link,
    (parameters, forces), at a ratio.

    ``columns`` are what goes into them, at an instant; ``slopes`` (parameters, columns) how that
    changes. At a station a force is that on its tip's side. A size changes as what goes along it
    does.
    """
    table, p = table_of(data.space), ca.SX.sym("p", len(data.parameters))
    values, slopes, xi = (
        ca.SX.sym("columns", len(columns)),
        ca.SX.sym("slopes", len(by), len(columns)),
        ca.SX.sym("xi"),
    )
    section = data.section(link, dict(zip(columns, ca.vertsplit(values), strict=True)), p)
    own = {force: section.at(force, Place(xi), END["double"]) for force in table.sections}
    seeds = ca.SX(p.numel(), len(by))
    for k, j in enumerate(by):
        seeds[j, k] = 1.0
    found = ca.jtimes(ca.vertcat(*own.values()), ca.vertcat(values, p), ca.vertcat(slopes.T, seeds))
    changes = dict(zip(own, ca.vertsplit(found), strict=True))
    rows = []
    for force in table.forces:
        parts = table.parts("section", force)
        size = ca.sqrt(sum(own[part] * own[part] for part in parts)) if len(parts) > 1 else None
        if size is None:
            rows.append(changes[force])
        else:
            rows.append(
                sum(own[part] * changes[part] for part in parts) / ca.if_else(size > 0.0, size, 1.0)
            )
    given, names = [values, slopes, xi, p], ["columns", "slopes", "xi", "p"]
    return ca.Function(
        "at_once", given, [ca.densify(ca.vertcat(*rows).T)], names, ["changes"], {"cse": True}
    )

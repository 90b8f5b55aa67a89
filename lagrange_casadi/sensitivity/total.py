"""Total derivatives of a graph's columns by parameters at an instant, all at once: one CasADi
function.

They are those at a time that stands still. Driven coordinates change with the parameters of their
laws, iterated ones by the implicit function theorem, as in :mod:`.points`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from ..equations.program import Program
from ..equations.reciprocals import differentiable


def total(graph: Program, rows: Sequence[int], by: Sequence[int]) -> Any:
    """``total(t, d, d_rate, d_acceleration, z, p) -> slopes``: of some ``rows`` of a graph by some
    parameters, by their numbers.

    ``slopes`` is (parameters, rows), dense. It is made forward, a sweep a parameter, unless there
    are fewer rows: then backwards, a sweep a row.
    """
    instant = differentiable(graph.instant)
    t, d, rate, acceleration, z, p = inputs = instant.sx_in()
    out = instant(*inputs)[list(rows)]
    moved = [*_driven(graph, t, p, by), ca.SX(0, len(by)), _seeds(p.numel(), by)]
    if graph.newton is not None:
        step = graph.newton.step(z, t, d, p)[0]
        moved[3] = ca.jtimes(step, ca.vertcat(d, p), ca.vertcat(moved[0], moved[4]))
    of, along = ca.vertcat(d, rate, acceleration, z, p), ca.vertcat(*moved)
    forward = len(by) <= len(rows)
    slopes = (
        ca.jtimes(out, of, along).T
        if forward
        else along.T @ ca.jtimes(out, of, ca.SX.eye(len(rows)), True)
    )
    names = ["t", "d", "d_rate", "d_acceleration", "z", "p"]
    return ca.Function("total", inputs, [ca.densify(slopes)], names, ["slopes"], {"cse": True})


def _seeds(count: int, by: Sequence[int]) -> Any:
    """Derivatives of all parameters by some of them."""
    seeds = ca.SX(count, len(by))
    for k, j in enumerate(by):
        seeds[j, k] = 1.0
    return seeds


def _driven(graph: Program, t: Any, p: Any, by: Sequence[int]) -> list[Any]:
    """Derivatives of the drives' coordinates, rates and accelerations by some parameters."""
    return [ca.jtimes(part, p, _seeds(p.numel(), by)) for part in graph.laws.motion(t, p)]

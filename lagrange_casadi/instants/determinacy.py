"""What equilibrium determines, decided for the parameters and instants that are evaluated.

In a mechanism with more constraints than it needs, forces are f + s u, where u is what equilibrium leaves open. A check ``open`` of
a force is the size of s. A force is determined where that is zero: by structure, and then it has no such check, in every posture,
or in one alone.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.status import Status
from ..equations.checks import Check, Column
from ..equations.program import Program
from .backends import run
from .rules import limits
from .rung import Rung


def undetermined(graph: Program, out: Array, p: Array, rung: Rung) -> tuple[Output, ...]:
    """The outputs that equilibrium leaves open at any of some instants, by the columns there, (columns, t)."""
    if not graph.doubtful:
        return ()
    known = zip(graph.bounds, limits(graph, rung.precision, rung.newton, graph.extent(p)), strict=True)
    most = {bound.column: limit for bound, limit in known}
    return tuple(output for output, k in graph.doubtful.items() if np.any(out[k] > most[k]))


def determinate(graph: Program, t: Array, p: Array, *, telling: bool = False) -> tuple[Program, tuple[Output, ...]]:
    """The graph without the outputs that are open at some of the instants, for parameters ``p``; and these outputs.

    With ``telling`` it goes on to tell, for other parameters and instants, where others are open.
    """
    if not graph.doubtful:
        return graph, ()
    table, _ = run(graph, t, p, Rung("vm"))
    left_open = undetermined(graph, table.out[:, table.status == Status.OK], p, Rung())
    others = () if telling else tuple(output for output in graph.doubtful if output not in left_open)
    return _without(graph, (*left_open, *(Check("open", output) for output in (*left_open, *others)))), left_open


@functools.lru_cache(maxsize=32)
def _without(graph: Program, columns: tuple[Column, ...]) -> Program:
    kept = [k for k, column in enumerate(graph.columns) if column not in columns]
    inputs = graph.instant.sx_in()
    names = [graph.instant.name_in(i) for i in range(graph.instant.n_in())]
    instant = ca.Function("instant", inputs, [ca.densify(graph.instant(*inputs)[kept])], names, ["out"], {"cse": True})
    return replace(graph, instant=instant, columns=tuple(graph.columns[k] for k in kept))

"""What equilibrium determines, decided for the parameters and instants that are evaluated.

In a mechanism with more constraints than it needs, forces are f + s u, where u is what equilibrium leaves open: the column
``_open:NAME`` is the size of s. A force is determined where that is zero: by structure, and then it has no such column, in every
posture, or in one alone.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import casadi as ca
import numpy as np

from ..arithmetic.compensated import Precision
from ..codegen.emit import OK
from ..declare.density import Array
from ..equations.scene_graph import SceneGraph
from ..quantities import MOMENT, unit_in
from .backends import run
from .rung import Rung

_OPEN: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
_COUNTED = 1e-3
"""Where loops are closed by so many steps: what is zero where they are closed is as small as what is left of them."""


def open_limits(graph: SceneGraph, rung: Rung) -> dict[str, tuple[float, bool]]:
    """Of each output that equilibrium may leave open, the size of s above which it does.

    And whether that goes times the mechanism's extent, as moments do.
    """
    least = _OPEN[rung.precision] if rung.newton is None else max(_COUNTED, _OPEN[rung.precision])
    return {name: (least, unit_in(graph.scene.mechanism.joints, name) == MOMENT) for name in graph.doubtful}


def undetermined(graph: SceneGraph, out: Array, p: Array, rung: Rung) -> tuple[str, ...]:
    """The outputs that equilibrium leaves open at any of some instants, by the columns there, (columns, t)."""
    if not graph.doubtful:
        return ()
    extent, limits = graph.extent(p), open_limits(graph, rung)
    sizes = {name: limit * (extent if moment else 1.0) for name, (limit, moment) in limits.items()}
    return tuple(name for name, k in graph.doubtful.items() if np.any(out[k] > sizes[name]))


def determinate(graph: SceneGraph, t: Array, p: Array, *, telling: bool = False) -> tuple[SceneGraph, tuple[str, ...]]:
    """The graph without the outputs that are open at some of the instants, for parameters ``p``; and these outputs.

    With ``telling`` it goes on to tell, for other parameters and instants, where others are open.
    """
    if not graph.doubtful:
        return graph, ()
    table, _ = run(graph, t, p, Rung("vm"))
    left_open = undetermined(graph, table.out[:, table.status == OK], p, Rung())
    others = () if telling else tuple(name for name in graph.doubtful if name not in left_open)
    return _without(graph, (*left_open, *(f"_open:{name}" for name in (*left_open, *others)))), left_open


@functools.lru_cache(maxsize=32)
def _without(graph: SceneGraph, columns: tuple[str, ...]) -> SceneGraph:
    kept = [k for k, name in enumerate(graph.columns) if name not in columns]
    inputs = graph.instant.sx_in()
    names = [graph.instant.name_in(i) for i in range(graph.instant.n_in())]
    instant = ca.Function("instant", inputs, [ca.densify(graph.instant(*inputs)[kept])], names, ["out"], {"cse": True})
    return replace(graph, instant=instant, columns=tuple(graph.columns[k] for k in kept))

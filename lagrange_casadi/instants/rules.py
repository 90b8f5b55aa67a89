"""Limits of what columns must keep to (:mod:`..equations.status`), by the precision in which they
are evaluated.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import ROUNDING
from ..base.arrays import Array
from ..base.vocabulary import Precision
from ..codegen.emit import NEWTON_LOST
from ..declare.ends import BEYOND
from ..equations.checks import Check
from ..equations.program import Program
from ..equations.status import Bound
from ..equations.turns import REACH

MISFIT: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""Largest residual of redundant equations, relative to the links' length, and of a row, relative to
its terms.
"""

OPEN: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
_COUNTED = 1e-3
"""Limit for iterated loops that are closed by a fixed number of steps: zero is as small as their
residual.
"""

_DEAD = 64.0
"""Roundings below which a closure says nothing but that it is zero."""

SLIP: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
"""Largest relative residual of friction laws."""

NEAR = 0.3
"""Sines of the transmission angle below which a loop may pass a dead centre."""

EXTENSIVE = ("GAP", "OPEN_MOMENT")
"""Kinds whose limit is a share of the mechanism's extent."""


def limits(graph: Program, precision: Precision, newton: int | None, extent: Any) -> list[Any]:
    """The limits of a graph's bounds, in their order, for its ``extent``; ``newton`` as in
    :class:`.Rung`.
    """
    shares = (
        (limit(graph, bound, precision, newton), bound.kind in EXTENSIVE) for bound in graph.bounds
    )
    return [share * extent if extensive else share for share, extensive in shares]


def limit(graph: Program, bound: Bound, precision: Precision, newton: int | None) -> float:
    """The limit of a bound; of those that are :data:`EXTENSIVE` a share
    of the mechanism's extent.
    """
    exact, kind = newton is None, bound.kind
    if kind in ("OPEN", "OPEN_MOMENT"):
        return open_limit(graph, precision, newton)
    if kind == "BEYOND":
        return BEYOND[precision]
    if kind in ("CLOSURE", "BRANCH"):
        check = graph.columns[bound.column]
        assert isinstance(check, Check)
        return (
            dead_centre(graph, precision, str(bound.part))
            if check.kind == "closure"
            else _DEAD * ROUNDING[precision]
        )
    if kind == "GAP":
        return MISFIT[precision] if exact else NEWTON_LOST
    if kind in ("MISFIT", "ROW"):
        return MISFIT[precision] if exact else max(_COUNTED, MISFIT[precision])
    if kind == "SLIP":
        return SLIP[precision] if exact else max(_COUNTED, SLIP[precision])
    return {"JAM": _DEAD * ROUNDING[precision], "REST": 0.5, "TURNED": REACH}[kind]


def open_limit(graph: Program, precision: Precision, newton: int | None) -> float:
    """Limit of how far a determined force may change with what equilibrium leaves open; of a
    moment, a share of the extent.
    """
    return max(
        OPEN[precision] if newton is None else max(_COUNTED, OPEN[precision]), graph.data.rounding
    )


def dead_centre(graph: Program, precision: Precision, closure: str) -> float:
    """Below what a closure says nothing: of a closed form it is the square of a sine, of an
    iterated loop as the sine itself.
    """
    square = _DEAD * ROUNDING[precision]
    return math.sqrt(square) if graph.iterates(closure) else square


def passes_dead_centre(closure: Array, *, ends: bool = False) -> npt.NDArray[np.bool_]:
    """After which instants a loop may pass a dead centre: straight on from either side its
    transmission angle's sine meets zero.

    The closed forms keep to their branch there, with a kink; the mechanism itself may not. With
    ``ends`` the first interval and the last are looked at too, each from its one side.
    """
    found = np.zeros(closure.size, dtype=bool)
    sine = np.sqrt(np.where((closure > 0.0) & (closure < np.inf), closure, 0.0))
    left, right = np.full((2, max(closure.size - 1, 0)), -1.0 if ends else 1.0)
    left[1:], right[:-1] = 2 * sine[1:-1] - sine[:-2], 2 * sine[1:-1] - sine[2:]
    found[:-1] = (left < 0.0) & (right < 0.0) & (np.maximum(sine[:-1], sine[1:]) < NEAR)
    return found

"""When an instant has a result, and when not: one list, for what is evaluated here, for designs and for exported C.

The rules stand in the order in which they are told: of an instant that breaks several, the first says why it has no result. Loops
that iteration did not close, or closes slowly, are told beside them: the former before all rules, the latter after those of loops
that are at a dead centre, for what else is wrong follows from that.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import ROUNDING
from ..base.arrays import Array
from ..base.quantities import Output
from ..base.tables import MOMENT
from ..base.vocabulary import Precision
from ..codegen.emit import NEWTON_LOST
from ..declare.ends import BEYOND
from ..equations.checks import Check
from ..equations.program import Program
from ..equations.turns import REACH

MISFIT: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""How far equations that are too many may miss, of the links' length, and a row, of the size of its terms."""

OPEN: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
_COUNTED = 1e-3
"""Where iterated loops are closed by so many steps: what is zero where they are closed is as small as what is left of them."""

_DEAD = 64.0
"""Roundings below which a closure says nothing but that it is zero."""

SLIP: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
"""How far the laws of frictions may miss, of their forces."""

Kind: TypeAlias = Literal[
    "BEYOND", "CLOSURE", "BRANCH", "GAP", "MISFIT", "ROW", "TURNED", "OPEN", "OPEN_MOMENT", "JAM", "SLIP", "REST"
]


@dataclass(frozen=True)
class Rule:
    """What a column must keep to, so that an instant has a result.

    A ``CLOSURE``, of a loop, of three turns, of a bar's roll or of what drives hold, must be above its limit, and above its
    opposite unless links do not reach; so must a ``BRANCH``, whose loop is iterated. ``GAP`` and ``TURNED`` must be
    within it by size, a ``GAP`` times the mechanism's extent. A ``MISFIT`` and what is ``BEYOND`` the ends of a curve must not
    be above it, nor a ``ROW`` by size, times the column ``beside``, which is the size of its terms. What is ``OPEN`` must not
    be above it, an ``OPEN_MOMENT`` times the extent: else the output ``part`` is not determined. What tells of a ``JAM`` must
    be above its limit, what is left of frictions' laws, a ``SLIP``, must not be above it. A friction at ``REST`` is above it:
    what depends on it is no number there, and the rest is.
    """

    kind: Kind
    column: int
    part: str | Output
    limit: float
    beside: int = -1


@functools.lru_cache(maxsize=32)
def rules(graph: Program, precision: Precision, newton: int | None) -> tuple[Rule, ...]:
    """The rules of a graph, in the order in which they are told; ``newton`` as in :class:`.Rung`."""
    found: list[Rule] = []
    open_ = max(open_limit(precision, newton), graph.data.rounding)
    for k, check in enumerate(graph.columns):
        if not isinstance(check, Check):
            continue
        part = check.part
        if isinstance(part, Output):
            moment = part.unit(graph.data.kinds) == MOMENT
            found.append(Rule("OPEN_MOMENT" if moment else "OPEN", k, part, open_))
        elif check.kind == "beyond":
            found.append(Rule("BEYOND", k, part, BEYOND[precision]))
        elif check.kind == "closure":
            found.append(Rule("BRANCH" if graph.iterates(part) else "CLOSURE", k, part, dead_centre(graph, precision, part)))
        elif check.kind in ("gimbal", "roll", "hold"):
            found.append(Rule("CLOSURE", k, part, _DEAD * ROUNDING[precision]))
        elif check.kind == "gap":
            found.append(Rule("GAP", k, part, gap_limit(precision, newton)))
        elif check.kind == "misfit":
            found.append(Rule("MISFIT", k, part, misfit_limit(precision, newton)))
        elif check.kind == "row":
            found.append(Rule("ROW", k, part, misfit_limit(precision, newton), graph.checks("rowsize")[part]))
        elif check.kind == "jam":
            found.append(Rule("JAM", k, part, _DEAD * ROUNDING[precision]))
        elif check.kind == "slip":
            found.append(Rule("SLIP", k, part, SLIP[precision] if newton is None else max(_COUNTED, SLIP[precision])))
        elif check.kind == "rest":
            found.append(Rule("REST", k, part, 0.5))
        elif check.kind == "turned":
            found.append(Rule("TURNED", k, part, REACH))
    return tuple(found)


def dead_centre(graph: Program, precision: Precision, closure: str) -> float:
    """Below what a closure says nothing: of a closed form it is the square of a sine, of an iterated loop as the sine itself."""
    square = _DEAD * ROUNDING[precision]
    return math.sqrt(square) if graph.iterates(closure) else square


def gap_limit(precision: Precision, newton: int | None) -> float:
    """How far what is left of a loop's equations may be from zero, of the mechanism's extent; ``newton`` as in :class:`.Rung`."""
    return MISFIT[precision] if newton is None else NEWTON_LOST


def misfit_limit(precision: Precision, newton: int | None) -> float:
    """How far equations that are too many may miss, of the links' length, and a row, of the size of its terms."""
    return MISFIT[precision] if newton is None else max(_COUNTED, MISFIT[precision])


def open_limit(precision: Precision, newton: int | None) -> float:
    """How far a force may change with what equilibrium leaves open, and be determined: of a moment, of the mechanism's extent."""
    return OPEN[precision] if newton is None else max(_COUNTED, OPEN[precision])


NEAR = 0.3
"""Sines of the transmission angle below which a loop may pass a dead centre."""


def passes_dead_centre(closure: Array, *, ends: bool = False) -> npt.NDArray[np.bool_]:
    """After which instants a loop may pass a dead centre: straight on from either side its transmission angle's sine meets zero.

    The closed forms keep to their branch there, with a kink; the mechanism itself may not. With ``ends`` the first interval and the
    last are looked at too, each from its one side.
    """
    found = np.zeros(closure.size, dtype=bool)
    sine = np.sqrt(np.where((closure > 0.0) & (closure < np.inf), closure, 0.0))
    left, right = np.full((2, max(closure.size - 1, 0)), -1.0 if ends else 1.0)
    left[1:], right[:-1] = 2 * sine[1:-1] - sine[:-2], 2 * sine[1:-1] - sine[2:]
    found[:-1] = (left < 0.0) & (right < 0.0) & (np.maximum(sine[:-1], sine[1:]) < NEAR)
    return found

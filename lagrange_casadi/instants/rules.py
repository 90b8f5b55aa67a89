"""Limits of what columns must keep to (:mod:`..equations.status`), by the precision in which they
are evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import ROUNDING
from ..arithmetic.interpret import interpret, numpy_arithmetic
from ..base.arrays import Array, Expression
from ..base.vocabulary import Precision
from ..codegen.emit import NEWTON_LOST
from ..declare.ends import BEYOND
from ..equations.checks import Check
from ..equations.friction import SLIP
from ..equations.program import Program
from ..equations.revolutions import REACH
from ..equations.status import NEAR, Bound

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

EXTENSIVE = ("GAP", "OPEN_MOMENT")
"""Kinds whose limit is a share of the mechanism's extent."""


def limits(
    program: Program, precision: Precision, newton: int | None, extent: Expression
) -> list[Expression]:
    """The limits of a graph's bounds, in their order, for its ``extent``; ``newton`` as in
    :class:`.EvaluationMethod`.
    """
    shares = (
        (limit(program, bound, precision, newton), bound.kind in EXTENSIVE)
        for bound in program.bounds
    )
    return [share * extent if extensive else share for share, extensive in shares]


def limit(program: Program, bound: Bound, precision: Precision, newton: int | None) -> float:
    """The limit of a bound; of those that are :data:`EXTENSIVE` a share
    of the mechanism's extent.
    """
    exact, kind = newton is None, bound.kind
    if kind in ("OPEN", "OPEN_MOMENT"):
        return indeterminate_limit(program, precision, newton)
    if kind == "BEYOND":
        return BEYOND[precision]
    if kind in ("CLOSURE", "BRANCH"):
        check = program.columns[bound.column]
        assert isinstance(check, Check)
        return (
            dead_centre(program, precision, str(bound.part))
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


def indeterminate_limit(program: Program, precision: Precision, newton: int | None) -> float:
    """Limit of how far a determined force may change with what equilibrium leaves open; of a
    moment, a share of the extent.
    """
    return max(
        OPEN[precision] if newton is None else max(_COUNTED, OPEN[precision]), program.data.rounding
    )


def dead_centre(program: Program, precision: Precision, closure: str) -> float:
    """Below what a closure says nothing: of a closed form it is the square of a sine, of an
    iterated loop as the sine itself.
    """
    square = _DEAD * ROUNDING[precision]
    return math.sqrt(square) if program.iterates(closure) else square


def beside(program: Program, out: Array, outside: float) -> Array:
    """Values beside the checks of each instant of columns ``out`` (columns, t), (bounds, t): see
    :class:`.Bound`. Closures are ``outside`` before the first instant and after the last.
    """
    count = out.shape[-1]
    rows = [np.asarray(out[bound.column], float) for bound in program.bounds]
    found: list[Any] = [
        np.fmax.reduce(out[bound.size], initial=0.0) if bound.kind == "ROW" else 0.0
        for bound in program.bounds
    ]
    if any(map(_depends_on_others, program.bounds, rows)):
        ends = [
            row[-1] if bound.kind == "TURNED" else outside
            for bound, row in zip(program.bounds, rows, strict=True)
        ]
        longer = [np.concatenate(([x], row, [x, x])) for x, row in zip(ends, rows, strict=True)]
        shifted = [[row[k : k + count] for row in longer] for k in range(4)]
        (found,) = interpret(program.beside, [*shifted, found], numpy_arithmetic())
    return np.array([np.broadcast_to(row, count) for row in found], float).reshape(-1, count)


def first_broken(
    program: Program,
    out: Array,
    most: Sequence[float],
    beside: Array,
    status: npt.NDArray[np.generic],
) -> npt.NDArray[np.intp]:
    """The number of the first rule that each instant of columns ``out`` (columns, t) breaks (t,),
    or zero.

    ``most`` are the limits, ``beside`` (bounds, t) the values beside checks, ``status`` (t,) that
    of iterated loops.
    """
    checks, shares = [out[bound.column] for bound in program.bounds], [*map(np.float64, most)]

    def numbers(
        checks: Iterable[Array], beside: Iterable[Array], status: Array
    ) -> npt.NDArray[np.intp]:
        given = [[np.asarray(row, float) for row in checks], shares, [*beside], [status]]
        (found,) = interpret(program.status, given, numpy_arithmetic())
        return np.broadcast_to(found[0], status.shape).astype(np.intp)

    if not status.any():
        # A rule is kept within an interval: if the least and the largest keep it, all do.
        few, near = (
            [np.array([row.min(), row.max()]) for row in rows] for rows in (checks, [*beside])
        )
        if not (np.isnan([*few, *near]).any() or numbers(few, near, np.zeros(2)).any()):
            return np.zeros(status.shape, np.intp)
    return numbers(checks, beside, status.astype(float))


def _depends_on_others(bound: Bound, row: Array) -> bool:
    """Return whether other instants can break a bound: loops must come near a dead centre."""
    if bound.kind in ("CLOSURE", "BRANCH"):
        return not bool(((row >= NEAR**2) & (row < math.inf)).all())
    return bound.kind == "TURNED"

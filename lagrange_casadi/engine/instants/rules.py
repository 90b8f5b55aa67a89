"""Limits of what columns must keep to (:mod:`.engine.status`), by the precision in which they
are evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Expression
from ...base.compensated import ROUNDING
from ...base.interpret import interpret, numpy_arithmetic
from ...base.vocabulary import Precision
from ...model.ends import BEYOND
from ..checks import Check
from ..codegen.emit import NEWTON_LOST
from ..friction import SLIP
from ..program import Program
from ..revolutions import REACH
from ..status import Bound

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

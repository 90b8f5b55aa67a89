"""Distance of a result from its graph in longer numbers, on the side of every jump that it took.

The instructions of the emitted C are followed one by one (:mod:`.interpret`), in long doubles or in
many digits. A longer number may fall on the other side of a jump than the result did. That is no
error where doubles do not distinguish the sides: so doubles decide, at an instant and a little
before and after it, and the side that is nearest to the result is taken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...base.arrays import Array, Operand
from ...base.interpret import REMAINDERS, Arithmetic, followable, interpret, numpy_arithmetic
from ...base.lookups import Lookup
from ...engine.codegen.stages import Stages
from ...engine.compensated import ROUNDING, SPLITTER
from ...engine.program import Program
from .reference import closed

LONG = float(np.finfo(np.longdouble).eps) / 2
"""The largest relative error of one rounding of a long double."""

_SPLITTER = np.longdouble(2) ** ((np.finfo(np.longdouble).nmant + 2) // 2) + 1
"""The factor that splits a long double into halves of its digits."""

_STEPS, _CLOSED = 8, 1e-9
_BESIDE = 256.0
"""Distance in time of the sides of a jump, in roundings of the span."""

_DOUBLES = numpy_arithmetic().operations
_WHOLE = {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR}
_WHOLE |= {ca.OP_SIGN, ca.OP_FLOOR, ca.OP_CEIL}
_DECIDED = _WHOLE | REMAINDERS | {ca.OP_ATAN2, ca.OP_COPYSIGN, ca.OP_IF_ELSE_ZERO}


def long_doubles() -> Arithmetic:
    """NumPy's arithmetic on long doubles.

    Pairs of doubles become pairs of long doubles: by another splitter. NumPy has the error function
    of doubles only: four roundings of it stand for its error.
    """
    known = numpy_arithmetic().operations
    rounded = {ca.OP_ERF: lambda x: known[ca.OP_ERF](x) * (1 + 4 * ROUNDING["double"])}
    return Arithmetic(
        lambda x: _SPLITTER if x == SPLITTER["double"] else np.longdouble(x), {**known, **rounded}
    )


def missed(
    program: Program, stages: Stages, out: Array, t: Array, p: Array, z: Array, longer: Arithmetic
) -> tuple[Array, Array]:
    """Errors of columns ``out`` (columns, n) at times ``t`` (n,), and the columns in longer
    numbers, both (columns, n).

    Times and parameters are exact; iterated loops are closed from ``z`` (k, n). ``stages`` are the
    graph's in doubles.
    """
    start, stop = program.data.span
    beside = _BESIDE * ROUNDING["double"] * (stop - start) + 4.0 * np.spacing(np.abs(t))
    sides = t + np.multiply.outer((0.0, -1.0, 1.0), beside)
    columns = _columns(stages, t, sides, p, z, longer)
    apart = [row - exact for row, exact in zip(out, columns, strict=True)]
    for k in map(program.outputs.__getitem__, program.loop_angles):
        apart[k] = apart[k] - _turn(longer) * np.rint(_real(apart[k]) / math.tau)
    gaps = list(map(_real, apart))
    # Columns that have one side do not show which one was taken.
    distances = np.zeros_like(sides)
    for gap, row in zip(gaps, out, strict=True):
        if len(gap) > 1:
            distances += np.nan_to_num(np.abs(gap) / (np.fmax.reduce(np.abs(row)) or 1.0))
    taken = np.argmin(distances, axis=0), np.arange(t.size)

    def picked(rows: Iterable[Array]) -> Array:
        return np.array([row[taken] if len(row) > 1 else row[0] for row in rows])

    return picked(gaps), picked(map(_real, columns))


class _Number(NamedTuple):
    """A longer number, (n,) or (sides, n), and the double (sides, n) that decides."""

    exact: Any
    deciding: Any


def _columns(
    stages: Stages, t: Array, sides: Array, p: Array, z: Array, longer: Arithmetic
) -> list[Any]:
    """Every column at times ``t`` (n,), as decided at the times of ``sides`` (sides, n), in longer
    numbers: (sides, n), or (1, n) if all sides are alike.
    """
    # A turn is meant in a graph, not the double that is nearest to it; but not in a law.
    law, graph = _deciding(longer, {}), _deciding(longer, {math.tau: _turn(longer)})
    moment = _Number(_longer(t, longer), sides)
    inner = [_Number(_longer(row, longer), row) for row in z]
    values = [_Number(longer.constant(value), value) for value in p]
    with np.errstate(all="ignore"):
        if followable(stages.drive):
            driven = interpret(stages.drive, [[moment], values], law)
        else:
            driven = [
                [_Number(_longer(row[0], longer), row) for row in order]
                for order in (
                    found.full().reshape(-1, *sides.shape)
                    for found in stages.drive(sides.reshape(1, -1), p)
                )
            ]
        if stages.loops is not None:
            inner, _ = closed(stages.loops, inner, [driven[0], values], graph, _small, _STEPS)
        (found,) = interpret(stages.instant, [*driven, inner, values], graph)
    return [np.atleast_2d(number.exact) + np.zeros(t.size) for number in found]


def _small(size: _Number) -> bool:
    """Return whether the square of a Newton step is nothing to a result."""
    return not np.fmax.reduce(_real(size.exact), axis=None) >= _CLOSED


def _deciding(longer: Arithmetic, known: Mapping[float, Any]) -> Arithmetic:
    """The arithmetic of numbers of which doubles decide what is compared, counted or reduced.

    ``known`` are longer numbers of constants.
    """
    turn = _turn(longer)

    def looked_up(lookup: Lookup, x: _Number) -> _Number:
        # The number of a cell is decided, and an entry is the double that it is.
        found = lookup.at(x.deciding)
        return _Number(_longer(_common(found), longer), found)

    def rule(code: int) -> Callable[..., _Number]:
        decided, operation = _DOUBLES[code], longer.operations[code]

        def apply(*values: _Number) -> _Number:
            operands, deciding = zip(*values, strict=True)
            decision = decided(*deciding)
            if code not in _DECIDED:
                return _Number(operation(*operands), decision)
            if code == ca.OP_COPYSIGN and values[0] is values[1]:
                return values[0]  # a number that CasADi must not look into
            if code in _WHOLE:
                return _Number(_longer(_common(decision), longer), decision)
            if code == ca.OP_COPYSIGN:
                size, negative = abs(operands[0]), _common(np.signbit(decision))
                return _Number(np.where(negative, -size, size), decision)
            if code == ca.OP_IF_ELSE_ZERO:
                there = _common(values[0].deciding != 0.0)
                return _Number(np.where(there, operands[1], 0.0), decision)
            found, period = operation(*operands), turn if code == ca.OP_ATAN2 else abs(operands[1])
            found = found - period * _common(np.rint(_real((found - decision) / period)))
            return _Number(found, decision)

        return apply

    rules: dict[int, Callable[..., _Number]] = {code: rule(code) for code in longer.operations}
    return Arithmetic(
        lambda value: _Number(known.get(value, longer.constant(value)), value),
        rules | {ca.OP_CALL: looked_up},
    )


def _turn(longer: Arithmetic) -> Operand:
    return 2 * longer.operations[ca.OP_ACOS](longer.constant(-1.0))


def _longer(values: Operand, longer: Arithmetic) -> Operand:
    """Doubles as longer numbers."""
    return longer.operations[ca.OP_ADD](values, longer.constant(0.0))


def _common(decision: Operand) -> Operand:
    """A decision (sides, n) as one row (n,) if all sides decide alike."""
    if np.ndim(decision) < 2 or (decision != decision[:1]).any():
        return decision
    return decision[0]


def _real(values: Operand) -> Array:
    """Longer numbers as doubles; NaN for complex ones."""
    rows = np.asarray(values)
    if rows.dtype != object:
        return np.asarray(rows, float)
    real = [math.nan if hasattr(x, "_mpc_") else float(x) for x in rows.flat]
    return np.array(real).reshape(rows.shape)

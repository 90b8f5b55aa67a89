"""Places of kinks and jumps of each operation of CasADi."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca

from ..arithmetic.lookups import is_entry
from ..base.arrays import Expression

_TRUTHS = (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR)


def marks_of(operation: int, operands: Sequence[ca.SX]) -> Iterator[tuple[Expression, bool, bool]]:
    """Expressions at whose zeros, or whole numbers, an operation has a kink; and whether it is
    undefined there.
    """
    x, y = operands[0], operands[-1]
    if operation in (ca.OP_LE, ca.OP_FMIN, ca.OP_FMAX, ca.OP_LT):
        yield (y - x if operation == ca.OP_LT else x - y), False, False
    elif operation in (ca.OP_FABS, ca.OP_SIGN, ca.OP_COPYSIGN):
        yield from ((one, False, False) for one in operands)
    elif operation in (ca.OP_EQ, ca.OP_NE):
        yield from ((one, False, False) for one in _zeros(x - y))
    elif operation in (ca.OP_NOT, ca.OP_IF_ELSE_ZERO):
        yield from ((one, False, False) for one in _zeros(x))
    elif operation in (ca.OP_AND, ca.OP_OR):
        yield from ((mark, False, False) for one in operands for mark in _zeros(one))
    elif operation in (ca.OP_FLOOR, ca.OP_CEIL):
        # What a table has for a cell is a whole number already.
        if not is_entry(x):
            yield (x if operation == ca.OP_FLOOR else -x), True, False
    elif operation in (ca.OP_FMOD, ca.OP_REMAINDER):
        yield x / y + (0.5 if operation == ca.OP_REMAINDER else 0.0), True, False
        yield y, False, True
    elif operation in (ca.OP_DIV, ca.OP_INV):
        yield y, False, True
    elif operation == ca.OP_TAN:
        yield ca.cos(x), False, True
    elif operation in (ca.OP_SQRT, ca.OP_LOG):
        yield x, False, True
    elif operation == ca.OP_LOG1P:
        yield 1.0 + x, False, True
    elif operation in (ca.OP_ASIN, ca.OP_ACOS, ca.OP_ATANH):
        yield 1.0 - x * x, False, True
    elif operation == ca.OP_ACOSH:
        yield x - 1.0, False, True
    elif operation == ca.OP_HYPOT:
        yield x * x + y * y, False, True
    elif operation == ca.OP_ATAN2:
        # Its cut is where the first is zero and the second negative.
        yield x, False, False
        yield x * x + y * y, False, True
    elif operation in (ca.OP_POW, ca.OP_CONSTPOW) and not (
        y.is_constant() and float(y) >= 0.0 and float(y).is_integer()
    ):
        yield x, False, True


def _zeros(x: ca.SX) -> Iterator[Expression]:
    """Marks of where something is zero, for a stretch or at a place that it passes; a comparison
    has marks of its own.
    """
    if x.op() not in _TRUTHS:
        yield from (ca.fabs(x), x)

"""Between which bounds a function of scalars stays while what is put into it stays within bounds of
its own.

Every operation gives bounds of its result for all numbers between those of its operands (R. E.
Moore, *Interval Analysis*, 1966). They are wider than need be where an operand comes twice, never
narrower: each is widened by far more than rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import casadi as ca

from .arrays import Operand
from .interpret import Arithmetic, codes, interpret
from .lookups import Lookup
from .scalars import applied

Box = tuple[Any, Any]

_WIDER = 2.0**-40
"""Relative widening of each bound."""

_TURN = 2.0 * math.pi
_RISING = codes("sqrt log log1p exp expm1 sinh tanh asin atan asinh acosh atanh erf")
_STEPS = codes("floor ceil sign fmin fmax assign twice")
"""Operations that rise with their operands, and round nothing."""


def boxed(function: ca.Function) -> tuple[list[Operand], list[Box], Operand]:
    """Bounds of the rows of a followable function ``(x, fixed) -> rows``, with the symbols ``low``,
    ``high`` and ``fixed``.

    Last is how wide all bounds are, added up: where it is not finite they say nothing.
    """
    x, fixed = function.sx_in()
    low, high = ca.SX.sym("low", x.numel()), ca.SX.sym("high", x.numel())
    boxes = _Boxes()
    given = [boxes.wider((low[k], high[k])) for k in range(x.numel())]
    (rows,) = interpret(
        function,
        [given, [(one, one) for one in ca.vertsplit(fixed)] if fixed.numel() else []],
        boxes.arithmetic,
    )
    return [low, high, fixed], rows, boxes.width


class _Boxes:
    """Rules of operations on bounds, and how wide all of them were."""

    def __init__(self) -> None:
        self.width = ca.SX(0.0)

    @property
    def arithmetic(self) -> Arithmetic:
        """The arithmetic of bounds."""
        rules: dict[int, Callable[..., Box]] = {code: self._monotone(code) for code in _RISING}
        rules |= {code: self._monotone(code, exact=True) for code in _STEPS}
        rules |= {
            ca.OP_NEG: lambda x: (-x[1], -x[0]),
            ca.OP_FABS: _size,
            ca.OP_SQ: lambda x: self.wider(tuple(one**2 for one in _size(x))),
            ca.OP_COSH: lambda x: self.wider(tuple(ca.cosh(one) for one in _size(x))),
            ca.OP_HYPOT: lambda x, y: self.wider(
                tuple(ca.hypot(*both) for both in zip(_size(x), _size(y), strict=True))
            ),
            ca.OP_COS: lambda x: self._wave(x, 0.0, ca.cos),
            ca.OP_SIN: lambda x: self._wave(x, 0.25, ca.sin),
            ca.OP_TAN: self._tan,
            ca.OP_ACOS: lambda x: self.wider((ca.acos(x[1]), ca.acos(x[0]))),
            ca.OP_ADD: self._add,
            ca.OP_SUB: self._sub,
            ca.OP_MUL: self._mul,
            ca.OP_INV: self._inv,
            ca.OP_DIV: lambda x, y: self._mul(x, self._inv(y)),
            ca.OP_POW: self._pow,
            ca.OP_CONSTPOW: self._pow,
            ca.OP_ATAN2: self._atan2,
            ca.OP_FMOD: lambda x, y: self._left(x, y, lambda q: (_whole(q[0]), _whole(q[1]))),
            ca.OP_REMAINDER: lambda x, y: self._left(
                x, y, lambda q: (ca.ceil(q[0] - 0.5), ca.floor(q[1] + 0.5))
            ),
            ca.OP_COPYSIGN: lambda x, _: (-_size(x)[1], _size(x)[1]),
            ca.OP_LT: lambda x, y: (x[1] < y[0], x[0] < y[1]),
            ca.OP_LE: lambda x, y: (x[1] <= y[0], x[0] <= y[1]),
            ca.OP_EQ: _equal,
            ca.OP_NE: lambda x, y: _not(_equal(x, y)),
            ca.OP_NOT: lambda x: _not(_true(x)),
            ca.OP_AND: lambda x, y: tuple(
                ca.logic_and(*both) for both in zip(_true(x), _true(y), strict=True)
            ),
            ca.OP_OR: lambda x, y: tuple(
                ca.logic_or(*both) for both in zip(_true(x), _true(y), strict=True)
            ),
            ca.OP_IF_ELSE_ZERO: _where,
        }
        known: dict[int, Callable[..., Box]] = {
            code: _once(code, rule) for code, rule in rules.items()
        }
        return Arithmetic(lambda value: (ca.SX(value),) * 2, known | {ca.OP_CALL: self._looked_up})

    def wider(self, box: Box) -> Box:
        """Bounds with room for rounding."""
        low, high = box
        self.width += high - low
        capacity = _WIDER * ca.fmax(ca.fabs(low), ca.fabs(high))
        return low - capacity, high + capacity

    def unknown(self, where: Operand) -> None:
        """Bounds that exclude nothing."""
        self.width += ca.if_else(where, math.inf, 0.0)

    def _hull(self, *corners: Operand) -> Box:
        low = high = corners[0]
        for corner in corners[1:]:
            # The smaller of a number and none is the number.
            self.width += ca.fabs(corner - corners[0])
            low, high = ca.fmin(low, corner), ca.fmax(high, corner)
        return self.wider((low, high))

    def _monotone(self, code: int, exact: bool = False) -> Callable[..., Box]:
        def rule(*boxes: Box) -> Box:
            low, high = (applied(code, *ends) for ends in zip(*boxes, strict=True))
            return (low, high) if exact else self.wider((low, high))

        return rule

    def _add(self, x: Box, y: Box) -> Box:
        return self.wider((x[0] + y[0], x[1] + y[1]))

    def _sub(self, x: Box, y: Box) -> Box:
        return self.wider((x[0] - y[1], x[1] - y[0]))

    def _mul(self, x: Box, y: Box) -> Box:
        for one, other in ((x, y), (y, x)):
            if one[0].is_constant() and one[0] is one[1]:
                low, high = other if float(one[0]) >= 0.0 else other[::-1]
                return self.wider((one[0] * low, one[0] * high))
        return self._hull(*(one * other for one in _ends(x) for other in _ends(y)))

    def _inv(self, x: Box) -> Box:
        self.unknown(ca.logic_and(x[0] <= 0.0, x[1] >= 0.0))
        return self.wider((1.0 / x[1], 1.0 / x[0]))

    def _wave(self, x: Box, shift: float, wave: Callable[[Operand], Operand]) -> Box:
        """The wave is largest a part of a turn after whole turns."""
        revolutions = [end / _TURN for end in x]
        low, high = (ends(wave(x[0]), wave(x[1])) for ends in (ca.fmin, ca.fmax))
        most, least = (
            ca.floor(revolutions[1] - of + 1e-9) >= ca.ceil(revolutions[0] - of - 1e-9)
            for of in (shift, shift + 0.5)
        )
        low, high = ca.if_else(least, -1.0, low), ca.if_else(most, 1.0, high)
        # Of an angle of many turns its own rounding counts, which is in its bounds.
        return self.wider((low, high))

    def _tan(self, x: Box) -> Box:
        low, high = self._wave(x, 0.0, ca.cos)
        self.unknown(ca.logic_and(low <= 0.0, high >= 0.0))
        return self.wider((ca.tan(x[0]), ca.tan(x[1])))

    def _pow(self, x: Box, y: Box) -> Box:
        if y[0].is_constant() and y[0] is y[1]:
            power = float(y[0])
            if power >= 0.0 and power.is_integer():
                return self.wider(
                    tuple(end**power for end in (_size(x) if power % 2.0 == 0.0 else x))
                )
        self.unknown(x[0] <= 0.0)
        return self._hull(*(one**other for one in _ends(x) for other in _ends(y)))

    def _atan2(self, y: Box, x: Box) -> Box:
        self.unknown(ca.logic_and(ca.logic_and(y[0] <= 0.0, y[1] >= 0.0), x[0] <= 0.0))
        return self._hull(*(ca.atan2(one, other) for one in _ends(y) for other in _ends(x)))

    def _left(self, x: Box, y: Box, whole: Callable[[Box], Box]) -> Box:
        """Remainder of ``x`` after whole multiples of ``y``."""
        times = whole(self._mul(x, self._inv(y)))
        return self._sub(x, self._mul(times, y))

    def _looked_up(self, table: Lookup, x: Box) -> Box:
        if table.kind == "cell":
            return table.function(x[0]), table.function(x[1])
        return ca.SX(min(table.numbers)), ca.SX(max(table.numbers))


def _once(code: int, rule: Callable[..., Box]) -> Callable[..., Box]:
    """Compute a value that is known to the last bit as elsewhere."""

    def ruled(*boxes: Box) -> Box:
        if all(box[0] is box[1] for box in boxes):
            return (applied(code, *(box[0] for box in boxes)),) * 2
        return rule(*boxes)

    return ruled


def _ends(box: Box) -> tuple[Operand, ...]:
    return box[:1] if box[0] is box[1] else box


def _size(x: Box) -> Box:
    return ca.fmax(ca.fmax(x[0], -x[1]), 0.0), ca.fmax(ca.fabs(x[0]), ca.fabs(x[1]))


def _whole(x: Operand) -> Operand:
    return ca.if_else(x < 0.0, ca.ceil(x), ca.floor(x))


def _true(x: Box) -> Box:
    """Return whether an interval certainly excludes zero, and whether it contains anything else."""
    return ca.logic_or(x[0] > 0.0, x[1] < 0.0), ca.logic_or(x[0] != 0.0, x[1] != 0.0)


def _not(x: Box) -> Box:
    return 1.0 - x[1], 1.0 - x[0]


def _equal(x: Box, y: Box) -> Box:
    certain = ca.logic_and(x[0] == y[1], x[1] == y[0])
    return certain, ca.logic_and(x[0] <= y[1], y[0] <= x[1])


def _where(x: Box, y: Box) -> Box:
    certain, possible = _true(x)
    low, high = (
        ca.if_else(possible, of(0.0, end), 0.0) for of, end in ((ca.fmin, y[0]), (ca.fmax, y[1]))
    )
    return ca.if_else(certain, y[0], low), ca.if_else(certain, y[1], high)

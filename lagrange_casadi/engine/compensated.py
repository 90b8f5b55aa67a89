"""Pairs of numbers as expressions: a value and what its rounding left of it, for phases that must
outlast many turns.

An angle of 1e10 rad in a double has lost six digits of its phase, one of 1e3 rad in a single nearly
all. Followed as an unevaluated sum high + low, with error-free sums and products (Knuth; Dekker, *A
floating-point technique for extending the available precision*, Numer. Math. 18, 1971), it keeps
twice the digits, in arithmetic of the one precision throughout. Compilers must not reassociate:
``-ffast-math`` takes the low parts away. Nor must CasADi, which knows that (a + b) - a is b, which
is just what does not hold here: see :func:`closed`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Expression, Operand
from ..base.interpret import Arithmetic, codes
from ..base.lookups import Lookup
from ..base.scalars import added, applied, as_expression, less, product
from ..base.vocabulary import Precision

DTYPES: dict[Precision, Any] = {"double": np.dtype(np.float64), "single": np.dtype(np.float32)}
ROUNDING: dict[Precision, float] = {
    name: float(np.finfo(dtype).eps) / 2 for name, dtype in DTYPES.items()
}
"""The largest relative error of one rounding."""

SPLITTER: dict[Precision, float] = {"double": 134217729.0, "single": 4097.0}
"""The factor that splits a number into halves of its digits."""

_TURN: dict[Precision, tuple[float, ...]] = {
    "double": (6.283185307179586, 2.4492935982947064e-16, -5.989539619436679e-33),
    "single": (6.2831854820251465, -1.7484555314695172e-07, -6.8604980400235275e-15),
}
"""2 pi as the sum of three numbers of a precision."""


def closed(x: Expression) -> Expression:
    """A value that CasADi does not look into where it simplifies: under a sign of its own.

    Its patterns are of operations on operations, and none holds this one. So a value stays as it is
    written, in every thread and however often the expression is made anew. Emitted C has no trace
    of it: see :func:`.opened`. A constant is folded.
    """
    return ca.SX.binary(ca.OP_COPYSIGN, x, x)


@dataclass(frozen=True, eq=False)
class Pair:
    """high + low, expressions of scalars; ``low`` is None where the value is exact.

    ``number`` is the value where it is known.

    Both are ``whole`` numbers where they are entries of a table.
    """

    high: Any
    low: Any = None
    number: float | None = None
    whole: bool = False

    @property
    def value(self) -> Expression:
        """The one number that is nearest."""
        return self.high if self.low is None else closed(added(self.high, self.low))


@dataclass(frozen=True)
class Pairs:
    """The arithmetic of pairs in a precision, on expressions.

    Sums, differences, products, quotients, roots and whole parts keep all digits; a sine, cosine or
    tangent is that of a pair's phase, rounded once. Everything else is done on the nearest single
    number.
    """

    precision: Precision

    @property
    def arithmetic(self) -> Arithmetic:
        """Operations for :func:`.interpret`."""
        return Arithmetic(self.constant, self.operations)

    @cached_property
    def operations(self) -> Mapping[int, Callable[..., Pair]]:
        """Operations by CasADi's ``OP_`` code."""
        rules = {
            ca.OP_ADD: self.add,
            ca.OP_SUB: self.subtract,
            ca.OP_NEG: self.negate,
            ca.OP_MUL: self.multiply,
            ca.OP_SQ: lambda x: self.multiply(x, x),
            ca.OP_TWICE: lambda x: self.add(x, x),
            ca.OP_DIV: self.divide,
            ca.OP_INV: lambda x: self.divide(self.constant(1.0), x),
            ca.OP_SQRT: self.root,
            ca.OP_SIN: self.sine,
            ca.OP_COS: self.cosine,
            ca.OP_TAN: lambda x: self.divide(self.sine(x), self.cosine(x)),
            ca.OP_FABS: self._size,
            ca.OP_COPYSIGN: lambda x, y: self._signed(self._size(x), y.value),
            ca.OP_FLOOR: self._floor,
            ca.OP_CEIL: lambda x: x if x.whole else self.negate(self._floor(self.negate(x))),
            ca.OP_FMOD: self.remainder,
            ca.OP_REMAINDER: self.nearest_remainder,
            ca.OP_FMIN: lambda x, y: self._either(x, y, x, y),
            ca.OP_FMAX: lambda x, y: self._either(x, y, y, x),
            ca.OP_IF_ELSE_ZERO: lambda where, x: _choose(where.value, x),
            ca.OP_ASSIGN: lambda x: x,
            ca.OP_CALL: self._looked_up,
        }
        return {code: self._once(code) for code in _PLAIN} | rules

    def constant(self, value: float) -> Pair:
        """A double, in as many parts as it takes."""
        high = self._rounded(value)
        low = self._rounded(value - float(high)) if np.isfinite(float(high)) else ca.SX(0)
        return Pair(high, None if low.is_zero() else low, value)

    @property
    def turn(self) -> Pair:
        """2 pi, of which the double is but the nearest one."""
        high, low, _ = _TURN[self.precision]
        return Pair(ca.SX(high), ca.SX(low), math.tau)

    def add(self, x: Pair, y: Pair) -> Pair:
        """Return x + y, to the last digits also where they nearly cancel."""
        total, error = self._sum(x.high, y.high)
        if x.low is None and y.low is None:
            return Pair(total, error)
        if x.low is None or y.low is None:
            return self._normal(total, self._plus(error, y.low if x.low is None else x.low))
        lows, rest = self._sum(x.low, y.low)
        first = self._normal(total, self._plus(error, lows))
        return self._normal(first.high, self._plus(first.low, rest))

    def subtract(self, x: Pair, y: Pair) -> Pair:
        """Return x - y."""
        return self.add(x, self.negate(y))

    def negate(self, x: Pair) -> Pair:
        """-x."""
        low = None if x.low is None else self._closed(-x.low)
        number = None if x.number is None else -x.number
        return Pair(self._closed(-x.high), low, number)

    def multiply(self, x: Pair, y: Pair) -> Pair:
        """Return x y; a power of two only scales."""
        for one, other in ((x, y), (y, x)):
            if other.number is not None and other.number and np.frexp(abs(other.number))[0] == 0.5:
                return Pair(
                    self._times(one.high, other.high),
                    None if one.low is None else self._times(one.low, other.high),
                )
        product, error = self._product(x.high, y.high)
        for part in ((x.high, y.low), (x.low, y.high)):
            if part[0] is not None and part[1] is not None:
                error = self._plus(error, self._times(part[0], part[1]))
        return self._normal(product, error)

    def divide(self, x: Pair, y: Pair) -> Pair:
        """Return x / y by what a first quotient leaves."""
        first = self._closed(x.high / y.high)
        remainder = self.subtract(x, self.multiply(Pair(first), y))
        return self._normal(first, self._closed(self._value(remainder) / y.high))

    def root(self, x: Pair) -> Pair:
        """The square root, by what a first root leaves; of zero, zero."""
        first = self._rounded(ca.sqrt(x.high))
        remainder = self.subtract(x, self.multiply(Pair(first), Pair(first)))
        twice = self._plus(self._times(2.0, first), first == 0.0)
        return self._normal(first, self._closed(self._value(remainder) / twice))

    def reduced(self, x: Pair) -> Pair:
        """Return x less whole turns, between -pi and pi."""
        revolutions = ca.floor(self._plus(self._times(x.high, self._rounded(1.0 / math.tau)), 0.5))
        for part in _TURN[self.precision]:
            x = self.subtract(x, Pair(*self._product(revolutions, ca.SX(part))))
        return x

    def sine(self, x: Pair) -> Pair:
        """The sine of a counted angle."""
        return self._turning(x, ca.sin, ca.cos)

    def cosine(self, x: Pair) -> Pair:
        """The cosine of a counted angle."""
        return self._turning(x, ca.cos, lambda angle: self._closed(-ca.sin(angle)))

    def remainder(self, x: Pair, y: Pair) -> Pair:
        """C's fmod: x less y as often as it goes into x, towards zero."""
        size, period = self._size(x), self._size(y)
        remainder = self.subtract(
            size, self.multiply(self._floor(self.divide(size, period)), period)
        )
        return self._signed(remainder, x.high)

    def nearest_remainder(self, x: Pair, y: Pair) -> Pair:
        """C's remainder: x less the multiple of y that is nearest."""
        return self.subtract(
            x, self.multiply(self._floor(self.add(self.divide(x, y), self.constant(0.5))), y)
        )

    def _looked_up(self, lookup: Lookup, x: Pair) -> Pair:
        """Look a number up in a table: an entry with all the digits of a pair."""
        if lookup.kind == "cell":
            return Pair(lookup.function(x.value))
        high, low = lookup.parts(DTYPES[self.precision])
        return Pair(high(x.value), None if low is None else low(x.value), whole=True)

    def _either(self, x: Pair, y: Pair, one: Pair, other: Pair) -> Pair:
        """``one`` where x is below y, and elsewhere the ``other``."""
        below = self._value(self.subtract(x, y)) < 0.0
        return self.add(_choose(below, one), _choose(ca.logic_not(below), other))

    def _turning(self, x: Pair, function: Callable[[Operand], Operand], slope: Operand) -> Pair:
        angle = self.reduced(x)
        rough, change = self._rounded(function(angle.high)), self._rounded(slope(angle.high))
        return Pair(*self._sum(rough, self._times(change, angle.low)))

    def _product(self, a: Expression, b: Expression) -> tuple[Expression, Expression]:
        """Return a b and its error (Dekker)."""
        product = self._times(a, b)
        (ah, al), (bh, bl) = self._split(a), self._split(b)
        error = self._minus(self._times(ah, bh), product)
        for half, other in ((ah, bl), (al, bh), (al, bl)):
            error = self._plus(error, self._times(half, other))
        return product, error

    def _split(self, a: Expression) -> tuple[Expression, Expression]:
        """The halves of a number's digits."""
        c = self._times(SPLITTER[self.precision], a)
        high = self._minus(c, self._minus(c, a))
        return high, self._minus(a, high)

    def _once(self, code: int) -> Operand:
        """An operation on the nearest numbers: what it gives is rounded once,
        as are its arguments.
        """
        return lambda *operands: Pair(self._rounded(applied(code, *map(self._value, operands))))

    def _plus(self, a: ca.SX, b: Expression) -> Expression:
        return self._closed(added(a, b))

    def _minus(self, a: ca.SX, b: ca.SX) -> Expression:
        return self._closed(less(a, b))

    def _times(self, a: Expression, b: Expression) -> Expression:
        return self._closed(product(a, b))

    def _closed(self, x: Expression) -> Expression:
        return closed(self._rounded(x))

    def _rounded(self, x: Expression) -> Expression:
        """A constant as it is where the precision's own arithmetic makes it: CasADi folds constants
        in doubles.
        """
        if not as_expression(x).is_constant():
            return x
        with np.errstate(over="ignore"):
            return ca.SX(float(DTYPES[self.precision].type(float(x))))

    def _value(self, x: Pair) -> Expression:
        return self._rounded(x.value)

    def _sum(self, a: Expression, b: Expression) -> tuple[Expression, Expression]:
        """Return a + b and its error (Knuth)."""
        total = self._plus(a, b)
        other = self._minus(total, a)
        return total, self._plus(self._minus(a, self._minus(total, other)), self._minus(b, other))

    def _normal(self, high: ca.SX, low: ca.SX) -> Pair:
        total = self._plus(high, low)
        return Pair(total, self._minus(low, self._minus(total, high)))

    def _signed(self, x: Pair, like: ca.SX) -> Pair:
        sign = ca.copysign(ca.SX(1.0), like)
        return Pair(self._times(x.high, sign), None if x.low is None else self._times(x.low, sign))

    def _size(self, x: Pair) -> Pair:
        return self._signed(x, x.high)

    def _floor(self, x: Pair) -> Pair:
        high = ca.floor(x.high)
        if x.low is None:
            return Pair(high)
        return self._normal(high, _zero_unless(high == x.high, ca.floor(x.low)))


def _choose(where: ca.SX, x: Pair) -> Pair:
    return Pair(_zero_unless(where, x.high), None if x.low is None else _zero_unless(where, x.low))


def _zero_unless(where: ca.SX, x: ca.SX) -> ca.SX:
    return ca.SX.binary(ca.OP_IF_ELSE_ZERO, where, x)


_PLAIN = codes(
    "exp log asin acos atan sinh cosh tanh asinh acosh atanh log1p expm1 erf sign not"
    " pow constpow atan2 hypot lt le eq ne and or"
)

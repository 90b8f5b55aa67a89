"""Polynomials whose coefficients are expressions, which may depend on parameters: the coefficients
of an expression that is one, and the lowest value on an interval.

An expression is followed by its operations, so that nothing is taken for a polynomial by chance.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.interpret import Arithmetic, interpret, steps
from ..base.scalars import applied, column
from ..errors import DeclarationError

Polynomial = tuple[Any, ...]
"""Coefficients of rising powers, each a ``casadi.SX``."""

_HALVINGS = 30
"""Number of halvings of an interval with a zero of a derivative.

At a turning point a miss by 1e-9 changes a value by its square.
"""


class _NoPolynomialError(Exception):
    """An operation that no polynomial comes from."""


def powers(expression: Expression, symbol: Expression, replaced: Polynomial) -> Polynomial | None:
    """Coefficients of an expression for a polynomial that is put in for ``symbol``; or None where
    it is none of that symbol.

    Only operations that give polynomials of polynomials are followed: a piece that changes at a
    place along ``symbol``, or a function of it, is no polynomial.
    """
    others = [
        other for other in ca.symvar(expression) if other.element_hash() != symbol.element_hash()
    ]
    function = ca.Function("along", [symbol, column(others)], [ca.densify(expression)])
    operations = {
        step.operation: _alone(partial(applied, step.operation))
        for step in steps(function)
        if step.operation not in _NOT_COMPUTED
    }
    operations |= _POLYNOMIAL
    inputs = [[replaced], [(other,) for other in others]]
    try:
        found: Polynomial = interpret(
            function, inputs, Arithmetic(lambda value: (ca.SX(value),), operations)
        )[0][0]
    except (_NoPolynomialError, DeclarationError):
        return None
    return _trimmed(found)


_NOT_COMPUTED = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT}


def _alone(function: Callable[..., ca.SX]) -> Callable[..., Polynomial]:
    """A function of what does not depend on the symbol."""

    def apply(*values: Polynomial) -> Polynomial:
        if any(len(value) > 1 for value in values):
            raise _NoPolynomialError
        return (function(*(value[0] for value in values)),)

    return apply


def _trimmed(polynomial: Sequence[Expression]) -> Polynomial:
    """Without leading coefficients that are zero."""
    many = len(polynomial)
    while many > 1 and polynomial[many - 1].is_zero():
        many -= 1
    return tuple(polynomial[:many])


def _plus(a: Polynomial, b: Polynomial) -> Polynomial:
    return _trimmed([x + y for x, y in itertools.zip_longest(a, b, fillvalue=ca.SX(0))])


def _negative(a: Polynomial) -> Polynomial:
    return tuple(-x for x in a)


def product(a: Sequence[Expression], b: Sequence[Expression]) -> list[ca.SX]:
    """The coefficients of the product of two polynomials."""
    found = [ca.SX(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            found[i + j] = found[i + j] + x * y
    return found


def _times(a: Polynomial, b: Polynomial) -> Polynomial:
    return _trimmed(product(a, b))


def _over(a: Polynomial, b: Polynomial) -> Polynomial:
    if len(b) > 1:
        raise _NoPolynomialError
    return tuple(x / b[0] for x in a)


_POLYNOMIAL: dict[int, Callable[..., Polynomial]] = {
    ca.OP_ADD: _plus,
    ca.OP_SUB: lambda a, b: _plus(a, _negative(b)),
    ca.OP_MUL: _times,
    ca.OP_DIV: _over,
    ca.OP_NEG: _negative,
    ca.OP_SQ: lambda a: _times(a, a),
    ca.OP_TWICE: lambda a: tuple(2 * x for x in a),
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_CALL: lambda looked_up, x: _alone(looked_up.function)(x),
}
"""Operations that make polynomials of polynomials: CasADi writes whole powers up to 100 as
products.
"""


def lowest(cell: Sequence[Expression], start: float, stop: float) -> tuple[ca.SX, ca.SX]:
    """Place u from ``start`` to ``stop`` at which sum_j cell[j] u^j is lowest, and its value there,
    for finite coefficients.
    """
    place, value = ca.SX(start), value_at(cell, ca.SX(start))
    turning = _zeros(_derivative(cell), start, stop) if len(cell) > 2 else []
    for u in (ca.SX(stop), *turning):
        other = value_at(cell, u)
        lower = other < value
        place, value = ca.if_else(lower, u, place), ca.if_else(lower, other, value)
    return place, value


def _zeros(cell: Sequence[Expression], start: float, stop: float) -> list[ca.SX]:
    """Places from ``start`` to ``stop``, in order: all zeros of a polynomial there, and for those
    that it lacks any others.

    Up to a parabola in closed form; of a higher degree between the zeros of its derivative, where
    it is monotonic.
    """
    if len(cell) == 2:
        return [_within(-cell[0] / ca.SX(cell[1]), start, stop)]
    if len(cell) == 3:
        c, b, a = (ca.SX(x) for x in cell)
        square = b * b - 4.0 * a * c
        root = ca.sqrt(ca.if_else(square > 0.0, square, 0.0))
        # The sum does not cancel; a parabola that is a line has one zero far away.
        total = -0.5 * (b + ca.if_else(b < 0.0, -root, root))
        one, other = _within(total / a, start, stop), _within(c / total, start, stop)
        return [ca.fmin(one, other), ca.fmax(one, other)]
    ends = [ca.SX(start), *_zeros(_derivative(cell), start, stop), ca.SX(stop)]
    return [_zero(cell, low, high) for low, high in itertools.pairwise(ends)]


def _zero(cell: Sequence[Expression], low: Expression, high: Expression) -> Expression:
    negative = value_at(cell, low) < 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        same = ca.eq(value_at(cell, middle) < 0.0, negative)
        low, high = ca.if_else(same, middle, low), ca.if_else(same, high, middle)
    return high


def value_at(cell: Sequence[Expression], u: Expression) -> ca.SX:
    """The value sum_j cell[j] u^j, by Horner's rule."""
    return ca.polyval(ca.densify(ca.SX(ca.vertcat(*reversed(cell)))), u)


def _derivative(cell: Sequence[Expression]) -> list[Expression]:
    return [j * coefficient for j, coefficient in enumerate(cell)][1:]


def _within(x: ca.SX, start: float, stop: float) -> ca.SX:
    """A place in the interval; its start for what is not a number."""
    return ca.if_else(x > start, ca.if_else(x < stop, x, stop), start)

"""An expression as a polynomial of one of its symbols: followed by its operations, so that nothing
is taken for one by chance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from ..arithmetic.interpret import Arithmetic, interpret, steps
from ..arithmetic.scalars import applied, column
from ..base.arrays import Expression
from ..errors import DeclarationError

Polynomial = tuple[Any, ...]
"""Coefficients of rising powers, each a ``casadi.SX``."""


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
    operations: dict[int, Callable[..., Polynomial]] = {
        step.operation: _alone(step.operation)
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


def _alone(operation: int) -> Callable[..., Polynomial]:
    """An operation on what does not depend on the symbol."""

    def apply(*operands: Any) -> Polynomial:
        *looked_up, values = (operands[0], operands[1:]) if operation == ca.OP_CALL else (operands,)
        if any(len(value) > 1 for value in values):
            raise _NoPolynomialError
        numbers = [value[0] for value in values]
        if looked_up:
            return (looked_up[0].function(*numbers),)
        return (applied(operation, *numbers),)

    return apply


def _trimmed(polynomial: Sequence[Expression]) -> Polynomial:
    """Without leading coefficients that are zero."""
    many = len(polynomial)
    while many > 1 and polynomial[many - 1].is_zero():
        many -= 1
    return tuple(polynomial[:many])


def _plus(a: Polynomial, b: Polynomial) -> Polynomial:
    longer, shorter = (a, b) if len(a) >= len(b) else (b, a)
    return _trimmed(
        [*(x + y for x, y in zip(longer, shorter, strict=False)), *longer[len(shorter) :]]
    )


def _negative(a: Polynomial) -> Polynomial:
    return tuple(-x for x in a)


def _times(a: Polynomial, b: Polynomial) -> Polynomial:
    found = [ca.SX(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            found[i + j] = found[i + j] + x * y
    return _trimmed(found)


def _over(a: Polynomial, b: Polynomial) -> Polynomial:
    if len(b) > 1:
        raise _NoPolynomialError
    return tuple(x / b[0] for x in a)


def _power(a: Polynomial, b: Polynomial) -> Polynomial:
    """A power; a whole one may be of the symbol."""
    if len(a) == len(b) == 1:
        return (a[0] ** b[0],)
    exponent = float(b[0]) if len(b) == 1 and b[0].is_constant() else math.nan
    if not (0.0 <= exponent <= _MOST and exponent == int(exponent)):
        raise _NoPolynomialError
    found: Polynomial = (ca.SX(1),)
    for _ in range(int(exponent)):
        found = _times(found, a)
    return found


_MOST = 64
_POLYNOMIAL: dict[int, Callable[..., Polynomial]] = {
    ca.OP_ADD: _plus,
    ca.OP_SUB: lambda a, b: _plus(a, _negative(b)),
    ca.OP_MUL: _times,
    ca.OP_DIV: _over,
    ca.OP_NEG: _negative,
    ca.OP_SQ: lambda a: _times(a, a),
    ca.OP_TWICE: lambda a: tuple(2 * x for x in a),
    ca.OP_POW: _power,
    ca.OP_CONSTPOW: _power,
    ca.OP_ASSIGN: lambda a: a,
}
"""Operations that make polynomials of polynomials."""

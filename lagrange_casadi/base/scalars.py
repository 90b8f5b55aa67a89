"""Sums, differences and products of numbers and expressions, columns of them, and functions, also
of many columns of numbers.

CasADi's operators first ask of each operand which of all kinds it is. That takes ten times as long
as to write the operation down. Here there are two kinds alone: numbers, and expressions of scalars
(``casadi.SX``).
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping

import casadi as ca
import numpy as np

from .arrays import Array, Expression

_SX, _binary = ca.SX, ca.SX.binary
_ADD, _SUB, _MUL = ca.OP_ADD, ca.OP_SUB, ca.OP_MUL


def added(a: Expression, b: Expression) -> Expression:
    """Return a + b."""
    return _binary(_ADD, a, b) if isinstance(a, _SX) or isinstance(b, _SX) else a + b


def less(a: Expression, b: Expression) -> Expression:
    """Return a - b."""
    return _binary(_SUB, a, b) if isinstance(a, _SX) or isinstance(b, _SX) else a - b


def product(a: Expression, b: Expression) -> Expression:
    """Return a b."""
    return _binary(_MUL, a, b) if isinstance(a, _SX) or isinstance(b, _SX) else a * b


def products_added(a: Expression, b: Expression, c: Expression, d: Expression) -> Expression:
    """Return a b + c d."""
    return added(product(a, b), product(c, d))


def products_less(a: Expression, b: Expression, c: Expression, d: Expression) -> Expression:
    """Return a b - c d."""
    return less(product(a, b), product(c, d))


def applied(operation: int, *operands: Expression) -> ca.SX:
    """An operation, by CasADi's ``OP_`` code, of one or two expressions."""
    return (
        ca.SX.unary(operation, *operands) if len(operands) == 1 else _binary(operation, *operands)
    )


def as_expression(value: Expression) -> ca.SX:
    """A number as an expression, an expression as it is."""
    return value if isinstance(value, _SX) else _SX(value)


def column(parts: Iterable[Expression]) -> ca.SX:
    """Parts one below the other; an empty column where there are none."""
    return ca.vertcat(_SX(0, 1), *parts)


def graph(name: str, given: Mapping[str, ca.SX], **found: Expression) -> ca.Function:
    """A function of symbols that are ``given``, with what is ``found`` of them as dense results,
    both by name. What stands in it twice is computed once.
    """
    results = [ca.densify(as_expression(value)) for value in found.values()]
    return ca.Function(name, [*given.values()], results, [*given], [*found], {"cse": True})


def inputs_of(function: ca.Function) -> dict[str, ca.SX]:
    """Symbols for the inputs of a function, by its names for them."""
    return dict(zip(function.name_in(), function.sx_in(), strict=True))


def entries(whole: Expression) -> list[ca.SX]:
    """The entries of a column, of which there may be none."""
    found = as_expression(whole)
    return ca.vertsplit(found) if found.numel() else []


def called(function: ca.Function, *columns: Array) -> Array:
    """The numbers (n, m) of a function of columns, column after column if they are a matrix; one
    column alone stands for all. Its inputs and its result are dense.
    """
    many = max(of.shape[1] for of in columns)
    if not many:
        return np.zeros((function.numel_out(0), 0))
    # Few sizes of batches, for each takes some milliseconds to make.
    size = 1 << (many - 1).bit_length()
    found = np.empty((size, function.numel_out(0)))
    buffer, call = _mapped(function, size).buffer()
    # A buffer has addresses alone: the arrays are kept here while it is called.
    given = [np.empty((size, len(of))) for of in columns]
    for number, (rows, of) in enumerate(zip(given, columns, strict=True)):
        rows[: of.shape[1]], rows[of.shape[1] :] = of.T, of.T[:1]
        buffer.set_arg(number, rows.data)
    buffer.set_res(0, found.data)
    call()
    return np.ascontiguousarray(found[:many].T)


@functools.lru_cache(maxsize=64)
def _mapped(function: ca.Function, size: int) -> ca.Function:
    return function.map(size) if size > 1 else function

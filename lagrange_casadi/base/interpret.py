"""An SX function followed instruction by instruction, in any arithmetic.

CasADi's own machine knows doubles. Here the same instructions run on whatever an
:class:`Arithmetic` computes with: numbers of many digits, arrays of any numbers, or expressions
that become another function.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from ..errors import DeclarationError
from .arrays import Array, Expression, Operand
from .lookups import Lookup, lookup
from .scalars import applied, column

_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Step:
    """An instruction: what it does (one of CasADi's ``OP_`` codes), the places it reads, the place
    it writes, and its number.

    Of an input or output the places are those of argument and nonzero. Of a call there is the
    function, and the table if it looks one up.
    """

    operation: int
    arguments: tuple[int, ...]
    results: tuple[int, ...]
    constant: float = 0.0
    called: Any = None
    looked_up: Lookup | None = None


INFIX = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_ASSIGN: "{0}",
}
"""Operations that C and structured text write alike."""

REMAINDERS = {ca.OP_FMOD, ca.OP_REMAINDER}
"""Operations that take whole multiples of their second operand from the first."""


@dataclass(frozen=True, eq=False)
class Arithmetic:
    """``constant`` makes a number of a double; ``operations`` are functions of one or two numbers
    by CasADi's ``OP_`` code.

    That of ``OP_CALL`` takes a :class:`.Lookup` and a number.
    """

    constant: Callable[[float], Any]
    operations: Mapping[int, Callable[..., Any]]


@functools.lru_cache(maxsize=64)
def steps(function: ca.Function) -> tuple[Step, ...]:
    """The instructions of an SX function."""
    found: list[Step] = []
    # To list them takes long, and where nothing is called nobody needs them.
    written = function.instructions_sx() if function.find_functions(0) else []
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        called = written[k].which_function() if operation == ca.OP_CALL else None
        number = function.instruction_constant(k) if operation == ca.OP_CONST else 0.0
        places = (tuple(function.instruction_input(k)), tuple(function.instruction_output(k)))
        looked_up = lookup(called) if called is not None else None
        if looked_up is not None and looked_up.alone:
            operation, looked_up = ca.OP_CONST, None
        found.append(Step(operation, *places, number, called, looked_up))
    return tuple(found)


@functools.lru_cache(maxsize=64)
def followable(function: ca.Function) -> bool:
    """Return whether a function is written in scalars, calls nothing but tables, and contains no
    operation that is unknown here.
    """
    return bool(function.is_a("SXFunction")) and all(
        step.operation in _KNOWN or step.looked_up for step in steps(function)
    )


def replay(
    function: ca.Function,
    inputs: Sequence[Sequence[_Value]],
    made: Callable[[int, Step, list[_Value]], _Value | Sequence[_Value]],
) -> list[list[_Value]]:
    """The nonzeros of every output of an SX function, from those of its inputs.

    ``made`` makes the value of every other step of its number, the step and its operands: a list if
    the step has several results.
    """
    work: dict[int, Any] = {}
    outputs: list[list[Any]] = [[None] * size for size in _sizes(function)]
    for k, step in enumerate(steps(function)):
        if step.operation == ca.OP_INPUT:
            work[step.results[0]] = inputs[step.arguments[0]][step.arguments[1]]
        elif step.operation == ca.OP_OUTPUT:
            outputs[step.results[0]][step.results[1]] = work[step.arguments[0]]
        else:
            value: Any = made(k, step, [work[place] for place in step.arguments])
            if len(step.results) == 1:
                work[step.results[0]] = value
            else:
                work |= zip(step.results, value, strict=True)
    return outputs


@functools.lru_cache(maxsize=64)
def _sizes(function: ca.Function) -> tuple[int, ...]:
    """The number of nonzeros of each output."""
    return tuple(function.nnz_out(i) for i in range(function.n_out()))


def interpret(
    function: ca.Function, inputs: Sequence[Sequence[Operand]], arithmetic: Arithmetic
) -> list[list[Operand]]:
    """The nonzeros of every output of an SX function, from those of its inputs.

    Raises :class:`DeclarationError` where the function calls another one, or does what the
    arithmetic has no name for.
    """

    def made(_k: int, step: Step, operands: list[Operand]) -> Operand:
        rule = arithmetic.operations.get(step.operation)
        if rule is not None and step.operation != ca.OP_CALL:
            return rule(*operands)
        if step.operation == ca.OP_CONST:
            return arithmetic.constant(step.constant)
        if rule is not None and step.looked_up is not None:
            return rule(step.looked_up, *operands)
        unknown = f"takes {operation_name(step.operation)}, unknown here"
        what = "calls another one" if step.operation == ca.OP_CALL else unknown
        raise DeclarationError(f"function '{function.name()}' cannot be followed: it {what}")

    return replay(function, inputs, made)


def expressed(step: Step, operands: Sequence[ca.SX]) -> ca.SX:
    """The expression of a step that is no call, but of a table, from
    the expressions that it reads.
    """
    if step.operation == ca.OP_CONST:
        return ca.SX(step.constant)
    return (
        step.looked_up.function(*operands)
        if step.looked_up is not None
        else applied(step.operation, *operands)
    )


def operations(function: ca.Function, inputs: Sequence[ca.SX]) -> list[tuple[int, list[ca.SX]]]:
    """Every operation of an SX function of scalars, with the expressions of ``inputs`` that it is
    applied to.
    """
    found: list[tuple[int, list[Any]]] = []

    def made(_k: int, step: Step, operands: list[ca.SX]) -> ca.SX:
        found.extend(operation_of(step, operands))
        return expressed(step, operands)

    replay(function, [given.nonzeros() for given in inputs], made)
    return found


def operation_of(step: Step, operands: list[ca.SX]) -> Iterator[tuple[int, list[ca.SX]]]:
    """The operation of a step and its operands; nothing for a constant.

    Of a table's cell (``OP_CALL``) the second is the numbers between its cells.
    """
    if step.looked_up is None and step.operation != ca.OP_CONST:
        yield step.operation, operands
    elif step.looked_up is not None and step.looked_up.kind == "cell":
        yield ca.OP_CALL, [*operands, ca.SX(step.looked_up.numbers[1:-1])]


def written_out(expression: ca.SX) -> Expression:
    """Return a scalar expression with the functions that it calls written out, but for tables and
    what has no expression.

    So a user's function of scalars that is never inlined is followed and compiled like all else.
    Other functions, as a callback, remain calls.
    """
    symbols = ca.symvar(expression)
    function = ca.Function("expression", symbols, [expression])
    if not any(called.is_a("SXFunction") for called in function.find_functions(0)):
        return expression
    return _written_out(function, symbols)[0]


def _written_out(function: ca.Function, inputs: Sequence[ca.SX]) -> list[Operand]:
    """Return the outputs of an SX function of expressions, with what it calls written out."""

    def made(_k: int, step: Step, operands: list[Operand]) -> Operand:
        called = step.called
        if called is None:
            return expressed(step, operands)
        values = iter(operands)
        given = [
            _filled(called.sparsity_in(i), itertools.islice(values, called.nnz_in(i)))
            for i in range(called.n_in())
        ]
        found = _written_out(called, given) if called.is_a("SXFunction") else called.call(given)
        every = [value for row in found for value in row.nonzeros()]
        return every if len(step.results) > 1 else every[0]

    outputs = replay(function, [given.nonzeros() for given in inputs], made)
    return [_filled(function.sparsity_out(i), nonzeros) for i, nonzeros in enumerate(outputs)]


def _filled(sparsity: ca.Sparsity, nonzeros: Iterable[Expression]) -> ca.SX:
    return ca.SX(sparsity, column(nonzeros))


def codes(names: str) -> dict[int, str]:
    """Operations by CasADi's ``OP_`` codes, from their ``names``, as "sin atan2"."""
    return {getattr(ca, f"OP_{name.upper()}"): name for name in names.split()}


def operation_name(operation: int) -> str:
    """Return CasADi's name of an operation."""
    return next(
        (name for name in dir(ca) if name.startswith("OP_") and getattr(ca, name) == operation),
        str(operation),
    )


@functools.cache
def numpy_arithmetic() -> Arithmetic:
    """NumPy's arithmetic on doubles and arrays of them."""
    return Arithmetic(np.float64, _ARITHMETIC | {ca.OP_CALL: lambda lookup, x: lookup.at(x)})


def _truth(function: Callable[..., Operand]) -> Callable[..., Array]:
    """Let a comparison be one or zero, as in C."""
    return lambda *values: np.asarray(function(*values)).astype(np.result_type(*values))


def _remainder(x: Array, y: float) -> Operand:
    """C's remainder, which is exact: every difference is of numbers within a factor of two."""
    remainder, y = np.abs(np.fmod(x, 2 * y)), np.abs(y)
    above = 2 * remainder > y
    remainder = np.where(above, remainder - y, remainder)
    remainder = np.where(above & (2 * remainder >= y), remainder - y, remainder)
    return np.where(np.signbit(x), -remainder, remainder)


_ARITHMETIC: dict[int, Callable[..., Any]] = {
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_DIV: np.divide,
    ca.OP_SQ: np.square,
    ca.OP_SQRT: np.sqrt,
    ca.OP_INV: np.reciprocal,
    ca.OP_NEG: np.negative,
    ca.OP_TWICE: lambda x: x + x,
    ca.OP_ASSIGN: lambda x: x,
    ca.OP_FABS: np.abs,
    ca.OP_SIGN: np.sign,
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_FMOD: np.fmod,
    ca.OP_COPYSIGN: np.copysign,
    ca.OP_IF_ELSE_ZERO: lambda x, y: np.where(x, y, 0.0),
    ca.OP_REMAINDER: _remainder,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_HYPOT: np.hypot,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_ASINH: np.arcsinh,
    ca.OP_ACOSH: np.arccosh,
    ca.OP_ATANH: np.arctanh,
    ca.OP_ERF: np.vectorize(math.erf),
    ca.OP_LT: _truth(np.less),
    ca.OP_LE: _truth(np.less_equal),
    ca.OP_EQ: _truth(np.equal),
    ca.OP_NE: _truth(np.not_equal),
    ca.OP_NOT: _truth(np.logical_not),
    ca.OP_AND: _truth(np.logical_and),
    ca.OP_OR: _truth(np.logical_or),
}
_ARITHMETIC |= {
    code: getattr(np, name)
    for code, name in codes("sin cos tan sinh cosh tanh exp log log1p expm1").items()
}
_KNOWN = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, *_ARITHMETIC}

"""How far what is put into curves is beyond their ends, where they are not defined."""

from __future__ import annotations

import functools
from typing import Any

import casadi as ca

from ..arithmetic.compensated import Precision
from ..arithmetic.interpret import Arithmetic, followable, interpret, numpy_arithmetic
from ..arithmetic.lookups import Lookup

BEYOND: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""Of what is between the ends of a curve: what is beyond them by so little is so by rounding."""


def beyond_ends(expression: Any) -> Any | None:
    """How far the arguments of an expression's curves are beyond their ends, the farthest, over what is between the ends.

    Below zero where all are between them; None where no curve has ends.
    """
    expression = ca.densify(ca.vec(ca.SX(expression)))
    symbols = ca.symvar(expression)
    function = ca.Function("arguments", symbols, [expression], {"cse": True})
    if not followable(function):
        return None
    found: list[Any] = []

    def looked_up(lookup: Lookup, x: Any) -> Any:
        if lookup.ends:
            low, high = float(lookup.numbers[0]), float(lookup.numbers[-1])
            found.append(ca.fmax(low - x, x - high) / (high - low))
        return lookup.function(x)

    rules: dict[int, Any] = {code: functools.partial(_applied, code) for code in numpy_arithmetic().operations}
    interpret(function, [[symbol] for symbol in symbols], Arithmetic(ca.SX, rules | {ca.OP_CALL: looked_up}))
    return functools.reduce(ca.fmax, found) if found else None


def _applied(code: int, *operands: Any) -> Any:
    return ca.SX.unary(code, *operands) if len(operands) == 1 else ca.SX.binary(code, *operands)

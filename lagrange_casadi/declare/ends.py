"""How far what is put into curves is beyond their ends, where they are not defined."""

from __future__ import annotations

import functools
import math
from typing import Any

import casadi as ca

from ..arithmetic.compensated import Precision
from ..arithmetic.interpret import Arithmetic, followable, interpret, numpy_arithmetic
from ..arithmetic.lookups import Lookup

BEYOND: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""How far an argument may be beyond the ends of a curve by rounding, as :func:`beyond_ends` tells it."""


def beyond_ends(expression: Any) -> list[Any]:
    """How far each argument of an expression's curves is beyond the curve's ends; of curves that have ends.

    The square of how far it is from the middle between the ends, over the square of how far these are, less one: it is above zero
    beyond the ends, and smooth, so that splines may follow it.
    """
    expression = ca.densify(ca.vec(ca.SX(expression)))
    symbols = ca.symvar(expression)
    function = ca.Function("arguments", symbols, [expression], {"cse": True})
    if not followable(function):
        return []
    found: list[Any] = []

    def looked_up(lookup: Lookup, x: Any) -> Any:
        if lookup.ends:
            low, high = float(lookup.numbers[0]), float(lookup.numbers[-1])
            found.append(((2.0 / (high - low)) * x - (high + low) / (high - low)) ** 2 - 1.0)
        return lookup.function(x)

    rules: dict[int, Any] = {code: functools.partial(_applied, code) for code in numpy_arithmetic().operations}
    interpret(function, [[symbol] for symbol in symbols], Arithmetic(ca.SX, rules | {ca.OP_CALL: looked_up}))
    return found


def share_beyond(beyond: float) -> float:
    """How far that is beyond the nearer end, over what is between the ends."""
    return (math.sqrt(1.0 + max(beyond, -1.0)) - 1.0) / 2.0


def _applied(code: int, *operands: Any) -> Any:
    return ca.SX.unary(code, *operands) if len(operands) == 1 else ca.SX.binary(code, *operands)

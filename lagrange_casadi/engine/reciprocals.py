"""Fewer divisions: what is divided by more than once, or depends on parameters alone, is inverted
once; and fewer changes of sign.

A division takes as long as ten products, and a machine has few dividers; a product with a
reciprocal rounds once more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.interpret import Step, expressed, followable, replay
from ..base.scalars import column, graph, inputs_of, less, product
from ..base.symbolic import symbolic


@symbolic
def share_reciprocals(function: ca.Function, parameters: str) -> ca.Function:
    """Function of one output with divisions shared; ``parameters`` names the input whose
    reciprocals always pay.

    Less a difference is the opposite difference, to the last bit.

    A function that calls others stays as it is.
    """
    if not followable(function):
        return function
    divisors = _divisors(function, function.index_in(parameters))
    uses = Counter(divisor for divisor, _ in divisors.values())
    inverses: dict[object, Any] = {}

    def made(k: int, step: Step, operands: list[Expression]) -> Expression:
        if k in divisors and (divisors[k][1] or uses[divisors[k][0]] > 1):
            x = operands[-1]
            # It is given its own sign, for else CasADi writes (1/x) y as y/x again.
            inverse = inverses.setdefault(
                divisors[k][0], ca.SX.binary(ca.OP_COPYSIGN, ca.SX.binary(ca.OP_DIV, 1.0, x), x)
            )
            return product(operands[0], inverse) if step.operation == ca.OP_DIV else inverse
        if step.operation == ca.OP_NEG and operands[0].op() == ca.OP_SUB:
            return less(operands[0].dep(1), operands[0].dep(0))
        return expressed(step, operands)

    return _replayed(function, made)


@symbolic
def differentiable(function: ca.Function) -> ca.Function:
    """A function of :func:`share_reciprocals` with plain divisions again.

    CasADi 3.7 differentiates copysign(a, b) as if a were positive.
    """
    if not followable(function):
        return function

    def made(_k: int, step: Step, operands: list[ca.SX]) -> ca.SX:
        if (
            step.operation == ca.OP_COPYSIGN
            and operands[0].op() == ca.OP_INV
            and ca.is_equal(operands[0].dep(0), operands[1])
        ):
            return operands[0]
        return expressed(step, operands)

    return _replayed(function, made)


def _replayed(
    function: ca.Function, made: Callable[[int, Step, list[Expression]], Expression]
) -> ca.Function:
    """The function of one output again, with what ``made`` makes of the number of a step, the step
    and its operands.
    """
    given = inputs_of(function)
    (nonzeros,) = replay(function, [symbols.nonzeros() for symbols in given.values()], made)
    out = ca.SX(function.sparsity_out(0), column(nonzeros))
    return graph(function.name(), given, **{function.name_out(0): out})


def _divisors(function: ca.Function, parameters: int) -> dict[int, tuple[object, bool]]:
    """For each step that divides: the step or the input that its divisor is of, and whether that
    depends on parameters alone.
    """
    found: dict[int, tuple[object, bool]] = {}

    def made(k: int, step: Step, operands: list[tuple[object, bool]]) -> tuple[object, bool]:
        if step.operation in (ca.OP_DIV, ca.OP_INV):
            found[k] = operands[-1]
        return k, all(fixed for _, fixed in operands)

    given: list[list[tuple[object, bool]]] = [
        [((i, k), i == parameters) for k in range(function.nnz_in(i))]
        for i in range(function.n_in())
    ]
    replay(function, given, made)
    return found

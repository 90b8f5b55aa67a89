"""An SX function followed instruction by instruction, in any arithmetic.

CasADi's own machine knows doubles. Here the same instructions run on whatever an :class:`Arithmetic` computes with: numbers of many
digits, arrays with an error put on every operation, or expressions that become another function.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from .errors import DeclarationError


@dataclass(frozen=True)
class Step:
    """An instruction: what it does (one of CasADi's ``OP_`` codes), the places it reads, the place it writes, and its number.

    Of an input or output the places are those of argument and nonzero.
    """

    operation: int
    arguments: tuple[int, ...]
    results: tuple[int, ...]
    constant: float = 0.0


@dataclass(frozen=True, eq=False)
class Arithmetic:
    """``constant`` makes a number of a double; ``operations`` are functions of one or two numbers by CasADi's ``OP_`` code."""

    constant: Callable[[float], Any]
    operations: Mapping[int, Callable[..., Any]]


@functools.lru_cache(maxsize=64)
def steps(function: Any) -> tuple[Step, ...]:
    """The instructions of an SX function. Raises :class:`DeclarationError` for a function of another kind."""
    if not function.is_a("SXFunction"):
        raise DeclarationError(f"function '{function.name()}' cannot be followed: it is not written in scalars (casadi.SX)")
    found = []
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        number = function.instruction_constant(k) if operation == ca.OP_CONST else 0.0
        places = (tuple(function.instruction_input(k)), tuple(function.instruction_output(k)))
        found.append(Step(operation, *places, number))
    return tuple(found)


def followable(function: Any) -> bool:
    """Whether a function is written in scalars and calls no other."""
    return bool(function.is_a("SXFunction")) and all(step.operation != ca.OP_CALL for step in steps(function))


def interpret(function: Any, inputs: Sequence[Sequence[Any]], arithmetic: Arithmetic) -> list[list[Any]]:
    """The nonzeros of every output of an SX function, from those of its inputs.

    Raises :class:`DeclarationError` where the function calls another one, or does what the arithmetic has no name for.
    """
    work: dict[int, Any] = {}
    outputs: list[list[Any]] = [[arithmetic.constant(0.0)] * function.nnz_out(i) for i in range(function.n_out())]
    for step in steps(function):
        if step.operation == ca.OP_CONST:
            work[step.results[0]] = arithmetic.constant(step.constant)
        elif step.operation == ca.OP_INPUT:
            work[step.results[0]] = inputs[step.arguments[0]][step.arguments[1]]
        elif step.operation == ca.OP_OUTPUT:
            outputs[step.results[0]][step.results[1]] = work[step.arguments[0]]
        else:
            rule = arithmetic.operations.get(step.operation)
            if rule is None:
                what = "calls another one" if step.operation == ca.OP_CALL else f"takes {_name(step.operation)}, unknown here"
                raise DeclarationError(f"function '{function.name()}' cannot be followed: it {what}")
            work[step.results[0]] = rule(*(work[place] for place in step.arguments))
    return outputs


def _name(operation: int) -> str:
    return next((name for name in dir(ca) if name.startswith("OP_") and getattr(ca, name) == operation), str(operation))

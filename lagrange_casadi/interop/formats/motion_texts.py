"""Motions as texts in files: expressions of time, read as data and written as Python."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Sequence
from itertools import accumulate

from .record import LARGEST, number

ONE_NUMBER = "sin cos tan asin acos atan sinh cosh tanh exp log sqrt fabs"
"""Functions of one number that a law may have; CasADi's and Python's are called the same."""

_FUNCTIONS = {name: name for name in f"{ONE_NUMBER} atan2".split()}
_NAMES = ", ".join(_FUNCTIONS)
_FUNCTIONS |= {"abs": "fabs", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "ln": "log"}
_VALUES = {"t": "t", "time": "t", "pi": "pi"}
_WORDS = _VALUES | {name: f"ca.{known}" for name, known in _FUNCTIONS.items()}
"""Names of a law as a case has them."""

LONGEST = 10_000
_TALLEST, _DEEPEST = 1000, 100
"""Terms of a sum, and pairs of parentheses in each other, at most."""

_OPERATORS: dict[type[ast.AST], Callable[..., float]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


class LawError(ValueError):
    """Part of a text that no law has, in words."""


def parsed(text: str) -> tuple[str, float | None]:
    """Return the expression of a text as Python, and its number if it is without t.

    A text has numbers, pi, t or time, + - * / ^ and functions. Each part without t is a number of
    at most 1e12. Raises :class:`LawError`.
    """
    if len(text) > LONGEST:
        raise LawError(f"an expression of more than {LONGEST} characters")
    plain = re.sub(r"(?<=[\d.])d(?![\w.])", "", " ".join(text.split())).replace("^", "**")
    try:
        tree = ast.parse(plain if plain.isascii() and "#" not in plain else "", mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise LawError("expected an expression of t") from None
    nodes, found = [tree], dict[ast.expr, float | None]()
    for node in nodes:  # which grow: no recursion, for a sum of many terms is as deep
        nodes += _parts(node, plain)
    for node in reversed(nodes):
        try:
            found[node] = _number(node, [found[part] for part in _parts(node, plain)])
        except (ArithmeticError, TypeError, ValueError):
            raise LawError(
                f"'{_stated(node, plain)}' is no number of at most {LARGEST:g}"
            ) from None
    nested = max(accumulate((one == "(") - (one == ")") for one in plain))
    if len(nodes) > 2 * _TALLEST or nested > _DEEPEST:
        raise LawError(
            f"expected at most {_TALLEST} terms, and {_DEEPEST} pairs of parentheses in each other"
        )
    return re.sub(r"(?<![\w.])[a-z]\w*", lambda word: _WORDS[word[0]], plain), found[tree]


def _parts(node: ast.expr, text: str) -> list[ast.expr]:
    """Return the parts of an expression. Raises :class:`LawError` for what no law has."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return []
        case ast.Name(id=name) if name in _VALUES:
            return []
        case ast.UnaryOp(op=sign, operand=inner) if type(sign) in _OPERATORS:
            return [inner]
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in _OPERATORS:
            return [left, right]
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if name in _FUNCTIONS:
            if len(given) != 1 + (name == "atan2"):
                raise LawError(f"{name} of {len(given)} numbers")
            return given
    raise LawError(
        f"'{_stated(node, text)}' is not supported; valid: numbers, pi, t, + - * / ^, {_NAMES}"
    )


def _stated(node: ast.expr, text: str) -> str:
    """Return the part of a text that an expression is of, for messages."""
    return text[node.col_offset : node.end_col_offset][:60]


def _number(node: ast.expr, values: Sequence[float | None]) -> float | None:
    """Return the number of an expression from those of its parts; None for one with t.

    Raises :class:`ArithmeticError`, :class:`TypeError` or :class:`ValueError` for a part without t
    that is no number.
    """
    match node:
        case ast.Constant(value=value):
            return number(value)
        case ast.Name(id=name):
            return math.pi if name == "pi" else None
        case ast.BinOp(op=ast.Div()) if values[1] == 0.0:
            raise ZeroDivisionError
        case ast.Call(func=ast.Name(id=name)) if None not in values:
            return number(getattr(math, _FUNCTIONS[name])(*values))
        case ast.UnaryOp(op=sign) | ast.BinOp(op=sign) if None not in values:
            return number(_OPERATORS[type(sign)](*values))
    return None

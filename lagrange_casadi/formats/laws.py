"""Motions as texts in files: expressions of time, read as data and written as Python."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Sequence

from numpy.polynomial import Polynomial

from .record import LARGEST

_TURNS = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")
ONE_NUMBER = (*_TURNS, "exp", "log", "sqrt", "fabs")
"""Functions of one number that a law may have; CasADi's are called the same."""

NAMES = (*ONE_NUMBER, "atan2")
"""All of them."""

_OTHER_NAMES = {"abs": "fabs", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "ln": "log"}
_TIMES = ("t", "time")
LONGEST = 10_000
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}


class LawError(ValueError):
    """Part of a text that no law has, in words."""


def parsed(text: str) -> ast.expr:
    """Return the expression of a text: numbers, pi, t or time, + - * / ^ and functions.

    Raises :class:`LawError`.
    """
    if len(text) > LONGEST:
        raise LawError(f"an expression of more than {LONGEST} characters")
    plain = re.sub(r"(?<=[\d.])d(?![\w.])", "", text.strip()).replace("^", "**")
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise LawError("expected an expression of t") from None
    try:
        return _allowed(tree)
    except RecursionError:
        raise LawError("its parentheses are too deep") from None


def _allowed(node: ast.expr) -> ast.expr:
    """Return a part of an expression under the names that cases use."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            if not abs(value) <= LARGEST:
                raise LawError(f"numbers are at most {LARGEST:g}")
            return ast.Constant(value)
        case ast.Name(id=name) if name in _TIMES:
            return ast.Name("t")
        case ast.Name(id="pi"):
            return node
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=inner):
            return ast.UnaryOp(sign, _allowed(inner))
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            return ast.BinOp(_allowed(left), operator, _allowed(right))
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if (
            _OTHER_NAMES.get(name, name) in NAMES
        ):
            name = _OTHER_NAMES.get(name, name)
            if len(given) != (2 if name == "atan2" else 1):
                raise LawError(f"{name} of {len(given)} numbers")
            return ast.Call(ast.Name(f"ca.{name}"), [_allowed(one) for one in given], [])
    raise LawError(
        f"'{ast.unparse(node)[:60]}' is not supported; valid: numbers, pi, t, + - * / ^,"
        f" {', '.join(NAMES)}"
    )


def python(text: str, less: float = 0.0) -> str:
    """Return a law, less a number, as what a case has for it, in the words of ``motion``."""
    tree = parsed(text)
    try:
        found = (_polynomial(tree) - less).trim().coef
    except LawError:
        shift = f" - {of_pi(less)}" if less > 0 else f" + {of_pi(-less)}" if less else ""
        return f"expression(lambda t: {ast.unparse(tree)}{shift})"
    return f"polynomial({', '.join(map(of_pi, found.tolist()))})"


def _polynomial(node: ast.expr) -> Polynomial:
    """Return a law as a polynomial of t. Raises :class:`LawError` for others."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return Polynomial([float(value)])
        case ast.Name(id=name):
            return Polynomial([0.0, 1.0] if name == "t" else [math.pi])
        case ast.UnaryOp(op=sign, operand=inner):
            return -_polynomial(inner) if isinstance(sign, ast.USub) else _polynomial(inner)
        case ast.BinOp(left=left, op=operator, right=right):
            one, other = _polynomial(left), _polynomial(right)
            whole, *rest = other.coef.tolist()
            made: Polynomial | None = None
            match operator:
                case ast.Add():
                    made = one + other
                case ast.Sub():
                    made = one - other
                case ast.Mult():
                    made = one * other
                case ast.Div() if whole and not rest:
                    made = one / whole
                case ast.Pow() if whole in (0.0, 1.0, 2.0, 3.0) and not rest:
                    made = one ** int(whole)
            if made is not None:
                return made
    raise LawError("no polynomial")


def of_pi(value: float) -> str:
    """Return a number as text: as a simple multiple of pi where it is one to the last digits."""
    share = value / math.pi
    for part in (1, 2, 3, 4, 6):
        whole = share * part
        near = round(whole)
        if near and abs(near) < 1000 and abs(whole - near) < 4e-16 * abs(whole):
            times = {1: "pi", -1: "-pi"}.get(near, f"{near} * pi")
            return times if part == 1 else f"{times} / {part}"
    return text_of(value)


def text_of(value: float) -> str:
    """Return a number as Python writes it; zero has no sign."""
    return repr(float(value) + 0.0)


def tuple_of(values: Sequence[float]) -> str:
    """Return numbers as a tuple in Python."""
    return f"({', '.join(map(text_of, values))})"

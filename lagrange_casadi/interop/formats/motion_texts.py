"""Motions as texts in files: expressions of time, read as data and written as Python."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from .posture import at_reference, extent
from .python_text import Call, of_pi, signed, vector
from .record import LARGEST, Law, Model, number

_TURNS = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")
ONE_NUMBER = (*_TURNS, "exp", "log", "sqrt", "fabs")
"""Functions of one number that a law may have; CasADi's are called the same."""

NAMES = (*ONE_NUMBER, "atan2")
"""All of them."""

_OTHER_NAMES = {"abs": "fabs", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "ln": "log"}
LONGEST = 10_000
_TALLEST, _DEEPEST, _DEGREE = 1000, 100, 20
"""Terms of a sum, pairs of parentheses in each other, and degree of a polynomial, at most."""

_OPERATORS: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", 1),
    ast.Sub: ("-", 1),
    ast.Mult: ("*", 2),
    ast.Div: ("/", 2),
    ast.Pow: ("**", 4),
}
"""Operators as Python writes them, each with its rank: the higher one binds first."""

_SIGN, _ATOM = 3, 5
"""Rank of a sign, and of a part that has no operator."""


class LawError(ValueError):
    """Part of a text that no law has, in words."""


@dataclass(frozen=True, eq=False)
class Expression:
    """An expression of ``t`` as Python, and as a polynomial of t if it is one.

    ``binds`` is how closely its outermost operator does, ``tall`` how many operators are in each
    other, ``deep`` how many of them are in parentheses or on the right.
    """

    text: str
    binds: int = _ATOM
    polynomial: Polynomial | None = None
    tall: int = 0
    deep: int = 0

    @property
    def number(self) -> float | None:
        """The value of one without t."""
        known = self.polynomial
        return float(known.coef[0]) if known is not None and known.degree() == 0 else None

    def within(self, binds: int) -> str:
        """Return the text as part of what binds so closely."""
        return self.text if self.binds >= binds else f"({self.text})"


_ZERO = Expression("0", polynomial=Polynomial([0.0]))


def parsed(text: str) -> Expression:
    """Return the expression of a text: numbers, pi, t or time, + - * / ^ and functions.

    Each part without t is a number of at most 1e12. Raises :class:`LawError`.
    """
    if len(text) > LONGEST:
        raise LawError(f"an expression of more than {LONGEST} characters")
    plain = re.sub(r"(?<=[\d.])d(?![\w.])", "", text.strip()).replace("^", "**")
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise LawError("expected an expression of t") from None
    nodes, made = [tree], dict[ast.expr, Expression]()
    for node in nodes:  # which grow: no recursion, for a sum of many terms is as deep
        nodes += _parts(node)
    for node in reversed(nodes):
        made[node] = _expression(node, [made[part] for part in _parts(node)])
    return made[tree]


def _parts(node: ast.expr) -> list[ast.expr]:
    """Return the parts of an expression. Raises :class:`LawError` for what no law has."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return []
        case ast.Name(id="t" | "time" | "pi"):
            return []
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=inner):
            return [inner]
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            return [left, right]
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if _name(name) in NAMES:
            if len(given) != (2 if _name(name) == "atan2" else 1):
                raise LawError(f"{_name(name)} of {len(given)} numbers")
            return given
    try:
        stated = ast.unparse(node)[:60]
    except RecursionError:
        stated = type(node).__name__
    raise LawError(
        f"'{stated}' is not supported; valid: numbers, pi, t, + - * / ^, {', '.join(NAMES)}"
    )


def _name(name: str) -> str:
    """Return what a function is called here."""
    return _OTHER_NAMES.get(name, name)


def _expression(node: ast.expr, parts: Sequence[Expression]) -> Expression:
    """Return an expression of its parts. Raises :class:`LawError` for one that is too large, or has
    a part without t that is no number.
    """
    text, binds = "t", _ATOM
    found: Polynomial | None = Polynomial([0.0, 1.0])
    tall = max((one.tall for one in parts), default=-1) + 1
    deep = max((one.deep for one in parts), default=-1) + 1
    try:
        match node:
            case ast.Constant(value=int() | float() as value):
                text = repr(value)
                found = Polynomial([number(value)])
            case ast.Name(id="pi"):
                text, found = "pi", Polynomial([math.pi])
            case ast.UnaryOp(op=sign):
                symbol, binds = "-" if isinstance(sign, ast.USub) else "+", _SIGN
                text = f"{symbol}{parts[0].within(binds)}"
                found = _combined(symbol, _ZERO, parts[0])
            case ast.BinOp(op=operator):
                symbol, binds = _OPERATORS[type(operator)]
                one, other = parts
                bare = one.binds >= binds + (symbol == "**")
                deep = max(one.deep + (not bare), other.deep + 1)
                sides = one.within(binds + (symbol == "**")), other.within(binds + (symbol != "**"))
                text = f" {symbol} ".join(sides)
                found = _combined(symbol, one, other)
            case ast.Call(func=ast.Name(id=name)):
                text = f"ca.{_name(name)}({', '.join(one.text for one in parts)})"
                values = [one.number for one in parts]
                known = None not in values
                found = Polynomial([getattr(math, _name(name))(*values)]) if known else None
        if found is not None and found.degree() == 0:
            number(float(found.coef[0]))
    except (ArithmeticError, TypeError, ValueError):
        raise LawError(f"'{text[:60]}' is no number of at most {LARGEST:g}") from None
    if tall > _TALLEST or deep > _DEEPEST:
        most = (
            f"expected at most {_TALLEST} terms, and {_DEEPEST} pairs of parentheses in each other"
        )
        raise LawError(most)
    return Expression(text, binds, found, tall, deep)


def _combined(symbol: str, one: Expression, other: Expression) -> Polynomial | None:
    """Return what an operator makes of two expressions, as a polynomial of t if it is one of finite
    numbers and a low degree.

    Raises :class:`ArithmeticError` and the like for numbers that have no such one.
    """
    left, right, value = one.polynomial, other.polynomial, other.number
    if symbol == "/" and value == 0.0:
        raise ZeroDivisionError
    if left is None or right is None:
        return None
    degree, found = left.degree() + right.degree(), None
    with np.errstate(all="ignore"):
        match symbol:
            case "+":
                found = left + right
            case "-":
                found = left - right
            case "*" if degree <= _DEGREE:
                found = left * right
            case "/" if value is not None:
                found = left / value
            case "**" if value is not None and not degree:
                found = Polynomial([number(float(left.coef[0]) ** value)])
            case "**" if value in (0.0, 1.0, 2.0, 3.0) and degree * value <= _DEGREE:
                found = left ** int(value)
    return found if found is not None and np.isfinite(found.coef).all() else None


def python(text: str, less: float = 0.0) -> Call:
    """Return a law, less a number, as what a case has for it, in the words of ``motion``."""
    found = parsed(text)
    if found.polynomial is None:
        return Call("expression", [f"lambda t: {found.text}{signed(-less)}"])
    return Call(
        "polynomial", [of_pi(one) for one in (found.polynomial - less).trim().coef.tolist()]
    )


class Motions:
    """Motions of a record as a case counts them: from the reference posture, and those of joints
    that are open as in the file.
    """

    def __init__(self, model: Model, opened: Container[str]) -> None:
        self.model, self.opened, self.size = model, opened, extent(model)

    def offset(self, coordinate: str) -> float:
        """Return what a coordinate of the file is where that of the case is zero."""
        if coordinate.partition(":")[0] in self.opened:
            return 0.0
        return self.at_reference(coordinate)

    def at_reference(self, coordinate: str) -> float:
        """Return a coordinate in the reference posture."""
        return at_reference(self.model, coordinate, self.size)

    def law(self, coordinate: str, law: Law) -> Call:
        """Return the motion of a coordinate."""
        less = self.offset(coordinate)
        if law.samples is not None:
            times, values = law.samples
            return Call("samples", [vector(times), vector(one - less for one in values)])
        try:
            return python(law.text, less)
        except LawError as error:
            words = f"motion of '{coordinate}': {error}"
            raise self.model.refuse(law.where, words) from None

    def counted(self, name: str) -> bool:
        """Return whether the turns of a joint are counted from another posture than the reference:
        three turns, of which not the last one alone differs from zero there, have no difference.
        """
        joint = self.model.joints[name]
        turns = [one for one in joint.coordinates if ":turn_" in one]
        if len(turns) < 3 or not any(map(self.at_reference, turns[:-1])):
            return False
        given = {one: law for one in turns if (law := self.model.motions.get(one))}
        if all(str(self.law(one, law)) == "polynomial(0.0)" for one, law in given.items()):
            return False
        if len(given) < len(turns):
            words = f"motion of '{next(iter(given))}': expected one of each turn of joint '{name}'"
            words += ", for the body is turned about several axes in the reference posture"
            raise self.model.refuse(joint.where, words)
        return True

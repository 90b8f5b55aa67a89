"""Motions as texts in files: expressions of time, read as data and written as Python."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Container

from numpy.polynomial import Polynomial

from .posture import at_reference
from .python_text import Call, of_pi, signed, vector
from .record import LARGEST, Law, Model

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


def python(text: str, less: float = 0.0) -> Call:
    """Return a law, less a number, as what a case has for it, in the words of ``motion``."""
    tree = parsed(text)
    try:
        found = (_polynomial(tree) - less).trim().coef
    except LawError:
        return Call("expression", [f"lambda t: {ast.unparse(tree)}{signed(-less)}"])
    return Call("polynomial", [of_pi(one) for one in found.tolist()])


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


class Motions:
    """Motions of a record as a case counts them: from the reference posture, and those of joints
    that are open as in the file.
    """

    def __init__(self, model: Model, opened: Container[str]) -> None:
        self.model, self.opened = model, opened

    def offset(self, coordinate: str) -> float:
        """Return what a coordinate of the file is where that of the case is zero."""
        if coordinate.partition(":")[0] in self.opened:
            return 0.0
        return at_reference(self.model, coordinate)

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
        given = {one: law for one, law in self.model.motions.items() if one in turns}
        if len(turns) < 3 or not any(at_reference(self.model, one) for one in turns[:-1]):
            return False
        if all(str(self.law(one, law)) == "polynomial(0.0)" for one, law in given.items()):
            return False
        if len(given) < len(turns):
            words = f"motion of '{next(iter(given))}': expected one of each turn of joint '{name}'"
            words += ", for the body is turned about several axes in the reference posture"
            raise self.model.refuse(joint.where, words)
        return True

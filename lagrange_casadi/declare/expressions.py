"""What may stand for a name or a number in a declaration."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from typing import Any

import casadi as ca

from ..errors import AngleError, DeclarationError, one_line
from .angles import angle as read_angle
from .parts import Expression

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def check_name(kind: str, name: str) -> None:
    """Raise :class:`DeclarationError` for what cannot be a name in a file, on the command line, and in C."""
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise DeclarationError(f"{kind} name {name!r} must be a letter followed by letters, digits or underscores")


def check_line(what: str, text: object) -> None:
    """Raise :class:`DeclarationError` for what is no line of printable characters: it may stand in files, figures and C."""
    if not isinstance(text, str) or not text.isprintable():
        raise DeclarationError(f"{what} must be a line of printable characters, got {text!r}")


def scalar(what: str, value: Any, symbols: Iterable[Any], allowed: str) -> Expression:
    """A finite float, or an SX scalar in the given symbols. Raises :class:`DeclarationError`, saying what is ``allowed``."""
    if isinstance(value, ca.SX):
        if value.numel() != 1:
            raise DeclarationError(f"{what} must be a scalar, got one of shape {value.shape}")
        known = {symbol.element_hash() for symbol in symbols}
        foreign = [f"'{symbol}'" for symbol in ca.symvar(value) if symbol.element_hash() not in known]
        if foreign:
            raise DeclarationError(f"{what} depends on {', '.join(foreign)}, not a {allowed}")
        if not (value.is_constant() or value.is_symbolic()):
            called = ca.Function("expression", ca.symvar(value), [value]).find_functions()
            if any(function.class_name().endswith("Interpolant") for function in called):
                raise DeclarationError(
                    f"{what} calls casadi.interpolant, whose C runs in doubles only, and one instant at a time; expected "
                    "lagrange_casadi.curve(x, y)(ARGUMENT), smooth, or where corners may be table(ARGUMENT, x, y)"
                )
        return value
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise DeclarationError(f"{what} must be a number or an expression in parameters, got {value!r}") from None
    if not math.isfinite(number):
        symbols = "; functions of math and float() make nan of a symbol: use CasADi's, as casadi.sin" if math.isnan(number) else ""
        raise DeclarationError(f"{what} must be finite, got {number}{symbols}")
    return number


def sound(condition: Any) -> Any:
    """One where a condition on parameters holds; elsewhere not a number, which every backend and compiler has as a root."""
    return ca.sqrt(2.0 * condition - 1.0)


def told(error: BaseException) -> str:
    """What an error says, in a line; of a choice that Python cannot make for a symbol, what makes it instead."""
    text = one_line(error)
    if "truth value of a CasADi" in text:
        return (
            "a symbol is neither true nor false before it has a value: use casadi.if_else(condition, a, b) for 'if', "
            "casadi.logic_and and logic_or for 'and' and 'or', casadi.fmin and fmax for 'min' and 'max'"
        )
    return f"{type(error).__name__}: {text}"


def typed(what: str, angle: Expression) -> Expression:
    """An angle [rad]: a text as a number, anything else as it is. Raises :class:`DeclarationError` for a text of none."""
    try:
        return read_angle(angle) if isinstance(angle, str) else angle
    except AngleError as error:
        raise DeclarationError(f"{what}: {error}") from None


def bound(what: str, value: Any, unit: str) -> float:
    """A number in a unit, not always finite; an angle may be a text. Raises :class:`DeclarationError` for anything else."""
    try:
        return float(typed(f"{what}: angle", value) if unit == "rad" else value)
    except (TypeError, ValueError, OverflowError):
        raise DeclarationError(f"{what}: expected a number [{unit}], got {value!r}") from None


def unit_vector(what: str, axis: Any, component: Callable[[Any], Expression]) -> tuple[Expression, Expression]:
    """A direction of length one. Raises :class:`DeclarationError` for (0, 0), or for what has not two components."""
    if not isinstance(axis, (tuple, list)) or len(axis) != 2:
        raise DeclarationError(f"{what}: axis must be two components, got {axis!r}")
    x, y = (component(a) for a in axis)
    if isinstance(x, ca.SX) or isinstance(y, ca.SX):
        norm = ca.sqrt(x * x + y * y)
        return x / norm, y / norm
    norm = math.hypot(x, y)
    if norm == 0.0:
        raise DeclarationError(f"{what}: axis must not be (0, 0)")
    return x / norm, y / norm


def plain(value: Any) -> Expression:
    """A number where an expression is one."""
    return float(value) if isinstance(value, ca.SX) and value.is_constant() else value

"""Values that may stand for a name or a number in a declaration."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence

import casadi as ca

from ..base.interpret import written_out
from ..base.units import Unit, number, typed
from ..errors import DeclarationError, NumberError, shown
from .declared_parts import Expression
from .mistakes import error_text

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def check_name(kind: str, name: str) -> None:
    """Raise :class:`DeclarationError` for what cannot be a name in a file, on the command line, and
    in C.
    """
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise DeclarationError(
            f"{kind} name {name!r} must be a letter followed by letters, digits or underscores"
        )


def check_line(what: str, text: object) -> None:
    """Raise :class:`DeclarationError` for what is no line of printable characters: it may stand in
    files, figures and C.
    """
    if not isinstance(text, str) or not text.isprintable():
        raise DeclarationError(f"{what} must be a line of printable characters, got {text!r}")


def scalar(
    what: str, value: object, symbols: Iterable[ca.SX], allowed: str, unit: str = "1"
) -> Expression:
    """A finite float, or an SX scalar in the given symbols; a number in a ``unit`` may be a text,
    as ``"100 mm"``.

    Raises :class:`DeclarationError`, saying what is ``allowed``.
    """
    if isinstance(value, ca.SX):
        if value.numel() != 1:
            raise DeclarationError(f"{what} must be a scalar, got one of shape {value.shape}")
        known = {symbol.element_hash() for symbol in symbols}
        foreign = [
            f"'{symbol}'" for symbol in ca.symvar(value) if symbol.element_hash() not in known
        ]
        if foreign:
            raise DeclarationError(f"{what} depends on {', '.join(foreign)}, not a {allowed}")
        if not (value.is_constant() or value.is_symbolic()):
            called = ca.Function("expression", ca.symvar(value), [value]).find_functions()
            if any(function.class_name().endswith("Interpolant") for function in called):
                raise DeclarationError(
                    f"{what} calls casadi.interpolant, which works in double precision only, one"
                    " instant at a time; expected lagrange_casadi.curve(x, y)(ARGUMENT), or"
                    " table(ARGUMENT, x, y) if corners are allowed"
                )
            return written_out(value)
        return value
    try:
        found = number(value, unit, finite=isinstance(value, str))
    except NumberError as error:
        if isinstance(value, str) and unit != "1":
            raise DeclarationError(f"{what}: {error}") from None
        hint = "; call the function, as with the time of the mechanism" if callable(value) else ""
        raise DeclarationError(
            f"{what} must be a number or an expression in parameters, got {shown(value)}{hint}"
        ) from None
    if not math.isfinite(found):
        nan = (
            "; the functions of math and float() cannot take a symbol: use casadi.sin, casadi.fmax"
            " and the like"
            if math.isnan(found)
            else ""
        )
        raise DeclarationError(f"{what} must be finite, got {found}{nan}")
    return found


def coordinates(
    what: str, terms: Iterable[tuple[Expression | str, str]]
) -> tuple[list[Expression], str]:
    """Numbers or expressions of a joint's coordinate, each with what it is per, as ``"/s"``; and in
    which unit texts give them.

    That is rad or m, or nothing without a text. Raises :class:`DeclarationError` for what is none
    of these, or in both units.
    """
    found: list[Expression] = []
    units: set[str] = set()
    for value, per in terms:
        read, unit = typed(value)
        base = unit.removesuffix(per)
        if isinstance(value, str) and unit not in (f"rad{per}", f"m{per}"):
            kinds = " or ".join(f"{Unit.of(one).kind} [{one}]" for one in (f"rad{per}", f"m{per}"))
            examples = f"'350 deg{per}' or '100 mm{per}'"
            raise DeclarationError(
                f"{what}: expected {kinds}: a number, an expression, or a text such as"
                f" {examples}, got {shown(value)}{f', {Unit.of(unit).kind}' if unit else ''}"
            )
        units |= {base} if unit else set()
        found.append(parametric(what, read))
    if len(units) > 1:
        raise DeclarationError(
            f"{what}: mixes angles and lengths; expected the unit of one coordinate"
        )
    return found, next(iter(units), "")


def parametric(what: str, value: object, unit: str = "1") -> Expression:
    """A :func:`scalar` in any symbols, for what belongs to no mechanism yet."""
    symbols = ca.symvar(value) if isinstance(value, ca.SX) else []
    return scalar(what, value, symbols, "parameter", unit)


def sound(condition: ca.SX) -> ca.SX:
    """One where a condition on parameters holds; elsewhere not a number, which every backend and
    compiler has as a root.
    """
    return ca.sqrt(2.0 * condition - 1.0)


def expressed(
    what: str, graph: Callable[..., Expression], arguments: Sequence[ca.SX], names: str
) -> Expression:
    """Return a user's function of symbols, which messages call by their ``names``.

    Raises :class:`.DeclarationError`, saying ``what`` it is, for whatever the function raises.
    """
    try:
        return graph(*arguments)
    except Exception as error:
        raise DeclarationError(
            f"{what} cannot be made as an expression of {names} (CasADi's functions, numbers"
            f" without units): {error_text(error)[:240]}"
        ) from None


def plain(value: Expression) -> Expression:
    """A number where an expression is one."""
    return float(value) if isinstance(value, ca.SX) and value.is_constant() else value

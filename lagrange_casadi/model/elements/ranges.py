"""Ranges of numbers of parts: numbers are refused when a part is declared, expressions for values
of parameters.
"""

from __future__ import annotations

import math

import casadi as ca

from ...base.numerals import readable
from ...errors import DeclarationError
from ..declared_parts import Expression
from ..meshes import FITTING, Fit

LEAST = 1e-12
"""Least number that counts as positive."""


def whole(what: str, name: str, value: Expression) -> list[Fit]:
    """Check that a number is whole, and 1 or more."""
    if isinstance(value, ca.SX):
        nearest = ca.fmax(ca.floor(value + 0.5), 1.0)
        return [Fit(f"{name} must be whole, and 1 or more, got {{got}}", value, nearest, 1.0)]
    if value < 1.0 or abs(value - round(value)) > FITTING:
        raise DeclarationError(
            f"{what}: {name} must be whole, and 1 or more, got {readable(value)}"
        )
    return []


def positive(what: str, name: str, value: Expression) -> list[Fit]:
    """Check that a length is positive."""
    if isinstance(value, ca.SX):
        return [Fit(f"{name} must be positive, got {{got}} m", value, ca.fmax(value, LEAST), LEAST)]
    if value <= 0.0:
        raise DeclarationError(f"{what}: {name} must be positive, got {readable(value)} m")
    return []


def within(what: str, name: str, angle: Expression, low: float, high: float) -> list[Fit]:
    """Check that an angle [rad] is between two others."""
    bounds = f"{name} must be from {math.degrees(low):.6g} to {math.degrees(high):.6g} deg"
    if isinstance(angle, ca.SX):
        return [Fit(f"{bounds}, got {{got}} rad", angle, ca.fmin(ca.fmax(angle, low), high), 1.0)]
    if not low <= angle <= high:
        raise DeclarationError(f"{what}: {bounds}, got {math.degrees(angle):.6g} deg")
    return []


def at_least(what: str, words: str, value: Expression, low: float, shown: Expression) -> list[Fit]:
    """Check that a number is not below another; an error has ``words``."""
    if isinstance(value, ca.SX):
        return [Fit(f"{words}, got {{got}}", shown, shown + ca.fmax(low - value, 0.0), LEAST)]
    if value < low:
        raise DeclarationError(f"{what}: {words}, got {shown:g}")
    return []


def share(what: str, value: Expression) -> list[Fit]:
    """Check that an efficiency is above 0, and 1 at most."""
    found = at_least(what, "efficiency must be above 0", value, LEAST, value)
    return found + at_least(what, "efficiency must not be above 1", 1 - value, 0.0, value)

"""Conditions on the numbers of a transmission: they are refused when it is declared, and for other
values of parameters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import casadi as ca

from ...errors import DeclarationError
from ..declared_parts import Expression
from ..meshes import FITTING, Fit
from ..validity import Evaluator

LEAST = 1e-12
"""Least number that counts as positive."""

_DEGREES = 180.0 / math.pi


@dataclass(frozen=True, eq=False)
class Fits:
    """Conditions of a part ``what``, ``found`` to hold where the ``number`` of an expression is its
    value with the defaults of parameters.

    Methods raise :class:`.DeclarationError` for what does not hold.
    """

    what: str
    number: Evaluator
    found: list[Fit] = field(default_factory=list)

    def same(self, words: str, got: Expression, meant: Expression, size: Expression) -> None:
        """Two numbers are the same, see :class:`.Fit`."""
        fit, one, other = Fit(words, got, meant, size), self.number(got), self.number(meant)
        if abs(one - other) > FITTING * self.number(size):
            raise DeclarationError(f"{self.what}: {fit.refusal(one, other)}")
        self.found.append(fit)

    def whole(self, name: str, value: Expression) -> None:
        """A number is whole, and 1 or more."""
        nearest = ca.fmax(ca.floor(value + 0.5), 1.0)
        self.same(f"{name} must be whole, and 1 or more, got {{got}}", value, nearest, 1.0)

    def positive(self, name: str, value: Expression) -> None:
        """A length is positive."""
        words = f"{name} must be positive, got {{got}} m"
        self.same(words, value, ca.fmax(value, LEAST), LEAST)

    def within(self, name: str, angle: Expression, low: float, high: float) -> None:
        """An angle [rad] is between two others [deg]."""
        words = f"{name} must be from {low:.6g} to {high:.6g} deg, got {{got}} deg"
        degrees = _DEGREES * angle
        self.same(words, degrees, ca.fmin(ca.fmax(degrees, low), high), _DEGREES)

    def at_least(self, words: str, value: Expression, low: float, shown: Expression) -> None:
        """A number is not below another; an error has ``words``, and what is ``shown``."""
        self.same(f"{words}, got {{got}}", shown, shown + ca.fmax(low - value, 0.0), LEAST)

    def share(self, value: Expression) -> None:
        """An efficiency is above 0, and 1 at most."""
        self.at_least("efficiency must be above 0", value, LEAST, value)
        self.at_least("efficiency must not be above 1", 1 - value, 0.0, value)

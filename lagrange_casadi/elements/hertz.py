"""The pressure of Hertz where two cylinders touch along a line.

Source: K. L. Johnson, *Contact Mechanics*, 1985, equation 4.45.
"""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

from ..declare.expressions import sound
from ..declare.mechanism import Mechanism
from ..declare.parts import Expression
from ..errors import DeclarationError

STEEL = (210e9, 0.3)
"""Young's modulus [Pa] and Poisson's ratio."""


def stiffness_of(what: str, elastic: tuple[float, float]) -> float:
    """The stiffness [Pa] of the contact of two bodies of one material. Raises :class:`.DeclarationError` for constants of none."""
    if not (0.0 < elastic[0] < math.inf and 0.0 <= elastic[1] <= 0.5):
        raise DeclarationError(f"{what}: elastic must be Young's modulus [Pa] and Poisson's ratio, 0 to 0.5, got {elastic!r}")
    return elastic[0] / (2.0 * (1.0 - elastic[1] ** 2))


def largest_pressure(what: str, mechanism: Mechanism, force: Any, curvature: Any, width: Expression, stiffness: float) -> Any:
    """The largest pressure [Pa] of two bodies, by force [N], width [m], the sum of their curvatures [1/m], and stiffness [Pa].

    Raises :class:`.DeclarationError` for a width that is not positive.
    """
    wide = mechanism.own.expression(f"{what}: width", width, "m")
    if isinstance(wide, ca.SX):
        wide = wide * sound(wide > 0.0)
    elif wide <= 0.0:
        raise DeclarationError(f"{what}: width must be positive, got {wide:g} m")
    return ca.sqrt(force * ca.fmax(curvature, 0.0) * stiffness / (math.pi * wide))

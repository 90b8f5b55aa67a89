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


def largest_pressure(
    what: str, mechanism: Mechanism, force: Any, curvature: Any, width: Expression, elastic: tuple[float, float]
) -> Any:
    """The largest pressure [Pa] of two bodies of one material, by force [N], width [m] and the sum of their curvatures [1/m].

    Raises :class:`.DeclarationError` for a width that is not positive, and constants of no material.
    """
    wide = mechanism.own.expression(f"{what}: width", width, "m")
    if isinstance(wide, ca.SX):
        wide = wide * sound(wide > 0.0)
    elif wide <= 0.0:
        raise DeclarationError(f"{what}: width must be positive, got {wide:g} m")
    if not (len(elastic) == 2 and elastic[0] > 0.0 and 0.0 <= elastic[1] <= 0.5):
        raise DeclarationError(f"{what}: elastic must be Young's modulus [Pa] and Poisson's ratio, 0 to 0.5, got {elastic!r}")
    stiffness = elastic[0] / (2.0 * (1.0 - elastic[1] ** 2))
    return ca.sqrt(force * ca.fmax(curvature, 0.0) * stiffness / (math.pi * wide))

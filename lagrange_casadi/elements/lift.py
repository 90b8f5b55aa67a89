"""What a cam makes of its follower: a law of the cam's angle, as an expression."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from ..declare.expressions import told
from ..declare.mechanism import Mechanism
from ..errors import DeclarationError

_LOOKED_AT = 37


def rise_of(what: str, mechanism: Mechanism, lift: Callable[[Any], Any], angle: Any) -> Any:
    """The lift as an expression of the symbol ``angle``.

    Raises :class:`.DeclarationError` for what is no function of expressions, and where it is no finite number.
    """
    try:
        rise = ca.SX(lift(angle))
    except Exception as error:  # whatever a user's function raises
        raise DeclarationError(
            f"{what}: lift must be a function of the cam's angle, of CasADi's expressions: {told(error)}"
        ) from None
    defaults = [parameter.default for parameter in mechanism.parameters.values()]
    angles = np.linspace(0.0, math.tau, _LOOKED_AT)
    values = ca.Function("lift", [angle, mechanism.symbols], [ca.densify(rise)])(angles[None], defaults).full().ravel()
    if not np.isfinite(values).all():
        first = math.degrees(angles[np.argmin(np.isfinite(values))])
        raise DeclarationError(
            f"{what}: lift is no finite number at {first:.4g} deg of the cam; expected a function of CasADi's expressions, "
            "with casadi.sin in place of math.sin"
        )
    return rise

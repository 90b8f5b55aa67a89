"""Laws of motion that can be differentiated as often as one likes: those by samples as the same splines in scalars."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from ..declare.curves import curve
from ..declare.motion import Motion, expression, motion_function
from ..errors import DeclarationError


def in_scalars(laws: Mapping[str, Motion], symbols: Any) -> dict[str, Motion]:
    """Laws by joint, of parameters that are ``symbols``, none of them a spline of CasADi's own.

    The spline through what one is at its knots is the same one. Raises :class:`.DeclarationError` where it does not tell them.
    """
    found = dict(laws)
    for name, law in laws.items():
        if law.spline:
            if not law.knots:
                raise DeclarationError(f"the motion of joint '{name}' does not tell its knots, which its further derivatives need")
            values = motion_function({name: law}, symbols)(ca.DM(law.knots).T, ca.DM.zeros(symbols.numel()))[0]
            found[name] = expression(curve(law.knots, values.full().ravel().tolist()))
    return found

"""The follower of a cam: its lift, a law of the cam's angle, and the pressure of Hertz where both
touch along a line.

Source: K. L. Johnson, *Contact Mechanics*, 1985, equation 4.45.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import casadi as ca
import numpy as np

from ...errors import DeclarationError
from ..declared_parts import Expression, Ground, Point
from ..expressions import expressed, sound
from ..joints import Joint
from ..mechanism import Mechanism

_SAMPLED = 37


def rise_of(
    what: str, mechanism: Mechanism, lift: Callable[[ca.SX], Expression], angle: ca.SX
) -> ca.SX:
    """The lift as an expression of the symbol ``angle``.

    Raises :class:`.DeclarationError` for what is no function of expressions, and where it is no
    finite number.
    """
    rise: ca.SX = expressed(f"{what}: lift", lambda x: ca.SX(lift(x)), [angle], "the cam's angle")
    defaults = [parameter.default for parameter in mechanism.parameters.values()]
    angles = np.linspace(0.0, math.tau, _SAMPLED)
    values = (
        ca.Function("lift", [angle, mechanism.symbols], [ca.densify(rise)])(angles[None], defaults)
        .full()
        .ravel()
    )
    if not np.isfinite(values).all():
        first = math.degrees(angles[np.argmin(np.isfinite(values))])
        raise DeclarationError(
            f"{what}: lift is no finite number at {first:.4g} deg of the cam; expected a function"
            " of CasADi's expressions, with casadi.sin in place of math.sin"
        )
    return rise


def held_by(
    what: str,
    mechanism: Mechanism,
    cam: Joint,
    follower: Joint,
    point: Point | None,
    *,
    space: bool,
) -> Point:
    """The point that a cam moves on its follower, by default where the follower's joint guides it.

    Raises :class:`.DeclarationError` for joints of no cam and follower on the ground, in a plane or
    in ``space``, and for a point of another body.
    """
    for joint, kinds in ((cam, ("revolute",)), (follower, ("prismatic", "revolute"))):
        kind = mechanism.ownership.joint(joint).kind
        on_ground = isinstance(joint.parent.body, Ground)
        if kind not in kinds or mechanism.space is not space or not on_ground:
            raise DeclarationError(
                f"{what}: expected a {' or '.join(kinds)} joint whose parent is the ground, in"
                f" {'space' if space else 'a plane'}, got '{joint.name}'"
            )
    held = follower.child if point is None else mechanism.ownership.point(what, point)
    if held.body is not follower.child.body:
        raise DeclarationError(
            f"{what}: its point must be on '{follower.child.body.name}', which joint"
            f" '{follower.name}' guides"
        )
    return held


STEEL = (210e9, 0.3)
"""Young's modulus [Pa] and Poisson's ratio."""


def stiffness_of(what: str, elastic: tuple[float, float]) -> float:
    """The stiffness [Pa] of the contact of two bodies of one material.

    Raises :class:`.DeclarationError` for constants of none.
    """
    if not (0.0 < elastic[0] < math.inf and 0.0 <= elastic[1] <= 0.5):
        raise DeclarationError(
            f"{what}: elastic must be Young's modulus [Pa] and Poisson's ratio, 0 to 0.5, got"
            f" {elastic!r}"
        )
    return elastic[0] / (2.0 * (1.0 - elastic[1] ** 2))


def largest_pressure(
    what: str,
    mechanism: Mechanism,
    force: ca.SX,
    curvature: ca.SX,
    width: Expression,
    stiffness: float,
) -> Expression:
    """The largest pressure [Pa] of two bodies, by force [N], width [m], the sum of their curvatures
    [1/m], and stiffness [Pa].

    Raises :class:`.DeclarationError` for a width that is not positive.
    """
    wide = positive(mechanism, f"{what}: width", width)
    return ca.sqrt(force * ca.fmax(curvature, 0.0) * stiffness / (math.pi * wide))


def positive(mechanism: Mechanism, what: str, size: Expression) -> Expression:
    """A length [m], which is not a number where parameters make it zero or less.

    Raises :class:`.DeclarationError` for a number that is not positive.
    """
    found = mechanism.ownership.expression(what, size, "m")
    if isinstance(found, ca.SX):
        return found * sound(found > 0.0)
    if not found > 0.0:
        raise DeclarationError(f"{what} must be positive, got {found:g} m")
    return found

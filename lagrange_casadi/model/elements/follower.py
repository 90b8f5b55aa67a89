"""The follower of a cam: its lift, a law of the cam's angle, the contact of both, and the pressure
of Hertz where they touch along a line.

Source: K. L. Johnson, *Contact Mechanics*, 1985, equation 4.45.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.brief import Brief
from ...base.scalars import column, graph
from ...base.vectors import Vector, cross, dot, norm
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Expression, Ground, Point
from ..expressions import expressed, sound
from ..joints import Joint
from ..mechanism import Mechanism
from .contact import touching
from .courses import along
from .fits import Fits

ANGLES = np.linspace(0.0, math.tau, 721)
"""Angles of a turn at which expressions are looked at."""

_SAME = 1e-9
"""Share of a lift that is rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class Touch(Brief):
    """Position of a contact, by the symbol ``angle`` of the cam [rad], in ground axes.

    ``place`` is the follower's point, ``normal`` of length one along the force on the follower,
    ``travel`` the direction in which the follower moves its point.
    """

    angle: Any
    place: Vector
    normal: Vector
    travel: Vector

    @property
    def pressure_angle(self) -> Expression:
        """The angle between the contact's force and the way of the follower's point [rad]."""
        return ca.atan2(norm(cross(self.normal, self.travel)), dot(self.normal, self.travel))


def sampled(mechanism: Mechanism, angle: ca.SX, at: Array, *rows: Expression) -> Array:
    """Values (rows, n) of expressions of the cam's ``angle`` ``at`` some, with the defaults of
    parameters.
    """
    defaults = [parameter.default for parameter in mechanism.parameters.values()]
    function = graph("rows", {"angle": angle, "p": mechanism.symbols}, rows=column(rows))
    return np.asarray(function(at[None], defaults).full())


def rise_of(
    what: str, mechanism: Mechanism, lift: Callable[[ca.SX], Expression]
) -> tuple[ca.SX, ca.SX]:
    """A symbol for the cam's angle, and the lift as an expression of it.

    Raises :class:`.DeclarationError` for what is no function of expressions, where it is no finite
    number, and where it is another after a turn.
    """
    angle = ca.SX.sym("angle")
    rise: ca.SX = expressed(f"{what}: lift", lambda x: ca.SX(lift(x)), [angle], "the cam's angle")
    few = ANGLES[::20]
    (values,) = sampled(mechanism, angle, few, rise)
    if not np.isfinite(values).all():
        first = math.degrees(few[np.argmin(np.isfinite(values))])
        raise DeclarationError(
            f"{what}: lift is no finite number at {first:.4g} deg of the cam; expected a function"
            " of CasADi's expressions, with casadi.sin in place of math.sin"
        )
    if abs(values[-1] - values[0]) > _SAME * (np.ptp(values) or 1.0):
        raise DeclarationError(
            f"{what}: its lift must be the same after a turn of the cam; expected a period of 2 pi"
        )
    return angle, rise


def contact(
    mechanism: Mechanism, name: str, cam: Joint, touch: Touch, gap: Expression, rise: Expression
) -> Constraint:
    """Declare that a ``gap`` along the contact's normal is zero, and the outputs NAME_force and
    NAME_pressure_angle.

    Raises :class:`.DeclarationError` for a name that is taken.
    """
    phi, lift, lean = (
        ca.substitute(ca.SX(one), touch.angle, mechanism.coordinate(cam))
        for one in (gap, rise, touch.pressure_angle)
    )
    made = touching(mechanism, name, phi, lift=lift)
    mechanism.output(f"{name}_force", mechanism.results.multiplier(made), unit="N")
    mechanism.output(f"{name}_pressure_angle", lean, unit="rad")
    return made


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


def output_pressure(
    mechanism: Mechanism,
    name: str,
    force: ca.SX,
    curvature: ca.SX,
    width: Expression,
    stiffness: float,
) -> None:
    """Declare the output NAME_hertz: the largest pressure [Pa] of two bodies, by force [N], width
    [m], the sum of their curvatures [1/m], and stiffness [Pa].

    Raises :class:`.DeclarationError` for a width that is not positive.
    """
    wide = positive(mechanism, f"cam '{name}'", "width", width)
    pressure = ca.sqrt(force * ca.fmax(curvature, 0.0) * stiffness / (math.pi * wide))
    mechanism.output(f"{name}_hertz", pressure, unit="Pa")


def positive(mechanism: Mechanism, what: str, name: str, size: Expression) -> Expression:
    """A length [m], which is not a number where parameters make it zero or less.

    Raises :class:`.DeclarationError` where it is not positive with the defaults of parameters.
    """
    found = mechanism.ownership.expression(f"{what}: {name}", size, "m")
    Fits(what, mechanism.ownership.at_defaults).positive(name, found)
    return found * sound(found > 0.0) if isinstance(found, ca.SX) else found


def unit(vector: Vector) -> Vector:
    """A direction of length 1."""
    return along(vector, norm(vector))

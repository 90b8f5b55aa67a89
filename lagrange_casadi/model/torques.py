"""Torques that drive a machine or load it, as expressions of time, angle and speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import casadi as ca

from ..base.arguments import Measured, Row, Symbolic, public
from ..base.arrays import Expression
from ..base.scalars import entries
from ..base.symbolic import symbolic
from ..base.tables import FORCE, MOMENT
from ..base.units import typed
from ..errors import DeclarationError
from . import curves
from .expressions import expressed, parametric, scalar


@dataclass(frozen=True, eq=False)
class Law:
    """A torque [N m], or force [N] of a drive that slides, over the time [s], the coordinate [rad
    or m] and the rate [rad/s or m/s] of the drive: ``graph(t, angle, speed)``. ``unit`` is that of
    a text that gives a number.
    """

    graph: Callable[[Expression, Expression, Expression], Expression]
    unit: str = ""

    @public
    def geared(self, ratio: Symbolic) -> Law:
        """Return the law of a motor that is geared to the drive, without losses.

        Parameters
        ----------
        ratio : float or casadi.SX
            Speed of the motor over that of the drive.

        Returns
        -------
        Law
            Its torque [N m] or force [N] at the drive.
        """
        times = parametric("geared: ratio", ratio, "1")
        return Law(
            lambda t, angle, speed: times * self.graph(t, times * angle, times * speed), self.unit
        )


@symbolic
def torque_of(
    law: Law, what: str, arguments: Sequence[ca.SX], parameters: ca.SX, unit: str
) -> ca.SX:
    """Return a law as an expression of symbols for time, angle and speed, and of parameters.

    Raises :class:`.DeclarationError`, saying ``what`` it is, for what is no such expression, and
    for one in another ``unit``.
    """
    if law.unit not in ("", unit):
        raise DeclarationError(f"{what} is in {law.unit}; expected {unit}")
    value = expressed(what, law.graph, arguments, "t, angle and speed")
    symbols = [*arguments, *entries(parameters)]
    return ca.SX(scalar(what, value, symbols, "parameter", "N m"))


def law_of(given: Law | Measured | None, what: str) -> Law:
    """Read a law; a number is a constant torque, and None no torque at all."""
    if isinstance(given, Law):
        return given
    if given is None:
        return torque(0.0)
    try:
        return torque(given)
    except DeclarationError as error:
        raise DeclarationError(f"{what}: expected a law of forward, or a number; {error}") from None


@public
def torque(value: Symbolic) -> Law:
    """Return the law of a drive with constant torque or force.

    Parameters
    ----------
    value : float or casadi.SX
        Torque [N m], or force [N] of a drive that slides.

    Returns
    -------
    Law
        The torque or force.
    """
    unit = typed(value)[1]
    constant = parametric("torque", value, FORCE if unit == FORCE else MOMENT)
    return Law(lambda t, angle, speed: constant, unit)


@public
def power(value: Symbolic) -> Law:
    """Return the law of a drive with constant power.

    Parameters
    ----------
    value : float or casadi.SX
        Power [W].

    Returns
    -------
    Law
        The torque power/speed, which is without bound at rest.
    """
    constant = parametric("power", value, "W")
    return Law(lambda t, angle, speed: constant / speed)


@public
def torque_curve(speeds: Annotated[Row, "rad/s"], torques: Annotated[Row, "N m"]) -> Law:
    """Return the law of a drive from a table of torques over speeds.

    Parameters
    ----------
    speeds : sequence of float
        Increasing speeds (n,) [rad/s].
    torques : sequence of float
        Torques there (n,) [N m].

    Returns
    -------
    Law
        A torque that is linear between the points and beyond them.

    Raises
    ------
    DeclarationError
        If the speeds do not increase.
    """
    curves.rows("torque_curve", speeds, torques, 2)
    return Law(lambda t, angle, speed: curves.table(speed, speeds, torques, beyond="line"))


@public
def dc_motor(stall_torque: Symbolic, no_load_speed: Symbolic) -> Law:
    """Return the law of a DC motor at constant voltage.

    Parameters
    ----------
    stall_torque : float or casadi.SX
        Torque at rest [N m].
    no_load_speed : float or casadi.SX
        Speed without torque [rad/s]. Both are negative for a motor that turns backwards.

    Returns
    -------
    Law
        A torque that falls linearly from rest to the no-load speed.

    Raises
    ------
    DeclarationError
        For numbers of different signs, and for zero.
    """
    stall = parametric("dc_motor: stall_torque", stall_torque, "N m")
    free = parametric("dc_motor: no_load_speed", no_load_speed, "rad/s")
    _check_direction("dc_motor", stall, free)
    return Law(lambda t, angle, speed: stall * (1.0 - speed / free))


@public
def induction_motor(
    breakdown_torque: Symbolic, breakdown_slip: Symbolic, synchronous_speed: Symbolic
) -> Law:
    """An induction motor by Kloss's formula, 2 T_b / (s/s_b + s_b/s) with the slip s = 1 -
    speed/synchronous speed.

    Parameters
    ----------
    breakdown_torque
        Largest torque T_b [N m].
    breakdown_slip
        Slip s_b at which it is reached.
    synchronous_speed
        Speed of the field [rad/s]; negative as the torque is for a motor that turns backwards.

    Returns
    -------
    Law
        The torque over speed; above the synchronous speed the motor brakes.

    Raises
    ------
    DeclarationError
        For torque and speed of different signs, for a slip that is not positive, and for zero.
    """
    most = parametric("induction_motor: breakdown_torque", breakdown_torque, "N m")
    at = parametric("induction_motor: breakdown_slip", breakdown_slip, "1")
    field = parametric("induction_motor: synchronous_speed", synchronous_speed, "rad/s")
    _check_direction("induction_motor", most, field)
    if not isinstance(at, ca.SX) and not at > 0.0:
        raise DeclarationError(f"induction_motor: breakdown_slip must be positive, got {at:g}")

    def graph(_t: Expression, _angle: Expression, speed: Expression) -> Expression:
        slip = 1.0 - speed / field
        return 2.0 * most * at * slip / (slip * slip + at * at)

    return Law(graph)


@public
def expression(law: Callable[[Expression, Expression, Expression], Expression]) -> Law:
    """Return a law of a drive from a function.

    Parameters
    ----------
    law : callable
        A function of the symbols t [s], angle [rad or m] and speed [rad/s or m/s] that returns a
        ``casadi.SX`` expression of them and of parameters [N m or N].

    Returns
    -------
    Law
        The torque or force.

    Raises
    ------
    DeclarationError
        If it is not a function.
    """
    return Law(law)


def _check_direction(motor: str, torque: Expression, speed: Expression) -> None:
    """Raise :class:`.DeclarationError` if a torque and a speed have different signs, or are zero;
    expressions of parameters are not known.
    """
    known = not isinstance(torque, ca.SX) and not isinstance(speed, ca.SX)
    if known and not torque * speed > 0.0:
        raise DeclarationError(
            f"{motor}: torque and speed must have one sign, because a motor drives in the direction"
            f" in which it turns; got {torque:g} N m and {speed:g} rad/s"
        )

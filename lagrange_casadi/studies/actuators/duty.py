"""Requirements of a cycle on the motor of a drive: speeds and torques behind its gearbox, their
means, power and energy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...base.arguments import Measured, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.units import quantity
from ...engine.instants.beyond_equilibrium import Holding
from ...errors import DeclarationError, check_known
from ...results.solution import Solution
from ...results.statistics import shares

_COARSE = 0.01
"""Largest relative change, if only every second instant is used, for which instants are enough."""


class InertiaRatio(NamedTuple):
    """The inertia of what is driven over that of the motor, both at the motor: over a cycle the
    least, the mean, the largest.
    """

    least: float
    mean: float
    largest: float


@public
@dataclass(frozen=True, eq=False, repr=False)
class Duty(Brief):
    """Requirements of a drive over the instants ``t`` [s]: ``speed`` [rad/s], ``torque`` [N m],
    each (t,).

    The motor turns ``ratio`` times as fast as the drive. Its gearbox loses a share of what passes
    it, whichever way: 1 less its ``efficiency``. The torque turns the motor's own ``inertia`` [kg
    m^2] too. Of a drive that slides the ratio is in rad/m; a ``linear`` motor has speeds in m/s,
    forces in N and a mass in kg in their place. ``carried`` is the inertia reflected to the drive
    [kg m^2 or kg], (t,), where it is known: see :func:`.inertia_at`.
    """

    joint: str
    ratio: float
    efficiency: float
    inertia: float
    t: Array
    speed: Array
    torque: Array
    linear: bool = False
    carried: Array | None = None

    @property
    def pull(self) -> str:
        """Name of the drive's torque or force."""
        return "force" if self.linear else "torque"

    @property
    def rms_torque(self) -> float:
        """The root of the mean square of the torque [N m], by trapezia: what heats the motor."""
        return math.sqrt(self.torque**2 @ shares(self.t))

    @property
    def mean_speed(self) -> float:
        """The mean of the size of the speed [rad/s]."""
        return float(np.abs(self.speed) @ shares(self.t))

    @property
    def peak_torque(self) -> float:
        """The largest size of the torque at the instants [N m]."""
        return float(np.abs(self.torque).max())

    @property
    def peak_speed(self) -> float:
        """The largest size of the speed at the instants [rad/s]."""
        return float(np.abs(self.speed).max())

    @property
    def power(self) -> Array:
        """Power of the motor [W], (t,)."""
        return self.speed * self.torque

    @property
    def peak_power(self) -> float:
        """The largest power that it gives [W]; negative where it only takes."""
        return float(self.power.max())

    @property
    def peak_return(self) -> float:
        """The largest power that comes back to it [W], nothing where none does: what a brake
        resistor bears.
        """
        return max(0.0, float(-self.power.min()))

    @property
    def energy(self) -> float:
        """Energy from the motor over the instants [J]; energy that comes back is not subtracted."""
        return _positive_area(self.t, self.power)

    @property
    def regenerated(self) -> float:
        """Energy that comes back to the motor over the instants [J]."""
        return _positive_area(self.t, -self.power)

    @property
    def inertia_ratio(self) -> InertiaRatio:
        """The inertia of what is driven, reflected to the motor, over the motor's own.

        Raises :class:`.DeclarationError` where the inertia of what is driven is not known, or the
        motor's is zero.
        """
        if self.carried is None or self.inertia == 0.0:
            lacking = (
                "the motor's inertia"
                if self.carried is not None
                else "the inertia reflected to the drive, carried=inertia_at(...)"
            )
            raise DeclarationError(f"inertia ratio of '{self.joint}': expected {lacking}")
        ratio = self.carried / (self.ratio**2 * self.inertia)
        return InertiaRatio(float(ratio.min()), float(ratio @ shares(self.t)), float(ratio.max()))

    @property
    def coarse(self) -> bool:
        """True if the instants are too few: with every second one a root mean square, or a peak,
        changes by 1 %.
        """
        half = replace(
            self, t=self.t[::2], speed=self.speed[::2], torque=self.torque[::2], carried=None
        )
        if half.t.size < 2:
            return True
        pairs = (
            (self.rms_torque, half.rms_torque),
            (self.peak_torque, half.peak_torque),
            (self.peak_speed, half.peak_speed),
        )
        return any(abs(whole - part) > _COARSE * whole for whole, part in pairs)


@public
def duty_of(
    solution: Solution,
    joint: str,
    *,
    ratio: Measured = 1.0,
    efficiency: float = 1.0,
    inertia: Measured = 0.0,
    linear: bool = False,
    carried: Array | None = None,
    holding: Holding | None = None,
) -> Duty:
    """Return the requirements of a drive on its motor, from a solution.

    Parameters
    ----------
    solution : Solution
        Has the effort and the motion of the drive, over a whole cycle.
    joint : str
        The driven joint.
    ratio : float
        Speed of the motor over that of the drive [1, or rad/m for a drive that slides]; negative if
        it turns the other way.
    efficiency : float
        Efficiency of the gearbox, above 0 and at most 1.
    inertia : float
        Inertia of the motor's rotor and what turns with it [kg m^2]; of a linear motor the mass of
        its moving part [kg].
    linear : bool
        A linear motor, for a drive that slides; its ratio is usually 1.
    carried : array, optional
        Result of :func:`.inertia_at` for the drive (t,), for the ratio of inertias.
    holding : Holding, optional
        Range of the efforts while joints with friction are at rest, by default that of the
        solution. The end of the range with the larger magnitude is used.

    Returns
    -------
    Duty
        Torque, speed and power over time, with their means and peaks.

    Raises
    ------
    UnknownNameError
        If the joint is not a drive of the solution.
    DeclarationError
        For numbers out of range, fewer than two instants, or an effort that is indeterminate.
    """
    drives = [
        str(name).partition(":")[2] for name in solution.names() if str(name).startswith("effort:")
    ]
    check_known("drive", [joint], drives)
    turns = quantity("ratio", ratio, "rad/m" if slides(solution, joint) and not linear else "1")
    if not turns:
        raise DeclarationError(f"ratio must be a finite number other than 0, got {ratio!r}")
    if not 0.0 < efficiency <= 1.0:
        raise DeclarationError(f"efficiency must be above 0 and at most 1, got {efficiency!r}")
    rotor = quantity("inertia", inertia, "kg" if linear else "kg m^2")
    if rotor < 0.0:
        raise DeclarationError(f"inertia must not be negative, got {inertia!r}")
    if linear and not slides(solution, joint):
        raise DeclarationError(
            f"drive '{joint}' turns, and a linear motor slides; expected a rotary one"
        )
    if solution.t.size < 2:
        raise DeclarationError("a duty needs two instants or more, over a whole cycle")
    if carried is not None and np.shape(carried) != solution.t.shape:
        raise DeclarationError(
            f"carried: expected an inertia at each of the {solution.t.size} instants"
        )
    effort, motion = solution.effort(joint), solution.motion(joint)
    rests = np.isnan(effort)
    holding = solution.holding.get(joint) if holding is None else holding
    if holding is not None:
        effort = np.where(rests, holding.worst, effort)
    missing = int(np.count_nonzero(~np.isfinite(effort)))
    if missing:
        why = (
            "; joints with friction are at rest there: use the range of holding(), or give their"
            " friction smooth="
        )
        if holding is not None:
            why = (
                f"; joints with friction are at rest there, and {holding.reason}: give their"
                " friction smooth="
            )
        why = why if solution.resting.any() else ""
        raise DeclarationError(
            f"the effort of drive '{joint}' is indeterminate at {missing} of {solution.t.size}"
            f" instants{why}"
        )
    # The gearbox takes its losses from whoever gives power; what holds at rest gets no help from
    # it.
    passed = np.where(rests | (effort * motion.rate >= 0.0), 1.0 / efficiency, efficiency)
    torque = effort * passed / turns + rotor * turns * motion.acceleration
    return Duty(
        joint,
        turns,
        float(efficiency),
        rotor,
        solution.t,
        turns * motion.rate,
        torque,
        bool(linear),
        carried,
    )


def slides(solution: Solution, joint: str) -> bool:
    """Return whether the coordinate of a drive is a length."""
    return solution.unit(f"motion:{joint}") == "m"


def _positive_area(t: Array, values: Array) -> float:
    """The area of what is above zero of straight lines between values."""
    a, b = values[:-1], values[1:]
    high, low = np.maximum(a, b), np.minimum(a, b)
    with np.errstate(all="ignore"):
        share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / (high - low)))
    height = np.where(low >= 0.0, (a + b) / 2.0, np.maximum(high, 0.0) / 2.0)
    return float(np.sum(np.diff(t) * share * height))

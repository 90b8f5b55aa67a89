"""What a cycle asks of the motor of a drive: speeds and torques behind its gearbox, their means, power and energy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..declare.density import Array
from ..errors import DeclarationError, UnknownNameError
from ..instants.solution import Solution


@dataclass(frozen=True, eq=False)
class Duty:
    """What a drive asks of its motor over the instants ``t`` [s]: ``speed`` [rad/s], ``torque`` [N m], each (t,).

    The motor turns ``ratio`` times as fast as the drive. Its gearbox loses a share of what passes it, whichever way: 1 less its
    ``efficiency``. The torque turns the motor's own ``inertia`` [kg m^2] too. Of a drive that slides the ratio is in rad/m.
    """

    joint: str
    ratio: float
    efficiency: float
    inertia: float
    t: Array
    speed: Array
    torque: Array

    @property
    def rms_torque(self) -> float:
        """The root of the mean square of the torque [N m], by trapezia: what heats the motor."""
        return math.sqrt(_mean(self.t, self.torque**2))

    @property
    def mean_speed(self) -> float:
        """The mean of the size of the speed [rad/s]."""
        return _mean(self.t, np.abs(self.speed))

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
        """What the motor gives [W], (t,)."""
        return self.speed * self.torque

    @property
    def peak_power(self) -> float:
        """The largest power that it gives [W]."""
        return float(self.power.max())

    @property
    def energy(self) -> float:
        """What the motor gives over the instants, less nothing that comes back [J]."""
        return _positive_area(self.t, self.power)

    @property
    def regenerated(self) -> float:
        """What comes back to the motor over the instants [J]."""
        return _positive_area(self.t, -self.power)


def duty_of(solution: Solution, joint: str, *, ratio: float = 1.0, efficiency: float = 1.0, inertia: float = 0.0) -> Duty:
    """The duty of a drive's motor, from a solution that has the drive's effort and its motion.

    ``ratio`` is how many times as fast as the drive the motor turns, for a drive that slides in rad/m; a negative one turns it the
    other way. ``efficiency`` is that of the gearbox, ``inertia`` [kg m^2] that of the motor's rotor and what turns with it.

    Raises :class:`.UnknownNameError` for what is no drive of the solution, :class:`.DeclarationError` for numbers that cannot be
    and for fewer than two instants.
    """
    drives = [str(name).partition(":")[2] for name in solution.names() if str(name).startswith("effort:")]
    if joint not in drives:
        raise UnknownNameError("drive", joint, drives)
    if not (math.isfinite(ratio) and ratio != 0.0):
        raise DeclarationError(f"ratio must be a finite number other than 0, got {ratio!r}")
    if not 0.0 < efficiency <= 1.0:
        raise DeclarationError(f"efficiency must be above 0 and at most 1, got {efficiency!r}")
    if not 0.0 <= inertia < math.inf:
        raise DeclarationError(f"inertia must be a finite number that is not negative, got {inertia!r}")
    if solution.t.size < 2:
        raise DeclarationError("a duty needs two instants or more, over a whole cycle")
    effort, motion = solution.effort(joint), solution.motion(joint)
    # The gearbox takes its losses from whoever gives power.
    passed = np.where(effort * motion.rate >= 0.0, 1.0 / efficiency, efficiency)
    torque = effort * passed / ratio + inertia * ratio * motion.acceleration
    return Duty(joint, float(ratio), float(efficiency), float(inertia), solution.t, ratio * motion.rate, torque)


def _mean(t: Array, values: Array) -> float:
    return float(np.sum((values[1:] + values[:-1]) / 2.0 * np.diff(t)) / (t[-1] - t[0]))


def _positive_area(t: Array, values: Array) -> float:
    """The area of what is above zero of straight lines between values."""
    a, b = values[:-1], values[1:]
    high, low = np.maximum(a, b), np.minimum(a, b)
    with np.errstate(all="ignore"):
        share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / (high - low)))
    height = np.where(low >= 0.0, (a + b) / 2.0, np.maximum(high, 0.0) / 2.0)
    return float(np.sum(np.diff(t) * share * height))

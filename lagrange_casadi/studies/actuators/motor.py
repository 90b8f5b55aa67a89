"""A motor by its numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.arguments import NotNegative, Numeric, Positive, public
from ...base.arrays import Array
from ...base.brief import Brief


@public
@dataclass(frozen=True, repr=False)
class Motor(Brief):
    """A motor: torques in N m, speeds in rad/s, the rotor's inertia in kg m^2. Of a ``linear`` one
    forces in N, speeds in m/s, and the mass of what moves in kg.

    It bears ``stall_torque`` continuously at rest and ``rated_torque`` at its ``rated_speed``,
    linear between and on; ``peak_torque`` for a short time, and no speed above ``max_speed``. Where
    its voltage limits it, it gives ``peak_torque`` up to ``knee_speed`` alone, and from there less,
    linear to ``end_torque`` at ``max_speed``. ``time_constant`` [s] is that of its winding: in so
    long it warms by 63 %. Infinite, it is warm by the mean of a cycle, however long that is.
    """

    name: str
    stall_torque: NotNegative
    rated_torque: NotNegative
    rated_speed: Positive
    peak_torque: NotNegative
    max_speed: Positive
    inertia: NotNegative
    knee_speed: NotNegative | None = None
    end_torque: NotNegative | None = None
    time_constant: float = math.inf
    linear: bool = False

    def continuous_torque(self, speed: Numeric) -> Array:
        """Return the continuous torque at a speed.

        Parameters
        ----------
        speed : float or array
            Speed [rad/s or m/s]; its sign does not matter.

        Returns
        -------
        array
            Torque [N m], or force [N] of a linear motor; zero at speeds without any.
        """
        fall = (self.stall_torque - self.rated_torque) / self.rated_speed
        return np.asarray(np.maximum(self.stall_torque - fall * np.abs(speed), 0.0))

    def short_time_torque(self, speed: Numeric) -> Array:
        """Return the largest torque for a short time at a speed that the motor reaches.

        Parameters
        ----------
        speed : float or array
            Speed [rad/s or m/s]; its sign does not matter.

        Returns
        -------
        array
            Torque [N m], or force [N] of a linear motor.
        """
        if self.knee_speed is None or self.end_torque is None or self.knee_speed >= self.max_speed:
            return np.full(np.shape(speed), self.peak_torque)
        speeds, torques = (self.knee_speed, self.max_speed), (self.peak_torque, self.end_torque)
        return np.asarray(np.interp(np.abs(speed), speeds, torques))

    @property
    def rated_power(self) -> float:
        """Power at the rated speed [W]."""
        return self.rated_torque * self.rated_speed

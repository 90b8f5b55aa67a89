"""A motor by its numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.arguments import Measured, Numeric, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.units import quantity
from ...errors import DeclarationError

_TORQUE, _SPEED = ("N m", "N"), ("rad/s", "m/s")
UNITS = {
    "stall_torque": _TORQUE,
    "rated_torque": _TORQUE,
    "rated_speed": _SPEED,
    "peak_torque": _TORQUE,
    "max_speed": _SPEED,
    "inertia": ("kg m^2", "kg"),
    "knee_speed": _SPEED,
    "end_torque": _TORQUE,
    "time_constant": ("s", "s"),
}
"""Units of a motor's numbers, and of a linear motor's, in the order of its fields."""

_POSITIVE = ("rated_speed", "max_speed", "time_constant")


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
    stall_torque: Measured
    rated_torque: Measured
    rated_speed: Measured
    peak_torque: Measured
    max_speed: Measured
    inertia: Measured
    knee_speed: Measured | None = None
    end_torque: Measured | None = None
    time_constant: Measured = math.inf
    linear: bool = False

    def __post_init__(self) -> None:
        for name, units in UNITS.items():
            value = getattr(self, name)
            if value is not None and not (name == "time_constant" and value == math.inf):
                what = f"motor '{self.name}': {name}"
                found = quantity(what, value, units[self.linear])
                if found < 0.0 or (found == 0.0 and name in _POSITIVE):
                    least = "a positive number" if name in _POSITIVE else "a number of at least 0"
                    raise DeclarationError(f"{what}: expected {least}, got {value!r}")
                object.__setattr__(self, name, found)

    def continuous_torque(self, speed: Numeric | str) -> Array:
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
        return np.asarray(np.maximum(self.stall_torque - fall * self._size(speed), 0.0))

    def short_time_torque(self, speed: Numeric | str) -> Array:
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
        size = self._size(speed)
        if self.knee_speed is None or self.end_torque is None or self.knee_speed >= self.max_speed:
            return np.full(size.shape, self.peak_torque)
        speeds, torques = (self.knee_speed, self.max_speed), (self.peak_torque, self.end_torque)
        return np.asarray(np.interp(size, speeds, torques))

    def _size(self, speed: Numeric | str) -> Array:
        """Speeds without their sign."""
        read = isinstance(speed, str)
        return np.asarray(np.abs(quantity("speed", speed, _SPEED[self.linear]) if read else speed))

    @property
    def rated_power(self) -> float:
        """Power at the rated speed [W]."""
        return float(self.rated_torque * self.rated_speed)

"""Classes of motors whose numbers follow from a rule: they show what size is needed, and are no
product of a maker.

The torque at rest is that of a shear stress sigma on the surface of a rotor of diameter D and
length l = lambda D, T = sigma pi lambda D^3 / 2 (Miller, *Brushless Permanent-Magnet and Reluctance
Motor Drives*, chapter 12, gives the stresses of machines). The rotor is a steel cylinder, so that
J = pi rho lambda D^5 / 32. The rated powers are those of a standard, not compared with the printed
one; ratios, stresses and speeds are this project's own, one for each class.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .motor import Motor

_STEEL = 7850.0
_RPM = math.tau / 60.0


@dataclass(frozen=True)
class MotorClass:
    """A class of motors: their rated powers [W] and speed [1/min], and the rest by ratios.

    ``stall`` is the torque at rest over the rated one, ``peak`` the short one over that at rest,
    ``top`` the largest speed over the rated one, ``shear`` the stress sigma [Pa] and ``slender``
    the length of the rotor over its diameter.
    """

    powers: tuple[float, ...]
    speed: float
    stall: float
    peak: float
    top: float
    shear: float
    slender: float

    def motors(self, name: str) -> list[Motor]:
        """The motors of the class, smallest first."""
        return [self._motor(name, power) for power in self.powers]

    def _motor(self, name: str, power: float) -> Motor:
        speed = self.speed * _RPM
        rated = power / speed
        rest = self.stall * rated
        diameter = (2.0 * rest / (math.pi * self.shear * self.slender)) ** (1.0 / 3.0)
        inertia = math.pi / 32.0 * _STEEL * self.slender * diameter**5
        peak, top = self.peak * rest, self.top * speed
        return Motor(f"class {name} {power / 1e3:g} kW", rest, rated, speed, peak, top, inertia)


CLASSES = {
    # Rated powers of the series R5 of ISO 3.
    "servo": MotorClass(
        (100.0, 160.0, 250.0, 400.0, 630.0, 1e3, 1.6e3, 2.5e3, 4e3, 6.3e3, 10e3, 16e3),
        speed=3000.0,
        stall=1.2,
        peak=3.0,
        top=2.0,
        shear=15e3,
        slender=1.5,
    ),
    # Four poles at 50 Hz, with rated powers of IEC 60072.
    "induction": MotorClass(
        (
            *(180.0, 250.0, 370.0, 550.0, 750.0, 1.1e3, 1.5e3, 2.2e3, 3e3, 4e3, 5.5e3, 7.5e3),
            *(11e3, 15e3, 18.5e3, 22e3, 30e3),
        ),
        speed=1450.0,
        stall=1.0,
        peak=2.0,
        top=2.0,
        shear=10e3,
        slender=1.2,
    ),
}
"""The classes by name."""

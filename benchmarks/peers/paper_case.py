"""The slider-crank of the paper as bare numbers, for peers that know nothing of the package."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Work = Callable[[], Array]
"""What does the work, everything else being ready, and returns its result."""

SPEED = 25 * math.pi
HALF_ACCELERATION = math.pi / 200


@dataclass(frozen=True)
class SliderCrank:
    """Crank ``r`` and rod ``l`` [m], uniform slender bars; masses of crank, rod and slider [kg];
    gravity [m/s^2] along -y.
    """

    r: float = 0.1
    l: float = 0.2
    m1: float = 0.1
    m2: float = 0.1
    m3: float = 0.1
    g: float = 9.81

    @property
    def parameters(self) -> tuple[float, float, float, float, float]:
        """In the order of the package."""
        return self.r, self.l, self.m1, self.m2, self.m3

    def motion(self, t: Array) -> tuple[Array, Array, Array]:
        """Angle [rad], rate and acceleration of the crank (paper eq. 22)."""
        theta = (HALF_ACCELERATION * t + SPEED) * t
        return theta, 2.0 * HALF_ACCELERATION * t + SPEED, np.full_like(t, 2.0 * HALF_ACCELERATION)

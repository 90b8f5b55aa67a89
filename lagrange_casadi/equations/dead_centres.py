"""Where a loop may go on in two ways, told by its closure at instants."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array

NEAR = 0.3
"""Sines of the transmission angle below which a loop may pass a dead centre."""


def passes_dead_centre(closure: Array, *, ends: bool = False) -> npt.NDArray[np.bool_]:
    """After which instants a loop may pass a dead centre: straight on from either side its transmission angle's sine meets zero.

    The closed forms keep to their branch there, with a kink; the mechanism itself may not. With ``ends`` the first interval and the
    last are looked at too, each from its one side.
    """
    found = np.zeros(closure.size, dtype=bool)
    sine = np.sqrt(np.where((closure > 0.0) & (closure < np.inf), closure, 0.0))
    left, right = np.full((2, max(closure.size - 1, 0)), -1.0 if ends else 1.0)
    left[1:], right[:-1] = 2 * sine[1:-1] - sine[:-2], 2 * sine[1:-1] - sine[2:]
    found[:-1] = (left < 0.0) & (right < 0.0) & (np.maximum(sine[:-1], sine[1:]) < NEAR)
    return found

"""Temperature of a motor's winding in a cycle that is repeated without end."""

from __future__ import annotations

import math

import numpy as np

from ..base.arrays import Array
from .duty import mean_of


def warmest(t: Array, torque: Array, time_constant: float = math.inf) -> float:
    """The torque [N m] that would warm for ever as much as a cycle's warmest instant does.

    The losses in the winding go with the square of the torque, and warm it by the law tau w' + w =
    torque^2, straight between instants, w the same at the start of a cycle as at its end. Where tau
    is infinite that is the root of the mean square.
    """
    heat, steps = torque**2, np.diff(t)
    if math.isinf(time_constant):
        return math.sqrt(mean_of(t, heat))
    parts = steps / time_constant
    keep, gain = np.exp(-parts), -np.expm1(-parts)
    # The exact solution for heat that goes straight from a to b: w1 = keep w0 + gain a + (1 -
    # gain/part) (b - a).
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(parts > 1e-6, 1.0 - gain / parts, parts / 2.0)
    added = gain * heat[:-1] + slope * (heat[1:] - heat[:-1])
    # The start of a cycle is its end: w0 = (keep of all) w0 + what a cycle adds.
    end = 0.0
    for share, more in zip(keep.tolist(), added.tolist(), strict=True):
        end = share * end + more
    warm = [end / -math.expm1(-float(parts.sum()))]
    for share, more in zip(keep.tolist(), added.tolist(), strict=True):
        warm.append(share * warm[-1] + more)
    # Between instants it is warmest where the heat that falls meets it.
    start, rate = np.array(warm[:-1]), (heat[1:] - heat[:-1]) / steps
    rises = (rate < 0.0) & (start < heat[:-1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        after = time_constant * np.log1p((start - heat[:-1]) / (rate * time_constant))
        reached = np.where(rises & (after < steps), heat[:-1] + rate * after, 0.0)
    return math.sqrt(max(max(warm), float(reached.max())))

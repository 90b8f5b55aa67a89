"""Axis of a sweep's histories: time, a drive's coordinate, or the fraction of each design's
cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...declare.even_points import points
from ...declare.times import Timing, instants_of
from ...equations.model_data import ModelData
from .meanings import CYCLE, OVER

_WORDS = {OVER: "the drive's coordinate", CYCLE: "the cycle"}


def in_words(axes: Sequence[str]) -> str:
    """Axes of columns in words."""
    return " and ".join(_WORDS.get(axis, axis) for axis in axes)


@dataclass(frozen=True, eq=False)
class InstantAxis:
    """An axis: its name in the file and values (t,); ``joint`` is the drive by which instants are
    asked for.
    """

    name: str
    values: Array
    joint: str = ""
    drive_unit: str = ""

    @classmethod
    def of(cls, data: ModelData, timing: Timing) -> InstantAxis:
        """Axis of a mechanism's designs."""
        if timing.shared:
            return cls("t", instants_of(data.laws, timing, data.values(data.defaults)).t)
        joint = timing.joint
        unit = timing.unit if joint else ""
        if joint and timing.fixed:
            start, stop, _ = timing.bounds(np.zeros((1, 0)))
            coordinates = points((float(start[0]), float(stop[0]), timing.count))
            return cls(OVER, coordinates, joint, unit)
        places = points((0.0, 1.0, timing.count)) if timing.count > 1 else np.zeros(1)
        return cls(CYCLE, places, joint, unit)

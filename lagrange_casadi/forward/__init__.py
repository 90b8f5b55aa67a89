"""A machine left to itself: its motion under a drive's law, its steady cycle, and its flywheel."""

from ..declare.torques import (
    Law,
    dc_motor,
    expression,
    induction_motor,
    power,
    torque,
    torque_curve,
)
from .machine import Event
from .motion import Cycle, FreeMotion
from .plot import plot_cycle
from .running import Flywheel

__all__ = [
    "Cycle",
    "Event",
    "Flywheel",
    "FreeMotion",
    "Law",
    "dc_motor",
    "expression",
    "induction_motor",
    "plot_cycle",
    "power",
    "torque",
    "torque_curve",
]

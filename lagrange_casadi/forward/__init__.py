"""A machine left to itself: the motion it makes by itself, its steady cycle, and its flywheel."""

from .cycle import Cycle, Flywheel, flywheel, steady
from .laws import Law, dc_motor, expression, induction_motor, power, torque, torque_curve
from .motion import Event, FreeMotion, free

__all__ = [
    "Cycle",
    "Event",
    "Flywheel",
    "FreeMotion",
    "Law",
    "dc_motor",
    "expression",
    "flywheel",
    "free",
    "induction_motor",
    "power",
    "steady",
    "torque",
    "torque_curve",
]

"""A machine left to itself: its motion under a drive's law, its steady cycle, and its flywheel."""

from .model.torques import Law, dc_motor, expression, induction_motor, power, torque, torque_curve
from .studies.forward.free_motion import Cycle, FreeMotion
from .studies.forward.machine import Event
from .studies.forward.running import Flywheel
from .views.charts.free_cycle import plot_cycle

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

"""Motors of drives: the requirements of a cycle, and the smallest motor of a catalogue that meets
them.
"""

from .studies.actuators.catalogue import read_motors
from .studies.actuators.choice import Choice, assess, select
from .studies.actuators.duty import Duty, InertiaRatio, duty_of
from .studies.actuators.inertia import inertia_at
from .studies.actuators.motor import Motor
from .views.charts.duty_chart import plot_duty

__all__ = [
    "Choice",
    "Duty",
    "InertiaRatio",
    "Motor",
    "duty_of",
    "inertia_at",
    "assess",
    "plot_duty",
    "read_motors",
    "select",
]

"""Motors of drives: the requirements of a cycle, and the smallest motor of a catalogue that meets
them.
"""

from .catalogue import read_motors
from .choice import Choice, assess, select
from .duty import Duty, InertiaRatio, duty_of
from .inertia import inertia_at
from .motor import Motor
from .plot import plot_duty

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

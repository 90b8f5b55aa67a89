"""Motors of drives: what a cycle asks of one, and the smallest of a catalogue that serves."""

from .catalogue import read_motors
from .choice import Choice, judge, select
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
    "judge",
    "plot_duty",
    "read_motors",
    "select",
]

"""Motors of drives: what a cycle asks of one, and the smallest of a catalogue that serves."""

from .catalogue import Choice, Motor, read_motors, select
from .duty import Duty, duty_of
from .plot import plot_duty

__all__ = ["Choice", "Duty", "Motor", "duty_of", "plot_duty", "read_motors", "select"]

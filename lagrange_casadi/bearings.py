"""Pins and bearings of joints: what they are made of, and how near they are to what they bear."""

from .declare.fitted import Pin, Plain, Rolling, fit
from .strength.bearings import bending_of_pin, equivalent_load, rated_hours

__all__ = ["Pin", "Plain", "Rolling", "bending_of_pin", "equivalent_load", "fit", "rated_hours"]

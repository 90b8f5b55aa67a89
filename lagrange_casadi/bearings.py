"""Pins and bearings of joints: what they are made of, how near they are to what they bear, and
tables to choose from.
"""

from .model.elements.fitting import fit
from .model.fitted import Pin, Plain, Rolling
from .results.strength.bearing_life import bending_of_pin, equivalent_load, rated_hours
from .results.strength.rolling_bearings import (
    RollingBearing,
    deep_groove,
    dynamic_rating,
    read_bearings,
    select_bearing,
    static_rating,
)

__all__ = [
    "RollingBearing",
    "Pin",
    "Plain",
    "Rolling",
    "bending_of_pin",
    "deep_groove",
    "dynamic_rating",
    "equivalent_load",
    "fit",
    "rated_hours",
    "read_bearings",
    "select_bearing",
    "static_rating",
]

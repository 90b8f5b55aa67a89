"""What may be chosen, and what is chosen where nothing is said: words and numbers that need no
other module.
"""

from __future__ import annotations

from typing import Literal

Precision = Literal["double", "single"]
PRECISIONS: tuple[Precision, ...] = ("double", "single")

Backend = Literal["auto", "lanes", "c", "vm"]
BACKENDS: tuple[Backend, ...] = ("auto", "lanes", "c", "vm")

Keep = Literal["peaks", "laws", "histories"]
KEEPS: tuple[Keep, ...] = ("peaks", "laws", "histories")
"""What a sweep keeps of each design."""

CRITERIA = ("goodman", "gerber", "soderberg", "morrow", "findley")
"""How a mean stress counts in fatigue."""

YIELDING = ("von_mises", "tresca")
"""Stresses that yield."""

POINTS = 11
"""Points of a front."""

SAMPLES = 2000
"""Designs drawn within tolerances."""

WIDTH, RATE, SECONDS = 640, 25.0, 4.0
"""Of an animation: pixels of its width, frames a second, seconds that a cycle takes."""

TIME_LIMIT = 60.0
"""Seconds that reading a file of unknown origin may take."""

SIMPLE = "four_bar"
"""The case that another one begins as."""

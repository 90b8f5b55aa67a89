"""Choices and defaults: words and numbers that need no other module."""

from __future__ import annotations

from typing import Literal, get_args

Precision = Literal["double", "single"]

Compiled = Literal["auto", "lanes", "c"]
"""Backends of designs."""

Backend = Literal[Compiled, "vm"]

Keep = Literal["peaks", "laws", "histories"]
KEEPS: tuple[Keep, ...] = get_args(Keep)
"""Results of each design that a sweep can keep."""

PeakSearch = Literal["exact", "sampled"]
"""Peaks of designs: sought between the instants, or those at them, with an error."""

Beyond = Literal["hold", "line"]
"""Ways of a table to go on beyond its ends: with the value there, or in a straight line."""

Criterion = Literal["goodman", "gerber", "soderberg", "morrow", "findley"]
"""Treatments of a mean stress in fatigue."""

Yielding = Literal["von_mises", "tresca"]
"""Stresses that yield."""

POINTS = 11
"""Points of a front."""

SAMPLES = 2000
"""Designs drawn within tolerances."""

WIDTH, RATE, SECONDS = 640, 25.0, 4.0
"""Defaults of an animation: width in pixels, frames a second, seconds of a cycle."""

AZIMUTH, ELEVATION = -60.0, 25.0
"""The view that shows most of most mechanisms [deg]."""

LoadFormat = Literal["json", "csv", "inp", "beam"]
"""Formats of load cases for finite elements."""

"""Peaks between instants: the public part of :mod:`.study.peaks` and :mod:`.study.strength_peaks`."""

from .study.peaks import forces, refine, shortfall
from .study.strength_peaks import refine_safety, refine_stress

__all__ = ["forces", "refine", "refine_safety", "refine_stress", "shortfall"]

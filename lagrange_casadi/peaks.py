"""Peaks between instants: the public part of :mod:`.studies.peaks_between` and
:mod:`.studies.strength_peaks`.
"""

from .studies.peaks_between import forces, refine, shortfall
from .studies.strength_peaks import refine_safety, refine_stress

__all__ = ["forces", "refine", "refine_safety", "refine_stress", "shortfall"]

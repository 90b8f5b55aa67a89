"""Peaks between instants: the public part of :mod:`.study.peaks`."""

from .study.peaks import forces, refine, shortfall

__all__ = ["forces", "refine", "shortfall"]

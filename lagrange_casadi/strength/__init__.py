"""Strength of links: stresses, factors of safety against yielding, buckling
and fatigue, and lives.
"""

from ..declare.end_conditions import effective_lengths
from ..equations.buckling import Column, critical_stress
from .bearings import joint_safety
from .critical_plane import Plane, critical_plane, plane_factor
from .fatigue import CRITERIA, cycles, factor, reversed_amplitude
from .parts import safeties
from .rainflow import StressCycle, rainflow
from .safety import Life, Safety, Verdict, life, safety, stress
from .stress import Stress, StressPeak

__all__ = [
    "CRITERIA",
    "Column",
    "Life",
    "Plane",
    "Safety",
    "Stress",
    "StressPeak",
    "StressCycle",
    "Verdict",
    "critical_plane",
    "critical_stress",
    "cycles",
    "effective_lengths",
    "factor",
    "joint_safety",
    "life",
    "plane_factor",
    "rainflow",
    "reversed_amplitude",
    "safeties",
    "safety",
    "stress",
]

"""Strength of links: stresses, factors of safety against yielding, buckling
and fatigue, and lives.
"""

from .engine.buckling import Column, critical_stress
from .model.end_conditions import effective_lengths
from .results.strength.all_parts import safeties
from .results.strength.bearing_life import joint_safety
from .results.strength.critical_plane import Plane, critical_plane, plane_factor
from .results.strength.fatigue import CRITERIA, cycles, factor, reversed_amplitude
from .results.strength.rainflow import StressCycle, rainflow
from .results.strength.safety import Life, Safety, Verdict, life, safety, stress
from .results.strength.stress import Stress, StressPeak

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

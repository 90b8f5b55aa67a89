"""Strength of links: stresses, factors of safety against yielding, buckling and fatigue, and lives."""

from ..declare.held import effective_lengths
from .bearings import joint_safety
from .buckling import Column, critical_stress
from .fatigue import CRITERIA, cycles, factor, reversed_amplitude
from .parts import safeties
from .rainflow import Swing, rainflow
from .safety import Life, Safety, Verdict, life, safety, stress
from .stress import Stress, StressPeak

__all__ = [
    "CRITERIA",
    "Column",
    "Life",
    "Safety",
    "Stress",
    "StressPeak",
    "Swing",
    "Verdict",
    "critical_stress",
    "cycles",
    "effective_lengths",
    "factor",
    "joint_safety",
    "life",
    "rainflow",
    "reversed_amplitude",
    "safeties",
    "safety",
    "stress",
]

"""Designs found by gradients: what is least, within limits that hold at all times of the motion."""

from .front import Front, FrontPoint
from .optimum import Limit, LocalOptimum, Optimum, Start
from .search import optimise
from .terms import Constraint, Term

__all__ = [
    "Constraint",
    "Front",
    "FrontPoint",
    "Limit",
    "LocalOptimum",
    "Optimum",
    "Start",
    "Term",
    "optimise",
]

"""Designs found by gradients: what is least, within limits that hold at all times of the motion."""

from .optimum import Limit, Optimum, Start
from .search import optimise
from .terms import Constraint, Term

__all__ = ["Constraint", "Limit", "Optimum", "Start", "Term", "optimise"]

"""Sweeps: one scene over many designs, in blocks that survive, into one file; ``docs/sweeps.md``
says how.
"""

from ...base.vocabulary import KEEPS, Keep
from .axes import Axis, Grid, Listed, Range, Values
from .best import Condition, Design, best, chosen
from .design_lists import read_designs
from .reading import Sweep, is_sweep
from .sweeping import sweep

__all__ = [
    "KEEPS",
    "Axis",
    "Condition",
    "Design",
    "Grid",
    "Keep",
    "Listed",
    "Range",
    "Sweep",
    "Values",
    "best",
    "chosen",
    "is_sweep",
    "read_designs",
    "sweep",
]

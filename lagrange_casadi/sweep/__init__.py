"""Sweeps: one scene over many designs, in blocks that survive, into one file; ``docs/sweeps.md`` says how."""

from .axes import DESIGN, Axis, Grid, Listed, Range, Values, counted, grouped
from .best import Condition, Design, best, chosen, conditions_in, tally
from .columns import KEEPS, STATUS, Keep
from .listing import read_designs
from .reading import Sweep, is_sweep
from .sweeping import sweep

__all__ = [
    "DESIGN",
    "KEEPS",
    "STATUS",
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
    "conditions_in",
    "counted",
    "grouped",
    "is_sweep",
    "read_designs",
    "sweep",
    "tally",
]

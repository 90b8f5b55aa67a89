"""Sweeps: one scene over many designs, in blocks that survive, into one file; ``docs/sweeps.md`` says how."""

from .axes import Axis, Grid, Listed, Range, Values
from .columns import KEEPS, Keep
from .listing import read_designs
from .reading import Sweep, is_sweep
from .sweeping import sweep

__all__ = ["KEEPS", "Axis", "Grid", "Keep", "Listed", "Range", "Sweep", "Values", "is_sweep", "read_designs", "sweep"]

"""A mechanism drawn into axes of a figure that shows other things too."""

from __future__ import annotations

from typing import Any

from ..base.tables import SPACE
from ..instants.solution import Solution
from . import drawing, space_drawing


def draw_into(axes: Any, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one
    side.
    """
    (space_drawing if solution.table is SPACE else drawing).draw_into(axes, solution)

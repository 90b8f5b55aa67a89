"""A mechanism drawn into axes of a figure that shows other things too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.tables import SPACE
from ..instants.solution import Solution
from . import drawing, space_drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_into(axes: Axes, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one
    side.
    """
    (space_drawing if solution.table is SPACE else drawing).draw_into(axes, solution)

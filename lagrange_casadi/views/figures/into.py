"""A mechanism drawn into axes of a figure that shows other things too."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from ...base.tables import SPACE
from ...results.solution import Solution
from ..shapes.shapes import named_spots
from . import drawing, space_drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_into(axes: Axes, solution: Solution, names: Collection[str] | None = None) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one
    side.

    ``names`` are the joints and declared points whose names are written, by default all.
    """
    named = named_spots(solution.description)
    chosen = {name: spot for name, spot in named.items() if names is None or name in names}
    (space_drawing if solution.table is SPACE else drawing).draw_into(axes, solution, chosen)

"""What all pictures share: how they become files, and a mechanism drawn into axes of theirs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, BinaryIO

from ..instants.solution import Solution
from ..tables import SPACE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    ".svg": {"Creator": None, "Date": None},
}
"""What names of pictures end in, and what these must not hold, so that a figure always gives the same bytes: programs, clocks."""


def save(figure: Figure, file: BinaryIO | str | os.PathLike[str], ending: str = ".png", dpi: int = 150) -> None:
    """Write a figure into a file, of the kind that one of :data:`PICTURES` tells, in ``dpi`` pixels an inch."""
    from matplotlib import rc_context

    # Names within an SVG are drawn at random where nothing is given.
    with rc_context({"svg.hashsalt": "lagrange_casadi"}):
        figure.savefig(file, format=ending.removeprefix("."), dpi=dpi, metadata=PICTURES[ending])


def draw_into(axes: Any, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one side."""
    from . import drawing, space_drawing

    (space_drawing if solution.table is SPACE else drawing).draw_into(axes, solution)

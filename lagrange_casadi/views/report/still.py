"""The mechanism at one instant as a small SVG: for notebooks, in any colours of theirs."""

from __future__ import annotations

from ...base.arrays import every
from ...results.solution import Solution
from ..shapes.picture_sheet import picture, view_of
from ..shapes.poses import Poses
from ..shapes.primitives import drawing
from ..shapes.vector import svg

_TRACED = 120
"""Largest number of instants at which paths of declared points are drawn."""


def still(solution: Solution) -> str:
    """The mechanism at the first instant; from a slanted direction where it is in space."""
    whole = Poses.of(solution.during(every(solution.t.size, _TRACED)))
    things = drawing(whole.during([0]), whole)
    title, one = f"{solution.case} at its first instant", view_of(solution.description)
    return svg(picture(title, things, one, 460, tallest=0.65, unit=0.85), paper=False)

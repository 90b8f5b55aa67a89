"""Projection of ground axes [m] to the sheet: one view, and one scale for everything that is ever
shown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...model.description import Description
from ..shapes.views import AZIMUTH, ELEVATION, upright, view

_MARGIN, _FOOT = 40.0, 30.0
"""Around everything, and below for words [points]."""

_FLATTEST, _TALLEST = 0.3, 1.0
"""The sheet's height over its width."""

WIDE = 640.0
"""The width of a sheet [points]: widths of lines and sizes of letters are for it, and grow with the
picture.
"""


@dataclass(frozen=True, eq=False)
class Stage:
    """A sheet of a ``width`` and ``height`` [pixels], whose point is ``unit`` pixels; ``scale`` in
    pixels a metre.

    ``right``, ``up`` and ``toward`` are directions in ground axes (3,), ``middle`` (2,) is what
    stands at ``centre`` (2,).
    """

    width: int
    height: int
    unit: float
    scale: float
    right: Array
    up: Array
    toward: Array
    middle: Array
    centre: Array

    def on_sheet(self, places: Array) -> Array:
        """Places (..., 3) [m] on the sheet (..., 2) [pixels]."""
        found: Array = self.centre + (
            self.projected(places) - self.scale * self.middle * [1.0, -1.0]
        )
        return found

    def projected(self, directions: Array) -> Array:
        """Directions (..., 3) on the sheet (..., 2), whose y is downward."""
        found: Array = self.scale * (directions @ np.column_stack([self.right, -self.up]))
        return found

    def depth(self, places: Array) -> float:
        """Mean depth of places (..., 3) towards the viewer."""
        return float(np.mean(places @ self.toward))


def directions(description: Description) -> tuple[Array, Array]:
    """Directions to the right and up on the sheet: x and y, or those of a slanted view in space."""
    if not description.space:
        return np.eye(3)[0], np.eye(3)[1]
    one = view(upright(description.gravity), AZIMUTH, ELEVATION)
    return one.right, one.up


def stage_for(description: Description, places: Array, width: int, *, foot: bool) -> Stage:
    """A sheet on which places (n, 3) [m] fit, with room for words at its ``foot``."""
    right, up = directions(description)
    flat = places @ np.column_stack([right, up])
    low, high = flat.min(axis=0), flat.max(axis=0)
    span = np.maximum(high - low, 1e-9 * max(float(np.max(high - low)), 1e-12))
    unit = width / WIDE
    margin, below = _MARGIN * unit, _FOOT * unit if foot else 0.0
    scale = min((width - 2 * margin) / span[0], (_TALLEST * width - 2 * margin - below) / span[1])
    inner = max(scale * span[1] + 2 * margin, _FLATTEST * width)
    height = 2 * math.ceil((inner + below) / 2)
    centre = np.array([width / 2, (height - below) / 2])
    return Stage(
        width, height, unit, float(scale), right, up, np.cross(right, up), (low + high) / 2, centre
    )

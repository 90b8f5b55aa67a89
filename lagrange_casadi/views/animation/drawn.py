"""Lines, faces, dots and words on the sheet, frame by frame.

Places are in points, from the upper left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array

INK = "#222222"


@dataclass(frozen=True, eq=False)
class Line:
    """A polyline through ``points`` (frames, n, 2), or one polygon where it is ``closed``; one
    frame where it stands still.

    ``fill`` is a colour or nothing, ``opacity`` that of the filling. A ``width`` of 0 has no line.
    """

    points: Array
    colour: str
    width: float
    closed: bool = False
    fill: str = ""
    opacity: float = 1.0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Dot:
    """A circle about ``points`` (frames, 2)."""

    points: Array
    radius: float
    fill: str


@dataclass(frozen=True, eq=False)
class Words:
    """A text whose left end is at ``points`` (frames, 2), or its right end where it is ``before``
    them.
    """

    points: Array
    text: str
    before: bool = False


Thing = Line | Dot | Words


@dataclass(frozen=True, eq=False)
class Picture:
    """All that is drawn, in the sequence in which it is, over a number of ``frames``; ``unit`` is
    the size of a point in pixels.

    ``closed`` says that the first frame follows the last one.
    """

    title: str
    width: int
    height: int
    unit: float
    frames: int
    closed: bool
    things: tuple[Thing, ...]


def along(directions: Array) -> Array:
    """Directions (..., 2) of length 1; of nothing, nothing."""
    size = np.hypot(directions[..., 0], directions[..., 1])[..., None]
    found: Array = directions / np.where(size > 0.0, size, 1.0)
    return found


def across(directions: Array) -> Array:
    """Directions (..., 2) a quarter of a turn on."""
    return np.stack([directions[..., 1], -directions[..., 0]], axis=-1)

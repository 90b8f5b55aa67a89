"""Symbols of joints, masses, places and the ground, which are as large as the paper says, not the
mechanism.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array

INK, PAPER, PATH, STAND, FOOT = "#222222", "#ffffff", "#c0392b", "#777777", "#eeeeee"

BODY = "body"
"""The filling in the colour of the symbol's body."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A polyline (n, 2) of a symbol against the symbol's place [points], x along the symbol's
    direction and y up; a polygon where it is ``closed``.

    The ``fill`` is a colour, :data:`BODY` or nothing. A circle has a ``radius``.
    """

    points: Array
    colour: str = INK
    width: float = 1.4
    closed: bool = False
    fill: str = ""
    radius: float = 0.0

    @classmethod
    def polygon(cls, points: Sequence[tuple[float, float]], fill: str, ink: str = INK) -> Outline:
        """A filled polygon."""
        return cls(np.array(points), ink, closed=True, fill=fill)

    @classmethod
    def box(cls, wide: float, high: float, fill: str) -> Outline:
        """A rectangle about the place."""
        x, y = wide / 2, high / 2
        return cls.polygon([(-x, -y), (x, -y), (x, y), (-x, y)], fill)

    @classmethod
    def circle(cls, radius: float, fill: str) -> Outline:
        """A circle about the place."""
        turns = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
        points = radius * np.column_stack([np.cos(turns), np.sin(turns)])
        return cls(points, closed=True, fill=fill, radius=radius)


def _line(start: tuple[float, float], stop: tuple[float, float], colour: str = INK) -> Outline:
    return Outline(np.array([start, stop]), colour)


_BLOCK, _PIN = Outline.box(24.0, 15.0, BODY), Outline.circle(4.8, PAPER)

SYMBOLS: dict[str, tuple[Outline, ...]] = {
    "revolute": (_PIN,),
    "spherical": (Outline.circle(4.4, INK),),
    "universal": (Outline.circle(5.6, PAPER), _line((-4, -4), (4, 4)), _line((-4, 4), (4, -4))),
    "drive": (Outline.circle(1.7, INK),),
    "weld": (Outline.box(6.0, 6.0, INK),),
    "free": (_line((-6, 0), (6, 0)), _line((0, -6), (0, 6))),
    "planar": (Outline.polygon([(-11, -5), (5, -5), (11, 5), (-5, 5)], PAPER),),
    "prismatic": (_BLOCK,),
    "cylindrical": (_BLOCK, _line((-12, 0), (12, 0))),
    "screw": (_BLOCK, *(_line((x - 2, -7.5), (x + 2, 7.5)) for x in (-7, 0, 7))),
    "slot": (Outline.box(24.0, 15.0, PAPER), _PIN),
    "mass": (Outline.box(18.0, 18.0, BODY),),
    "sliding mass": (Outline.box(36.0, 24.0, BODY),),
    "point": (Outline.polygon([(-5, 0), (0, -5), (5, 0), (0, 5)], PATH, PATH),),
    "stand": (
        Outline.polygon([(0, 0), (10, -17), (-10, -17)], FOOT, STAND),
        _line((-16, -17), (16, -17), STAND),
        *(_line((x, -17), (x - 5, -23), STAND) for x in (-12, -5, 2, 9)),
    ),
}
"""The symbols by kinds of joints, of a drive in a page, of a point mass, of one that slides, of a
declared point and of the ground.
"""

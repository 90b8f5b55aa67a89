"""Lines, arrows and names that pictures are made of, and symbols of joints, masses, places and the
ground, which are as large as the paper says, not the mechanism.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from ...base.arrays import Array

INK, PAPER, PATH, STAND, FOOT = "#222222", "#ffffff", "#c0392b", "#777777", "#eeeeee"

BODY = "body"
"""The filling in the colour of the symbol's body."""

LOW, WAYS, GROUND, SPRINGS, BODIES, AXES, BLOCKS, PINS, POINTS, FORCES = range(10)
"""Levels: what has a lower one lies behind."""


@dataclass(frozen=True, eq=False)
class Line:
    """A polyline through ``points`` (frames, n, 3) [m], or a polygon where it is ``closed``.

    ``width`` is in points of paper; 0 is no line. ``opacity`` is that of a polygon's filling, which
    has the line's colour or that of ``fill``. ``body`` is the body of which the line is a part. A
    circle about a symbol's place has a ``radius`` [points of paper].
    """

    points: Array
    colour: str
    width: float
    closed: bool = False
    opacity: float = 0.0
    dashed: bool = False
    level: int = BODIES
    body: str = ""
    fill: str = ""
    radius: float = 0.0


@dataclass(frozen=True, eq=False)
class Symbol:
    """A symbol of :data:`SYMBOLS` at ``points`` (frames, 1, 3) [m].

    The symbol's x axis has the direction ``along`` (frames, 3), by default that to the right;
    ``colour`` is that of the body.
    """

    kind: str
    points: Array
    along: Array | None = None
    colour: str = ""
    level: int = PINS


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow along ``points`` (frames, n, 3) [m], with its head at the last of them, whose length
    is at most ``head`` [m].
    """

    points: Array
    colour: str
    head: float
    level: int = FORCES
    width: float = 2.6


@dataclass(frozen=True, eq=False)
class Name:
    """A name beside ``points`` (frames, 1, 3) [m], or on a sheet with its left end there."""

    points: Array
    text: str
    level: int = FORCES
    colour: str = INK


Primitive: TypeAlias = Line | Symbol | Arrow | Name


def frame(values: Array, k: int) -> Array:
    """The values at a frame; the only ones of what stands still."""
    return np.asarray(values[min(k, len(values) - 1)])


def turn(symbol: Symbol, k: int) -> float:
    """The angle of a symbol on a page at a frame, counter-clockwise [rad]."""
    if symbol.along is None:
        return 0.0
    x, y = frame(symbol.along, k)
    return math.atan2(y, x)


def edge(line: Line, points: Array) -> Array:
    """The points (n, 2) of a polyline; of a closed polygon, and the first again."""
    return np.vstack([points, points[:1]]) if line.closed else points


def outlines(thing: Line | Symbol, point: Array, k: int = 0) -> Iterator[tuple[Line, Array]]:
    """The polylines and polygons that a thing on a page is, each with its points (n, 2) at a frame;
    ``point`` (2,) is a point of paper to the right and up.
    """
    here = frame(thing.points, k)
    if isinstance(thing, Line):
        yield thing, here
        return
    angle = turn(thing, k)
    c, s = math.cos(angle), math.sin(angle)
    turned = np.array([[c, s], [-s, c]]) * point
    for one in SYMBOLS[thing.kind]:
        filled = replace(one, fill=thing.colour) if one.fill == BODY else one
        yield filled, here + one.points @ turned


def _line(start: tuple[float, float], stop: tuple[float, float], colour: str = INK) -> Line:
    return Line(np.array([start, stop]), colour, 1.4)


def _polygon(points: Sequence[tuple[float, float]], fill: str, ink: str = INK) -> Line:
    return Line(np.array(points), ink, 1.4, closed=True, opacity=1.0, fill=fill)


def _box(wide: float, high: float, fill: str) -> Line:
    x, y = wide / 2, high / 2
    return _polygon([(-x, -y), (x, -y), (x, y), (-x, y)], fill)


def _circle(radius: float, fill: str) -> Line:
    turns = np.linspace(0.0, math.tau, 25)[:-1].tolist()
    points = [(radius * math.cos(one), radius * math.sin(one)) for one in turns]
    return replace(_polygon(points, fill), radius=radius)


_BLOCK, _PIN = _box(24.0, 15.0, BODY), _circle(4.8, PAPER)

SYMBOLS: dict[str, tuple[Line, ...]] = {
    "revolute": (_PIN,),
    "spherical": (_circle(4.4, INK),),
    "universal": (_circle(5.6, PAPER), _line((-4, -4), (4, 4)), _line((-4, 4), (4, -4))),
    "drive": (_circle(1.7, INK),),
    "weld": (_box(6.0, 6.0, INK),),
    "free": (_line((-6, 0), (6, 0)), _line((0, -6), (0, 6))),
    "planar": (_polygon([(-11, -5), (5, -5), (11, 5), (-5, 5)], PAPER),),
    "prismatic": (_BLOCK,),
    "cylindrical": (_BLOCK, _line((-12, 0), (12, 0))),
    "screw": (_BLOCK, *(_line((x - 2, -7.5), (x + 2, 7.5)) for x in (-7, 0, 7))),
    "slot": (_box(24.0, 15.0, PAPER), _PIN),
    "mass": (_box(18.0, 18.0, BODY),),
    "sliding mass": (_box(36.0, 24.0, BODY),),
    "point": (_polygon([(-5, 0), (0, -5), (5, 0), (0, 5)], PATH, PATH),),
    "centre": (
        _circle(3.6, PAPER),
        _polygon([(0, 0), (3.6, 0), (3.3, -1.4), (2.5, -2.5), (1.4, -3.3), (0, -3.6)], INK),
        _polygon([(0, 0), (-3.6, 0), (-3.3, 1.4), (-2.5, 2.5), (-1.4, 3.3), (0, 3.6)], INK),
    ),
    "stand": (
        _polygon([(0, 0), (10, -17), (-10, -17)], FOOT, STAND),
        _line((-16, -17), (16, -17), STAND),
        *(_line((x, -17), (x - 5, -23), STAND) for x in (-12, -5, 2, 9)),
    ),
}
"""The symbols by kinds of joints, of a drive in a page, of a point mass, of one that slides, of a
declared point, of a centre of mass in a page and of the ground: lines whose points (n, 2) are
against the symbol's place [points of paper], x along the symbol's direction and y up.
"""

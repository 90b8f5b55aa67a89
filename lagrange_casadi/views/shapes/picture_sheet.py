"""Sheets of pictures that are films or stills: everything that is ever shown, to one scale, in
pixels from the upper left corner.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.vocabulary import AZIMUTH, ELEVATION
from ...model.description import Description
from .labels import apart, placed
from .orthographic import View, upright, view
from .primitives import cloud, seen
from .symbols import Line, Name, Primitive, Symbol, edge, outlines

_MARGIN, _FOOT = 40.0, 30.0
"""Around everything, and below for words [points]."""

_FLATTEST = 0.3
"""The least height of a sheet over the width."""

LETTER = 13.0
"""The size of names [points]."""

_CLOSE = 8.0
"""Names that are never farther apart are written together [points]."""

_WIDE, _LINE, _LONG, _FAR, _LEADER = 0.6, 18.0, 60, 16.0, "#999999"
"""The width of a letter over its size, the height of a line of words [points], letters of names
that are written together, and the distance from which a name has a line to its place [points].
"""

_HEAD = 36
"""The height of a title [points]."""

_GRID = 2.0
"""Distance of points that names may hide, where lines have more [points]."""

_SIDES, _DOWN = np.array([(1.0, 1.0), (-1.0, -1.0)]), np.array([1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Picture:
    """A sheet of a ``width`` and ``height`` [pixels] with ``things`` in the order in which they are
    painted, over a number of ``frames``; ``unit`` is the size of a point [pixels].

    The points of things are in pixels, y downward. ``closed`` says that the first frame follows the
    last one.
    """

    title: str
    width: int
    height: int
    unit: float
    frames: int
    closed: bool
    things: tuple[Line | Symbol | Name, ...]


def view_of(description: Description) -> View:
    """The direction from which a picture shows a mechanism: the plane itself; space from a slanted
    direction.
    """
    if description.space:
        return view(upright(description.gravity), AZIMUTH, ELEVATION)
    return View("", *np.eye(3)[:2])


def picture(
    title: str,
    primitives: Iterable[Primitive],
    one: View,
    width: int,
    *,
    tallest: float = 1.0,
    unit: float = 1.0,
    words: str = "",
    closed: bool = False,
) -> Picture:
    """Primitives on a sheet on which all of them fit, at most ``tallest`` times as high as wide,
    with ``words`` at the foot.
    """
    things, lines = seen(primitives, one), words.split("\n") if words else []
    points = cloud(things)
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum(high - low, 1e-9 * (float(np.max(high - low)) or 1.0))
    margin = _MARGIN * unit
    below = (_FOOT + _LINE * (len(lines) - 1)) * unit if words else 0.0
    scale = min((width - 2 * margin) / span[0], (tallest * width - 2 * margin - below) / span[1])
    height = 2 * math.ceil((max(scale * span[1] + 2 * margin, _FLATTEST * width) + below) / 2)
    corner = np.array([width, height - below]) / 2 - scale * (low + high) / 2 * _DOWN
    placed = [replace(thing, points=corner + scale * _DOWN * thing.points) for thing in things]
    painted = written(placed, unit * _DOWN, ((0.0, height - below), (width, 0.0)))
    for k, line in enumerate(lines, 1 - len(lines)):
        painted.append(_words(12.0 * unit, height + (_LINE * k - 12.0) * unit, line))
    return Picture(
        title,
        width,
        height,
        unit,
        frames=max(len(thing.points) for thing in painted),
        closed=closed,
        things=tuple(painted),
    )


def sheet(title: str, pictures: Sequence[Picture], across: int, lines: Sequence[str]) -> Picture:
    """Stills of one width in rows, so many ``across``, below a title, with lines of words on the
    right.
    """
    wide, top, things = pictures[0].width, _HEAD, list[Line | Symbol | Name]()
    for start in range(0, len(pictures), across):
        row = pictures[start : start + across]
        for k, one in enumerate(row):
            shift = np.array([k * wide, top])
            things += [replace(thing, points=thing.points + shift) for thing in one.things]
        top += max(one.height for one in row)
    left, step = across * wide + 12.0, 1.4 * LETTER
    things.append(_words(12.0, 0.7 * _HEAD, title))
    things += [_words(left, _HEAD + step * k, line) for k, line in enumerate(lines, 1)]
    width = left + _WIDE * LETTER * max(map(len, lines))
    height = max(top, _HEAD + step * (len(lines) + 1))
    return Picture(title, round(width), round(height), 1.0, 1, False, tuple(things))


def written(
    things: Sequence[Line | Symbol | Name],
    point: Array,
    corners: Sequence[Sequence[float]] | Array,
) -> list[Line | Symbol | Name]:
    """Things on a sheet with their names where these hide neither each other nor more of the first
    frame than they must, and are between ``corners`` at all frames; with a line to a place that is
    far.

    ``point`` (2,) is a point of paper to the right and up, ``corners`` are the lower left and the
    upper right one.
    """
    painted: list[Line | Symbol | Name] = [one for one in things if not isinstance(one, Name)]
    names = _together((one for one in things if isinstance(one, Name)), _CLOSE * float(point[0]))
    if not names:
        return painted
    hidden = [np.zeros((0, 2))]
    for thing in painted:
        if isinstance(thing, Line):
            along = _spread(thing, thing.points[0]) / point
            hidden += [along + thing.width / 2 * side for side in _SIDES]
        elif isinstance(thing, Symbol):
            hidden += [corners / point for _, corners in outlines(thing, point)]
    ways = [one.points[:, 0] / point for one in names]
    anchors = np.array([way[0] for way in ways])
    sizes = np.array([(_WIDE * LETTER * len(one.text), 1.1 * LETTER) for one in names])
    low, high = (np.array(corner) / point for corner in corners)
    boxes = [
        np.concatenate(
            [low + way[0] - way.min(axis=0) + 4.0, high + way[0] - way.max(axis=0) - 4.0]
        )
        for way in ways
    ]
    hides = _GRID * np.unique(np.round(np.concatenate(hidden) / _GRID), axis=0)
    places = placed(anchors, sizes, hides, boxes)
    for one, anchor, place, size in zip(names, anchors, places, sizes, strict=True):
        if apart(place, size, anchor) > _FAR:
            nearest = np.clip(anchor, place, place + size)
            ends = np.array([anchor, nearest]) - anchor
            painted.append(Line(one.points + ends * point, _LEADER, 0.7))
        shift = place - anchor + [0.0, 0.25 * LETTER]
        painted.append(replace(one, points=one.points + shift * point))
    return painted


def _words(x: float, y: float, text: str) -> Name:
    return Name(np.array([[[x, y]]]), text)


def _spread(line: Line, points: Array) -> Array:
    """Points along a line, as things that a name may hide."""
    ends = edge(line, points)
    shares = np.linspace(0.0, 1.0, max(2, 80 // len(ends)))[:, None, None]
    return np.asarray(ends[:-1] + shares * np.diff(ends, axis=0)).reshape(-1, 2)


def _together(names: Iterable[Name], close: float) -> list[Name]:
    """Names in place of those that are never farther apart than ``close``."""
    found: list[Name] = []
    for one in names:
        for k, other in enumerate(found):
            near = np.max(np.abs(other.points - one.points)) < close
            if near and other.colour == one.colour and len(other.text + one.text) < _LONG:
                found[k] = replace(other, text=f"{other.text}, {one.text}")
                break
        else:
            found.append(one)
    return found

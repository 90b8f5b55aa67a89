"""Sheets of pictures that are films or stills: everything that is ever shown, to one scale, in
pixels from the upper left corner.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.vocabulary import AZIMUTH, ELEVATION
from ...model.description import Description
from .labels import apart, placed
from .orthographic import View, upright, view
from .primitives import Line, Name, Primitive, Symbol, cloud, frame, seen, spread, turn
from .symbols import BODY, INK, SYMBOLS, Outline

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

_SIDES = np.array([(1.0, 1.0), (-1.0, -1.0)])


@dataclass(frozen=True, eq=False)
class Words:
    """A text whose left end is at ``points`` (frames, 2) [pixels]."""

    points: Array
    text: str
    colour: str = INK


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
    things: tuple[Line | Symbol | Words, ...]


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
    corner = np.array([width, height - below]) / 2 - scale * (low + high) / 2 * [1.0, -1.0]
    flip = np.array([1.0, -1.0])
    placed = [replace(thing, points=corner + scale * flip * thing.points) for thing in things]
    painted: list[Line | Symbol | Words] = [one for one in placed if not isinstance(one, Name)]
    names = together((one for one in placed if isinstance(one, Name)), _CLOSE * unit)
    painted += _named(names, painted, (width, height - below), unit)
    for k, line in enumerate(lines, 1 - len(lines)):
        foot = height + (_LINE * k - 12.0) * unit
        painted.append(Words(np.array([[12.0 * unit, foot]]), line))
    frames = max(len(thing.points) for thing in painted)
    return Picture(title, width, height, unit, frames, closed, tuple(painted))


def sheet(title: str, pictures: Sequence[Picture], across: int, lines: Sequence[str]) -> Picture:
    """Stills of one width in rows, so many ``across``, below a title, with lines of words on the
    right.
    """
    wide, top, things = pictures[0].width, _HEAD, list[Line | Symbol | Words]()
    for start in range(0, len(pictures), across):
        row = pictures[start : start + across]
        for k, one in enumerate(row):
            shift = np.array([k * wide, top])
            things += [replace(thing, points=thing.points + shift) for thing in one.things]
        top += max(one.height for one in row)
    left, step = across * wide + 12.0, 1.4 * LETTER
    written = [(12.0, 0.7 * _HEAD, title)]
    written += [(left, _HEAD + step * k, line) for k, line in enumerate(lines, 1)]
    things += [Words(np.array([[x, y]]), line) for x, y, line in written]
    width = left + _WIDE * LETTER * max(map(len, lines))
    height = max(top, _HEAD + step * (len(lines) + 1))
    return Picture(title, round(width), round(height), 1.0, 1, False, tuple(things))


def outline(symbol: Symbol, one: Outline, unit: float, k: int) -> Array:
    """The points (n, 2) of an outline of a symbol on the sheet at a frame [pixels]."""
    angle = turn(symbol, k)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(frame(symbol.points, k) + unit * one.points @ [[c, -s], [-s, -c]])


def filling(symbol: Symbol, one: Outline) -> str:
    """The colour in which an outline of a symbol is filled, or nothing."""
    return symbol.colour if one.fill == BODY else one.fill


def together(names: Iterable[Name], close: float) -> list[Name]:
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


def _named(
    names: Sequence[Name],
    things: Iterable[Line | Symbol | Words],
    room: tuple[float, float],
    unit: float,
) -> Iterator[Line | Words]:
    """Names where they hide neither each other nor more of the first frame than they must, and are
    on the sheet at all frames; with a line to a place that is far.
    """
    if not names:
        return
    flip, hidden = np.array([1.0, -1.0]) / unit, [np.zeros((0, 2))]
    for thing in things:
        if isinstance(thing, Line):
            along = flip * spread(thing.points[0], thing.closed)
            hidden += [along + thing.width / 2 * side for side in _SIDES]
        elif isinstance(thing, Symbol):
            hidden += [flip * outline(thing, one, unit, 0) for one in SYMBOLS[thing.kind]]
    anchors = np.array([flip * one.points[0, 0] for one in names])
    sizes = np.array([(_WIDE * LETTER * len(one.text), 1.1 * LETTER) for one in names])
    ways = [flip * one.points[:, 0] - anchor for one, anchor in zip(names, anchors, strict=True)]
    low, high = np.array([4.0, 4.0 - room[1] / unit]), np.array([room[0] / unit - 4.0, -4.0])
    boxes = [np.concatenate([low - way.min(axis=0), high - way.max(axis=0)]) for way in ways]
    things_there = _GRID * np.unique(np.round(np.concatenate(hidden) / _GRID), axis=0)
    corners = placed(anchors, sizes, things_there, boxes)
    for one, way, anchor, corner, size in zip(names, ways, anchors, corners, sizes, strict=True):
        if apart(corner, size, anchor) > _FAR:
            nearest = np.clip(anchor, corner, corner + size)
            yield Line(
                one.points + np.array([[anchor - anchor, nearest - anchor]]) / flip, _LEADER, 0.7
            )
        yield Words((way + corner + np.array([0.0, 0.25 * LETTER])) / flip, one.text, one.colour)

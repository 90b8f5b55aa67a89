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

_SIDES = np.array([(1.0, 1.0), (-1.0, -1.0)])


@dataclass(frozen=True, eq=False)
class Words:
    """A text whose left end is at ``points`` (frames, 2) [pixels], or the right end if it is
    ``before`` them.
    """

    points: Array
    text: str
    before: bool = False
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
    span = np.maximum(high - low, 1e-9 * max(float(np.max(high - low)), 1e-12))
    margin = _MARGIN * unit
    below = (_FOOT + _LINE * (len(lines) - 1)) * unit if words else 0.0
    scale = min((width - 2 * margin) / span[0], (tallest * width - 2 * margin - below) / span[1])
    height = 2 * math.ceil((max(scale * span[1] + 2 * margin, _FLATTEST * width) + below) / 2)
    corner = np.array([width, height - below]) / 2 - scale * (low + high) / 2 * [1.0, -1.0]
    flip = np.array([1.0, -1.0])
    placed = [replace(thing, points=corner + scale * flip * thing.points) for thing in things]
    painted: list[Line | Symbol | Words] = [one for one in placed if not isinstance(one, Name)]
    names = together((one for one in placed if isinstance(one, Name)), _CLOSE * unit)
    frames = max((len(thing.points) for thing in placed), default=1)
    if frames > 1:
        painted += _names(names, width, unit)
    else:
        painted += _placed(names, painted, (width, height - below), unit)
    for k, line in enumerate(reversed(lines)):
        foot = height - (12.0 + _LINE * k) * unit
        painted.append(Words(np.array([[12.0 * unit, foot]]), line))
    return Picture(title, width, height, unit, frames, closed, tuple(painted))


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


def _names(names: Iterable[Name], width: int, unit: float) -> list[Words]:
    """Names above and to the right of their places, or to the left where the sheet ends."""
    found = []
    for name in names:
        points = name.points[:, 0]
        room = width - (9.0 + 0.6 * LETTER * len(name.text)) * unit
        before = bool(np.max(points[:, 0]) > room and np.min(points[:, 0]) > width - room)
        offset = unit * np.array([-9.0 if before else 9.0, -13.0])
        found.append(Words(points + offset, name.text, before, name.colour))
    return found


def _placed(
    names: Sequence[Name],
    things: Iterable[Line | Symbol | Words],
    room: tuple[float, float],
    unit: float,
) -> Iterator[Line | Words]:
    """Names of a still, where they hide neither each other nor more of it than they must, with a
    line to a place that is far.
    """
    if not names:
        return
    flip = np.array([1.0, -1.0]) / unit
    hidden = []
    for thing in things:
        if isinstance(thing, Line):
            along = flip * spread(thing.points[0], thing.closed)
            hidden += [along + thing.width / 2 * side for side in _SIDES]
        elif isinstance(thing, Symbol):
            hidden += [flip * outline(thing, one, unit, 0) for one in SYMBOLS[thing.kind]]
    anchors = np.array([flip * one.points[0, 0] for one in names])
    sizes = np.array([(_WIDE * LETTER * len(one.text), 1.1 * LETTER) for one in names])
    box = [4.0, 4.0 - room[1] / unit, room[0] / unit - 4.0, -4.0]
    corners = placed(anchors, sizes, np.concatenate([np.zeros((0, 2)), *hidden]), box)
    for one, anchor, low, size in zip(names, anchors, corners, sizes, strict=True):
        if apart(low, size, anchor) > _FAR:
            nearest = np.clip(anchor, low, low + size)
            yield Line(np.array([[anchor / flip, nearest / flip]]), _LEADER, 0.7)
        yield Words(
            (low + np.array([0.0, 0.25 * LETTER]))[None] / flip, one.text, colour=one.colour
        )

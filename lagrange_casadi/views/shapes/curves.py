"""Curves of parts that pictures show, over instants: springs, dampers, circles, belts and racks.

Places and directions are (t, 3) in ground axes, curves (t, n, 3) [m].
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array
from .poses import frame_along

_TURN = np.exp(0.5j * np.pi * np.arange(33))
"""The eight coils of a spring."""

_COIL = np.column_stack(
    [np.r_[0.0, np.linspace(0.15, 0.85, 33), 1.0], np.pad(_TURN.imag, 1), np.pad(_TURN.real, 1)]
)
_ROD, _PISTON, _CUP, _TAIL = (
    np.array([(*point, 0.0) for point in points])
    for points in (
        [(0.0, 0.0), (0.5, 0.0)],
        [(0.5, -0.7), (0.5, 0.7)],
        [(0.38, 1.0), (0.64, 1.0), (0.64, -1.0), (0.38, -1.0)],
        [(0.64, 0.0), (1.0, 0.0)],
    )
)
_BETWEEN = {"spring": (_COIL,), "damper": (_ROD, _PISTON, _CUP, _TAIL)}
"""Polylines between two places: the share of the way, and two sides over the radius."""

_ASIDE, _ENDS = {"spring": 1.3, "damper": -1.3}, 0.1
"""Distance of a spring and a damper, side by side, from the line between their places, over the
radius; and the share of the way at which they begin.
"""

_ROUND = np.exp(2j * np.pi * np.arange(60) / 60)
_SPIRAL = np.linspace(0.2, 1.0, 61) * np.exp(2.5j * np.pi * np.linspace(0.0, 2.0, 61))

_TOOTH = np.pi / 12
"""The pitch of a rack's teeth over the radius of the gear."""


def between(start: Array, stop: Array, radius: float, symbols: tuple[str, ...]) -> list[Array]:
    """The polylines of a spring, of a damper, or of both side by side, between two places."""
    patterns = [one for symbol in symbols for one in _BETWEEN[symbol]]
    if len(symbols) > 1:
        patterns = [np.array([(x, _ASIDE[s], 0.0) for s in symbols]) for x in (_ENDS, 1 - _ENDS)]
        patterns += [
            np.array([(x, 0.0, 0.0), (y, 0.0, 0.0)]) for x, y in ((0, _ENDS), (1 - _ENDS, 1))
        ]
        for symbol in symbols:
            shift, share = np.array([_ENDS, _ASIDE[symbol], 0.0]), [1.0 - 2.0 * _ENDS, 1.0, 1.0]
            patterns += [shift + share * one for one in _BETWEEN[symbol]]
    way = stop - start
    axes = frame_along(np.where(way.any(axis=1, keepdims=True), way, np.eye(3)[0]))
    return [
        start[:, None] + one[:, :1] * way[:, None] + radius * one[:, 1:] @ axes[:, 1:]
        for one in patterns
    ]


def circle(middle: Array, axis: Array, radius: float) -> Array:
    """A circle about an axis, as a polygon."""
    return middle[:, None] + _across(axis, radius * _ROUND)


def spiral(middle: Array, axis: Array, radius: float) -> Array:
    """The coil of a torsion spring."""
    return middle[:, None] + _across(axis, radius * _SPIRAL)


def arc(middle: Array, axis: Array, radius: float, start: float, stop: float) -> Array:
    """A part of a circle from an angle to another one [rad]."""
    return middle[:, None] + _across(axis, radius * np.exp(1j * np.linspace(start, stop, 31)))


def belt(
    first: Array, second: Array, axis: Array, radii: tuple[float, float], *, crossed: bool
) -> Array:
    """A belt around two circles with parallel axes, as a polygon."""
    way = second - first
    distance = np.linalg.norm(way, axis=1, keepdims=True)
    along = way / distance
    across = np.cross(axis, along)
    one, two = radii
    # Where the strands leave the circles, from the line of the centres.
    lean = np.arccos(np.clip((one + two if crossed else one - two) / distance, -1.0, 1.0))
    share = np.linspace(-1.0, 1.0, 31)
    here, there = np.pi + (np.pi - lean) * share, lean * share
    if crossed:
        there = (np.pi - lean) * -share
    angles = [(first, one, here), (second, two, there)]
    return np.concatenate(
        [
            middle[:, None]
            + radius
            * (np.cos(at)[..., None] * along[:, None] + np.sin(at)[..., None] * across[:, None])
            for middle, radius, at in angles
        ],
        axis=1,
    )


def rack(spot: Array, along: Array, gear: Array, radius: float, ends: tuple[float, float]) -> Array:
    """A rack through a ``spot`` on its pitch line, as a polygon with teeth toward the centre of the
    ``gear``; ``ends`` are those along the line from the spot [m].
    """
    away = spot - gear
    away = away - np.sum(away * along, axis=1, keepdims=True) * along
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    count = max(1, round((ends[1] - ends[0]) / (_TOOTH * radius)))
    at = np.linspace(*ends, 4 * count + 1)
    high = 0.35 * _TOOTH * radius * np.array([1.0, -1.0, -1.0, 1.0])[(np.arange(at.size) + 3) % 4]
    at, high = np.r_[at, ends[1], ends[0]], np.r_[high, np.full(2, _TOOTH * radius)]
    return np.asarray(spot[:, None] + at[:, None] * along[:, None] + high[:, None] * away[:, None])


def _across(axis: Array, points: Array) -> Array:
    """Points at right angles to an axis, given as complex numbers."""
    # From x in the plane, counter-clockwise.
    _, back, first = np.moveaxis(frame_along(axis), 1, 0)
    return np.asarray(points.real[:, None] * first[:, None] - points.imag[:, None] * back[:, None])

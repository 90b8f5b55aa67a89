"""Curves of parts that pictures show, over instants: springs, dampers, circles, belts and racks.

Places and directions are (t, 3) in ground axes, curves (t, n, 3) [m].
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array
from ...model.description import LoadNumbers
from .poses import frame_along

_TURN = np.exp(0.5j * np.pi * np.arange(33))
"""The eight coils of a spring."""

_COIL = np.column_stack(
    [np.r_[0.0, np.linspace(0.15, 0.85, 33), 1.0], np.pad(_TURN.imag, 1), np.pad(_TURN.real, 1)]
)
_DASHPOT = tuple(
    np.array([(*point, 0.0) for point in points])
    for points in (
        [(0.0, 0.0), (0.15, 0.0), (0.5, 0.0)],
        [(0.5, -0.7), (0.5, 0.7)],
        [(0.38, 1.0), (0.64, 1.0), (0.64, -1.0), (0.38, -1.0)],
        [(0.64, 0.0), (0.85, 0.0), (1.0, 0.0)],
    )
)
_GAS = tuple(
    np.array([(share, side, 0.0, along) for along, side in points])
    for share, points in (
        (
            0.0,
            [
                (0.0, 0.0),
                (0.06, 0.0),
                (0.06, 1.0),
                (0.95, 1.0),
                (0.95, -1.0),
                (0.06, -1.0),
                (0.06, 0.0),
            ],
        ),
        (0.0, [(0.86, 0.0), (0.92, 0.6), (0.92, -0.6), (0.86, 0.0)]),
        (1.0, [(-0.88, -0.9), (-0.88, 0.9), (-0.84, 0.9), (-0.84, 0.25), (0.0, 0.25)]),
        (1.0, [(-0.88, -0.9), (-0.84, -0.9), (-0.84, -0.25), (0.0, -0.25)]),
    )
)
"""A barrel, the mark of its gas, and a rod with its piston: the share of the way where the part is
held, two sides over the radius, and the way along from there over the closed length.
"""

_BETWEEN = {"spring": (_COIL,), "damper": _DASHPOT}
"""Polylines between two places: the share of the way, and two sides over the radius."""

_ASIDE = {"spring": 1.3, "damper": -1.3}
"""Distance of a spring and a damper, side by side, from the line between their places, over the
radius.
"""

ROUND = np.exp(2j * np.pi * np.arange(48) / 48)
SPIRAL = np.linspace(0.2, 1.0, 61) * np.exp(2.5j * np.pi * np.linspace(0.0, 2.0, 61))
"""A circle and a coil of radius 1, as complex numbers."""

_TOOTH = np.pi / 12
"""The pitch of a rack's teeth over the radius of the gear."""


def patterns(load: LoadNumbers) -> list[Array]:
    """The polylines (n, 4) of a gas spring, of a spring, of a damper, or of both side by side: the
    share of the way between two places, two sides over the radius, and the way on from there over
    the length of the closed gas spring.
    """
    if load.closed is not None:
        return [*_GAS]
    symbols, found = load.symbols or ("spring",), []
    for symbol in symbols:
        for one in _BETWEEN[symbol]:
            aside = _ASIDE[symbol] * (len(symbols) > 1) * ((one[:, 0] > 0.0) & (one[:, 0] < 1.0))
            found.append(np.column_stack([one + aside[:, None] * np.eye(3)[1], 0.0 * aside]))
    return found


def between(start: Array, stop: Array, radius: float, load: LoadNumbers) -> list[Array]:
    """The polylines of a load between two places."""
    way = stop - start
    far = np.linalg.norm(way, axis=1)[:, None, None]
    axes = frame_along(np.where(far[:, 0] > 0.0, way, np.eye(3)[0]))
    return [
        start[:, None]
        + one[:, :1] * way[:, None]
        + one[:, 3:] * (load.closed or 0.0) * axes[:, :1]
        + radius * one[:, 1:3] @ axes[:, 1:]
        for one in patterns(load)
    ]


def around(middle: Array, axis: Array, points: Array) -> Array:
    """Points at right angles to an axis, given as complex numbers: in the plane x and y."""
    # Of the axes beside the axis, in the plane the first is -y, and the second x.
    sides = np.column_stack([-points.imag, points.real])
    return np.asarray(middle[:, None] + sides @ frame_along(axis)[:, 1:])


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
    here = np.pi + (np.pi - lean) * share
    there = (lean - np.pi) * share if crossed else lean * share
    return np.concatenate(
        [
            middle[:, None]
            + radius
            * (np.cos(at)[..., None] * along[:, None] + np.sin(at)[..., None] * across[:, None])
            for middle, radius, at in ((first, one, here), (second, two, there))
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

"""Orthographic views of a mechanism by azimuth and elevation, and pages of several pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ...base.arrays import Array
from ...base.rotation import direction

_WIDE, _HIGH, _LARGE = 9.6, 7.6, 6.4
"""The most that all columns, all rows and one picture take [inch]."""

_LEFT, _BETWEEN, _RIGHT, _BELOW = 0.75, 0.8, 0.25, 0.6
"""Room for the scales of pictures and around all of them [inch]."""

Quad: TypeAlias = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class View:
    """An orthographic view: the directions in ground axes that are to the ``right`` and ``up`` on
    the page, and its title.

    The two :attr:`coordinates` of a view along an axis may run backward.
    """

    title: str
    right: Array
    up: Array

    def on_page(self, points: Array) -> Array:
        """Points (..., 3) on the page (..., 2) [m]."""
        return np.asarray(points, float) @ np.column_stack([self.right, self.up])

    @property
    def coordinates(self) -> tuple[str, str] | None:
        """The coordinates to the right and up with their signs, as "x" or "-z"; None where the view
        is along no axis.
        """
        named = [_named(direction) for direction in (self.right, self.up)]
        return (named[0], named[1]) if all(named) else None


def upright(gravity: Sequence[float]) -> Array:
    """The ground's axes as rows: to the right, away and up on the page; up is the axis that is most
    against gravity.
    """
    g = np.array(gravity, float)
    k = 2 if not g.any() else int(np.argmax(np.abs(g) * [1.0, 1.0, 1.0 + 1e-9]))
    up = np.zeros(3)
    up[k] = -1.0 if g[k] > 0.0 else 1.0
    right = np.eye(3)[1 if k == 0 else 0]
    return np.array([right, np.cross(up, right), up])


def view(axes: Array, azimuth: float, elevation: float, title: str = "") -> View:
    """The view from a direction [deg]: ``azimuth`` about the upward axis, from that to the right;
    ``elevation`` above the level.

    ``axes`` are those of :func:`upright`.
    """
    (c, s), (ce, se) = (
        direction(math.radians(math.remainder(angle, 360.0))) for angle in (azimuth, elevation)
    )
    right, up = np.array([-s, c, 0.0]) @ axes, np.array([-se * c, -se * s, ce]) @ axes
    text = f"azimuth {azimuth:g}°, elevation {elevation:g}°, {_named(axes[2])} up"
    return View(title or text, right, up)


def views(
    gravity: Sequence[float], azimuth: float, elevation: float
) -> tuple[View, View, View, View]:
    """Views from above, from a chosen direction, from the front, from the right: as rows of a page
    in third-angle projection.
    """
    axes = upright(gravity)
    up, front, right = (_named(axis) for axis in (axes[2], -axes[1], axes[0]))
    return (
        view(axes, -90.0, 90.0, f"from above ({_signed(up)})"),
        view(axes, azimuth, elevation),
        view(axes, -90.0, 0.0, f"from the front ({_signed(front)})"),
        view(axes, 0.0, 0.0, f"from the right ({_signed(right)})"),
    )


def page(
    ends: Sequence[tuple[Array, Array]], across: int, *, title: float, least: float
) -> tuple[float, float, list[Quad], list[Quad]]:
    """A page of pictures that show the ranges between their ``ends``, lower left and upper right
    [m], so many ``across``, in rows, all to one scale: its width and height [inch]; of each picture
    left, bottom, width and height [inch]; and left, right, bottom and top of what it shows [m].

    ``title`` is the height above each picture, ``least`` the width of each at least [inch].
    """
    spans = np.array([high - low for low, high in ends])
    columns = np.array([spans[k::across, 0].max() for k in range(across)])
    rows = np.array([spans[k : k + across, 1].max() for k in range(0, len(ends), across)])
    scale = min(
        _WIDE / columns.sum(), _HIGH / rows.sum(), _LARGE / columns.max(), _LARGE / rows.max()
    )
    columns = np.maximum(columns, least / scale)
    lefts = _LEFT + np.cumsum([0.0, *(scale * columns[:-1] + _BETWEEN)])
    bottoms = _BELOW + np.cumsum([0.0, *(scale * rows[:0:-1] + _BELOW + title)])[::-1]
    places, boxes = list[Quad](), list[Quad]()
    for k, (low, high) in enumerate(ends):
        row, column = divmod(k, across)
        half, middle = np.array([columns[column], rows[row]]) / 2, (low + high) / 2
        (left, bottom), (right, top) = middle - half, middle + half
        boxes.append((left, right, bottom, top))
        places.append((lefts[column], bottoms[row], scale * columns[column], scale * rows[row]))
    width, height = lefts[-1] + scale * columns[-1] + _RIGHT, bottoms[0] + scale * rows[0] + title
    return width, height, places, boxes


def _named(direction: Array) -> str:
    """The ground's axis that a direction is, with its sign where it is backward; nothing where it
    is none.
    """
    along = np.flatnonzero(direction)
    if along.size != 1:
        return ""
    return f"{'-' if direction[along[0]] < 0 else ''}{'xyz'[along[0]]}"


def _signed(name: str) -> str:
    return name if name.startswith("-") else f"+{name}"

"""Names beside their points, where they hide neither each other nor more of the picture than they
must.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.arrays import Array

_REACHES, _DIRECTIONS = (6.0, 10.0, 15.0, 21.0, 28.0, 38.0, 50.0, 70.0), 16
"""Distances of a name from its point [pt], and number of directions, that are tried."""

_FARTHER = (*_REACHES, 90.0, 115.0, 150.0)
"""Distances that are tried where all of these places are on other names [pt]."""

_OVERLAP, _HIDDEN, _OUTSIDE, _FAR = 1e4, 6.0, 1e4, 1.0
"""Costs of a name's place: on another name, on a part of the picture, beyond the edge; and for each
point [pt] of distance.
"""


def placed(
    anchors: Array, sizes: Array, things: Array, boxes: Sequence[Sequence[float] | Array]
) -> Array:
    """Lower left corners (n, 2) of names of ``sizes`` (n, 2) beside their ``anchors`` (n, 2), all
    in one unit [pt].

    ``things`` (m, 2) are points of what is drawn, ``boxes`` are left, bottom, right and top of the
    picture for each name. Names are placed one after the other, those first that have least room.
    """
    found = np.full(anchors.shape, np.nan)
    near = np.sum(
        np.hypot(*np.moveaxis(anchors[:, None] - anchors[None], 2, 0)) < _REACHES[-1], axis=1
    )
    for k in np.lexsort((np.arange(len(anchors)), -sizes[:, 0], -near)):
        for reaches in (_REACHES, _FARTHER):
            corners = _around(anchors[k], sizes[k], reaches)
            close = np.all(np.abs(things - anchors[k]) < reaches[-1] + sizes[k] + 1.0, axis=1)
            costs = _costs(corners, k, anchors, sizes, things[close], found, boxes[k])
            if costs.min() < _OVERLAP:
                break
        found[k] = corners[int(np.argmin(costs))]
    return found


def apart(corners: Array, size: Array, anchor: Array) -> Array:
    """Distances (...) of places of a name, by the corners (..., 2), from its point [pt]."""
    nearest = np.clip(anchor, corners, corners + size)
    return np.asarray(np.hypot(*np.moveaxis(nearest - anchor, -1, 0)))


def _around(anchor: Array, size: Array, distances: Sequence[float]) -> Array:
    """Lower left corners (n, 2) of a name all around its point at some distances, near ones first,
    and of these to the upper right.
    """
    angles = math.pi / 4 + np.linspace(0.0, math.tau, _DIRECTIONS, endpoint=False)
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    reaches = np.array(distances)[:, None, None]
    return np.asarray(anchor + reaches * ways + (ways - 1.0) * size / 2).reshape(-1, 2)


def _costs(
    corners: Array,
    k: int,
    anchors: Array,
    sizes: Array,
    things: Array,
    found: Array,
    box: Sequence[float] | Array,
) -> Array:
    """Costs (n,) of places of a name by its corners (n, 2)."""
    low, high = corners[:, None] - 1.0, corners[:, None] + sizes[k] + 1.0
    over = np.minimum(high, found + sizes) - np.maximum(low, found)
    # Names without a place so far overlap nothing.
    overlaps = np.sum(np.all(over > 0.0, axis=2), axis=1)
    hidden = _within(things, low, high) + 4 * _within(anchors, low, high)
    beyond = np.concatenate([np.array(box[:2]) - low[:, 0], high[:, 0] - np.array(box[2:])], axis=1)
    outside = np.sum(np.maximum(beyond, 0.0), axis=1)
    far = apart(corners, sizes[k], anchors[k])
    return np.asarray(_OVERLAP * overlaps + _HIDDEN * hidden + _OUTSIDE * outside + _FAR * far)


def _within(points: Array, low: Array, high: Array) -> Array:
    """Numbers (n,) of points (m, 2) between corners (n, 1, 2)."""
    (x, y), (left, bottom), (right, top) = (np.moveaxis(one, -1, 0) for one in (points, low, high))
    return np.asarray(np.sum((x > left) & (x < right) & (y > bottom) & (y < top), axis=1))

"""Names beside their points, where they hide neither each other nor more of the picture than they
must; and those of colours.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure, SubFigure

_REACHES, _DIRECTIONS = (6.0, 10.0, 15.0, 21.0, 28.0, 38.0, 50.0, 70.0), 16
"""Distances of a name from its point [pt], and number of directions, that are tried."""

_OVERLAP, _HIDDEN, _OUTSIDE, _FAR = 1e4, 6.0, 1e4, 1.0
"""Costs of a name's place: on another name, on a part of the picture, beyond the edge; and for each
point [pt] of distance.
"""

NAMES_IN_ROW = 6
"""Bodies in a row of the legend."""


def placed(anchors: Array, sizes: Array, things: Array, box: Sequence[float]) -> Array:
    """Lower left corners (n, 2) of names of ``sizes`` (n, 2) beside their ``anchors`` (n, 2), all
    in one unit [pt].

    ``things`` (m, 2) are points of what is drawn, ``box`` is left, bottom, right and top of the
    picture. Names are placed one after the other, those first that have least room.
    """
    anchors, sizes, things = (
        np.asarray(values, float).reshape(-1, 2) for values in (anchors, sizes, things)
    )
    found = np.full(anchors.shape, np.nan)
    near = np.sum(
        np.hypot(*np.moveaxis(anchors[:, None] - anchors[None], 2, 0)) < _REACHES[-1], axis=1
    )
    for k in np.lexsort((np.arange(len(anchors)), -sizes[:, 0], -near)):
        corners = _around(anchors[k], sizes[k])
        costs = np.array([_cost(at, k, anchors, sizes, things, found, box) for at in corners])
        found[k] = corners[int(np.argmin(costs))]
    return found


def apart(corner: Array, size: Array, anchor: Array) -> float:
    """Distance of a name from its point [pt]."""
    nearest = np.clip(anchor, corner, corner + size)
    return float(np.hypot(*(nearest - anchor)))


def _around(anchor: Array, size: Array) -> list[Array]:
    """Lower left corners of a name all around its point, near ones first, and of these to the upper
    right.
    """
    angles = math.pi / 4 + np.linspace(0.0, math.tau, _DIRECTIONS, endpoint=False)
    return [
        anchor + reach * np.array([c, s]) + (np.array([c, s]) - 1.0) * size / 2
        for reach in _REACHES
        for c, s in zip(np.cos(angles), np.sin(angles), strict=True)
    ]


def _cost(
    at: Array,
    k: int,
    anchors: Array,
    sizes: Array,
    things: Array,
    found: Array,
    box: Sequence[float],
) -> float:
    low, high = at - 1.0, at + sizes[k] + 1.0
    over = np.minimum(high, found + sizes) - np.maximum(low, found)
    there = ~np.isnan(found[:, 0])
    overlaps = np.sum(np.prod(np.maximum(over[there], 0.0), axis=1) > 0.0)
    hidden = np.sum(np.all((things > low) & (things < high), axis=1)) + 4 * np.sum(
        np.all((anchors > low) & (anchors < high), axis=1)
    )
    outside = np.sum(
        np.maximum([box[0] - low[0], box[1] - low[1], high[0] - box[2], high[1] - box[3]], 0.0)
    )
    return float(
        _OVERLAP * overlaps
        + _HIDDEN * hidden
        + _OUTSIDE * outside
        + _FAR * apart(at, sizes[k], anchors[k])
    )


def label_bodies(
    figure: Figure | SubFigure, handles: Sequence[Artist], names: Sequence[str]
) -> None:
    """Draw the legend of bodies and colours, once below all drawings of a figure; where its layout
    is not constrained, in its corner.
    """
    if not figure.legends:
        figure.legend(
            handles,
            names,
            loc="outside lower center" if figure.get_layout_engine() else "lower left",
            ncols=NAMES_IN_ROW,
            frameon=False,
            fontsize=8,
        )

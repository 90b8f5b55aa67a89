"""Local peaks between instants, at their exact times and places, and how they follow as parameters change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...base.arrays import Array
from .judged import Signed
from .look import Look, Point
from .values import Followed

_TRIALS, _NUDGE, _REACH = 6, 1e-2, 8.0
"""Steps of Newton's method to a peak; steps between instants, of which second derivatives are taken, and which a peak follows at
most."""


def top(followed: Followed, point: Point, p: Array, where: Array, sign: float, step: float, *, free: bool) -> Point:
    """The smooth peak that is near a point, by Newton's method; the point itself where there is none. ``free`` may xi be."""
    guess = list(point.guess)
    nudges = np.array([_NUDGE * step, _NUDGE])

    def slopes(at: Array) -> Array:
        found = followed.slopes(at[0], guess, p, at[1], where).full().ravel()
        return found if free else np.array([found[0], 0.0])

    at = np.array([point.share, point.xi])
    turn = np.zeros((2, 2))
    for _ in range(_TRIALS):
        if not 0.0 < at[0] < 1.0 or (free and not 0.0 < at[1] < 1.0):
            return point
        bend = np.zeros((2, 2))
        for k in range(1 + free):
            nudge = np.eye(2)[k] * nudges
            bend[k] = (slopes(at + nudge) - slopes(at - nudge)) / (2 * nudges[k])
        bend = (bend + bend.T) / 2
        size = 2 if free else 1
        inner = bend[:size, :size]
        if not np.isfinite(inner).all() or not (np.linalg.eigvalsh(sign * inner) < 0.0).all():
            return point
        turn = np.zeros((2, 2))
        turn[:size, :size] = -np.linalg.inv(inner)
        away = turn @ slopes(at)
        if not (abs(away[0]) <= step and abs(away[1]) <= 0.1):
            return point
        at = at + away
        if abs(away[0]) <= 1e-9 * step and abs(away[1]) <= 1e-9:
            break
    value = float(followed.value(at[0], guess, p, at[1], where))
    if not sign * value >= sign * point.value - 1e-9 * abs(point.value):
        return point
    reach = (_REACH * step, 0.1 if free else 0.0)
    return replace(
        point,
        share=float(at[0]),
        xi=float(at[1]),
        value=value,
        turn=(float(turn[0, 0]), float(turn[0, 1]), float(turn[1, 1])),
        reach=reach,
    )


def told(points: Sequence[Signed], look: Look, value: float, t: float, xi: float) -> list[Signed]:
    """The largest of local peaks, where it is between instants."""
    sign = math.copysign(1.0, value)
    share = look.share(t)
    near = [point for point, its in points if its == sign and abs(point.share - share) <= 2 * look.step]
    ratio = 0.0 if math.isnan(xi) else xi

    def apart(point: Point) -> float:
        return abs(point.xi - ratio) + abs(point.value - value) / abs(value)

    if not near or value == 0.0:
        k = int(np.argmin(np.abs(look.t - t)))
        return [(Point(share, ratio, 0, value, look.instant(k).guess), sign)]
    best = min(near, key=apart)
    return [(Point(share, ratio, best.place, value, best.guess), sign)]

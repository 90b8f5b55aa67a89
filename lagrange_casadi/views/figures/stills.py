"""Instants at which a mechanism is drawn: postures that differ from each other."""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array, every
from ...results.solution import Solution
from ..shapes.poses import Poses
from ..shapes.primitives import drawing, size_of

_SAME = 0.02
"""Over the mechanism's size: postures all of whose points are no farther apart look the same."""

THINNED = 2000
"""Largest number of instants at which postures are looked at."""


def stills(solution: Solution, count: int) -> list[int]:
    """The numbers of at most ``count`` instants, evenly spread over the motion until it repeats
    itself; no posture is there twice.

    Of a motion that does not return to its start both ends are among them.
    """
    n = solution.t.size
    if count < 2 or n < 2:
        return [0]
    few = every(n, THINNED)
    thin = solution.during(few)
    things = drawing(Poses.of(thin))
    size = size_of(things)
    moving = [one.points for one in things if len(one.points) == thin.t.size]
    cloud = np.concatenate(moving, axis=1)
    turn = _period(cloud, size)
    ends = np.linspace(0, turn, count + 1)[:-1] if turn else np.linspace(0, len(cloud) - 1, count)
    found: list[int] = []
    for k in ends.round().astype(int).tolist():
        moved = (np.linalg.norm(cloud[k] - cloud[other], axis=1).max() for other in found)
        if all(distance > _SAME * size for distance in moved):
            found.append(k)
    return [few.step * k for k in found]


def _period(cloud: Array, size: float) -> int:
    """After how many instants points (t, n, 3) are where they were, and go on as they did; 0 where
    they never are.
    """
    steps = np.linalg.norm(np.diff(cloud, axis=0), axis=2).max(axis=1)
    # Instants need not fall on the period: half a step may be between.
    near = max(1e-6 * size, 0.51 * float(steps.max()))
    away = np.linalg.norm(cloud - cloud[0], axis=2).max(axis=1)
    for turn in np.flatnonzero(away[1:] <= near) + 1:
        if np.linalg.norm(cloud[turn:] - cloud[: len(cloud) - turn], axis=2).max() <= near:
            return int(turn)
    return 0

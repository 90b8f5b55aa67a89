"""Instants at which a mechanism is drawn: postures that differ from each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ...base.arrays import Array
from ...model.description import Description, Place
from ...results.solution import Solution
from ..shapes.places import drawn_spots, placed, spokes

_SAME = 0.02
"""Over the mechanism's size: postures all of whose points are no farther apart look the same."""

_SHOWN = 0.045
"""Half the length of the line along a joint's axis, over the mechanism's size."""

_THINNED = 2000


def stills(solution: Solution, count: int) -> list[int]:
    """The numbers of at most ``count`` instants, evenly spread over the motion until it repeats
    itself; no posture is there twice.

    Of a motion that does not return to its start both ends are among them.
    """
    n = solution.t.size
    if count < 2 or n < 2:
        return [0]
    step = 1 + n // _THINNED
    thin = solution.during(slice(None, None, step))
    cloud = _cloud(thin, (*drawn_spots(thin.description), *spokes(thin.description)))
    size = float(np.ptp(cloud, axis=(0, 1)).max()) or 1.0
    cloud = np.concatenate(
        [cloud, *(_cloud(thin, [end]) for end in _ends_of_axes(thin.description, _SHOWN * size))],
        axis=1,
    )
    turn = _period(cloud, size)
    ends = np.linspace(0, turn, count + 1)[:-1] if turn else np.linspace(0, len(cloud) - 1, count)
    found: list[int] = []
    for k in ends.round().astype(int).tolist():
        moved = (np.linalg.norm(cloud[k] - cloud[other], axis=1).max() for other in found)
        if all(distance > _SAME * size for distance in moved):
            found.append(k)
    return [step * k for k in found]


def _cloud(solution: Solution, spots: Iterable[Place]) -> Array:
    """Places over the instants, (t, n, 3) [m]."""
    return np.stack([placed(solution, spot) for spot in spots], axis=1)


def _ends_of_axes(description: Description, reach: float) -> Iterator[Place]:
    """Ends of joints' axes on the bodies that carry them: they show a shaft turn, whose points do
    not move.
    """
    for joint in description.joints.values():
        carried = [(joint.parent, axis.direction) for axis in joint.axes[:1]] + (
            [(joint.child, joint.carried)] if joint.carried else []
        )
        for spot, axis in carried:
            x, y, z = (at + reach * along for at, along in zip(spot.at, axis, strict=True))
            yield Place(spot.body, (x, y, z))


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

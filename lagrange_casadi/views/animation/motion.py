"""A solution's motion at the frames of an animation: equal steps of time through the cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...errors import DeclarationError
from ...model.description import Place, Triple
from ...results.solution import Solution
from ..shapes.places import drawn_spots, placed

_SAME = 1e-3
"""Over the mechanism's size: a motion whose ends are no farther apart is a cycle, and its last
instant is the first again.
"""


@dataclass(frozen=True, eq=False)
class Motion:
    """The frames lie between instants ``before`` and those that follow, at a ``share`` (frames,) of
    the way.

    ``closed`` says that the first frame follows the last one. Between two instants everything goes
    straight.
    """

    solution: Solution
    before: npt.NDArray[np.intp]
    share: Array
    closed: bool

    def at(self, values: Array) -> Array:
        """Values over the instants (t, ...) at the frames (frames, ...)."""
        share = self.share.reshape(-1, *[1] * (values.ndim - 1))
        found: Array = values[self.before] * (1.0 - share) + values[self.before + 1] * share
        return found

    def place(self, spot: Place) -> Array:
        """Return the coordinates of a place, (frames, 3) in ground axes [m]."""
        return self.at(placed(self.solution, spot))

    def direction(self, body: str, direction: Triple, at: Triple = (0.0, 0.0, 0.0)) -> Array:
        """A direction that a body carries, (frames, 3) in ground axes."""
        x, y, z = np.add(at, direction).tolist()
        return self.place(Place(body, (x, y, z))) - self.place(Place(body, at))


def motion_of(solution: Solution, count: int) -> Motion:
    """The motion at ``count`` frames; at no more than there are instants.

    Raises :class:`.DeclarationError` where there are not two instants.
    """
    t = solution.t
    if t.size < 2:
        raise DeclarationError(
            f"{solution.case}: an animation shows a motion, and there is 1 instant; ask for more"
        )
    ends = np.array([placed(solution, spot)[[0, -1]] for spot in drawn_spots(solution.description)])
    whole = np.array([placed(solution, spot) for spot in drawn_spots(solution.description)])
    size = float(np.max(np.ptp(whole.reshape(-1, 3), axis=0)))
    closed = t.size > 2 and float(np.max(np.abs(ends[:, 1] - ends[:, 0]))) <= _SAME * size
    frames = max(2, min(count, t.size - 1 if closed else t.size))
    at = np.linspace(t[0], t[-1], frames + 1)[:-1] if closed else np.linspace(t[0], t[-1], frames)
    before = np.clip(np.searchsorted(t, at, side="right") - 1, 0, t.size - 2)
    share = np.clip((at - t[before]) / (t[before + 1] - t[before]), 0.0, 1.0)
    return Motion(solution, before, share, closed)

"""A solution's motion at the frames of an animation: equal steps of time through the cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...errors import DeclarationError
from ...results.solution import Solution
from ..shapes.poses import Poses, blended, require_poses
from ..shapes.primitives import drawing, size_of

_SAME = 1e-3
"""Over the mechanism's size: a motion whose ends are no farther apart is a cycle, and its last
instant is the first again.
"""


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames lie between instants ``before`` and those that follow, at a ``share`` (frames,) of
    the way.

    ``whole`` are the poses at all instants, ``poses`` those at the frames. ``closed`` says that the
    first frame follows the last one.
    """

    solution: Solution
    whole: Poses
    poses: Poses
    before: npt.NDArray[np.intp]
    share: Array
    closed: bool

    def at(self, values: Array) -> Array:
        """Values over the instants (t, ...) at the frames (frames, ...)."""
        return blended(values, self.before, self.share)


def require_motion(solution: Solution) -> None:
    """Raise :class:`.DeclarationError` where a body has no pose among the outputs, and where there
    are not two instants.
    """
    require_poses(solution, "an animation")
    if solution.t.size < 2:
        raise DeclarationError(
            f"{solution.case}: an animation shows a motion, and there is 1 instant; ask for more"
        )


def frames_of(solution: Solution, count: int) -> Frames:
    """The motion at ``count`` frames; at no more than there are instants.

    Raises as :func:`require_motion` does.
    """
    require_motion(solution)
    t = solution.t
    whole = Poses.of(solution)
    ends = [
        one.points
        for one in drawing(whole.during([0, -1]), whole)
        if len(one.points) == 2  # of what moves
    ]
    gap = max((float(np.max(np.abs(points[1] - points[0]))) for points in ends), default=0.0)
    closed = t.size > 2 and gap <= _SAME * size_of(drawing(whole))
    frames = max(2, min(count, t.size - 1 if closed else t.size))
    at = np.linspace(t[0], t[-1], frames + 1)[:-1] if closed else np.linspace(t[0], t[-1], frames)
    before = np.clip(np.searchsorted(t, at, side="right") - 1, 0, t.size - 2)
    share = np.clip((at - t[before]) / (t[before + 1] - t[before]), 0.0, 1.0)
    return Frames(solution, whole, whole.between(before, share), before, share, closed)

"""A solution's motion at the frames of an animation: equal steps of time through the cycle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import DeclarationError
from ...results.solution import Solution
from ..shapes.poses import Poses, require_poses
from ..shapes.primitives import cloud, drawing, size_of

_SAME = 1e-3
"""Over the mechanism's size: a motion whose ends are no farther apart is a cycle, and its last
instant is the first again.
"""


def require_motion(solution: Solution) -> None:
    """Raise :class:`.DeclarationError` where a body has no pose among the outputs, and where there
    are not two instants.
    """
    require_poses(solution, "an animation")
    if solution.t.size < 2:
        raise DeclarationError(
            f"{solution.case}: an animation shows a motion, and there is 1 instant; ask for more"
        )


def frames_of(solution: Solution, whole: Poses, count: int) -> tuple[Solution, bool]:
    """The outputs at ``count`` frames, or at no more than there are instants, between which all of
    them go straight; and whether the first frame follows the last one. The poses are those of the
    ``whole`` motion.
    """
    t = solution.t
    first, last = (cloud(drawing(whole.during([k]), whole)) for k in (0, -1))
    gap = float(np.abs(last - first).max())
    closed = t.size > 2 and gap <= _SAME * size_of(drawing(whole))
    frames = max(2, min(count, t.size - 1 if closed else t.size))
    at = np.linspace(t[0], t[-1], frames + 1)[:-1] if closed else np.linspace(t[0], t[-1], frames)
    outputs = {output: np.interp(at, t, values) for output, values in solution.outputs.items()}
    return replace(solution, t=at, outputs=outputs), closed

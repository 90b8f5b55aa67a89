"""A picture of a free machine: torque over the drive's coordinate, with the areas above and below
its mean, and speed.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...base.arguments import public
from ...results.statistics import shares
from ...studies.forward.free_motion import FreeMotion
from ..shapes.picture_files import GRIDS, one_at_a_time, put_figure, subplots


@public
@one_at_a_time(GRIDS)
def plot_cycle(motion: FreeMotion, path: str | Path) -> None:
    """Draw torques and speed of a free machine over its coordinate, into a file.

    Parameters
    ----------
    motion : FreeMotion
        Result of :func:`.free`.
    path : path
        File of the picture; its ending says whether it is PNG, SVG or PDF.

    Raises
    ------
    PathError
        If the file cannot be written.
    DeclarationError
        For another ending.

    Notes
    -----
    The required torque is the one that would keep the present speed constant. The areas between it
    and the torque of the drive are the energy that changes the speed.
    """
    angle = motion.unit == "rad"
    x = np.degrees(motion.angle) if angle else motion.angle
    resisting = motion.resisting
    mean = float(resisting @ shares(motion.angle))
    figure, (upper, lower) = subplots((7.0, 6.0), 2, sharex=True)
    upper.fill_between(x, resisting, mean, where=resisting > mean, color="#f2c9b8", lw=0.0)
    upper.fill_between(x, resisting, mean, where=resisting <= mean, color="#c9dff2", lw=0.0)
    upper.plot(x, resisting, color="#1f4e79", lw=1.0, label="needed")
    upper.axhline(mean, color="#1f4e79", lw=0.8, ls="--", label="its mean")
    upper.plot(x, motion.drive, color="#c0392b", lw=1.0, label="drive")
    upper.set(ylabel="torque [N m]" if angle else "force [N]")
    upper.legend(loc="best")
    turn = 60.0 / math.tau if angle else 1.0
    lower.plot(x, turn * motion.speed, color="#2e7d4f", lw=1.2)
    lower.set(
        xlabel=f"{motion.joint} [{'deg' if angle else 'm'}]",
        ylabel="speed [1/min]" if angle else "speed [m/s]",
    )
    put_figure(figure, path)

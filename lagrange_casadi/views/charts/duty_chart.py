"""A picture of a duty: torque over speed, beside what a motor bears."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...base.arguments import public
from ...studies.actuators.duty import Duty
from ...studies.actuators.motor import Motor
from ..shapes.picture_files import GRIDS, one_at_a_time, put_figure, subplots


@public
@one_at_a_time(GRIDS)
def plot_duty(duty: Duty, path: str | Path, motor: Motor | None = None) -> None:
    """Draw torque over speed of a duty, with the limits of a motor, into a file.

    Parameters
    ----------
    duty : Duty
        Result of :func:`.duty_of`.
    path : path
        File of the picture; its ending says whether it is PNG, SVG or PDF.
    motor : Motor, optional
        Its limits are drawn too.

    Raises
    ------
    PathError
        If the file cannot be written.
    DeclarationError
        For another ending.
    """
    per_minute = 1.0 if duty.linear else 60.0 / math.tau
    figure, (axes,) = subplots((7.0, 5.0))
    axes.plot(
        per_minute * np.abs(duty.speed),
        np.abs(duty.torque),
        ".-",
        color="#1f4e79",
        lw=0.8,
        ms=3,
        label=f"motor of {duty.joint}",
    )
    axes.plot(
        per_minute * duty.mean_speed,
        duty.rms_torque,
        "D",
        color="#c0392b",
        label="root mean square, at the mean speed",
    )
    if motor is not None:
        speeds = np.linspace(0.0, motor.max_speed, 200)
        axes.plot(
            per_minute * speeds,
            motor.continuous_torque(speeds),
            color="#2e7d4f",
            label=f"{motor.name}, continuous",
        )
        limit = np.append(motor.short_time_torque(speeds), 0.0)
        ends = np.append(speeds, motor.max_speed)
        axes.plot(per_minute * ends, limit, color="#b3541e", label=f"{motor.name}, peak")
    speed, pull = ("speed [m/s]", "force [N]") if duty.linear else ("speed [1/min]", "torque [N m]")
    axes.set(xlabel=speed, ylabel=pull, xlim=(0, None), ylim=(0, None))
    figure.legend(loc="outside lower center", ncols=2)
    put_figure(figure, path)

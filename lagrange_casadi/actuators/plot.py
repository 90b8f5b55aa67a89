"""A picture of a duty: torque over speed, beside what a motor bears."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ..errors import DeclarationError
from ..system.publish import check_writable, writing
from .catalogue import Motor
from .duty import Duty

_PICTURES = (".png", ".pdf", ".svg")


def plot_duty(duty: Duty, path: str | Path, motor: Motor | None = None) -> None:
    """Draw a duty's points of torque over speed, its root mean square at its mean speed, and the limits of a motor, into a file.

    Raises :class:`.DeclarationError` for a name that ends in none of .png, .pdf and .svg, and :class:`.PathError`.
    """
    target = Path(path)
    if target.suffix not in _PICTURES:
        raise DeclarationError(f"{target}: expected a name that ends in {', '.join(_PICTURES)}")
    check_writable(target)
    from matplotlib.figure import Figure

    turns = 60.0 / math.tau
    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.subplots()
    axes.plot(turns * np.abs(duty.speed), np.abs(duty.torque), ".-", color="#1f4e79", lw=0.8, ms=3, label=f"motor of {duty.joint}")
    axes.plot(turns * duty.mean_speed, duty.rms_torque, "D", color="#c0392b", label="root mean square, at the mean speed")
    if motor is not None:
        speeds = np.linspace(0.0, motor.max_speed, 50)
        axes.plot(turns * speeds, motor.lasting(speeds), color="#2e7d4f", label=f"{motor.name}, for ever")
        limits = [motor.peak_torque, motor.peak_torque, 0.0]
        axes.plot(
            turns * np.array([0.0, motor.max_speed, motor.max_speed]), limits, color="#b3541e", label=f"{motor.name}, at most"
        )
    axes.set(xlabel="speed [1/min]", ylabel="torque [N m]", xlim=(0, None), ylim=(0, None))
    axes.grid(True, color="0.92")
    axes.legend(frameon=False, fontsize=9)
    with writing(target) as (file,):
        figure.savefig(file, format=target.suffix.removeprefix("."), dpi=150)

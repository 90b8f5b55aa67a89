"""``lagrange-casadi free``: a machine left to itself, its steady cycle, its flywheel."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import click

from ..errors import check_known
from ..model.even_points import EvenPoints
from ..model.torques import Law, dc_motor, induction_motor, power, torque
from ..results.store.runs import check_target, save
from ..results.verification.certificate import refuse_failed, summary
from ..studies.case import load_case
from ..studies.forward.free_motion import FreeMotion
from ..studies.forward.running import flywheel
from ..studies.forward.running import free as run
from ..views.charts.free_cycle import plot_cycle
from ..views.shapes.picture_files import check_picture
from .echo import echo, write_asked
from .options import HDF5, measured, refuse, target

LAWS: dict[str, tuple[Callable[..., Law], int]] = {
    "torque": (torque, 1),
    "power": (power, 1),
    "dc": (dc_motor, 2),
    "induction": (induction_motor, 3),
}
"""Laws of drives by the word of the option, and how many numbers each takes."""


def free(
    case: Path,
    *,
    drive: str | None = None,
    geared: float = 1.0,
    load: float | str = 0.0,
    inertia: float | str = 0.0,
    start: str | None = None,
    steady: bool = False,
    fluctuation: float | None = None,
    cycle: float = 1.0,
    t: EvenPoints | None = None,
    out: Path | None = None,
    plot: Path | None = None,
    **given: Any,
) -> None:
    """Compute the motion of CASE under the torques of a motor, its loads and its weight.

    All forces are those of this motion. CASE has one degree of freedom; the motion that it
    declares is used for the start only.

    lagrange-casadi free punch_press --drive induction=200,0.2,157 --geared 15 --fluctuation 0.05

    Parameters
    ----------
    case : CASE
    drive : LAW=NUMBER,...
        Drive it by torque=TORQUE [N m], power=POWER [W], dc=STALL_TORQUE,NO_LOAD_SPEED or
        induction=BREAKDOWN_TORQUE,BREAKDOWN_SLIP,SYNCHRONOUS_SPEED [rad/s]. Default: nothing; of
        a steady cycle the torque that keeps the mean speed.
    geared : NUMBER
        Set the gear ratio, turns of the motor per turn of the drive.
    load : TORQUE
        Apply this resisting torque [N m].
    inertia : INERTIA
        Put a flywheel of this inertia on the drive [kg m^2].
    start : COORDINATE,RATE
        Set the initial coordinate and rate [rad, rad/s or m, m/s]; default: those of the case.
    steady
        As of :func:`.studies.forward.running.free`.
    fluctuation : NUMBER
        Find the flywheel with which the steady cycle has this coefficient of fluctuation.
    cycle : TURNS
        Set the turns after which the machine repeats.
    count : NUMBER
        As of :func:`.studies.forward.running.free`.
    parameters, t, wanted
        As of :func:`.studies.forward.running.free`.
    out
        Write the run to this HDF5 file; default: <case>_free.h5.
    plot : FILE.png
        Draw torque and speed over the drive's coordinate into this file, .png, .pdf or .svg.
    """
    sized = fluctuation is not None
    refuse(
        (sized and inertia, "--fluctuation finds the flywheel; expected it without --inertia"),
        (sized and t, "--fluctuation computes a steady cycle; expected it without --t"),
        (drive is None and geared != 1.0, "--geared goes with --drive"),
        (
            not 0.0 < cycle < math.inf,
            f"--cycle: expected a positive number of turns, got {cycle:g}",
        ),
    )
    check_picture(plot)
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_free.h5", HDF5)
    check_target(out)
    given |= {
        "load": load,
        "drive": None if drive is None else _law(drive).geared(geared),
        "start": None if start is None else _numbers("--start", start, 2),
        "cycle": math.tau * cycle,
    }
    if fluctuation is None:
        found = run(loaded.scene, inertia=inertia, t=t, steady=steady, **given)
        echo(*_lines(found))
    else:
        wheel = flywheel(loaded.scene, fluctuation=fluctuation, **given)
        found = wheel.motion
        echo(
            *_lines(found),
            f"flywheel: {wheel.inertia:.6g} kg m^2 by the exact cycle, {wheel.textbook:.6g} kg m^2"
            f" by the energy method, for a swing of {wheel.energy:.6g} J",
        )
    save(found.solution, out)
    echo(f"wrote {out}")
    write_asked(plot, partial(plot_cycle, found))
    echo(summary(found.solution.certificate))
    refuse_failed(found.solution)


def _law(text: str) -> Law:
    """Read WORD=NUMBER,... as a law."""
    word, _, numbers = text.partition("=")
    check_known("law of --drive", [word], LAWS)
    make, many = LAWS[word]
    return make(*_numbers(f"--drive {word}", numbers, many))


def _numbers(what: str, text: str, many: int) -> list[float | str]:
    try:
        found = [measured(word) for word in text.split(",")]
    except click.BadParameter:
        found = []
    finite = all(isinstance(x, str) or math.isfinite(x) for x in found)
    numbers = "a finite number" if many == 1 else f"{many} finite numbers with commas between"
    refuse((not finite or len(found) != many, f"{what}: expected {numbers}, got '{text}'"))
    return found


def _lines(found: FreeMotion) -> Iterator[str]:
    solution, cycle = found.solution, found.cycle
    unit, speed = found.unit, f"{found.unit}/s"
    yield (
        f"{solution.case}: {found.t.size} instants from {found.t[0]:.6g} to {found.t[-1]:.6g} s,"
        f" {found.joint} at first {found.angle[0]:.6g}, at last {found.angle[-1]:.6g} {unit}, speed"
        f" between {found.speed.min():.6g} and {found.speed.max():.6g} {speed}"
    )
    if cycle is not None:
        yield (
            f"steady cycle of {cycle.period:.6g} s: mean speed {cycle.mean_speed:.6g} {speed}, from"
            f" {cycle.least:.6g} to {cycle.largest:.6g}, fluctuation {cycle.fluctuation:.4g}"
        )
        if cycle.torque:
            yield f"torque that keeps the mean speed: {cycle.torque:.6g} N m"
        yield (
            f"power: {cycle.power:.6g} W from the drive, {cycle.load:.6g} W to its load,"
            f" {cycle.taken:.6g} W to the machine, of which {cycle.lost:.6g} W to friction"
        )
    yield from (f"event: {event}" for event in found.events)

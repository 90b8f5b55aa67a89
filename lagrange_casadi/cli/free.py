"""``lagrange-casadi free``: a machine left to itself, its steady cycle, its flywheel."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click

from ..base.numerals import real
from ..errors import UnknownNameError
from ..model.even_points import EvenPoints
from ..model.torques import Law, dc_motor, induction_motor, power, torque
from ..results.store.runs import check_target, save
from ..results.verification.certificate import refuse_failed, summary
from ..studies.case import load_case
from ..studies.forward.motion import FreeMotion
from ..studies.forward.running import flywheel
from ..studies.forward.running import free as run
from ..views.charts.free_cycle import plot_cycle
from ..views.shapes.pictures import check_picture
from .echo import echo
from .options import HDF5, target

LAWS: dict[str, tuple[Callable[..., Law], int]] = {
    "torque": (torque, 1),
    "power": (power, 1),
    "dc": (dc_motor, 2),
    "induction": (induction_motor, 3),
}
"""Laws of drives by the word of the option, and how many numbers each takes."""


def free(
    case: Path,
    drive: str | None,
    geared: float,
    inertia: float,
    start: str | None,
    steady: bool,
    fluctuation: float | None,
    cycle: float,
    t: EvenPoints | None,
    out: Path | None,
    plot: Path | None,
    **given: Any,
) -> None:
    """See :func:`.commands.free`."""
    if fluctuation is not None and inertia:
        raise click.UsageError("--fluctuation finds the flywheel; expected it without --inertia")
    if fluctuation is not None and t is not None:
        raise click.UsageError("--fluctuation computes a steady cycle; expected it without --t")
    if drive is None and geared != 1.0:
        raise click.UsageError("--geared goes with --drive")
    if not math.isfinite(given["load"]):
        raise click.UsageError(f"--load: expected a finite number, got {given['load']:g}")
    if not 0.0 < cycle < math.inf:
        raise click.UsageError(f"--cycle: expected a positive number of turns, got {cycle:g}")
    if plot is not None:
        check_picture(plot)
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_free.h5", HDF5)
    check_target(out)
    given |= {
        "drive": None if drive is None else _law(drive).geared(geared),
        "start": None if start is None else _numbers("--start", start, 2),
        "cycle": math.tau * cycle,
    }
    wheel = None
    if fluctuation is not None:
        wheel = flywheel(loaded.scene, fluctuation=fluctuation, **given)
        found = wheel.motion
    else:
        found = run(loaded.scene, inertia=inertia, t=t, steady=steady, **given)
    echo(*_lines(found))
    if wheel is not None:
        echo(
            f"flywheel: {wheel.inertia:.6g} kg m^2 by the exact cycle, {wheel.textbook:.6g} kg m^2"
            f" by the energy method, for a swing of {wheel.energy:.6g} J"
        )
    save(found.solution, out)
    echo(f"wrote {out}")
    if plot is not None:
        plot_cycle(found, plot)
        echo(f"wrote {plot}")
    echo(summary(found.solution.certificate))
    refuse_failed(found.solution)


def _law(text: str) -> Law:
    """Read WORD=NUMBER,... as a law."""
    word, _, numbers = text.partition("=")
    if word not in LAWS:
        raise UnknownNameError("law of --drive", word, LAWS)
    make, many = LAWS[word]
    return make(*_numbers(f"--drive {word}", numbers, many))


def _numbers(what: str, text: str, many: int) -> list[float]:
    try:
        found = [real(word) for word in text.split(",")]
    except ValueError:
        found = []
    if len(found) != many or not all(map(math.isfinite, found)):
        numbers = "a finite number" if many == 1 else f"{many} finite numbers with commas between"
        raise click.UsageError(f"{what}: expected {numbers}, got '{text}'")
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

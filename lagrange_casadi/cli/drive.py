"""``lagrange-casadi drive``: what a cycle asks of the motors of drives, and which of a catalogue
serve.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ..base.arrays import Array
from ..base.units import quantity, typed
from ..errors import NoDesignError, check_known
from ..results.solution import Solution
from ..results.verification.certificate import certified_outputs, refuse_failed, summary
from ..studies.actuators.catalogue import read_motors
from ..studies.actuators.choice import Choice, select
from ..studies.actuators.duty import Duty, duty_of, slides
from ..studies.actuators.inertia import inertia_at
from ..studies.actuators.motor import Motor
from ..studies.case import load_case
from ..studies.evaluate import evaluate
from ..views.charts.duty_chart import plot_duty
from ..views.shapes.picture_files import check_picture
from .echo import echo
from .options import refuse

_BAR = 40


def drive(
    case: Path,
    *,
    motors: Path | None = None,
    drives: Sequence[str] = (),
    ratios: tuple[float, ...] = (),
    lead: float | None = None,
    efficiency: float = 1.0,
    inertia: float | str = 0.0,
    plot: Path | None = None,
    **given: Any,
) -> None:
    """Choose the smallest motor that suits each drive of CASE.

    It lists the speeds, torques and power that a cycle demands, and the reserves of the motor.

    Parameters
    ----------
    case : CASE
    motors : FILE.csv|NAME
        Choose from this catalogue, or by name from a class of motors: servo, induction; default:
        motors.csv next to the case.
    drives : JOINT
        Choose a motor for this drive. Default: all drives.
    ratios : NUMBER,...
        Set the gear ratio, turns of the motor per turn of the drive; the best of several is
        taken. Default: 1.
    lead : LENGTH
        Set the travel per turn [m] of the screw or belt of a sliding drive.
    efficiency : NUMBER
        Set the efficiency of the gearbox, from 0 to 1.
    inertia : INERTIA
        Add this moment of inertia to that of the motor's rotor [kg m^2].
    parameters
        As of :func:`.studies.evaluate.evaluate`.
    t
        As of :func:`.studies.evaluate.evaluate`: Set the instants [s] over a whole cycle, both ends
        included; default: those of the case.
    over
        As of :func:`.studies.evaluate.evaluate`.
    plot : FILE.png
        Draw torque over speed into this file, .png, .pdf or .svg.
    """
    refuse(
        (
            lead is not None and not 0.0 < lead < math.inf,
            f"--lead: expected a positive length [m], got {lead}",
        ),
        (
            not 0.0 <= typed(inertia)[0] < math.inf,
            f"--inertia: expected a number that is not negative [kg m^2], got {inertia}",
        ),
    )
    loaded = load_case(case)
    scene = loaded.scene
    beside = loaded.path.parent / "motors.csv"
    catalogue = read_motors(motors or beside) if motors is not None or beside.is_file() else []
    valid = scene.needs_drives if scene.weights is None else tuple(scene.weights)
    check_known("drive", drives, valid)
    chosen = tuple(dict.fromkeys(drives)) or valid
    refuse(
        (
            plot and len(chosen) > 1,
            f"--plot: expected one drive, by --drive; there are {', '.join(chosen)}",
        )
    )
    check_picture(plot)
    solution = evaluate(scene, wanted=certified_outputs(scene.outputs), **given)
    lines = [
        (
            f"{solution.case}: {solution.t.size} instants from {solution.t[0]:.5g} to"
            f" {solution.t[-1]:.5g} s"
        )
    ]
    failed: list[str] = []
    for name in chosen:
        carried = inertia_at(scene, name, **given)
        load = duty_of(solution, name, linear=slides(solution, name), carried=carried)
        lines += _load_lines(load)
        motor = None
        if catalogue:
            try:
                choice = _choose(
                    solution, name, catalogue, ratios, lead, efficiency, inertia, carried
                )
            except NoDesignError as error:
                failed.append(f"drive '{name}': {error}")
                continue
            lines += _choice_lines(choice, len(catalogue))
            load, motor = choice.duty, choice.motor
        if plot is not None:
            plot_duty(load, plot, motor)
            lines.append(f"wrote {plot}")
    lines += (f"note: {note}" for note in solution.notes)
    echo(*lines, summary(solution.certificate))
    refuse_failed(solution)
    if failed:
        raise NoDesignError("; ".join(failed))


def _choose(
    solution: Solution,
    name: str,
    catalogue: Sequence[Motor],
    ratios: Sequence[float],
    lead: float | None,
    efficiency: float,
    inertia: float | str,
    carried: Array,
) -> Choice:
    """The motor of a drive.

    Raises ``click.UsageError`` where its ratio is left open, and :class:`.NoDesignError`.
    """
    linear, slide = catalogue[0].linear, slides(solution, name)
    refuse(
        (lead and linear, "--lead: linear motors have no lead"),
        (lead and not slide, f"--lead: drive '{name}' turns; expected --ratio"),
        (
            slide and not (linear or lead or ratios),
            (
                f"drive '{name}' slides: expected --lead, the travel per turn of the motor, or"
                " linear motors"
            ),
        ),
    )
    per_unit = math.tau / lead if lead else 1.0
    beside_rotor = quantity("--inertia", inertia, "kg" if linear else "kg m^2")

    def asked(ratio: float, rotor: float) -> Duty:
        return duty_of(
            solution,
            name,
            ratio=ratio,
            efficiency=efficiency,
            inertia=rotor + beside_rotor,
            linear=linear,
            carried=carried,
        )

    return select(catalogue, asked, ratios=[per_unit * ratio for ratio in ratios or (1.0,)])


def _load_lines(load: Duty) -> Iterator[str]:
    """Lines of the load at the drive itself."""
    yield f"{load.joint}: {_peaks(load)}"
    yield f"  {_energy(load)}"
    if load.carried is not None:
        yield (
            f"  inertia of what it drives: {_range(load.carried.min(), load.carried.max())}"
            f" {'kg' if load.linear else 'kg m^2'}"
        )
    if load.coarse:
        yield (
            "  note: with half the instants a mean or a peak differs by more than 1 %; take more"
            " instants"
        )


def _choice_lines(choice: Choice, count: int) -> Iterator[str]:
    """The motor, what it is used to, and why nothing smaller will do."""
    duty, motor = choice.duty, choice.motor
    yield (
        f"  smallest suitable of {count} motors: '{motor.name}', {motor.rated_power:.5g} W, with a"
        f" ratio of {duty.ratio:.6g}"
    )
    for name, share in choice.shares.items():
        governs = " governs" if name == choice.governs else ""
        yield (
            f"    {name:<12} {share:>8.4g}"
            f" |{'#' * min(_BAR, math.ceil(share * _BAR)):<{_BAR}}|{governs}"
        )
    yield f"    {_peaks(duty)}"
    yield f"    {_energy(duty)}"
    if duty.inertia > 0.0:
        ratio = duty.inertia_ratio
        yield (
            f"    inertia of the load over that of the motor:"
            f" {_range(ratio.least, ratio.largest)}, mean {ratio.mean:.5g}"
        )
    yield from (f"    smaller: {why}" for why in choice.refused)


def _peaks(duty: Duty) -> str:
    force, per_unit, unit = ("N", 1.0, "m/s") if duty.linear else ("N m", 60.0 / math.tau, "1/min")
    return (
        f"rms {duty.rms_torque:.5g} {force}, peak {duty.peak_torque:.5g} {force}, peak speed"
        f" {duty.peak_speed * per_unit:.5g} {unit}, peak power {duty.peak_power:.5g} W"
    )


def _energy(duty: Duty) -> str:
    back = (
        f"; regenerated {duty.regenerated:.5g} J, at most {duty.peak_return:.5g} W"
        if duty.peak_return > 0.0
        else ""
    )
    return f"energy of a cycle {duty.energy:.5g} J{back}"


def _range(least: float, largest: float) -> str:
    """Write two numbers, or one if they are the same in the digits shown."""
    ends = dict.fromkeys(f"{value:.5g}" for value in (least, largest))
    return " to ".join(ends)

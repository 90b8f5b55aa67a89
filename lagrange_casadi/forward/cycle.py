"""The steady cycle of a machine, and the flywheel that keeps its speed even.

Over the angle the speed obeys dw/dphi = a(phi, w)/w. A cycle is steady where the speed at its end is
that at its start: Newton's method finds it, with the exact derivative of the end by the start, which
is integrated beside the speed. So are the derivatives by the drive's torque and by the flywheel's
inertia, where these are sought too: the torque that keeps a mean speed, the inertia that keeps a
fluctuation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arguments import NotNegative, Outputs, Positive, public
from ..base.arrays import Array
from ..base.packages import check_installed
from ..case import Case, scene_of
from ..declare.even_points import checked
from ..declare.scene import Scene
from ..errors import DeclarationError, LagrangeCasadiError
from .laws import Law, law_of
from .machine import ROW, Machine
from .motion import ACCURACY, FreeMotion, Start, begun_at, follow

_STEPS, _TRIES, _FASTER = 40, 24, 1.4
_SAME, _FLAT = 1e-6, 1e-9
_DONE = 1e-11
"""Relative residual at which a cycle is steady."""

_EVEN = 1e9
"""A flywheel of so many times the machine's inertia lets it turn evenly."""

_SPEED, _TIME, _BY, _TIME_BY = 0, 1, slice(2, 5), slice(5, 8)
"""States over the angle: the speed, the time, and their derivatives by the speed at the start, the
added torque and the flywheel's inertia.
"""


@public
@dataclass(frozen=True, eq=False, repr=False)
class Cycle:
    """A steady cycle of a machine: ``motion`` over one cycle of the drive.

    ``mean_speed`` is the cycle's angle over its ``period`` [s], ``least`` and ``largest`` are
    speeds [rad/s], between the instants too. ``torque`` [N m] is the constant one that keeps the
    mean speed where no drive was given, else zero. ``power`` [W] is the mean that the drive gives,
    ``load`` and ``taken`` are those that the load and the scene take, ``lost`` is that of the
    scene's frictions.
    """

    motion: FreeMotion
    period: float
    mean_speed: float
    least: float
    largest: float
    torque: float
    power: float
    load: float
    taken: float
    lost: float

    def __repr__(self) -> str:
        return (
            f"<Cycle of {self.motion.solution.case}: mean speed {self.mean_speed:.6g} rad/s,"
            f" fluctuation {self.fluctuation:.4g}, power {self.power:.5g} W>"
        )

    @property
    def fluctuation(self) -> float:
        """Coefficient of fluctuation: largest less least speed, over the mean speed."""
        return abs((self.largest - self.least) / self.mean_speed)


@public
@dataclass(frozen=True, eq=False, repr=False)
class Flywheel:
    """A flywheel that keeps a fluctuation of speed.

    ``inertia`` [kg m^2] is that of the exact steady ``cycle``, in which the machine's own inertia
    varies and the drive follows the speed. ``textbook`` is that of the energy method: the largest
    swing of energy ``energy`` [J] at the even mean speed under an even torque, over the fluctuation
    and the square of the speed (Norton, *Design of Machinery*, section 11.11; Shigley, *Mechanical
    Engineering Design*, chapter on flywheels).
    """

    inertia: float
    textbook: float
    energy: float
    cycle: Cycle

    def __repr__(self) -> str:
        return (
            f"<Flywheel of {self.inertia:.6g} kg m^2, by the energy method {self.textbook:.6g}"
            " kg m^2>"
        )


@public
def steady(
    scene: Scene | Case,
    *,
    drive: Law | float | None = None,
    load: Law | float | None = None,
    inertia: NotNegative = 0.0,
    start: Sequence[float] | None = None,
    cycle: Positive = math.tau,
    count: int = 721,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    accuracy: float = ACCURACY,
) -> Cycle:
    """Find the steady cycle of a machine of one degree of freedom.

    Parameters
    ----------
    scene, load, inertia, parameters, wanted, accuracy
        As of :func:`.free`.
    drive
        The law of the drive. Default: the constant torque that keeps the mean speed of ``start``.
    start
        Coordinate and rate of the joint where the cycle begins [rad, rad/s]; default: those of the
        scene's motion. The rate is a guess, or the mean speed where no drive is given.
    cycle
        Angle after which the machine repeats [rad]: one turn, or two for a four-stroke engine.
    count
        Number of instants of the cycle, in even steps of time, first and last included.

    Returns
    -------
    Cycle
        The cycle, with its :class:`.FreeMotion` and :class:`.Solution`.

    Raises
    ------
    DeclarationError
        As :func:`.free`; for a drive that slides, for laws or loads of the time, and where the
        machine does not repeat after the cycle.
    LagrangeCasadiError
        As :func:`.free`; where the machine stalls, and where no cycle is steady, as nothing depends
        on the speed.
    """
    machine, begin = _ready(scene, drive, load, inertia, start, parameters)
    goal = _Goal(math.copysign(cycle, begin.speed), None if drive is not None else begin.speed)
    return _finished(machine, _sought(machine, begin, goal, accuracy), count, wanted, accuracy)


@public
def flywheel(
    scene: Scene | Case,
    *,
    fluctuation: Positive = 0.02,
    drive: Law | float | None = None,
    load: Law | float | None = None,
    start: Sequence[float] | None = None,
    cycle: Positive = math.tau,
    count: int = 721,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    accuracy: float = ACCURACY,
) -> Flywheel:
    """Find the inertia of a flywheel on the drive that keeps a coefficient of fluctuation.

    Parameters
    ----------
    fluctuation
        Largest less least speed over the mean speed.
    scene, drive, load, start, cycle, count, parameters, wanted, accuracy
        As of :func:`steady`.

    Returns
    -------
    Flywheel
        The inertia by the exact cycle and by the energy method.

    Raises
    ------
    DeclarationError, LagrangeCasadiError
        As :func:`steady`; where the machine fluctuates less without a flywheel.
    """
    machine, begin = _ready(scene, drive, load, 0.0, start, parameters)
    span = math.copysign(cycle, begin.speed)
    mean = None if drive is not None else begin.speed
    speed = begin.speed
    if mean is None:
        heavy = _EVEN * float(machine.at(0.0, begin.angle, speed)[ROW["inertia"]])
        machine.added[1] = heavy
        speed = _sought(machine, begin, _Goal(span, None), accuracy).speed
        machine.added[1] = 0.0
    energy, _ = _swing(machine, Start(begin.angle, speed), span, accuracy)
    guess = energy / (fluctuation * speed**2)
    machine.added[1] = guess
    goal = _Goal(span, mean, fluctuation)
    found = _sought(machine, Start(begin.angle, speed), goal, accuracy)
    done = _finished(machine, found, count, wanted, accuracy)
    even = Start(begin.angle, done.mean_speed)
    machine.added[:] = 0.0
    energy, _ = _swing(machine, even, span, accuracy)
    return Flywheel(
        found.inertia, energy / (fluctuation * done.mean_speed**2), energy, done
    )


@dataclass(frozen=True)
class _Goal:
    """A cycle of a signed angle [rad] that is sought: one that is steady, with a ``mean`` speed or
    a ``fluctuation`` where they are numbers.
    """

    span: float
    mean: float | None = None
    fluctuation: float | None = None

    @property
    def unknowns(self) -> list[int]:
        """Numbers of what is sought: the speed at the start, the torque, the inertia."""
        return [0, *([1] if self.mean is not None else []), *([2] if self.fluctuation else [])]


@dataclass(frozen=True)
class _Found:
    """A steady cycle: the state at its start, what was added, its time and its extreme speeds."""

    angle: float
    speed: float
    torque: float
    inertia: float
    period: float
    span: float
    least: float
    largest: float


@dataclass(frozen=True, eq=False)
class _Turn:
    """States at the end of a cycle, and at its least and its largest speed."""

    end: Array
    least: Array
    largest: Array


def _ready(
    scene: Scene | Case,
    drive: Law | float | None,
    load: Law | float | None,
    inertia: float,
    start: Sequence[float] | None,
    parameters: Mapping[str, float] | None,
) -> tuple[Machine, Start]:
    """The machine and the state at which its cycle begins."""
    check_installed("scipy", "a steady cycle", "free")
    scene = scene_of(scene)
    values = scene.values(parameters)
    scene.checked(values)
    machine = Machine.of(scene, law_of(drive, "drive"), law_of(load, "load"), inertia, values)
    if scene.mechanism.coordinates[machine.joint][1].kind == "slide":
        raise DeclarationError(
            f"a steady cycle is one of a drive that turns, and '{machine.joint}' slides"
        )
    if machine.timed:
        raise DeclarationError(
            f"a steady cycle of '{scene.name}': a law or load depends on the time; expected laws of"
            " coordinates and rates"
        )
    begin = begun_at(machine, start, machine.program.data.span[0])
    if begin.speed == 0.0:
        raise DeclarationError(
            "a steady cycle: the speed at the start is 0, expected start=(angle, speed) with a"
            " guess of the speed"
        )
    return machine, begin


def _sought(machine: Machine, begin: Start, goal: _Goal, accuracy: float) -> _Found:
    """Find a cycle by Newton's method.

    Raises :class:`.LagrangeCasadiError` where there is none.
    """
    _check_repeats(machine, begin, goal.span)
    name, speed = machine.scene.name, begin.speed
    if goal.mean is not None:
        machine.added[0] += _swing(machine, begin, goal.span, accuracy)[1]
    turn = None
    for _ in range(_TRIES):  # to a speed with which it gets round at all
        turn = _turned(machine, Start(begin.angle, speed), goal.span, accuracy)
        if turn is not None:
            break
        speed *= _FASTER
    if turn is None:
        raise LagrangeCasadiError(
            f"machine '{name}' stalls: it does not get round from {begin.angle:.6g} rad, at"
            f" speeds from {begin.speed:.6g} to {speed:.6g} rad/s"
        )
    for _ in range(_STEPS):
        residuals, slopes = _residuals(turn, speed, goal)
        if np.abs(residuals).max() < _DONE * 10.0 * max(1.0, accuracy / ACCURACY):
            return _Found(
                begin.angle,
                speed,
                *map(float, machine.added),
                float(abs(turn.end[_TIME])),
                goal.span,
                *sorted((float(turn.least[_SPEED]), float(turn.largest[_SPEED])), key=abs),
            )
        if abs(slopes[0, 0]) < _FLAT and goal.mean is None:
            raise LagrangeCasadiError(
                f"machine '{name}' has no steady cycle: nothing in it depends on the speed, so each"
                " turn adds as much energy as the one before"
            )
        step = -np.linalg.solve(slopes, residuals)
        turn, speed = _moved(machine, begin.angle, speed, step, goal, accuracy)
    raise LagrangeCasadiError(
        f"machine '{name}': no steady cycle was found near {begin.speed:.6g} rad/s; after"
        f" {_STEPS} steps its speed at the start is {speed:.6g} rad/s"
        + ("" if goal.fluctuation is None else f", the flywheel's {machine.added[1]:.6g} kg m^2")
    )


def _moved(
    machine: Machine, angle: float, speed: float, step: Array, goal: _Goal, accuracy: float
) -> tuple[_Turn, float]:
    """Take a step, or as much of it as lets the machine get round."""
    before = np.array([speed, *machine.added])
    whole = np.zeros(3)
    whole[goal.unknowns] = step
    share = 1.0
    for _ in range(_TRIES):
        now = before + share * whole
        if now[0] * speed > 0.04 * speed**2 and now[2] >= 0.0:
            machine.added[:] = now[1:]
            turn = _turned(machine, Start(angle, float(now[0])), goal.span, accuracy)
            if turn is not None:
                return turn, float(now[0])
        share /= 2.0
    if goal.fluctuation is not None and before[2] + whole[2] < 0.0:
        raise LagrangeCasadiError(
            f"machine '{machine.scene.name}' needs no flywheel: it fluctuates by less than"
            f" {goal.fluctuation:g} without one"
        )
    raise LagrangeCasadiError(
        f"machine '{machine.scene.name}' stalls: below {speed:.6g} rad/s at {angle:.6g} rad it does"
        " not get round, and above it slows down"
    )


def _residuals(turn: _Turn, speed: float, goal: _Goal) -> tuple[Array, Array]:
    """Relative residuals of what is sought, and their slopes."""
    end = turn.end
    rows = [(end[_SPEED] - speed) / speed]
    slopes = [(end[_BY] - np.array([1.0, 0.0, 0.0])) / speed]
    if goal.mean is not None:
        wanted = goal.span / goal.mean
        rows.append(end[_TIME] / wanted - 1.0)
        slopes.append(end[_TIME_BY] / wanted)
    if goal.fluctuation is not None:
        swing = (turn.largest - turn.least) / goal.span
        rows.append(swing[_SPEED] * end[_TIME] - goal.fluctuation)
        slopes.append(swing[_BY] * end[_TIME] + swing[_SPEED] * end[_TIME_BY])
    return np.array(rows), np.array(slopes)[:, goal.unknowns]


def _turned(machine: Machine, begin: Start, span: float, accuracy: float) -> _Turn | None:
    """Go round once; None where the machine does not."""
    if not machine.begin(0.0, begin.angle):
        return None
    a, by = ROW["acceleration"], [ROW[f"by_{name}"] for name in ("speed", "drive", "inertia")]

    def rates(angle: float, y: Array) -> Array:
        speed = y[_SPEED]
        found = np.full(8, np.nan)
        if speed * span <= 0.0:
            return found
        rows = machine.at(0.0, angle, speed)
        found[_SPEED], found[_TIME] = rows[a] / speed, 1.0 / speed
        slope = (rows[by[0]] - rows[a] / speed) / speed
        found[_BY] = slope * y[_BY]
        found[_BY][1:] += rows[by[1:]] / speed
        found[_TIME_BY] = -y[_BY] / speed**2
        return found

    def even(angle: float, y: Array) -> float:
        return float(machine.at(0.0, angle, float(y[_SPEED]))[a])

    state = np.zeros(8)
    state[_SPEED], state[_BY] = begin.speed, (1.0, 0.0, 0.0)
    run = _over(rates, (begin.angle, begin.angle + span), state, accuracy, even)
    if run is None:
        return None
    states = np.concatenate([run.y[:, [0, -1]].T, run.y_events[0].reshape(-1, 8)])
    order = np.argsort(states[:, _SPEED])
    least, largest = states[order[0]], states[order[-1]]
    return _Turn(run.y[:, -1], least, largest)


def _swing(
    machine: Machine, begin: Start, span: float, accuracy: float
) -> tuple[float, float]:
    """The largest swing of energy [J] of a machine that turns evenly under an even torque, and that
    torque [N m].
    """
    before = machine.added.copy()
    own = float(machine.at(0.0, begin.angle, begin.speed)[ROW["inertia"]])
    machine.added[:] = 0.0, _EVEN * own
    machine.begin(0.0, begin.angle)
    effort, load = ROW["effort"], ROW["load"]

    def resisting(angle: float) -> float:
        rows = machine.at(0.0, angle, begin.speed)
        return float(rows[effort] + rows[load])

    def over(mean: float) -> Any:
        machine.begin(0.0, begin.angle)
        return _over(
            lambda angle, y: [resisting(angle) - mean],
            (begin.angle, begin.angle + span),
            np.zeros(1),
            accuracy,
            lambda angle, y: resisting(angle) - mean,
        )

    first = over(0.0)
    if first is None:
        raise LagrangeCasadiError(
            f"machine '{machine.scene.name}': its torque at the even speed {begin.speed:.6g} rad/s"
            " is not finite all the way round"
        )
    mean = float(first.y[0, -1]) / span
    run = over(mean)
    machine.added[:] = before
    reached = np.concatenate([run.y[0, [0, -1]], run.y_events[0].ravel()])
    return float(np.ptp(reached)), mean


def _over(
    rates: Any, span: tuple[float, float], state: Array, accuracy: float, even: Any
) -> Any | None:
    """A run over the angle, with ends and extremes; None where it does not come to its end."""
    from scipy.integrate import solve_ivp

    with np.errstate(invalid="ignore"):
        run = solve_ivp(
            rates,
            span,
            state,
            method="DOP853",
            rtol=max(accuracy, 2.3e-14),
            atol=accuracy * 1e-3,
            events=even,
        )
    return run if run.status == 0 else None


def _check_repeats(machine: Machine, begin: Start, span: float) -> None:
    """Raise :class:`.DeclarationError` where the machine is another one after a cycle."""
    machine.begin(0.0, begin.angle)
    first, last = (
        machine.at(0.0, begin.angle + share * span, begin.speed).copy() for share in (0.0, 1.0)
    )
    for name in ("effort", "drive", "load", "inertia", "taken"):
        a, b = first[ROW[name]], last[ROW[name]]
        if not abs(a - b) <= _SAME * (abs(a) + abs(b) + 1e-3 * first[ROW["kinetic"]]):
            raise DeclarationError(
                f"machine '{machine.scene.name}' does not repeat after {abs(span):.6g} rad: its"
                f" {name} is {a:.6g} there and {b:.6g} here; expected cycle= the angle after which"
                " it does"
            )


def _finished(
    machine: Machine, found: _Found, count: int, wanted: Outputs | None, accuracy: float
) -> Cycle:
    """Follow a cycle in time, with all forces."""
    even = checked("count", (0.0, found.period, count))
    machine.added[:] = found.torque, found.inertia
    motion = follow(machine, Start(found.angle, found.speed), even, wanted, accuracy)
    lost = [
        array for name, array in motion.solution.series.items()
        if name.startswith("friction:") and name.endswith(":loss")
    ]
    works = (motion.work_drive, motion.work_load, motion.work_taken)
    return Cycle(
        motion,
        found.period,
        found.span / found.period,
        found.least,
        found.largest,
        found.torque,
        *(float(work[-1]) / found.period for work in works),
        lost=sum(float(np.mean((one[1:] + one[:-1]) / 2.0)) for one in lost),
    )

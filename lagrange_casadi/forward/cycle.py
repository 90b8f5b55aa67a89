"""The steady cycle of a machine, and the flywheel that keeps its speed even.

Over the angle the speed obeys dw/dphi = a(phi, w)/w. A cycle is steady where the speed at its end
is that at its start: Newton's method finds it, with the exact derivative of the end by the start,
which is integrated beside the speed. So are the derivatives by the drive's torque and by the
flywheel's inertia, where these are sought too: the torque that keeps a mean speed, the inertia that
keeps a fluctuation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arguments import Outputs
from ..base.arrays import Array
from ..declare.even_points import checked
from ..declare.scene import Scene
from ..errors import DeclarationError, LagrangeCasadiError
from .machine import ROW, Machine
from .motion import ACCURACY, Cycle, FreeMotion, Start, follow

_STEPS, _TRIES, _FASTER = 25, 12, 1.4
_SAME, _FLAT = 1e-6, 1e-9
_SLOWEST = 1e-2
"""Share of the speed at the start below which a machine is said not to get round."""

_DONE = 1e-10
"""Relative residual at which a cycle is steady."""

_SPEED, _TIME, _BY, _TIME_BY = 0, 1, slice(2, 5), slice(5, 8)
"""States over the angle: the speed, the time, and their derivatives by the speed at the start, the
added torque and the flywheel's inertia.
"""


@dataclass(frozen=True)
class Goal:
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
class Found:
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


def sought(machine: Machine, begin: Start, goal: Goal, accuracy: float) -> Found:
    """Find a cycle by Newton's method.

    Raises :class:`.LagrangeCasadiError` where there is none.
    """
    _check_repeats(machine, begin, goal.span)
    name, speed = machine.name, begin.speed
    if goal.mean is not None:
        machine.added[0] += swing(machine, begin, goal.span, accuracy)[1]
    turn = None
    for _ in range(_TRIES):  # to a speed with which it gets round at all
        turn = _turned(machine, Start(begin.angle, speed), goal.span, accuracy)
        if turn is not None:
            break
        speed *= _FASTER
    if turn is None:
        raise LagrangeCasadiError(
            f"machine '{name}' stalls: it does not complete a turn from {begin.angle:.6g} rad, at"
            f" initial speeds from {begin.speed:.6g} to {speed:.6g} rad/s"
        )
    signs, close = set[float](), False
    for number in range(_STEPS):
        residuals, slopes = _residuals(turn, speed, goal)
        signs.add(math.copysign(1.0, residuals[0]))
        if number == 0 and goal.mean is None and abs(slopes[0, 0] * speed) < _FLAT:
            raise LagrangeCasadiError(
                f"machine '{name}' has no steady cycle: nothing in it depends on the speed, so each"
                " turn adds as much energy as the one before"
            )
        step = np.asarray(-np.linalg.lstsq(slopes, residuals)[0], float)
        before, close = close, np.abs(residuals).max() < _DONE * max(1.0, accuracy / ACCURACY)
        if before and close and abs(step[0]) < _SAME * abs(speed):  # one more step than it takes
            least, largest = sorted((turn.least[_SPEED], turn.largest[_SPEED]), key=abs)
            return Found(
                *(begin.angle, speed, float(machine.added[0]), float(machine.added[1])),
                *(float(abs(turn.end[_TIME])), goal.span, float(least), float(largest)),
            )
        step *= min(1.0, abs(speed / (2.0 * step[0])) if step[0] else 1.0)
        turn, speed = _moved(machine, begin.angle, speed, step, goal, accuracy)
    why = {
        -1.0: "the machine slows down each turn, and stalls",
        1.0: "the machine gains speed each turn",
    }
    raise LagrangeCasadiError(
        f"machine '{name}': no steady cycle was found near {begin.speed:.6g} rad/s; "
        + (why[signs.pop()] if len(signs) == 1 else f"after {_STEPS} steps")
        + f", {speed:.6g} rad/s at the start of the last one"
        + ("" if goal.fluctuation is None else f", a flywheel of {machine.added[1]:.6g} kg m^2")
    )


def _moved(
    machine: Machine, angle: float, speed: float, step: Array, goal: Goal, accuracy: float
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
            f"machine '{machine.name}' needs no flywheel: it fluctuates by less than"
            f" {goal.fluctuation:g} without one"
        )
    raise LagrangeCasadiError(
        f"machine '{machine.name}' stalls: below {speed:.6g} rad/s at {angle:.6g} rad it does"
        " not complete a turn, and above that speed it slows down"
    )


def _residuals(turn: _Turn, speed: float, goal: Goal) -> tuple[Array, Array]:
    """Relative residuals of what is sought, and their slopes: the first is the energy that a cycle
    adds, which does not depend on the speed where nothing does.
    """
    end = turn.end
    rows = [(end[_SPEED] ** 2 - speed**2) / (2.0 * speed**2)]
    slopes = [(end[_SPEED] * end[_BY] - np.array([speed, 0.0, 0.0])) / speed**2]
    if goal.mean is not None:
        wanted = goal.span / goal.mean
        rows.append(end[_TIME] / wanted - 1.0)
        slopes.append(end[_TIME_BY] / wanted)
    if goal.fluctuation is not None:
        swing = (turn.largest - turn.least) / abs(goal.span)
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
        if not speed / begin.speed > _SLOWEST:
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
    states = _over(rates, (begin.angle, begin.angle + span), state, accuracy, even)
    if states is None:
        return None
    order = np.argsort(states[:, _SPEED])
    return _Turn(states[1], states[order[0]], states[order[-1]])


def swing(machine: Machine, begin: Start, span: float, accuracy: float) -> tuple[float, float]:
    """The largest swing of energy [J] of a machine that turns evenly under an even torque, and that
    torque [N m].

    Raises :class:`.LagrangeCasadiError` where it cannot turn evenly.
    """
    effort, load = ROW["effort"], ROW["load"]

    def over(mean: float) -> Array:
        def rates(angle: float, _y: Array) -> list[float]:
            rows = machine.at(0.0, angle, begin.speed)
            return [float(rows[effort] + rows[load]) - mean]

        machine.begin(0.0, begin.angle)
        ends = begin.angle, begin.angle + span
        energies = _over(rates, ends, np.zeros(1), accuracy, lambda x, y: rates(x, y)[0])
        if energies is None:
            raise LagrangeCasadiError(
                f"machine '{machine.name}': the torque at the constant speed"
                f" {begin.speed:.6g} rad/s is not finite over the whole turn"
            )
        return energies

    with machine.evenly(begin.angle, begin.speed):
        mean = float(over(0.0)[1, 0]) / span
        return float(np.ptp(over(mean))), mean


def _over(
    rates: Callable[[float, Array], Sequence[float] | Array],
    span: tuple[float, float],
    state: Array,
    accuracy: float,
    even: Callable[[float, Array], float],
) -> Array | None:
    """States over the angle, one a row: at the start, at the end, and where ``even`` is zero; None
    where the machine does not come to the end.
    """
    from scipy.integrate import solve_ivp

    with np.errstate(invalid="ignore"):
        run = solve_ivp(
            *(rates, span, state),
            method="DOP853",
            rtol=max(accuracy, 2.3e-14),
            atol=accuracy * 1e-3,
            events=even,
        )
    if run.status != 0:
        return None
    return np.concatenate([run.y[:, [0, -1]].T, np.reshape(run.y_events[0], (-1, state.size))])


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
                f"machine '{machine.name}' does not repeat after {abs(span):.6g} rad: its"
                f" {name} is {a:.6g} there and {b:.6g} here; expected cycle= the angle after which"
                " it does"
            )


def finished(
    scene: Scene,
    machine: Machine,
    found: Found,
    count: int,
    wanted: Outputs | None,
    accuracy: float,
) -> FreeMotion:
    """Follow a cycle in time, with all forces."""
    even = checked("count", (0.0, found.period, count))
    machine.added[:] = found.torque, found.inertia
    motion = follow(scene, machine, Start(found.angle, found.speed), even, wanted, accuracy)
    lost = [
        array
        for name, array in motion.solution.series.items()
        if name.startswith("friction:") and name.endswith(":loss")
    ]
    gave, took, taken = (
        float(work[-1]) / found.period
        for work in (motion.work_drive, motion.work_load, motion.work_taken)
    )
    cycle = Cycle(
        *(found.period, found.span / found.period, found.least, found.largest, found.torque),
        *(gave, took, taken),
        lost=sum(float(np.mean((one[1:] + one[:-1]) / 2.0)) for one in lost),
    )
    return replace(motion, cycle=cycle)

"""The steady cycle of a machine, and the flywheel that keeps its speed even.

Over the angle the speed obeys dw/dphi = a(phi, w)/w. A cycle is steady if the speed at its end is
that at its start: Newton's method finds it, with the exact derivative of the end by the start,
which is integrated beside the speed. So are the derivatives by the drive's torque and by the
flywheel's inertia, if these are sought too: the torque that keeps a mean speed, the inertia that
keeps a fluctuation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arguments import Outputs
from ...base.arrays import Array
from ...errors import DeclarationError, LagrangeCasadiError
from ...model.even_points import checked
from ...model.scene import Scene
from .free_motion import ACCURACY, Cycle, FreeMotion, follow
from .integration import integrated, terminal
from .machine import ROW, Machine, Start

_STEPS, _TRIES, _FASTER, _SLOWER = 25, 12, 1.4, 0.3
_SAME = 1e-6
_SLOWEST = 1e-4
"""Share of the speed at the start below which a machine is said to stall."""

_DONE = 1e-10
"""Relative residual at which a cycle is steady."""

_EVEN = 1e9
"""A flywheel of so many times the machine's inertia lets it turn evenly."""

_FLAT = 1e-12
"""Change of energy with the speed, beside the kinetic energy, that is none."""

_SPEED, _TIME, _BY, _TIME_BY = 0, 1, slice(2, 5), slice(5, 8)
"""States over the angle: the speed over that at the start, the time times that, and the derivatives
of both by the speed at the start, the added torque and the flywheel's inertia, in ``units``.
"""

_ZERO, _ROUGH = 1e-3, 1e3
"""A state that counts as zero; and one of which Newton's method needs few digits."""


@dataclass(frozen=True, eq=False)
class Turn:
    """A cycle of a signed angle ``span`` [rad] from a state on: the states at its end, and at its
    least and its largest speed by size.

    ``units`` are the speed at the start, and the torque and the inertia that the machine has beside
    it.
    """

    begin: Start
    span: float
    units: Array
    end: Array
    least: Array
    largest: Array

    @property
    def period(self) -> float:
        """Time of the cycle [s]."""
        return float(self.end[_TIME]) / self.begin.speed

    @property
    def speed(self) -> float:
        """Mean speed [rad/s]."""
        return self.span / self.period

    @property
    def fluctuation(self) -> float:
        """Largest less least speed, over the mean speed."""
        return float((self.largest - self.least)[_SPEED] * self.end[_TIME]) / self.span

    @property
    def gain(self) -> float:
        """Kinetic energy at the end beyond that at the start, over twice the latter, of an even
        inertia.
        """
        return float(self.end[_SPEED] ** 2 - 1.0) / 2.0


@dataclass(frozen=True)
class Stall:
    """A machine that comes to rest within a cycle: where it began, the ``angle`` [rad] at which it
    rests, and the ``time`` until then [s].
    """

    begin: Start
    angle: float
    time: float


@dataclass(frozen=True)
class Goal:
    """A steady cycle that is sought, of a signed angle ``span`` [rad]: with a ``mean`` speed
    [rad/s] and a ``fluctuation``, if they are numbers.
    """

    span: float
    mean: float | None = None
    fluctuation: float | None = None

    @property
    def unknown(self) -> list[bool]:
        """Marks of what is sought among the speed at the start, the torque and the inertia."""
        return [True, self.mean is not None, self.fluctuation is not None]

    def residuals(self, turn: Turn) -> tuple[Array, Array]:
        """Relative residuals of what is sought, and their slopes by the speed at the start, the
        torque and the inertia, in units. The first is the energy that a cycle adds, which does not
        depend on the speed if nothing does.
        """
        end = turn.end
        rows, slopes = [turn.gain], [end[_SPEED] * end[_BY] - (1.0, 0.0, 0.0)]
        if self.mean is not None:
            rows.append(self.mean / turn.speed - 1.0)
            slopes.append(end[_TIME_BY] * self.mean / (turn.begin.speed * self.span))
        if self.fluctuation is not None:
            swing = (turn.largest - turn.least) / self.span
            rows.append(turn.fluctuation - self.fluctuation)
            slopes.append(swing[_BY] * end[_TIME] + swing[_SPEED] * end[_TIME_BY])
        return np.array(rows), np.array(slopes)


def sought(machine: Machine, begin: Start, goal: Goal, accuracy: float) -> Turn:
    """Find a steady cycle near a state by Newton's method; the torque and the inertia that it needs
    are then those that are ``added`` to the machine.

    Raises :class:`.LagrangeCasadiError` if there is none.
    """
    _check_repeats(machine, begin, goal.span)
    if goal.mean is not None:
        machine.added[0] += swing(machine, begin, goal.span, accuracy)[1]
    turn = _at_speeds(machine, begin, goal.span, accuracy, _FASTER)
    if isinstance(turn, Stall):
        raise _stalled(machine, turn)
    turns, rough = [turn], max(1.0, accuracy / ACCURACY)
    for _ in range(_STEPS):
        rows, slopes = goal.residuals(turn)
        step = np.zeros(3)
        step[goal.unknown] = -np.linalg.lstsq(slopes[:, goal.unknown], rows)[0]
        if goal.mean is None and abs(slopes[0, 0]) < _FLAT * rough:
            if len(turns) > 1:  # at a speed that is large beyond measure
                break
            raise LagrangeCasadiError(
                f"machine '{machine.name}' has no steady cycle: nothing in it depends on the speed,"
                " so each turn adds as much energy as the one before"
            )
        if np.abs(rows).max() < _DONE * rough and abs(step[0]) < _SAME:
            return turn
        step *= min(1.0, abs(1.0 / (2.0 * step[0]))) if step[0] else 1.0
        before, found = np.array([turn.begin.speed, *machine.added]), None
        for _ in range(_TRIES):  # as much of the step as lets the machine get round
            now = before + turn.units * step
            machine.added[:] = now[1:]
            if now[2] >= 0.0:
                found = _turned(machine, Start(begin.angle, float(now[0])), goal.span, accuracy)
                if isinstance(found, Turn):
                    break
            step /= 2.0
        if not isinstance(found, Turn):
            raise _none(machine, goal, turns, found, accuracy)
        turns.append(turn := found)
    raise _none(machine, goal, turns, None, accuracy)


def _at_speeds(
    machine: Machine, begin: Start, span: float, accuracy: float, factor: float
) -> Turn | Stall:
    """The first cycle with a higher speed at its start, or the first stall with a lower one."""
    for k in range(_TRIES):
        start = Start(begin.angle, begin.speed * factor**k)
        found = _turned(machine, start, span, accuracy)
        if isinstance(found, Turn) == (factor > 1.0):
            break
    return found


def _none(
    machine: Machine, goal: Goal, turns: Sequence[Turn], stall: Stall | None, accuracy: float
) -> LagrangeCasadiError:
    """The reason why no steady cycle was found, by the ``turns`` and a ``stall`` on the way."""
    last, name = turns[-1], machine.name
    if goal.fluctuation is not None and last.fluctuation < goal.fluctuation:
        return LagrangeCasadiError(
            f"machine '{name}' needs no flywheel: it fluctuates by less than {goal.fluctuation:g}"
            " without one"
        )
    gains = [turn.gain for turn in turns]
    slows = max(gains) <= 0.0
    if slows and stall is None:
        slowest = min((turn.begin for turn in turns), key=lambda begin: abs(begin.speed))
        found = _at_speeds(machine, slowest, goal.span, accuracy, _SLOWER)
        stall = found if isinstance(found, Stall) else None
    if stall is not None:
        return _stalled(machine, stall, ", because it loses speed each turn" if slows else "")
    return LagrangeCasadiError(
        f"machine '{name}': no steady cycle was found near {turns[0].begin.speed:.6g} rad/s; "
        + ("the machine gains speed each turn" if min(gains) > 0.0 else f"after {_STEPS} steps")
        + f", {last.begin.speed:.6g} rad/s at the start of the last one"
        + ("" if goal.fluctuation is None else f", a flywheel of {machine.added[1]:.6g} kg m^2")
    )


def _stalled(machine: Machine, stall: Stall, cause: str = "") -> LagrangeCasadiError:
    """The error for a machine that stalls."""
    begin, way = stall.begin, math.copysign(machine.slow, stall.begin.speed)
    rows = machine.at(0.0, stall.angle, way)
    drive = float(rows[ROW["drive"]])
    need = drive - float(rows[ROW["inertia"]] * rows[ROW["acceleration"]])
    return LagrangeCasadiError(
        f"machine '{machine.name}' stalls{cause}: from {begin.speed:.6g} rad/s at"
        f" {machine.equation.joint} = {begin.angle:.6g} rad it comes to rest at {stall.angle:.6g}"
        f" rad, after {stall.time:.6g} s; there the drive gives {drive:.6g} N m, and {need:.6g} N m"
        " resist; expected a drive with more torque, more inertia, or a higher speed at the start"
    )


def _turned(machine: Machine, begin: Start, span: float, accuracy: float) -> Turn | Stall:
    """Go round once; or the stall before the machine is round."""
    machine.begin(0.0, begin.angle)
    a, by = ROW["acceleration"], [ROW[f"by_{name}"] for name in ("speed", "drive", "inertia")]
    usual, inertia = begin.speed, _inertia(machine, begin)
    units = np.array([usual, inertia * usual**2, inertia])

    def rates(angle: float, y: Array) -> Array:
        speed, found = usual * y[_SPEED], np.full(8, np.nan)
        if not y[_SPEED] > 0.0:
            return found
        rows = machine.at(0.0, angle, speed)
        found[_SPEED], found[_TIME] = rows[a] / (speed * usual), 1.0 / y[_SPEED]
        found[_BY] = (rows[by[0]] - rows[a] / speed) / speed * y[_BY]
        found[_BY][1:] += rows[by[1:]] * units[1:] / (speed * usual)
        found[_TIME_BY] = -y[_BY] / y[_SPEED] ** 2
        return found

    state = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    events = [
        lambda angle, y: float(machine.at(0.0, angle, usual * y[_SPEED])[a]),
        terminal(lambda _angle, y: float(y[_SPEED]) - _SLOWEST),
        terminal(lambda angle, y: machine.margin(0.0, angle, usual * y[_SPEED])),
    ]
    # The third shows whether anything depends on the speed.
    sizes = np.array([_ZERO] * 3 + [_ROUGH] * 5)
    run = integrated(rates, (begin.angle, begin.angle + span), state, accuracy, sizes, events)
    angle, (speed, t) = float(run.t[-1]), run.y[:2, -1] * (usual, 1.0 / usual)
    if run.t_events[1].size:  # from there evenly slower
        slower = float(machine.at(0.0, angle, speed)[a])
        return Stall(begin, angle - speed**2 / (2.0 * slower), float(t - speed / slower))
    if run.status != 0:
        raise LagrangeCasadiError(
            f"machine '{machine.name}' has no steady cycle: {machine.obstacle(t, angle, speed)}"
        )
    extremes = np.concatenate([run.y[:, [0, -1]].T, np.reshape(run.y_events[0], (-1, state.size))])
    order = np.argsort(extremes[:, _SPEED])
    return Turn(begin, span, units, run.y[:, -1], extremes[order[0]], extremes[order[-1]])


def _inertia(machine: Machine, begin: Start) -> float:
    """The inertia of a machine where it begins [kg m^2], that of the flywheel too."""
    return float(machine.at(0.0, begin.angle, begin.speed)[ROW["inertia"]])


def swing(machine: Machine, begin: Start, span: float, accuracy: float) -> tuple[float, float]:
    """The largest swing of energy [J] of a machine that turns evenly, with an even torque beside
    that of its drive; and that torque [N m].

    Raises :class:`.LagrangeCasadiError` if it cannot turn evenly.
    """
    effort, load, drive = ROW["effort"], ROW["load"], ROW["drive"]
    inertia, added = _inertia(machine, begin), machine.added.copy()
    energy = _ZERO * inertia * begin.speed**2

    def over(mean: float) -> Array:
        def rates(angle: float, _y: Array) -> list[float]:
            rows = machine.at(0.0, angle, begin.speed)
            return [float(rows[effort] + rows[load] - rows[drive]) - mean]

        machine.begin(0.0, begin.angle)
        ends = begin.angle, begin.angle + span
        events = [lambda angle, y: rates(angle, y)[0]]
        run = integrated(rates, ends, np.zeros(1), accuracy, energy, events)
        if run.status != 0:
            raise LagrangeCasadiError(
                f"machine '{machine.name}': the torque at the constant speed"
                f" {begin.speed:.6g} rad/s is not finite over the whole turn"
            )
        return np.append(run.y[0, [-1, 0]], run.y_events[0])

    machine.added[:] = 0.0, _EVEN * inertia
    try:
        mean = float(over(0.0)[0]) / span
        return float(np.ptp(over(mean))), mean
    finally:
        machine.added[:] = added


def _check_repeats(machine: Machine, begin: Start, span: float) -> None:
    """Raise :class:`.DeclarationError` if the machine is another one after a cycle."""
    machine.begin(0.0, begin.angle)
    first, last = (
        machine.at(0.0, begin.angle + share * span, begin.speed).copy() for share in (0.0, 1.0)
    )
    energy, rate = _ZERO * first[ROW["kinetic"]], abs(begin.speed)
    torques = dict.fromkeys(("effort", "drive", "load"), energy)
    for name, size in (torques | {"taken": energy * rate, "inertia": energy / rate**2}).items():
        a, b = first[ROW[name]], last[ROW[name]]
        if not abs(a - b) <= _SAME * (abs(a) + abs(b) + size):
            raise DeclarationError(
                f"machine '{machine.name}' does not repeat after {abs(span):.6g} rad: its"
                f" {name} is {a:.6g} there and {b:.6g} here; expected cycle= the angle after which"
                " it does"
            )


def finished(
    scene: Scene,
    machine: Machine,
    turn: Turn,
    count: int,
    wanted: Outputs | None,
    accuracy: float,
) -> FreeMotion:
    """Follow a steady cycle in time, with all forces."""
    even = checked("count", (0.0, turn.period, count))
    motion = follow(scene, machine, turn.begin, even, wanted, accuracy)
    lost = [
        motion.solution.statistics(name).mean or 0.0
        for name in motion.solution.series
        if name.startswith("friction:") and name.endswith(":loss")
    ]
    gave, took, taken = (
        float(work[-1]) / turn.period
        for work in (motion.work_drive, motion.work_load, motion.work_taken)
    )
    least, largest = (turn.begin.speed * float(at[_SPEED]) for at in (turn.least, turn.largest))
    cycle = Cycle(
        *(turn.period, turn.speed, least, largest),
        *(float(machine.added[0]), gave, took, taken),
        lost=sum(lost),
    )
    return replace(motion, cycle=cycle)

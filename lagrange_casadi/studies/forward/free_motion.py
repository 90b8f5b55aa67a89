"""A machine left to itself: its motion under a drive's law, and all forces along it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base import lookups
from ...base.arguments import Measured, Outputs, public
from ...base.arrays import Array
from ...base.quantities import Output
from ...base.symbolic import symbolic
from ...base.units import quantity
from ...engine.derive import compile_scene
from ...errors import CertificateWarning, DeclarationError, LagrangeCasadiError, warn
from ...model.even_points import EvenPoints, points
from ...model.motion_laws import Motion
from ...model.scene import Scene
from ...results.solution import Solution
from ...results.verification.certificate import failure
from ..request import Request
from ..solving import solve
from .integration import integrated, terminal
from .machine import ROW, Event, Machine, Start

ACCURACY = 1e-12
"""Relative error of a step of integration."""

_MOST_EVALUATIONS, _LOOKED = 4_000_000, 200_000
"""Evaluations that a whole run may take; and after how many it is compared with its share of them.
"""

_ZERO = 0.1
"""Share of the pace at which a rate counts as zero, beside which its error is absolute."""

_LEAST = 1e-9
"""Share of the whole time by which a run must go on after a stop."""

_NOTHING = 1e-300
"""Rate that is zero."""

_RATES = [ROW[name] for name in ("acceleration", "drive", "load", "taken")]


@public
@dataclass(frozen=True)
class Cycle:
    """Numbers of a steady cycle of a machine.

    ``mean_speed`` is the cycle's angle over its ``period`` [s], ``least`` and ``largest`` are the
    smallest and the greatest speed [rad/s], between the instants too. ``torque`` [N m] is the
    constant one that keeps the mean speed where no drive was given, else zero. ``power`` [W] is the
    mean that the drive gives; the load takes ``load``, and the scene ``taken``, of which its
    frictions take ``lost``, by its instants.
    """

    period: float
    mean_speed: float
    least: float
    largest: float
    torque: float
    power: float
    load: float
    taken: float
    lost: float

    @property
    def fluctuation(self) -> float:
        """Coefficient of fluctuation: largest less least speed, over the mean speed."""
        return abs((self.largest - self.least) / self.mean_speed)


@public
@dataclass(frozen=True, eq=False, repr=False)
class FreeMotion:
    """The motion that a machine makes by itself, over its instants ``t`` [s].

    ``angle``, ``speed`` and ``acceleration`` are those of the drive's ``joint`` [rad or m, and per
    s and s^2], ``drive`` and ``load`` the torques of the laws [N m or N], and ``reflected`` is the
    inertia reflected to the drive, without the flywheel's [kg m^2 or kg], each (t,). Since the
    first instant the drive has done ``work_drive`` [J], the load has taken ``work_load``, and the
    scene's own loads, springs, weights and frictions ``work_taken``; ``kinetic`` is the kinetic
    energy [J], that of the flywheel's ``inertia`` [kg m^2 or kg] too. ``energy`` is what is missing
    in their balance, over the largest of them: a residual of the certificate of ``solution``, which
    has all forces. ``unit`` is that of the angle. ``scene`` is the scene with this motion.
    ``events`` are what happened on the way; ``ended`` is the one that ended the run early, or None.
    ``cycle`` has the numbers of a steady cycle, if one was asked for.
    """

    joint: str
    t: Array
    angle: Array
    speed: Array
    acceleration: Array
    drive: Array
    load: Array
    reflected: Array
    work_drive: Array
    work_load: Array
    work_taken: Array
    kinetic: Array
    energy: Array
    inertia: float
    events: tuple[Event, ...]
    scene: Scene
    solution: Solution
    unit: str
    cycle: Cycle | None = None

    def __repr__(self) -> str:
        return (
            f"<FreeMotion of {self.solution.case}: {self.t.size} instants from {self.t[0]:.5g} to"
            f" {self.t[-1]:.5g} s, speed from {self.speed.min():.5g} to {self.speed.max():.5g}>"
        )

    @property
    def ended(self) -> Event | None:
        """The event that ended the run before its time."""
        last = self.events[-1] if self.events else None
        return last if last is not None and last.kind != "rest" else None

    @property
    def resisting(self) -> Array:
        """Torque [N m] that the load and the scene's loads, springs, weights and frictions take at
        the speed of the machine, with what its varying inertia does, (t,): without the flywheel
        the drive needs as much to turn evenly.
        """
        return np.asarray(self.drive - (self.reflected + self.inertia) * self.acceleration)


def begun_at(machine: Machine, start: Sequence[Measured] | None, t: float) -> Start:
    """Return the state at the start: as given, or as the law of the scene has it."""
    if start is None:
        return Start(*machine.law(t))
    try:
        angle, speed = start
    except (TypeError, ValueError):
        raise DeclarationError(f"start: expected (coordinate, rate), got {start!r}") from None
    unit = "m" if machine.equation.slides else "rad"
    return Start(quantity("start", angle, unit), quantity("start", speed, f"{unit}/s"))


def follow(
    scene: Scene,
    machine: Machine,
    start: Start,
    even: EvenPoints,
    wanted: Outputs | None,
    accuracy: float,
) -> FreeMotion:
    """Integrate a machine over instants, and evaluate the scene along the motion found."""
    times = points(even)
    if times.size < 2:
        raise DeclarationError("t: a free machine needs two instants or more")
    machine.begin(float(times[0]), start.angle)
    y, events = _integrated(machine, start, times, accuracy)
    # An instant at which friction stops the machine has no friction of its own.
    stops = bool(events) and events[-1].kind == "held" and abs(y[1, -1]) < machine.slow
    times, y = (row[..., : y.shape[1] - stops] for row in (times, y))
    if times.size < 2:
        raise LagrangeCasadiError(
            f"free machine '{machine.name}': the run ended before the second instant: {events[-1]}"
        )
    machine.begin(float(times[0]), start.angle)
    posture = {**scene.posture, **_posture(scene, machine, float(times[0]), start)}
    ways = np.append(y[1, 1:], y[1, -1])  # at rest, where something depends on that, the next one
    rows = np.empty((len(ROW), times.size))
    for i, (now, angle, speed) in enumerate(zip(times, y[0], y[1], strict=True)):
        rows[:, i] = machine.at(now, angle, speed)[: len(ROW)]
        if not math.isfinite(rows[ROW["acceleration"], i]):
            rows[:, i] = machine.at(now, angle, math.copysign(machine.slow, ways[i]))[: len(ROW)]
    flywheel, inertia = float(machine.added[1]), np.abs(rows[ROW["inertia"]])
    kinetic = rows[ROW["kinetic"]] + flywheel * y[1] ** 2 / 2.0
    still = float(inertia.max()) * machine.slow**2
    largest = max(still, *(float(np.abs(energy).max()) for energy in (kinetic, *y[2:])))
    law = hermite(times, y[0], y[1], rows[ROW["acceleration"]])
    moved = replace(
        scene,
        motion={machine.equation.joint: law},
        t=(float(times[0]), float(times[-1]), times.size),
        over=None,
        posture=posture,
    )
    solution = solve(moved, Request(machine.values, None, None, None, wanted))
    found = FreeMotion(
        machine.equation.joint,
        times,
        *(y[0], y[1], rows[ROW["acceleration"]], rows[ROW["drive"]], rows[ROW["load"]]),
        *(rows[ROW["inertia"]] - flywheel, y[2], y[3], y[4]),
        kinetic=kinetic,
        energy=np.abs(kinetic - kinetic[0] - y[2] + y[3] + y[4]) / (largest or 1.0),
        inertia=flywheel,
        events=tuple(events),
        scene=moved,
        solution=solution,
        unit="m" if machine.equation.slides else "rad",
    )
    still = machine.slow * machine.pace / machine.size
    turning = inertia * np.maximum(np.abs(found.acceleration), still)
    return replace(found, solution=_certified(found, float(turning.max())))


def _certified(found: FreeMotion, turning: float) -> Solution:
    """The solution with the residuals of energy and of the drive's law in its certificate;
    ``turning`` is the largest torque of inertia [N m].
    """
    solution = found.solution
    residuals = {"energy": found.energy}
    effort = Output("effort", found.joint)
    if effort in solution.outputs:
        given = found.drive - found.load - found.inertia * found.acceleration
        torques = (given, found.drive, found.load)
        largest = max(turning, *(float(np.abs(x).max()) for x in torques))
        missing = np.abs(np.nan_to_num(solution.outputs[effort] - given))
        residuals["drive"] = missing / (largest or 1.0)
    solution = replace(solution, certificate={**solution.certificate, **residuals})
    if solution.failed and any(name in solution.failed for name in residuals):
        warn(f"{failure(solution)}; the solution is not certified", CertificateWarning)
    return solution


def _posture(scene: Scene, machine: Machine, t: float, start: Start) -> dict[str, float]:
    """Coordinates of the joints at the start, from which the loops are assembled there; none where
    it is that of the scene.
    """
    if start.angle == machine.law(t)[0]:
        return {}
    program, p = (
        compile_scene(scene, ["motion"], parameters=machine.values),
        np.array([*machine.values.values()]),
    )
    out = program.instant(t, start.angle, 0.0, 0.0, machine.z, p).full().ravel()
    found = {}
    for name, kind in program.data.at(p).coordinates.items():
        row = program.outputs.get(Output("motion", name))
        if row is not None and name != machine.equation.joint:
            value = float(out[row])
            found[name] = math.remainder(value, math.tau) if kind == "angle" else value
    return found


@symbolic
def hermite(t: Array, value: Array, rate: Array, acceleration: Array) -> Motion:
    """A motion with given values, rates and accelerations at given times, exact there: a polynomial
    of degree five between two of them, so that its acceleration is continuous.
    """
    h = np.diff(t)
    rise = value[1:] - value[:-1] - h * (rate[:-1] + h * acceleration[:-1] / 2.0)
    faster = rate[1:] - rate[:-1] - h * acceleration[:-1]
    change = acceleration[1:] - acceleration[:-1]
    coefficients = (
        value[:-1],
        rate[:-1],
        acceleration[:-1] / 2.0,
        (10.0 * rise - 4.0 * h * faster + h**2 * change / 2.0) / h**3,
        (-15.0 * rise + 7.0 * h * faster - h**2 * change) / h**4,
        (6.0 * rise - 3.0 * h * faster + h**2 * change / 2.0) / h**5,
    )

    cells = np.transpose(coefficients).tolist()
    return Motion(
        lambda time: lookups.pieces(t.tolist(), cells, time, ends=False),
        span=(float(t[0]), float(t[-1])),
        knots=tuple(t.tolist()),
        description=f"the motion of a free machine through {t.size} instants",
    )


def _integrated(
    machine: Machine, start: Start, times: Array, accuracy: float
) -> tuple[Array, list[Event]]:
    """States at the instants that are reached, (5, t): coordinate, rate, works of the drive, of the
    load and of the scene; and the events.

    The time is integrated as a share of the whole, and the coordinate from the start on. The
    scene's work may be nothing but rounding: its error is held by that of the kinetic energy.
    """
    begin, span = float(times[0]), float(times[-1] - times[0])
    machine.evaluations = 0
    first = machine.at(begin, start.angle, start.speed).copy()
    for name in ("drive", "load"):
        if not math.isfinite(first[ROW[name]]):
            raise LagrangeCasadiError(
                f"free machine '{machine.name}': the law of its {name} is not finite at the start,"
                f" at the rate {start.speed:g}; expected another start"
            )
    machine.let_go(begin, start, span)
    inertia = machine.at(begin, start.angle, start.speed or machine.slow)[ROW["inertia"]]
    kinetic, small = inertia * start.speed**2 / 2.0, _ZERO * machine.pace
    energy = abs(inertia) * small**2
    sizes = np.array([machine.size, small, energy, energy, math.inf, energy])
    share, state = 0.0, np.array([0.0, start.speed, 0.0, 0.0, 0.0, kinetic])
    shares = (times - begin) / span
    done, events, back = [state[:, None]], list[Event](), 0.0
    while share < 1.0:
        t, angle = begin + span * share, start.angle + float(state[0])
        way = math.copysign(1.0, state[1]) if state[1] else _first_way(machine, t, angle)
        course = _Course(machine, begin, span, start.angle, back or way)
        if course.margin(share, state) <= 0.0:
            events.append(machine.obstacle(*course.at(share, state)))
            break
        if course.way == 0.0:
            events.append(Event("held", t, angle, 0.0))
            break
        run = integrated(
            course.rates,
            (share, 1.0),
            state,
            accuracy,
            sizes,
            [terminal(course.rest, -course.way), terminal(course.margin)],
            t_eval=shares[shares > share],
            first_step=(1.0 - share) * 1e-6,
        )
        done.append(np.reshape(run.y, (state.size, -1)))  # SciPy's is a list where it is empty
        if run.status == 0:
            break
        (rests, blocks), (states, blocked) = run.t_events, run.y_events
        if run.status == -1 or blocks.size:
            at = course.at(float(blocks[0]), blocked[0]) if blocks.size else machine.last
            events.append(machine.obstacle(*at))
            break
        before, share, state = share, float(rests[0]), states[0] * (1.0, 0.0, 1.0, 1.0, 1.0, 1.0)
        if share - before >= _LEAST:
            back = 0.0
            events.append(Event("rest", *course.at(share, state)[:2], 0.0))
        elif not back:  # a torque may begin right after
            back = -course.way
        else:
            events.append(Event("held", *course.at(share, state)[:2], 0.0))
            break
    y = np.concatenate(done, axis=1)[:5]
    y[0] += start.angle
    return y, events


@dataclass(frozen=True, eq=False)
class _Course:
    """A machine that moves one ``way``, from an ``angle`` at the time ``begin`` [s] on for a time
    ``span`` [s], by the share of that time and the states of :func:`_integrated`.

    What depends on the way, as a friction, stays as it is up to where the machine is at rest and
    beyond, so that nothing jumps before rest is found.
    """

    machine: Machine
    begin: float
    span: float
    angle: float
    way: float

    def at(self, share: float, y: Array) -> tuple[float, float, float]:
        """Time, coordinate and rate, which is slow at rest."""
        t, angle, speed = self.begin + self.span * share, self.angle + float(y[0]), float(y[1])
        return t, angle, speed or self.way * self.machine.slow

    def rates(self, share: float, y: Array) -> Array:
        """Rates of the states."""
        machine, speed = self.machine, float(y[1])
        t, angle, _ = self.at(share, y)
        if machine.evaluations > max(_LOOKED, 2.0 * share * _MOST_EVALUATIONS):
            raise LagrangeCasadiError(
                f"free machine '{machine.name}': after {machine.evaluations} evaluations the run"
                f" has only reached t = {t:.6g} s, rate {speed:.6g}; the law of the drive or of a"
                " load is stiff, or switches back and forth, there, or the time is too long for the"
                " accuracy"
            )
        slow = self.way * speed < machine.slow
        rows = machine.at(t, angle, self.way * machine.slow if slow else speed)
        a, drive, load, taken = rows[_RATES]
        gives, takes = drive * speed, load * speed
        return self.span * np.array([speed, a, gives, takes, taken, gives - takes - taken])

    def rest(self, _share: float, y: Array) -> float:
        """A function that is zero at rest, and not of what is at rest and stays so."""
        return float(y[1]) + self.way * _NOTHING

    def margin(self, share: float, y: Array) -> float:
        """A function that is zero at a dead centre, and at a jam."""
        return self.machine.margin(*self.at(share, y))


def _first_way(machine: Machine, t: float, angle: float) -> float:
    """The way in which a machine at rest begins to move: 1 or -1, or 0 where friction holds it."""
    ahead, back = (
        float(machine.at(t, angle, way * machine.slow)[ROW["acceleration"]]) for way in (1.0, -1.0)
    )
    if ahead > 0.0 or ahead == back == 0.0:
        return 1.0
    return -1.0 if back < 0.0 else 0.0

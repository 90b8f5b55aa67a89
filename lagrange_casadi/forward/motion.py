"""A machine left to itself: its motion under a drive's law, and all forces along it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ..arguments import NotNegative, Outputs, public
from ..arithmetic import lookups
from ..base.arrays import Array
from ..base.packages import check_installed
from ..base.quantities import Output
from ..base.symbolic import symbolic
from ..case import Case, scene_of
from ..declare.even_points import EvenPoints, checked, points
from ..declare.motion import Motion
from ..declare.scene import Scene
from ..declare.times import even_of
from ..equations.derive import compiled_for
from ..errors import CertificateWarning, DeclarationError, LagrangeCasadiError, warn
from ..instants.solution import Solution
from ..studies.request import Request
from ..studies.solving import solve
from ..verification.certificate import failure, tolerance
from .laws import Law, law_of
from .machine import ROW, Machine

ACCURACY = 1e-12
"""Relative error of a step of integration."""

_MOST_EVALUATIONS, _MOST_STOPS = 4_000_000, 1000
_LEAST = 1e-9
"""Share of the whole time by which a run must go on after a stop."""

STATES = ("angle", "speed", "work_drive", "work_load", "work_taken")


@dataclass(frozen=True)
class Event:
    """What happens to a free machine at time ``t`` [s], at an ``angle`` [rad or m] and a ``speed``
    [rad/s or m/s]: it comes to ``rest`` and turns back or goes on, it is ``held`` at rest by
    friction, or it comes to a ``dead centre``. The last two end the run.
    """

    kind: str
    t: float
    angle: float
    speed: float

    def __str__(self) -> str:
        return f"{self.kind} at t = {self.t:.6g} s, coordinate {self.angle:.6g}"


@public
@dataclass(frozen=True, eq=False, repr=False)
class FreeMotion:
    """The motion that a machine makes by itself, over its instants ``t`` [s].

    ``angle``, ``speed`` and ``acceleration`` are those of the drive's ``joint`` [rad or m, and per
    s and s^2], ``drive`` and ``load`` the torques of the laws [N m or N], each (t,). Since the
    first instant the drive has done ``work_drive`` [J], the load has taken ``work_load``, and the
    scene's own loads, springs, weights and frictions ``work_taken``; ``kinetic`` is the kinetic
    energy [J], that of the flywheel's ``inertia`` [kg m^2 or kg] too. ``energy`` is what is missing
    in their balance, over the largest of them: a residual of the certificate of ``solution``, which
    has all forces. ``scene`` is the scene with this motion. ``events`` are what happened on the
    way; ``ended`` is the one that ended the run early, or None.
    """

    joint: str
    t: Array
    angle: Array
    speed: Array
    acceleration: Array
    drive: Array
    load: Array
    work_drive: Array
    work_load: Array
    work_taken: Array
    kinetic: Array
    inertia: float
    events: tuple[Event, ...]
    scene: Scene
    solution: Solution

    def __repr__(self) -> str:
        return (
            f"<FreeMotion of {self.solution.case}: {self.t.size} instants from {self.t[0]:.5g} to"
            f" {self.t[-1]:.5g} s, speed from {self.speed.min():.5g} to {self.speed.max():.5g}>"
        )

    @property
    def ended(self) -> Event | None:
        """The event that ended the run before its time."""
        last = self.events[-1] if self.events else None
        return last if last is not None and last.kind in ("held", "dead centre") else None

    @property
    def energy(self) -> Array:
        """Residual of the balance of energy, (t,)."""
        works = (self.work_drive, self.work_load, self.work_taken)
        missing = self.kinetic - self.kinetic[0] - works[0] + works[1] + works[2]
        largest = max(float(np.abs(energy).max()) for energy in (self.kinetic, *works))
        return np.asarray(np.abs(missing) / (largest or 1.0))


@dataclass(frozen=True)
class Start:
    """State in which a machine is let go: coordinate and rate of its drive."""

    angle: float
    speed: float


@public
def free(
    scene: Scene | Case,
    *,
    drive: Law | float | None = None,
    load: Law | float | None = None,
    inertia: NotNegative = 0.0,
    start: Sequence[float] | None = None,
    t: EvenPoints | None = None,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    accuracy: float = ACCURACY,
) -> FreeMotion:
    """Let a machine of one degree of freedom go: its motion, and all forces along it.

    Parameters
    ----------
    scene
        The scene, in which the motion of one joint is given. Its law says where the machine
        starts, unless ``start`` does, and no more.
    drive, load
        What drives the joint, and what resists on it beside the loads of the scene: laws of
        :mod:`.forward`, or constant torques [N m], forces [N] of a joint that slides. Default:
        none. The joint's effort is the drive's less the load's and what turns the flywheel.
    inertia
        Inertia of a flywheel, or of a motor's rotor, that turns with the joint and is no part of
        the scene [kg m^2; kg where it slides]. Its weight is on nothing.
    start
        Coordinate and rate of the joint at the start [rad and rad/s; m and m/s].
    t
        Start, stop and count of the instants [s]; default: the scene's.
    parameters, wanted
        As of :func:`.evaluate`.
    accuracy
        Relative error of a step of the integrator, 1e-13 to 1e-3.

    Returns
    -------
    FreeMotion
        The motion, the balance of energy, the events, and a :class:`.Solution`. It ends early where
        friction holds the machine, and at a dead centre.

    Raises
    ------
    DeclarationError
        For a scene of more than one degree of freedom, and for laws that are no expressions.
    LagrangeCasadiError
        Without SciPy; if a motor stalls or friction holds the machine before the second instant; if
        the motion cannot be followed, as where the drive's power is without bound at rest.
    """
    scene = scene_of(scene)
    values = scene.values(parameters)
    scene.checked(values)
    even = checked("t", even_of(scene.timing(), values) if t is None and scene.over is None else t)
    laws = law_of(drive, "drive"), law_of(load, "load")
    machine = Machine.of(scene, *laws, inertia, values)
    return follow(machine, begun_at(machine, start, even[0]), even, wanted, accuracy)


def begun_at(machine: Machine, start: Sequence[float] | None, t: float) -> Start:
    """Return the state at the start: as given, or as the law of the scene has it."""
    if start is None:
        found = machine.program.motion(t, list(machine.values.values()))
        return Start(float(found[0]), float(found[1]))
    try:
        angle, speed = (float(x) for x in start)
    except (TypeError, ValueError):
        raise DeclarationError(f"start: expected (coordinate, rate), got {start!r}") from None
    if not (math.isfinite(angle) and math.isfinite(speed)):
        raise DeclarationError(f"start: expected finite numbers, got {start!r}")
    return Start(angle, speed)


def follow(
    machine: Machine,
    start: Start,
    even: EvenPoints,
    wanted: Outputs | None,
    accuracy: float,
) -> FreeMotion:
    """Integrate a machine over instants, and evaluate the scene along the motion found."""
    check_installed("scipy", "a free machine", "free")
    if not 1e-13 <= accuracy <= 1e-3:
        raise DeclarationError(f"accuracy: expected a number from 1e-13 to 1e-3, got {accuracy!r}")
    times = points(even)
    if times.size < 2:
        raise DeclarationError("t: a free machine needs two instants or more")
    if not machine.begin(float(times[0]), start.angle):
        raise DeclarationError(
            f"start: the loops of '{machine.scene.name}' do not close at {start.angle:.6g}"
        )
    y, events = _integrated(machine, start, times, accuracy)
    times = times[: y.shape[1]]
    if times.size < 2:
        raise LagrangeCasadiError(
            f"free machine '{machine.scene.name}': {events[-1]}, before the second instant"
        )
    machine.begin(float(times[0]), start.angle)
    rows = np.array(
        [machine.at(now, *state).copy() for now, state in zip(times, y[:2].T, strict=True)]
    ).T
    flywheel = float(machine.added[1])
    law = hermite(times, y[0], y[1], rows[ROW["acceleration"]])
    moved = replace(
        machine.scene,
        motion={machine.joint: law},
        t=(float(times[0]), float(times[-1]), times.size),
        over=None,
        posture={**machine.scene.posture, **_posture(machine, float(times[0]), start)},
    )
    solution = solve(moved, Request(machine.values, None, None, None, wanted))
    found = FreeMotion(
        machine.joint,
        times,
        *(y[0], y[1], rows[ROW["acceleration"]], rows[ROW["drive"]], rows[ROW["load"]]),
        *(y[2], y[3], y[4]),
        kinetic=rows[ROW["kinetic"]] + flywheel * y[1] ** 2 / 2.0,
        inertia=flywheel,
        events=tuple(events),
        scene=moved,
        solution=solution,
    )
    return replace(found, solution=_certified(found))


def _certified(found: FreeMotion) -> Solution:
    """The solution with the residuals of energy and of the drive's law in its certificate."""
    solution = found.solution
    residuals = {"energy": found.energy}
    effort = Output("effort", found.joint)
    if effort in solution.outputs:
        given = found.drive - found.load - found.inertia * found.acceleration
        largest = max(
            float(np.nanmax(np.abs(x), initial=0.0))
            for x in (given, found.drive, found.load, solution.outputs[effort])
        )
        missing = np.abs(np.nan_to_num(solution.outputs[effort] - given))
        scale = max(largest, float(np.abs(found.kinetic).max()), 1e-300)
        residuals["drive"] = missing / scale
    solution = replace(solution, certificate={**solution.certificate, **residuals})
    if solution.failed and any(name in solution.failed for name in residuals):
        warn(f"{failure(solution)}; the solution is not certified", CertificateWarning)
    return solution


def _posture(machine: Machine, t: float, start: Start) -> dict[str, float]:
    """Coordinates of the joints at the start, from which the loops are assembled there."""
    program = compiled_for(machine.scene, ["motion"], machine.values)
    p = list(machine.values.values())
    z = machine.posture() if program.newton is not None else []
    machine.begin(t, start.angle)
    out = program.instant(t, start.angle, 0.0, 0.0, z, p).full().ravel()
    found = {
        output.part: float(out[row])
        for output, row in program.outputs.items()
        if output.group == "motion" and not output.member and np.isfinite(out[row])
    }
    kinds = machine.scene.mechanism.coordinates
    return {
        name: value if kinds[name][1].kind == "slide" else math.remainder(value, math.tau)
        for name, value in found.items()
        if name in kinds and name != machine.joint
    }


@symbolic
def hermite(t: Array, value: Array, rate: Array, acceleration: Array) -> Motion:
    """A motion with given values, rates and accelerations at given times, exact there: a polynomial
    of degree five between two of them, so that its acceleration is continuous.
    """
    h = np.diff(t)
    rise = value[1:] - value[:-1] - h * (rate[:-1] + h * acceleration[:-1] / 2.0)
    faster = rate[1:] - rate[:-1] - h * acceleration[:-1]
    change = acceleration[1:] - acceleration[:-1]
    cells = (
        value[:-1],
        rate[:-1],
        acceleration[:-1] / 2.0,
        (10.0 * rise - 4.0 * h * faster + h**2 * change / 2.0) / h**3,
        (-15.0 * rise + 7.0 * h * faster - h**2 * change) / h**4,
        (6.0 * rise - 3.0 * h * faster + h**2 * change / 2.0) / h**5,
    )

    def graph(time: Any) -> Any:
        if t.size == 2:
            u, c = time - t[0], [float(cell[0]) for cell in cells]
        else:
            number = lookups.cell(t.tolist(), time, ends=False)
            u = time - lookups.entries(t[:-1].tolist(), number)
            c = [lookups.entries(cell.tolist(), number) for cell in cells]
        found = ca.SX(c[-1])
        for coefficient in reversed(c[:-1]):
            found = found * u + coefficient
        return found

    return Motion(
        graph,
        span=(float(t[0]), float(t[-1])),
        knots=tuple(t.tolist()),
        description=f"the motion of a free machine through {t.size} instants",
    )


def _integrated(
    machine: Machine, start: Start, times: Array, accuracy: float
) -> tuple[Array, list[Event]]:
    """States (STATES, t) at the instants that are reached, and the events."""
    from scipy.integrate import solve_ivp

    first = machine.at(float(times[0]), start.angle, start.speed).copy()
    energy = abs(first[ROW["kinetic"]]) + machine.added[1] * start.speed**2 / 2.0
    energy = max(energy, *(abs(first[ROW[name]]) for name in ("drive", "load", "inertia")), 1e-12)
    scales = accuracy * np.array([1.0, max(abs(start.speed), 1.0), energy, energy, energy])
    state = np.array([start.angle, start.speed, 0.0, 0.0, 0.0])
    t, end, done, events = float(times[0]), float(times[-1]), list[Array](), list[Event]()
    done.append(state[:, None])
    for _ in range(_MOST_STOPS):
        machine.lean[0] = 0.0
        if machine.rubs and state[1] == 0.0:
            way = _breaks_loose(machine, t, float(state[0]))
            if way == 0.0:
                events.append(Event("held", t, float(state[0]), 0.0))
                break
            machine.lean[0] = way
        ahead = times[(times > t) & (times <= end)]
        run = solve_ivp(
            _rates(machine),
            (t, end),
            state,
            method="DOP853",
            rtol=max(accuracy, 2.3e-14),
            atol=scales,
            t_eval=ahead,
            events=_watched(machine),
            first_step=(end - t) * 1e-6,
        )
        if run.status == -1:
            last = (float(run.t[-1]), run.y[:, -1]) if run.t.size else (t, state)
            events.append(_why_lost(machine, *last))
            done.append(run.y)
            break
        done.append(run.y)
        rests, dead = run.t_events
        states = run.y_events[0]
        events += [
            Event("rest", float(when), float(at[0]), 0.0)
            for when, at in zip(rests, states, strict=True)
            if when > t
        ]
        if dead.size:
            at = run.y_events[1][0]
            events.append(Event("dead centre", float(dead[0]), float(at[0]), float(at[1])))
            break
        if run.status == 0:
            break
        if rests[0] - t < _LEAST * (end - times[0]):
            events.append(Event("held", float(rests[0]), float(states[0][0]), 0.0))
            break
        t, state = float(rests[0]), states[0].copy()
        state[1] = 0.0
    return np.concatenate([part for part in done if part.size], axis=1), events


def _rates(machine: Machine) -> Callable[[float, Array], list[float]]:
    """The right-hand side of :data:`STATES`."""
    a, drive, load, taken = (ROW[name] for name in ("acceleration", "drive", "load", "taken"))

    def rates(t: float, y: Array) -> list[float]:
        if machine.evaluations > _MOST_EVALUATIONS:
            raise LagrangeCasadiError(
                f"free machine '{machine.scene.name}': after {_MOST_EVALUATIONS} evaluations the"
                f" run is at t = {t:.6g} s alone; expected a shorter time or a coarser accuracy"
            )
        speed = float(y[1])
        rows = machine.at(t, float(y[0]), speed)
        return [speed, rows[a], rows[drive] * speed, rows[load] * speed, rows[taken]]

    return rates


def _watched(machine: Machine) -> list[Any]:
    """Functions of the state that are zero at rest, and at a dead centre."""

    def rest(_t: float, y: Array) -> float:
        return float(y[1])

    def dead(t: float, y: Array) -> float:
        margin = float(machine.at(t, float(y[0]), float(y[1]))[ROW["margin"]])
        return min(margin, 2.0) - 1.0 if math.isfinite(margin) else 1.0

    rest.terminal, dead.terminal = machine.rubs, True  # type: ignore[attr-defined]
    return [rest, dead]


def _breaks_loose(machine: Machine, t: float, angle: float) -> float:
    """The way in which a machine at rest begins to move against its friction: 1 or -1, or 0 where
    friction holds it.
    """
    for way in (1.0, -1.0):
        machine.lean[0] = way
        a = float(machine.at(t, angle, 0.0)[ROW["acceleration"]])
        if math.isfinite(a) and a * way > 0.0:
            return way
    return 0.0


def _why_lost(machine: Machine, t: float, y: Array) -> Event:
    """The event at which the integrator can go no further.

    Raises :class:`.LagrangeCasadiError` where it is no dead centre.
    """
    rows = machine.at(t, float(y[0]), float(y[1]))
    margin = rows[ROW["margin"]]
    if not np.isfinite(margin) or margin < _NEAR_DEAD:
        return Event("dead centre", t, float(y[0]), float(y[1]))
    raise LagrangeCasadiError(
        f"free machine '{machine.scene.name}': its motion cannot be followed beyond t = {t:.6g} s,"
        f" coordinate {y[0]:.6g}, rate {y[1]:.6g}: acceleration {rows[ROW['acceleration']]:.3g},"
        f" drive {rows[ROW['drive']]:.3g}; a law is without bound or jumps back and forth there"
    )


_NEAR_DEAD = 1e6
"""Margin below which a run that cannot go on is at a dead centre."""



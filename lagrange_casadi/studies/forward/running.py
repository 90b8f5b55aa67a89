"""A machine left to itself, for users: its motion, its steady cycle, and its flywheel."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from ...base.arguments import Angle, Count, Measured, Outputs, Positive, public
from ...base.units import Within, quantity
from ...engine.free_equation import free_equation
from ...errors import DeclarationError
from ...model.scene import Scene
from ...model.times import Times, even_of
from ...model.torques import Law, law_of
from ..case import Case, scene_of
from .cycle import Goal, finished, sought, swing
from .free_motion import ACCURACY, FreeMotion, begun_at, follow
from .machine import Machine, Start

_EVEN = 1e-4
"""Fluctuation of the machine whose speed is the first guess of that with a flywheel."""


@public
@dataclass(frozen=True, eq=False, repr=False)
class Flywheel:
    """A flywheel on the drive that keeps a coefficient of fluctuation of speed.

    ``inertia`` [kg m^2] is exact: with it the steady cycle ``motion``, in which the machine's own
    inertia varies and the drive follows the speed, has that fluctuation. ``textbook`` is the
    inertia by the energy method, ``energy``/(fluctuation speed^2): the largest swing of ``energy``
    [J] of the machine that turns evenly, at the mean speed, under the torque that its drive has
    there and an even one beside it (Norton, *Design of Machinery*; Shigley, *Mechanical Engineering
    Design*: flywheels).
    """

    inertia: float
    textbook: float
    energy: float
    motion: FreeMotion

    def __repr__(self) -> str:
        return (
            f"<Flywheel of {self.inertia:.6g} kg m^2, by the energy method {self.textbook:.6g}"
            " kg m^2>"
        )


@public
def free(
    scene: Scene | Case,
    *,
    drive: Law | Measured | None = None,
    load: Law | Measured | None = None,
    inertia: Measured = 0.0,
    start: Sequence[Measured] | None = None,
    t: Times | None = None,
    steady: bool = False,
    cycle: Angle = math.tau,
    count: Count = 721,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    accuracy: Annotated[float, Within(1e-13, 1e-3)] = ACCURACY,
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
        none; of a steady cycle the drive is the constant torque that keeps the mean speed of
        ``start``.
    inertia
        Inertia of a flywheel, or of a motor's rotor, that turns with the joint and is no part of
        the scene [kg m^2; kg where it slides]. It has no weight.
    start
        Coordinate and rate of the joint at the start [rad and rad/s; m and m/s]; of a steady cycle
        where it begins, and a guess of the speed.
    t
        As of :func:`.studies.evaluate.evaluate`.

        Start, stop and count.
    steady
        Find the steady cycle, and compute one period of it.

        It has ``count`` instants.
    cycle
        Angle after which the machine repeats [rad]: one turn, or two for a four-stroke engine.
    count
        Set the number of instants of a steady cycle.

        They are in even steps of time, first and last included.
    parameters, wanted
        As of :func:`.studies.evaluate.evaluate`.
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
        For a scene of more than one degree of freedom, and for laws that are no expressions. Of a
        steady cycle for a drive that slides, for laws or loads of the time, and where the machine
        does not repeat.
    LagrangeCasadiError
        Without SciPy; if friction holds the machine before the second instant; if the motion
        cannot be followed, as where the drive's power is without bound at rest. Of a steady cycle
        where the machine stalls, and where nothing depends on the speed.
    """
    scene = scene_of(scene)
    machine = _machine(scene, drive, load, inertia, parameters, accuracy)
    if steady:
        if t is not None:
            raise DeclarationError(
                "t and steady exclude each other; give count=, the instants of a cycle"
            )
        begin = _turning(machine, start)
        goal = Goal(math.copysign(cycle, begin.speed), None if drive is not None else begin.speed)
        turn = sought(machine, begin, goal, accuracy)
        return finished(scene, machine, turn, count, wanted, accuracy)
    even = even_of(scene.timing(scene.t if t is None else t), machine.values)
    return follow(scene, machine, begun_at(machine, start, even[0]), even, wanted, accuracy)


@public
def flywheel(
    scene: Scene | Case,
    *,
    fluctuation: Positive = 0.02,
    drive: Law | Measured | None = None,
    load: Law | Measured | None = None,
    start: Sequence[Measured] | None = None,
    cycle: Angle = math.tau,
    count: Count = 721,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    accuracy: Annotated[float, Within(1e-13, 1e-3)] = ACCURACY,
) -> Flywheel:
    """Find the inertia of a flywheel on the drive that keeps a coefficient of fluctuation.

    Parameters
    ----------
    fluctuation
        Largest less least speed over the mean speed.
    scene, drive, load, start, cycle, count, parameters, wanted, accuracy
        As of the steady cycle of :func:`free`.

    Returns
    -------
    Flywheel
        The inertia by the exact cycle, and by the energy method.

    Raises
    ------
    DeclarationError, LagrangeCasadiError
        As :func:`free`; where the machine fluctuates less without a flywheel.
    """
    scene = scene_of(scene)
    machine = _machine(scene, drive, load, 0.0, parameters, accuracy)
    begin = _turning(machine, start)
    span, mean = math.copysign(cycle, begin.speed), None if drive is not None else begin.speed
    energy, _ = swing(machine, begin, span, accuracy)
    if mean is None:  # the speed at which the motor turns a machine that is nearly even
        machine.added[1] = energy / (_EVEN * begin.speed**2)
        begin = sought(machine, begin, Goal(span), accuracy).begin
        energy, _ = swing(machine, begin, span, accuracy)
    machine.added[1] = energy / (fluctuation * begin.speed**2)
    turn = sought(machine, begin, Goal(span, mean, fluctuation), accuracy)
    motion = finished(scene, machine, turn, count, wanted, accuracy)
    energy, _ = swing(machine, Start(begin.angle, turn.speed), span, accuracy)
    return Flywheel(motion.inertia, energy / (fluctuation * turn.speed**2), energy, motion)


def _machine(
    scene: Scene,
    drive: Law | Measured | None,
    load: Law | Measured | None,
    inertia: Measured,
    parameters: Mapping[str, float] | None,
    accuracy: float,
) -> Machine:
    values = scene.values(parameters)
    scene.checked(values)
    equation = free_equation(scene, law_of(drive, "drive"), law_of(load, "load"), values)
    added = quantity("inertia", inertia, "kg" if equation.slides else "kg m^2")
    if added < 0.0:
        raise DeclarationError(f"inertia: expected a number of at least 0, got {added:g}")
    return Machine.of(equation, added, values)


def _turning(machine: Machine, start: Sequence[Measured] | None) -> Start:
    """The state at which a steady cycle begins.

    Raises :class:`.DeclarationError` for a machine that cannot have one.
    """
    equation = machine.equation
    if equation.slides:
        raise DeclarationError(
            f"a steady cycle needs a drive that turns, and '{equation.joint}' slides"
        )
    if equation.timed:
        raise DeclarationError(
            f"machine '{machine.name}' has no steady cycle, because a law or load depends on the"
            " time; expected laws of coordinates and rates"
        )
    begin = begun_at(machine, start, equation.program.data.span[0])
    if begin.speed == 0.0:
        raise DeclarationError(
            "a steady cycle: the speed at the start is 0; expected start=(angle, speed) with a"
            " guess of the speed"
        )
    machine.pace = abs(begin.speed)
    return begin

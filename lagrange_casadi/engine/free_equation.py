"""The equation of motion of a machine with one degree of freedom, from the effort that its drive
needs.

The effort for a given motion of the drive's coordinate is tau(phi, w, a): a row of the Program's
instant. A machine whose motion is not given has the acceleration a for which

    tau(phi, w, a) + J a = drive(t, phi, w) - load(t, phi, w),

with J the inertia of a flywheel on the drive. If no friction depends on reactions, tau is affine in
a, which its graph shows, and one division solves the equation; otherwise Newton's method does.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from ..base.quantities import Output
from ..base.scalars import graph
from ..base.symbolic import Graphs, symbolic
from ..base.tables import FORCE, MOMENT
from ..errors import DeclarationError
from ..model.loads import Friction
from ..model.scene import Scene
from ..model.torques import Law, torque_of
from .derive import compile_scene
from .friction import SLIP
from .program import Program
from .reflected_inertia import reflected_inertia

STEPS = 8
"""Newton's steps for the acceleration where friction follows reactions: the effort is piecewise
smooth in it, and frictions change but a part of the inertia's torque.
"""

COLUMNS = (
    *("acceleration", "effort", "drive", "load", "taken", "kinetic", "inertia", "by_speed"),
    *("by_drive", "by_inertia", "sine"),
)
"""Rows of the function of a state. The ``effort`` [N m] is the Program's at the acceleration that
was found; ``taken`` is the power [W] that the scene's own loads, springs, weights and frictions
take, ``kinetic`` the kinetic energy [J] without the flywheel's; ``inertia`` is the torque by the
acceleration, the flywheel's too. ``by_speed``, ``by_drive`` and ``by_inertia`` are derivatives of
the acceleration by the speed, by an added torque and by the flywheel's inertia. ``sine`` is the
least of all loops' sines of the transmission angle.
"""

_JAMMED = SLIP["double"] / 2.0
"""Residual of friction's laws at a jam."""


@dataclass(frozen=True, eq=False)
class FreeEquation(Graphs):
    """The equation of motion of a machine: ``state(t, angle, speed, z, added, p)``, a row for
    each of :data:`COLUMNS` and a margin from a jam for each of ``jams``, joints whose frictions
    depend on each other; and ``loops(z, t, angle, p)``, Newton's correction of z and its size.

    ``added`` are a torque and the flywheel's inertia on the drive's ``joint``. ``timed`` says
    whether anything depends on the time, ``slides`` whether the coordinate is a length.
    """

    program: Program
    joint: str
    state: ca.Function
    loops: ca.Function | None
    jams: tuple[str, ...]
    timed: bool
    slides: bool


@symbolic
def free_equation(scene: Scene, drive: Law, load: Law, values: Mapping[str, float]) -> FreeEquation:
    """Derive the equation of motion of a scene's one degree of freedom, for values of all
    parameters.

    Raises :class:`.DeclarationError` for a scene of more degrees of freedom, and as
    :func:`.compile_scene` does.
    """
    joint = one_drive(scene)
    program = compile_scene(scene, ["effort"], parameters=values)
    t, d, rate, acceleration, z, p = program.instant.sx_in()
    symbols = scene.mechanism.symbols
    slides = scene.mechanism.coordinates[joint][1].kind == "slide"
    unit = FORCE if slides else MOMENT
    pushed, resisting = (
        ca.substitute(
            torque_of(law, f"{what}= of the free machine", (t, d, rate), symbols, unit), symbols, p
        )
        for what, law in (("drive", drive), ("load", load))
    )
    added = ca.SX.sym("added", 2)
    out = program.instant(t, d, rate, acceleration, z, p)
    effort = out[program.outputs[Output("effort", joint)]]
    missing = pushed + added[0] - resisting - effort - added[1] * acceleration
    slope = ca.jacobian(missing, acceleration)
    affine = not ca.depends_on(slope, acceleration)
    inputs = [acceleration, t, d, rate, z, added, p]
    newton = ca.Function("newton", inputs, [missing, slope])
    there = ca.Function(
        "there",
        inputs,
        [effort, slope, ca.jacobian(missing, rate), _sine(program, out), _margins(program, out)],
    )
    found = ca.SX(0)
    for _ in range(1 if affine else STEPS):
        gap, by = newton(found, *inputs[1:])
        found = found - gap / by
    reached, by, by_rate, sine, margins = there(found, *inputs[1:])
    inertia, change = _inertia(scene, program, values)
    taken = (reached - inertia * found - change * rate**2 / 2.0) * rate
    rows = [found, reached, pushed + added[0], resisting, taken, inertia * rate**2 / 2.0, -by]
    rows += [-by_rate / by, -1.0 / by, found / by, sine, margins]
    all_rows = ca.vertcat(*rows)
    given = {"t": t, "angle": d, "speed": rate, "z": z, "added": added, "p": p}
    state = graph("state", given, out=all_rows)
    timed = bool(ca.depends_on(all_rows, t))
    jams = tuple(_joints(scene, names) for names in program.checks("jam"))
    return FreeEquation(program, joint, state, _loops(program), jams, timed, slides)


def one_drive(scene: Scene) -> str:
    """Return the joint whose motion is the machine's one degree of freedom, and whose effort is the
    drive's.

    Raises :class:`.DeclarationError` for any other scene.
    """
    driven = tuple(scene.laws)
    if len(driven) != 1:
        raise DeclarationError(
            f"a free machine has one degree of freedom, but in '{scene.name}' {len(driven)} motions"
            f" are given: {', '.join(driven) or 'none'}; expected one"
        )
    if scene.mechanism.rows:
        raise DeclarationError(
            f"a free machine: non-holonomic constraints of '{scene.name}' are out of scope:"
            f" {', '.join(scene.mechanism.rows)}"
        )
    if scene.weights is not None and tuple(scene.weights) != driven:
        raise DeclarationError(
            f"a free machine is driven at the joint whose motion is given, '{driven[0]}', but"
            f" drives= names {', '.join(scene.weights)}"
        )
    return driven[0]


def _inertia(scene: Scene, program: Program, values: Mapping[str, float]) -> tuple[ca.SX, ca.SX]:
    """The inertia of all that moves, and its change with the coordinate: from the graph of kinetic
    energy, not from the effort's.
    """
    inertia = reflected_inertia(scene, values).program.instant
    t, d, rate, acceleration, z, p = program.instant.sx_in()
    moved = inertia(t, d, rate, acceleration, z, p)[0]
    by_angle = ca.jacobian(moved, d)
    if program.newton is not None:
        correction, _ = program.newton.step.call([z, t, d, p])
        by_angle += ca.jacobian(moved, z) @ ca.jacobian(correction, d)
    return moved, by_angle


def _loops(program: Program) -> ca.Function | None:
    if program.newton is None:
        return None
    inputs = program.newton.step.sx_in()
    step = ca.vertcat(*program.newton.step.call(inputs))
    return ca.Function("loops", inputs, [step], ["z", "t", "angle", "p"], ["step"])


def _sine(program: Program, out: ca.SX) -> ca.SX:
    """The least of the loops' sines: a closed form has its square, an iterated loop a volume."""
    found = ca.SX(1.0)
    for name, k in program.checks("closure").items():
        found = ca.fmin(found, ca.fabs(out[k]) if program.iterates(name) else ca.sqrt(out[k]))
    return found


def _margins(program: Program, out: ca.SX) -> ca.SX:
    """Distances from a jam, a row for each block of frictions that depend on each other: the least
    pivot (:mod:`.friction`), or less if the residual of their laws is too large.
    """
    slips = program.checks("slip")
    margins = [
        ca.fmin(out[k], 1.0 - out[slips[names]] / _JAMMED)
        for names, k in program.checks("jam").items()
    ]
    return ca.densify(ca.vertcat(ca.SX(0, 1), *margins))


def _joints(scene: Scene, frictions: str) -> str:
    """The joints of frictions, in words, by the names of these."""
    loads = scene.mechanism.loads
    found = {name: loads.get(name) for name in frictions.split(", ")}
    return ", ".join(
        f"'{load.joint.name if isinstance(load, Friction) else name}'"
        for name, load in found.items()
    )

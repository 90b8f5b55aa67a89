"""The equation of motion of a machine with one degree of freedom, from the effort that its drive
needs.

The effort that moves the drive's coordinate as told is tau(phi, w, a): the package's own function
of an instant. A machine left to itself goes with the acceleration a at which

    tau(phi, w, a) + J a = drive(t, phi, w) - load(t, phi, w),

J the inertia of a flywheel on the drive. Where nothing rubs under what presses on it tau is affine
in a, which the graph itself shows, and one division solves it; else Newton's method does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.symbolic import symbolic
from ..codegen import find_compiler, load_batch
from ..codegen.emit import newton_rule
from ..declare.scene import Scene
from ..equations.checks import Check
from ..equations.derive import compiled_for
from ..equations.program import Program
from ..equations.reflected_inertia import reflected_inertia
from ..errors import DeclarationError
from ..instants.backends import begun
from ..instants.rules import dead_centre
from .laws import Law

STEPS = 8
"""Newton's steps for the acceleration where friction follows reactions: the law is piecewise
smooth, and each friction changes but a part of itself."""

COLUMNS = (
    *("acceleration", "effort", "drive", "load", "taken", "kinetic", "by_speed", "by_drive"),
    *("by_inertia", "inertia", "margin"),
)
"""Rows of the function of a state. The effort [N m] is the package's, at the acceleration that was
found; ``taken`` is the power [W] that the scene's own loads, springs, weights and frictions take,
``kinetic`` the kinetic energy [J] without the flywheel's; ``by_...`` are derivatives of the
acceleration by the speed, by an added torque, by the flywheel's inertia; ``inertia`` is the
effort's slope over the acceleration; and ``margin`` is how far the nearest loop is from a dead
centre: at one it is no more than 1.
"""
ROW = {name: k for k, name in enumerate(COLUMNS)}

_GIVEN = ("t", "angle", "speed", "z", "added", "lean", "p")
_CLOSER = 8
"""A few steps more for a loop that is followed from far."""


@dataclass(eq=False)
class _Compiled:
    """A function at one point, compiled where there is a compiler: arguments are written into
    ``given``, and stay.
    """

    function: ca.Function
    given: dict[str, Array]
    found: Array
    _call: Any = None
    _entry: Any = None

    @classmethod
    def of(cls, function: ca.Function) -> _Compiled:
        given = {
            function.name_in(k): np.zeros(function.numel_in(k)) for k in range(function.n_in())
        }
        made = cls(function, given, np.zeros(function.numel_out(0)))
        if (compiler := find_compiler("c")) is not None:
            library = load_batch(function, compiler)
            made._entry = library.entry
            made._call = library.call.made(
                n=1,
                **{name: array.ctypes.data for name, array in given.items()},
                **{f"{name}_every": 0 for name in given},
                found=made.found.ctypes.data,
            )
        return made

    def __call__(self) -> Array:
        """Evaluate it; the result is overwritten by the next call."""
        if self._entry is None:
            self.found[:] = self.function(*self.given.values()).full().ravel()
        else:
            self._entry(self._call)
        return self.found


@dataclass(eq=False)
class Machine:
    """A machine with one degree of freedom, ready to be evaluated at any state.

    ``lean`` is the way in which the machine begins to move where it is at rest and something rubs:
    1, -1, or 0 where it moves. ``added`` are a torque [N m] and a flywheel's inertia [kg m^2] on
    the drive. ``timed`` tells whether anything depends on the time, ``rubs`` whether friction holds
    it at rest.
    """

    scene: Scene
    program: Program
    joint: str
    values: Mapping[str, float]
    state: _Compiled
    loops: _Compiled | None
    timed: bool
    affine: bool
    rubs: bool
    evaluations: int = 0
    _z: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    @symbolic
    def of(
        cls, scene: Scene, drive: Law, load: Law, inertia: float, values: Mapping[str, float]
    ) -> Machine:
        """Derive and compile it.

        Raises :class:`.DeclarationError` for a scene of another number of degrees of freedom, and
        as :func:`.compile_scene` does.
        """
        joint = one_drive(scene)
        program = compiled_for(scene, ["effort"], values)
        function, timed, affine = _state(scene, program, joint, drive, load, values)
        loops = None
        if program.newton is not None:
            step = program.newton.step
            z, t, d, p = step.sx_in()
            both = ca.vertcat(*step.call([z, t, d, p]))
            loops = _Compiled.of(
                ca.Function("loops", [z, t, d, p], [both], ["z", "t", "angle", "p"], ["step"])
            )
        made = cls(
            *(scene, program, joint, values, _Compiled.of(function), loops, timed, affine),
            rubs=bool(program.checks("rest")),
        )
        p = np.array(list(values.values()))
        for one in (made.state, made.loops):
            if one is not None:
                one.given["p"][:] = p
        made.state.given["added"][1] = inertia
        made._z = np.array(begun(program, program.data.span[0], p))
        return made

    @property
    def added(self) -> Array:
        """Torque and inertia on the drive, to be set."""
        return self.state.given["added"]

    @property
    def lean(self) -> Array:
        """Way in which it begins to move, to be set."""
        return self.state.given["lean"]

    def begin(self, t: float, angle: float) -> bool:
        """Follow the loops from the scene's own start to an angle; return whether they close."""
        first = float(self.program.motion(self.program.data.span[0], list(self.values.values()))[0])
        steps = 1 + int(abs(angle - first) / 0.05)
        return all(self._close(t, x) for x in np.linspace(first, angle, steps + 1)[1:])

    def at(self, t: float, angle: float, speed: float) -> Array:
        """Rows :data:`COLUMNS` of a state; no number where loops do not close there."""
        self.evaluations += 1
        given = self.state.given
        given["t"][0], given["angle"][0], given["speed"][0] = t, angle, speed
        if not self._close(t, angle):
            return np.full(len(COLUMNS), np.nan)
        given["z"][:] = self._z
        return self.state()

    def posture(self) -> npt.NDArray[np.float64]:
        """The coordinates of iterated loops where it was evaluated last."""
        return self._z.copy()

    def _close(self, t: float, angle: float) -> bool:
        if self.loops is None:
            return True
        rule, given, z = newton_rule("double", None), self.loops.given, self._z.copy()
        given["t"][0], given["angle"][0] = t, angle
        for _ in range(_CLOSER + int(rule["steps"])):
            given["z"][:] = z
            *correction, size = self.loops().tolist()
            if not np.isfinite(size):
                return False
            z += correction
            if size < rule["done"]:
                self._z = z
                return True
        return False


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
            f"a free machine is driven where its motion is, at '{driven[0]}', but drives= names"
            f" {', '.join(scene.weights)}"
        )
    if driven[0] not in scene.mechanism.coordinates:
        raise DeclarationError(f"a free machine: '{driven[0]}' is a guided point, not a joint")
    return driven[0]


def _state(
    scene: Scene,
    program: Program,
    joint: str,
    drive: Law,
    load: Law,
    values: Mapping[str, float],
) -> tuple[ca.Function, bool, bool]:
    """The function of a state, whether it depends on the time, and whether the effort is affine in
    the acceleration.
    """
    t, d, rate, acceleration, z, p = program.instant.sx_in()
    added, lean = ca.SX.sym("added", 2), ca.SX.sym("lean")
    arguments = (t, d, rate)
    torques = [
        law.of(f"{what}= of the free machine", arguments, scene.mechanism.symbols)
        for what, law in (("drive", drive), ("load", load))
    ]
    pushed, resisting = (
        ca.substitute(torque, scene.mechanism.symbols, p) if p.numel() else torque
        for torque in torques
    )
    out = program.instant(*(t, d, rate, acceleration, z, p))
    effort = out[program.outputs[Output("effort", joint)]]
    missing = pushed + added[0] - resisting - effort - added[1] * acceleration
    slope = ca.jacobian(missing, acceleration)
    affine = not ca.depends_on(slope, acceleration)
    newton = ca.Function("newton", [acceleration, *_before(program, added)], [missing, slope])
    found = lean
    for _ in range(1 if affine else STEPS):
        gap, by = newton(found, *_before(program, added))
        found = found - gap / by
    there = {"acceleration": found}
    values_there = ca.Function(
        "there",
        [acceleration, *_before(program, added)],
        [effort, slope, ca.jacobian(missing, rate), _margin(program, out)],
    )
    reached, by, by_rate, margin = values_there(found, *_before(program, added))
    inertia, change = _inertia(scene, program, values)
    inertial = (inertia * found + change * rate**2 / 2.0) * rate
    there |= {
        "effort": reached,
        "drive": pushed + added[0],
        "load": resisting,
        "taken": reached * rate - inertial,
        "kinetic": inertia * rate**2 / 2.0,
        "by_speed": -by_rate / by,
        "by_drive": -1.0 / by,
        "by_inertia": found / by,
        "inertia": -by,
        "margin": margin,
    }
    rows = ca.densify(ca.vertcat(*(there[name] for name in COLUMNS)))
    inputs = [t, d, rate, z, added, lean, p]
    timed = bool(ca.depends_on(rows, t))
    return ca.Function("state", inputs, [rows], list(_GIVEN), ["out"], {"cse": True}), timed, affine


def _before(program: Program, added: ca.SX) -> Sequence[ca.SX]:
    t, d, rate, _, z, p = program.instant.sx_in()
    return t, d, rate, z, added, p


def _inertia(
    scene: Scene, program: Program, values: Mapping[str, float]
) -> tuple[ca.SX, ca.SX]:
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


def _margin(program: Program, out: ca.SX) -> ca.SX:
    """The least of all loops' branch indicators over what is a dead centre."""
    found = ca.SX(np.inf)
    for k, check in enumerate(program.columns):
        if isinstance(check, Check) and check.kind in ("closure", "hold"):
            limit = dead_centre(program, "double", str(check.part)) * 1e6
            found = ca.fmin(found, ca.fabs(out[k]) / limit)
    return found

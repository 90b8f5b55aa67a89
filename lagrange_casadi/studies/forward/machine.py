"""The equation of motion of a machine, compiled: evaluated at one state after another."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...engine.codegen import find_compiler, load_batch
from ...engine.codegen.emit import newton_rule
from ...engine.free_equation import COLUMNS, FreeEquation
from ...engine.instants.backends import begun
from ...errors import DeclarationError, LagrangeCasadiError

ROW = {name: k for k, name in enumerate(COLUMNS)}

_APART = 0.05
"""Steps by which loops are followed to a start, in rad or shares of the extent."""

_SLOW, _SLIGHT = 1e-9, 1e-5
"""Share of the pace at which a machine is nearly at rest; and share of its size by which it hardly
moves in the whole time.
"""

_DEAD, _NEAR = 1e-4, 0.05
"""Sine of a loop's transmission angle at which the loop is at a dead centre; and that, or margin
from a jam, below which a run that cannot go on is at one.
"""


@dataclass(frozen=True)
class Event:
    """An event of a free machine at time ``t`` [s], at an ``angle`` [rad or m] and a ``speed``
    [rad/s or m/s]: it is at ``rest``, and turns back or goes on; it is ``held`` at rest, or at a
    ``dead centre``, or friction in ``joints`` makes it ``jam``, each of which ends the run.
    """

    kind: str
    t: float
    angle: float
    speed: float
    joints: str = ""

    def __str__(self) -> str:
        where = f" of {self.joints}" if self.joints else ""
        return f"{self.kind}{where} at t = {self.t:.6g} s, coordinate {self.angle:.6g}"


@dataclass(frozen=True)
class Start:
    """State in which a machine is let go: coordinate and rate of its drive."""

    angle: float
    speed: float


@dataclass(frozen=True, eq=False)
class _Compiled:
    """A function at one point, compiled where there is a compiler: arguments are written into
    ``given``, and stay.
    """

    given: dict[str, Array]
    found: Array
    evaluate: Callable[[], None]

    @classmethod
    def of(cls, function: ca.Function) -> _Compiled:
        given = {
            function.name_in(k): np.zeros(function.numel_in(k)) for k in range(function.n_in())
        }
        found, compiler = np.zeros(function.numel_out(0)), find_compiler("c")
        if compiler is not None:
            library = load_batch(function, compiler)
            return cls(given, found, library.bound(1, given, dict.fromkeys(given, 0), found))

        def interpreted() -> None:
            found[:] = function(*given.values()).full().ravel()

        return cls(given, found, interpreted)

    def __call__(self) -> Array:
        """Evaluate it; the result is overwritten by the next call."""
        self.evaluate()
        return self.found


@dataclass(eq=False)
class Machine:
    """A machine with one degree of freedom, ready to be evaluated at any state, with ``values`` of
    all parameters.

    ``z`` are the coordinates of iterated loops where it was evaluated last, ``evaluations`` how
    often it was, and ``last`` the last time, coordinate and rate at which it was finite. Its
    ``pace`` is a rate [rad/s or m/s] beside which rates are large or small.
    """

    equation: FreeEquation
    values: Mapping[str, float]
    state: _Compiled
    loops: _Compiled | None
    z: Array
    pace: float = 1.0
    evaluations: int = 0
    last: tuple[float, float, float] = (math.nan, math.nan, math.nan)

    @classmethod
    def of(cls, equation: FreeEquation, inertia: float, values: Mapping[str, float]) -> Machine:
        """Compile an equation of motion, with the ``inertia`` of a flywheel."""
        p, program = np.array(list(values.values())), equation.program
        state = _Compiled.of(equation.state)
        loops = None if equation.loops is None else _Compiled.of(equation.loops)
        for one in (state, loops):
            if one is not None:
                one.given["p"][:] = p
        state.given["added"][1] = inertia
        z = np.array(begun(program, program.data.span[0], tuple(p.tolist())))
        return cls(equation, values, state, loops, z)

    @property
    def name(self) -> str:
        """The mechanism's name, for messages."""
        return self.equation.program.data.name

    @property
    def size(self) -> float:
        """A coordinate that is neither large nor small: one rad, or the mechanism's extent [m]."""
        equation = self.equation
        return equation.program.extent(self.state.given["p"]) if equation.slides else 1.0

    @property
    def slow(self) -> float:
        """Rate of the machine nearly at rest, at which friction has its direction."""
        return _SLOW * self.pace

    def law(self, t: float) -> tuple[float, float]:
        """Coordinate and rate of the drive as the scene has them."""
        found = self.equation.program.motion(t, list(self.values.values()))
        return float(found[0]), float(found[1])

    @property
    def added(self) -> Array:
        """Torque and inertia on the drive, to be set."""
        return self.state.given["added"]

    def begin(self, t: float, angle: float) -> None:
        """Follow the loops from the scene's own start to an angle.

        Raises :class:`.DeclarationError` if they do not close there, or nothing has inertia.
        """
        first = self.law(self.equation.program.data.span[0])[0]
        steps = 1 + int(abs(angle - first) / (_APART * self.size))
        closed = all(self._close(t, x) for x in np.linspace(first, angle, steps + 1)[1:])
        rows = self.at(t, angle, self.pace)
        if not closed or math.isnan(rows[ROW["kinetic"]]):
            raise DeclarationError(
                f"start: the loops of '{self.name}' do not close at {angle:.6g}, or are at a dead"
                " centre there; expected another coordinate"
            )
        if rows[ROW["inertia"]] == 0.0:
            raise DeclarationError(
                f"free machine '{self.name}': nothing that '{self.equation.joint}' moves has"
                " inertia; expected masses or inertias, or inertia="
            )

    def let_go(self, t: float, start: Start, span: float) -> None:
        """Set the pace to that at which a machine moves from a start on, within a time ``span``:
        its rate there, or what its acceleration gives it over its size.
        """
        usual = self.size / span
        rows = self.at(t, start.angle, start.speed or _SLIGHT * usual)
        pace = max(abs(start.speed), math.sqrt(abs(rows[ROW["acceleration"]]) * self.size))
        self.pace = pace if _SLIGHT * usual < pace < math.inf else usual

    def at(self, t: float, angle: float, speed: float) -> Array:
        """Rows :data:`COLUMNS` of a state; no number where loops do not close there."""
        self.evaluations += 1
        given = self.state.given
        given["t"][0], given["angle"][0], given["speed"][0] = t, angle, speed
        if not self._close(t, angle):
            return np.full(len(COLUMNS), np.nan)
        given["z"][:] = self.z
        rows = self.state()
        if math.isfinite(rows[ROW["acceleration"]]):
            self.last = t, angle, speed
        return rows

    def margin(self, t: float, angle: float, speed: float) -> float:
        """Distance of a state from a dead centre and from a jam: zero at one of them."""
        rows = self.at(t, angle, speed)
        sine = float(rows[ROW["sine"]]) - _DEAD
        return min([sine, *rows[len(COLUMNS) :]]) if math.isfinite(sine) else 1.0

    def obstacle(self, t: float, angle: float, speed: float) -> Event:
        """The dead centre or the jam that a state is near, at which it can be followed no further.

        Raises :class:`.LagrangeCasadiError` if there is none.
        """
        rows = self.at(t, angle, speed)
        jams = zip(rows[len(COLUMNS) :], self.equation.jams, strict=False)
        near, joints = min([(rows[ROW["sine"]], ""), *jams])
        if near < _NEAR:
            return Event("jam" if joints else "dead centre", t, angle, speed, joints)
        raise LagrangeCasadiError(
            f"free machine '{self.name}': its motion cannot be followed beyond t = {t:.6g} s,"
            f" coordinate {angle:.6g}, rate {speed:.6g}: acceleration"
            f" {rows[ROW['acceleration']]:.3g}, drive torque or force {rows[ROW['drive']]:.3g} (SI"
            " units); there the law of the drive or of a load grows without bound, or switches back"
            " and forth"
        )

    def _close(self, t: float, angle: float) -> bool:
        if self.loops is None:
            return True
        rule, given, z = newton_rule("double", None), self.loops.given, self.z.copy()
        given["t"][0], given["angle"][0] = t, angle
        for _ in range(int(rule["steps"])):
            given["z"][:] = z
            *correction, size = self.loops().tolist()
            if not math.isfinite(size):
                return False
            z += correction
            if size < rule["done"]:
                self.z = z
                return True
        return False

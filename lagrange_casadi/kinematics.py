"""Loops: the undriven coordinates, their rates and accelerations, from the driven ones.

The loop equations Phi = 0 are solved block by block (:mod:`.blocks`). A dyad is solved in closed form (:mod:`.loops`); any other
block by Newton's method, iterated by whoever evaluates the graphs, from the solution of the instant before. Rates and
accelerations follow from the linear systems Phi_z z' = -Phi_d d' and Phi_z z'' = -(Phi_d d'' + what the rates leave), whose
matrix, transposed, gives the multipliers too.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from .blocks import Block, plan
from .density import Array
from .errors import AssemblyError, DeclarationError
from .linear import LinearSystem
from .loops import ClosedForm
from .multibody import Coordinate, Multibody, column, joint_coordinate
from .parts import Link
from .planar import misalignment

_LARGEST_STEP = 0.3
"""Of an angle [rad], or of a slide over the length of all links: a full step from afar may land on another branch."""

NEAR = 0.3
"""Sines of the transmission angle below which a loop may pass a dead centre."""


@dataclass(frozen=True, eq=False)
class NewtonLoop:
    """What is left to iterate: ``step(z, t, d, p) -> (correction, relative size)`` and the guess for the first instant.

    ``names`` are those of its blocks that have no closed form, and are judged by a volume; ``joints`` says what closes all of its
    blocks, for messages. ``turning`` tells which unknowns are angles that matter up to whole turns only.
    """

    step: Any
    guess: tuple[float, ...]
    turning: tuple[bool, ...]
    names: tuple[str, ...]
    joints: str


@dataclass(frozen=True)
class Start:
    """Numbers at the start of the motion: time, driven coordinates, parameters."""

    t: float
    driven: Sequence[float]
    parameters: Sequence[float]


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The whole motion as graphs over time, the driven coordinates d, d', d'', the iterated unknowns z and the parameters.

    ``symbols`` and ``values`` pair every variable, rate and acceleration of a :class:`.Multibody` with its expression; ``systems``
    are the factorized Phi_z of ``blocks``. ``closures`` say by joint how far each loop is from a dead centre, ``misfits`` how
    far the equations that are too many are from holding. ``loose`` names the joints whose angles are known up to whole turns.
    """

    driven: Any
    driven_rate: Any
    driven_acceleration: Any
    iterated: Any
    symbols: Any
    values: Any
    blocks: tuple[Block, ...]
    systems: tuple[LinearSystem, ...]
    closures: dict[str, Any]
    misfits: dict[str, Any]
    newton: NewtonLoop | None
    loose: frozenset[str]

    def evaluate(self, expression: Any) -> Any:
        """An expression in the multibody's symbols, as one in t, d, d', d'', z and the parameters."""
        return ca.substitute(ca.SX(expression), self.symbols, self.values)


def solve(multibody: Multibody, posture: Mapping[str, float], start: Start, *, iterate: bool = False) -> Kinematics:
    """Close every loop, on the branch that is nearest to ``posture`` at the start of the motion.

    ``posture`` gives rough directions of links [rad] and places of slides [m], by the link's or the joint's name. With ``iterate``
    dyads are left to Newton's method too; their closed form gives the guess.
    Raises :class:`MobilityError` where drives and degrees of freedom do not match, :class:`DeclarationError` for a posture that
    leaves the branch open, :class:`AssemblyError` where the mechanism cannot be assembled at the start.
    """
    solver = _Solver(multibody, dict(posture), start, iterate)
    blocks = plan(multibody, solver.numbers())
    for block in blocks:
        solver.close(block)
    return solver.finish(blocks)


class _Solver:
    """Carries the expressions known so far while the blocks are closed in order."""

    def __init__(self, multibody: Multibody, posture: dict[str, float], start: Start, iterate: bool) -> None:
        self.iterate = iterate
        self.multibody = multibody
        self.posture = posture
        self.start = start
        driven = [c for c in multibody.coordinates if c.driven]
        self.d, self.dd, self.ddd = (ca.SX.sym(name, len(driven)) for name in ("d", "d_rate", "d_acceleration"))
        self.iterated: list[Any] = []
        self.guess: list[float] = []
        self.scales: list[Any] = []
        self.turning: list[bool] = []
        self.residuals: list[Block] = []
        values = column(c.value for c in driven)
        self.known: dict[Coordinate, Any] = {c: _variables(c, values, self.d) for c in driven}
        self.closures: dict[str, Any] = {}
        self.loose: set[str] = set()

    def numbers(self) -> dict[str, Any]:
        """What the count of freedoms needs: the rough posture, and the inputs with their values at the start."""
        told = {c: self.posture[_posture_name(c)] for c in self.multibody.coordinates if _posture_name(c) in self.posture}
        symbols = [c.variables for c in self.known]
        numbers = self._at_start(column(self.known.values()))
        return {
            "posture": told,
            "inputs": [ca.vertcat(ca.SX(0, 1), *symbols), self.multibody.mechanism.time, self.multibody.mechanism.symbols],
            "values": [numbers, self.start.t, self.start.parameters],
        }

    def place(self, expression: Any) -> Any:
        """An expression in variables, with those known so far put in."""
        return ca.substitute(ca.SX(expression), column(c.variables for c in self.known), column(self.known.values()))

    def close(self, block: Block) -> None:
        """Solve a block for its variables."""
        form = block.form
        if form is None:
            if block.unknown:
                self._iterate(block, self._told(block))
        elif form.closure is None:
            for coordinate, value in zip(block.unknown, form.variables, strict=True):
                self.known[coordinate] = self.place(value)
        else:
            variables = self.place(ca.vertcat(*form.variables))
            closure = self.place(form.closure)
            sign = self._branch(block, form, variables, closure)
            if self.iterate:
                self.closures[block.name] = closure
                self._iterate(block, _numbers(block.unknown, self._at_start(variables, form.branch, sign)))
                return
            sizes = itertools.accumulate(c.variables.numel() for c in block.unknown)
            solved = ca.vertsplit(ca.substitute(variables, form.branch, sign), [0, *sizes])
            self.known.update(zip(block.unknown, solved, strict=True))
            self.loose |= {c.joint for c in block.unknown if c.kind == "angle"}
            self.closures[block.name] = closure

    def _at_start(self, expression: Any, extra: Any = None, value: float = 0.0) -> list[float]:
        inputs = [self.multibody.mechanism.time, self.d, column(self.iterated), self.multibody.mechanism.symbols]
        numbers: list[Any] = [self.start.t, self.start.driven, self.guess, self.start.parameters]
        if extra is not None:
            inputs, numbers = [*inputs, extra], [*numbers, value]
        found = ca.Function("start", inputs, [expression])(*numbers)
        return [float(x) for x in ca.DM(found).full().ravel()]

    def _branch(self, block: Block, form: ClosedForm, variables: Any, closure: Any) -> int:
        reach = self._at_start(closure)[0]
        if not reach > 0.0:
            what = "is at a dead centre" if reach == 0.0 else "cannot be closed"
            raise AssemblyError(f"the loop closed by {block.joints} {what} at the start of the motion{self._where()}")
        found = {sign: self._at_start(variables, form.branch, sign) for sign in (1, -1)}
        distance = {sign: self._distance(block, values) for sign, values in found.items()}
        if abs(distance[1] - distance[-1]) <= 1e-6 * (1.0 + distance[1]):
            choices = " or ".join(_describe(block.unknown, values) for values in found.values())
            raise DeclarationError(
                f"the loop closed by {block.joints} can be assembled in two ways at the start of the motion: {choices}; "
                f"say which by posture={{'{_posture_name(block.unknown[0])}': ...}}"
            )
        return min(distance, key=lambda sign: distance[sign])

    def _distance(self, block: Block, values: Sequence[float]) -> float:
        """How far a solution is from the posture, by all that the posture says of what the block places."""
        solved = column(c.variables for c in block.unknown)
        later = column(c.variables for c in self.multibody.coordinates if c not in self.known and c not in block.unknown)
        size = self._at_start(self._size())[0] or 1.0
        total = 0.0
        for name, rough in self.posture.items():
            if name in self.multibody.frames:
                turn = self.multibody.frames[name].rotation
                measured = ca.SX(ca.atan2(turn.s, turn.c))
            else:
                joint = self.multibody.mechanism.joints[name]
                measured = ca.SX(joint_coordinate(joint, self.multibody.frames, self.multibody.coordinates))
            if ca.depends_on(measured, solved) and not ca.depends_on(measured, later):
                gap = self._at_start(self.place(ca.substitute(measured, solved, ca.SX(ca.DM(values)))))[0] - rough
                total += abs(math.remainder(gap, 2.0 * math.pi)) if name in self.multibody.frames else abs(gap) / size
        return total

    def _told(self, block: Block) -> dict[Coordinate, float]:
        """What the posture says of a block that has no closed form."""
        missing = [_posture_name(c) for c in block.unknown if _posture_name(c) not in self.posture]
        if missing:
            raise DeclarationError(
                f"the loops closed by {block.joints} have no closed form; give a rough posture of {', '.join(missing)} too"
            )
        return {c: self.posture[_posture_name(c)] for c in block.unknown}

    def _iterate(self, block: Block, guess: Mapping[Coordinate, float]) -> None:
        for coordinate in block.unknown:
            symbol = ca.SX.sym(f"z_{coordinate.joint}")
            self.known[coordinate] = _variables(coordinate, coordinate.value, symbol)
            self.iterated.append(symbol)
            self.guess.append(guess[coordinate])
            self.scales.append(1 if coordinate.kind == "angle" else self._size())
            counted = any(ca.depends_on(closure.gap, coordinate.value) for closure in self.multibody.closures)
            self.turning.append(coordinate.kind == "angle" and not counted)
            if self.turning[-1]:
                self.loose.add(coordinate.joint)
        self.residuals.append(block)
        self._settle()

    def _size(self) -> Any:
        """A length to judge slides and gaps by: all links end to end."""
        return sum((ca.SX(body.length) for body in self.multibody.mechanism.moving if isinstance(body, Link)), ca.SX(0))

    def _settle(self) -> None:
        """Iterate the guess at the start of the motion, so that every later evaluation begins on this branch."""
        loop = self.newton()
        assert loop is not None
        for _ in range(100):
            correction, size = loop.step(self.guess, self.start.t, self.start.driven, self.start.parameters)
            self.guess = [float(z) for z in (ca.DM(self.guess) + correction).full().ravel()]
            if float(size) < 1e-9:
                return
        raise AssemblyError(
            f"the loops closed by {loop.joints} cannot be assembled from the given posture at the start of the motion"
            f"{self._where()}"
        )

    def _where(self) -> str:
        driven = [c for c in self.multibody.coordinates if c.driven]
        return where((c.joint, c.kind, v) for c, v in zip(driven, self.start.driven, strict=True))

    def finish(self, blocks: tuple[Block, ...]) -> Kinematics:
        """Rates and accelerations, block by block, and the substitution of everything."""
        body = self.multibody
        rates = {c: self.dd[i] for i, c in enumerate(c for c in body.coordinates if c.driven)}
        accelerations = {c: self.ddd[i] for i, c in enumerate(c for c in body.coordinates if c.driven)}
        systems, misfits = [], {}
        for block in blocks:
            still = ca.SX.zeros(len(block.unknown))
            left = ca.substitute(block.gap_rate, column(c.rate for c in block.unknown), still)
            left_over = ca.substitute(block.gap_acceleration, column(c.acceleration for c in block.unknown), still)
            system = LinearSystem.of(self._motion(block.jacobian, rates, accelerations))
            solved = system.solve(-self._motion(left, rates, accelerations))
            rates |= dict(zip(block.unknown, ca.vertsplit(solved) if block.unknown else (), strict=True))
            solved = system.solve(-self._motion(left_over, rates, accelerations))
            accelerations |= dict(zip(block.unknown, ca.vertsplit(solved) if block.unknown else (), strict=True))
            systems.append(system)
            if block in self.residuals:
                side = math.copysign(1.0, self._at_start(system.volume)[0])
                volume = ca.fabs(system.volume) if system.free else side * system.volume
                # Of a dyad the closed form knows how near its dead centre is, and the volume on which branch it is.
                dyad = self.closures.get(block.name)
                self.closures[block.name] = volume if dyad is None else dyad * ca.copysign(1.0, volume)
            if system.free:
                misfits[block.name] = self._misfit(block)
        symbols, values = self._substitution(rates, accelerations)
        return Kinematics(
            driven=self.d,
            driven_rate=self.dd,
            driven_acceleration=self.ddd,
            iterated=column(self.iterated),
            symbols=symbols,
            values=values,
            blocks=blocks,
            systems=tuple(systems),
            closures=self.closures,
            misfits=misfits,
            newton=self.newton(),
            loose=frozenset(self.loose),
        )

    def _misfit(self, block: Block) -> Any:
        """Gaps over the length of all links; and a direction is missed by its sine as by a half turn, which has none."""
        misfit = ca.mmax(ca.fabs(self.place(block.gap))) / self._size()
        for closure in block.closures:
            if closure.joint is not None and closure.joint.holds_direction:
                ends = (self.multibody.frames[body.name] for body in closure.joint.bodies)
                misfit = ca.fmax(misfit, self.place(1 - misalignment(closure.joint, *ends).c))
        return misfit

    def _substitution(self, rates: Mapping[Coordinate, Any], accelerations: Mapping[Coordinate, Any]) -> tuple[Any, Any]:
        symbols = [*(c.variables for c in self.known), *(c.rate for c in rates), *(c.acceleration for c in accelerations)]
        return column(symbols), column([*self.known.values(), *rates.values(), *accelerations.values()])

    def _motion(self, expression: Any, rates: Mapping[Coordinate, Any], accelerations: Mapping[Coordinate, Any]) -> Any:
        return ca.substitute(ca.SX(expression), *self._substitution(rates, accelerations))

    def newton(self) -> NewtonLoop | None:
        """The iteration of all blocks without a closed form, together."""
        if not self.residuals:
            return None
        iterated = column(self.iterated)
        gaps = self.place(column(block.gap for block in self.residuals))
        correction = -LinearSystem.of(ca.jacobian(gaps, iterated)).solve(gaps)
        relative = ca.mmax(ca.fabs(correction / column(self.scales)))
        # Not fmin(1, limit / relative): where the loops are closed, its derivative would be 0 times infinity.
        bounded = correction * (_LARGEST_STEP / ca.fmax(relative, _LARGEST_STEP))
        inputs = [iterated, self.multibody.mechanism.time, self.d, self.multibody.mechanism.symbols]
        step = ca.Function("loops", inputs, [bounded, relative], ["z", "t", "d", "p"], ["correction", "size"], {"cse": True})
        names = tuple(block.name for block in self.residuals if block.form is None)
        joints = ", ".join(block.joints for block in self.residuals)
        return NewtonLoop(step, tuple(self.guess), tuple(self.turning), names, joints)


def where(coordinates: Iterable[tuple[str, str, float]]) -> str:
    """Coordinates by joint, kind and value, to end a message with; nothing where there are none."""
    listed = ", ".join(describe_coordinate(*coordinate) for coordinate in coordinates)
    return f", where {listed}" if listed else ""


def passes_dead_centre(closure: Array, *, ends: bool = False) -> npt.NDArray[np.bool_]:
    """After which instants a loop may pass a dead centre: straight on from either side its transmission angle's sine meets zero.

    The closed forms keep to their branch there, with a kink; the mechanism itself may not. With ``ends`` the first interval and the
    last are looked at too, each from its one side.
    """
    found = np.zeros(closure.size, dtype=bool)
    sine = np.sqrt(np.where((closure > 0.0) & (closure < np.inf), closure, 0.0))
    left, right = np.full((2, max(closure.size - 1, 0)), -1.0 if ends else 1.0)
    left[1:], right[:-1] = 2 * sine[1:-1] - sine[:-2], 2 * sine[1:-1] - sine[2:]
    found[:-1] = (left < 0.0) & (right < 0.0) & (np.maximum(sine[:-1], sine[1:]) < NEAR)
    return found


def describe_coordinate(joint: str, kind: str, value: float) -> str:
    """A coordinate's value for a reader."""
    return f"{joint} = {value:.6g} rad ({math.degrees(value):.6g} deg)" if kind == "angle" else f"{joint} = {value:.6g} m"


def _variables(coordinate: Coordinate, symbols: Any, values: Any) -> Any:
    """A coordinate's variables for values of the coordinates ``symbols``."""
    if coordinate.kind == "slide":
        return ca.substitute(coordinate.value, symbols, values)
    turn, angle = ca.vertsplit(ca.substitute(ca.vertcat(coordinate.turn, coordinate.value), symbols, values))
    return ca.vertcat(ca.cos(turn), ca.sin(turn), angle)


def _posture_name(coordinate: Coordinate) -> str:
    return coordinate.body if coordinate.kind == "angle" else coordinate.joint


def _numbers(unknown: Sequence[Coordinate], values: Sequence[float]) -> dict[Coordinate, float]:
    found, rest = {}, list(values)
    for coordinate in unknown:
        size = coordinate.variables.numel()
        found[coordinate] = math.atan2(rest[1] + 0.0, rest[0]) if coordinate.kind == "angle" else rest[0]
        rest = rest[size:]
    return found


def _describe(unknown: Sequence[Coordinate], values: Sequence[float]) -> str:
    return " with ".join(describe_coordinate(_posture_name(c), c.kind, x) for c, x in _numbers(unknown, values).items())

"""Loops: the undriven coordinates, their rates and accelerations, from the driven ones.

The loop equations Phi = 0 are cut into blocks that can be solved one after another, each as small as possible. A block that
is a dyad is solved in closed form; any other by Newton's method, iterated by whoever evaluates the graphs, from the solution
of the instant before. Rates and accelerations follow from the linear systems Phi_z z' = -Phi_d d' and
Phi_z z'' = -(Phi_d d'' + what the rates leave), whose matrix, transposed, gives the multipliers too.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from .errors import AssemblyError, DeclarationError, MobilityError
from .linear import LinearSystem
from .loops import ClosedForm, solve_loop
from .multibody import Closure, Coordinate, Multibody


@dataclass(frozen=True, eq=False)
class Block:
    """Loop equations solved together: as many as the coordinates they are solved for."""

    closures: tuple[Closure, ...]
    unknown: tuple[Coordinate, ...]
    phi: Any
    form: ClosedForm | None

    @property
    def joints(self) -> str:
        """The joints that close the loops, for messages."""
        return ", ".join(f"'{closure.joint.name}'" for closure in self.closures)

    @property
    def jacobian(self) -> Any:
        """Phi_z, in symbols."""
        return ca.horzcat(*(ca.jacobian(self.phi, c.variables) @ c.tangent for c in self.unknown))


@dataclass(frozen=True, eq=False)
class NewtonLoop:
    """What is left to iterate: ``step(z, d, p) -> (correction, relative size)`` and the guess for the first instant."""

    step: Any
    guess: tuple[float, ...]
    joints: str


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The whole motion as graphs over the driven coordinates d, d', d'', the iterated unknowns z and the parameters.

    ``symbols`` and ``values`` pair every variable, rate and acceleration of a :class:`Multibody` with its expression;
    ``systems`` are the factorized Phi_z of ``blocks``; ``closures`` name the loops in closed form and say how far each is from
    not closing.
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
    newton: NewtonLoop | None

    def evaluate(self, expression: Any) -> Any:
        """An expression in the multibody's symbols, as one in d, d', d'', z and the parameters."""
        return ca.substitute(ca.SX(expression), self.symbols, self.values)


def solve(multibody: Multibody, posture: Mapping[str, float], start: Sequence[float], parameters: Sequence[float]) -> Kinematics:
    """Close every loop, on the branch that is nearest to ``posture`` at the driven coordinates ``start``.

    ``posture`` gives rough directions of links [rad] and places of slides [m], by the link's or the joint's name.
    Raises :class:`MobilityError` where drives and degrees of freedom do not match, :class:`DeclarationError` for a posture that
    leaves the branch open, :class:`AssemblyError` where the mechanism cannot be assembled at the start.
    """
    blocks = plan(multibody)
    solver = _Solver(multibody, dict(posture), list(start), list(parameters))
    for block in blocks:
        solver.close(block)
    return solver.finish(blocks)


def plan(multibody: Multibody) -> tuple[Block, ...]:
    """The blocks, smallest first among those that can be solved next."""
    driven = [c for c in multibody.coordinates if c.driven]
    open_coordinates = [c for c in multibody.coordinates if not c.driven]
    freedom = len(multibody.coordinates) - sum(closure.phi.numel() for closure in multibody.closures)
    if freedom != len(driven):
        raise MobilityError(
            f"mechanism '{multibody.mechanism.name}' has {freedom} degree(s) of freedom and {len(driven)} drive(s); drive "
            f"{freedom} of the joints {', '.join(n for n, j in multibody.mechanism.joints.items() if j.coordinate)}"
        )
    waiting, blocks = list(multibody.closures), []
    while waiting:
        block = _next_block(waiting, open_coordinates)
        blocks.append(block)
        waiting = [closure for closure in waiting if closure not in block.closures]
        open_coordinates = [c for c in open_coordinates if c not in block.unknown]
    if open_coordinates:
        raise MobilityError(
            f"joint '{open_coordinates[0].joint}' is neither driven nor in a loop that places it, "
            "while other loops are closed twice"
        )
    return tuple(blocks)


def _next_block(waiting: Sequence[Closure], unknown: Sequence[Coordinate]) -> Block:
    for size in range(1, len(waiting) + 1):
        for chosen in itertools.combinations(waiting, size):
            phi = ca.vertcat(*(closure.gap for closure in chosen))
            touched = tuple(c for c in unknown if ca.depends_on(phi, c.variables))
            if len(touched) < phi.numel():
                names = ", ".join(f"'{closure.joint.name}'" for closure in chosen)
                raise MobilityError(
                    f"the loops closed by {names} are over-determined: {phi.numel()} equations for {len(touched)} "
                    "unknown coordinate(s)"
                )
            if len(touched) == phi.numel():
                return Block(chosen, touched, phi, solve_loop(phi, touched))
    names = ", ".join(f"'{closure.joint.name}'" for closure in waiting)
    raise MobilityError(f"the loops closed by {names} leave coordinates undetermined")


class _Solver:
    """Carries the expressions known so far while the blocks are closed in order."""

    def __init__(self, multibody: Multibody, posture: dict[str, float], start: list[float], parameters: list[float]) -> None:
        self.multibody = multibody
        self.posture = posture
        self.start = start
        self.parameters = parameters
        driven = [c for c in multibody.coordinates if c.driven]
        self.d, self.dd, self.ddd = (ca.SX.sym(name, len(driven)) for name in ("d", "d_rate", "d_acceleration"))
        self.iterated: list[Any] = []
        self.guess: list[float] = []
        self.known: dict[Coordinate, Any] = {c: _variables(c, self.d[i]) for i, c in enumerate(driven)}
        self.closures: dict[str, Any] = {}
        self.scales: list[Any] = []
        self.residuals: list[Any] = []
        self.open_joints: list[str] = []

    def place(self, expression: Any) -> Any:
        """An expression in variables, with those known so far put in."""
        symbols = ca.vertcat(ca.SX(0, 1), *(c.variables for c in self.known))
        return ca.substitute(expression, symbols, ca.vertcat(ca.SX(0, 1), *self.known.values()))

    def close(self, block: Block) -> None:
        """Solve a block for its variables."""
        form = block.form
        if form is None:
            self._iterate(block)
        elif form.closure is None:
            for coordinate, value in zip(block.unknown, form.variables, strict=True):
                self.known[coordinate] = self.place(value)
        else:
            variables = self.place(ca.vertcat(*form.variables))
            closure = self.place(form.closure)
            sign = self._branch(block, form, variables, closure)
            solved = ca.vertsplit(ca.substitute(variables, form.branch, sign), _offsets(c.variables.numel() for c in block.unknown))
            self.known.update(zip(block.unknown, solved, strict=True))
            self.closures[block.closures[-1].joint.name] = closure

    def _at_start(self, expression: Any, extra: Any = None, value: float = 0.0) -> list[float]:
        inputs = [self.d, ca.vertcat(ca.SX(0, 1), *self.iterated), self.multibody.mechanism.symbols]
        numbers: list[Any] = [self.start, self.guess, self.parameters]
        if extra is not None:
            inputs, numbers = [*inputs, extra], [*numbers, value]
        found = ca.Function("start", inputs, [expression])(*numbers)
        return [float(x) for x in ca.DM(found).full().ravel()]

    def _branch(self, block: Block, form: ClosedForm, variables: Any, closure: Any) -> int:
        reach = self._at_start(closure)[0]
        if not reach > 0.0:
            what = "is at a dead centre" if reach == 0.0 else "cannot be closed"
            raise AssemblyError(f"the loop closed by joint {block.joints} {what} at the start of the motion, where {self._where()}")
        found = {sign: self._at_start(variables, form.branch, sign) for sign in (1, -1)}
        told = [c for c in block.unknown if _posture_name(c) in self.posture]
        distance = {sign: _distance(block.unknown, told, values, self.posture) for sign, values in found.items()}
        if abs(distance[1] - distance[-1]) <= 1e-6 * (1.0 + distance[1]):
            choices = " or ".join(_describe(block.unknown, values) for values in found.values())
            raise DeclarationError(
                f"the loop closed by joint {block.joints} can be assembled in two ways at the start of the motion: {choices}; "
                f"say which by posture={{'{_posture_name(block.unknown[0])}': ...}}"
            )
        return min(distance, key=lambda sign: distance[sign])

    def _iterate(self, block: Block) -> None:
        missing = [_posture_name(c) for c in block.unknown if _posture_name(c) not in self.posture]
        if missing:
            raise DeclarationError(
                f"the loops closed by joints {block.joints} have no closed form; give a rough posture of {', '.join(missing)} too"
            )
        for coordinate in block.unknown:
            symbol = ca.SX.sym(f"z_{coordinate.joint}")
            self.known[coordinate] = _variables(coordinate, symbol)
            self.iterated.append(symbol)
            self.guess.append(self.posture[_posture_name(coordinate)])
            self.scales.append(1 if coordinate.kind == "angle" else self._size())
        self.residuals.append(block.phi)
        self.open_joints.append(block.joints)
        self._settle()

    def _size(self) -> Any:
        """A length to judge slides by: all links end to end."""
        return sum((ca.SX(link.length) for link in self.multibody.mechanism.links.values()), ca.SX(0))

    def _settle(self) -> None:
        """Iterate the guess at the start of the motion, so that every later evaluation begins on this branch."""
        loop = self.newton()
        assert loop is not None
        for _ in range(100):
            correction, size = loop.step(self.guess, self.start, self.parameters)
            self.guess = [float(z) for z in (ca.DM(self.guess) + correction).full().ravel()]
            if float(size) < 1e-9:
                return
        raise AssemblyError(
            f"the loops closed by joints {loop.joints} cannot be assembled from the given posture at the start of the motion, "
            f"where {self._where()}"
        )

    def _where(self) -> str:
        driven = [c for c in self.multibody.coordinates if c.driven]
        return ", ".join(describe_coordinate(c.joint, c.kind, v) for c, v in zip(driven, self.start, strict=True))

    def finish(self, blocks: tuple[Block, ...]) -> Kinematics:
        """Rates and accelerations, block by block, and the substitution of everything."""
        body = self.multibody
        rates = {c: self.dd[i] for i, c in enumerate(c for c in body.coordinates if c.driven)}
        accelerations = {c: self.ddd[i] for i, c in enumerate(c for c in body.coordinates if c.driven)}
        systems = []
        for block in blocks:
            unknown_rates = ca.vertcat(*(c.rate for c in block.unknown))
            unknown_accelerations = ca.vertcat(*(c.acceleration for c in block.unknown))
            gap_rate = body.change(block.phi)
            left = ca.substitute(gap_rate, unknown_rates, ca.SX.zeros(unknown_rates.numel()))
            gap_acceleration = ca.substitute(
                body.change(gap_rate), unknown_accelerations, ca.SX.zeros(unknown_accelerations.numel())
            )
            system = LinearSystem.of(self._motion(block.jacobian, rates, accelerations))
            solved = system.solve(-self._motion(left, rates, accelerations))
            rates |= dict(zip(block.unknown, ca.vertsplit(solved), strict=True))
            solved = system.solve(-self._motion(gap_acceleration, rates, accelerations))
            accelerations |= dict(zip(block.unknown, ca.vertsplit(solved), strict=True))
            systems.append(system)
        symbols, values = self._substitution(rates, accelerations)
        return Kinematics(
            driven=self.d,
            driven_rate=self.dd,
            driven_acceleration=self.ddd,
            iterated=ca.vertcat(ca.SX(0, 1), *self.iterated),
            symbols=symbols,
            values=values,
            blocks=blocks,
            systems=tuple(systems),
            closures=self.closures,
            newton=self.newton(),
        )

    def _substitution(self, rates: Mapping[Coordinate, Any], accelerations: Mapping[Coordinate, Any]) -> tuple[Any, Any]:
        symbols = [*(c.variables for c in self.known), *(c.rate for c in rates), *(c.acceleration for c in accelerations)]
        values = [*self.known.values(), *rates.values(), *accelerations.values()]
        return ca.vertcat(*symbols), ca.vertcat(*values)

    def _motion(self, expression: Any, rates: Mapping[Coordinate, Any], accelerations: Mapping[Coordinate, Any]) -> Any:
        return ca.substitute(ca.SX(expression), *self._substitution(rates, accelerations))

    def newton(self) -> NewtonLoop | None:
        """The iteration of all blocks without a closed form, together."""
        if not self.residuals:
            return None
        iterated = ca.vertcat(*self.iterated)
        gaps = self.place(ca.vertcat(*self.residuals))
        correction = -LinearSystem.of(ca.jacobian(gaps, iterated)).solve(gaps)
        relative = ca.mmax(ca.fabs(correction / ca.vertcat(*self.scales)))
        inputs = [iterated, self.d, self.multibody.mechanism.symbols]
        step = ca.Function("loops", inputs, [correction, relative], ["z", "d", "p"], ["correction", "size"], {"cse": True})
        return NewtonLoop(step, tuple(self.guess), ", ".join(self.open_joints))


def describe_coordinate(joint: str, kind: str, value: float) -> str:
    """A coordinate's value for a reader."""
    return f"{joint} = {value:.6g} rad ({math.degrees(value):.6g} deg)" if kind == "angle" else f"{joint} = {value:.6g} m"


def _variables(coordinate: Coordinate, value: Any) -> Any:
    return ca.vertcat(ca.cos(value), ca.sin(value)) if coordinate.kind == "angle" else value


def _posture_name(coordinate: Coordinate) -> str:
    return coordinate.body if coordinate.kind == "angle" else coordinate.joint


def _numbers(unknown: Sequence[Coordinate], values: Sequence[float]) -> dict[Coordinate, float]:
    found, rest = {}, list(values)
    for coordinate in unknown:
        if coordinate.kind == "angle":
            found[coordinate] = math.atan2(rest[1] + 0.0, rest[0])
        else:
            found[coordinate] = rest[0]
        rest = rest[coordinate.variables.numel() :]
    return found


def _distance(
    unknown: Sequence[Coordinate], told: Sequence[Coordinate], values: Sequence[float], posture: Mapping[str, float]
) -> float:
    numbers = _numbers(unknown, values)
    gaps = [numbers[c] - posture[_posture_name(c)] for c in told]
    return sum(
        abs(math.remainder(gap, 2.0 * math.pi)) if c.kind == "angle" else abs(gap) for c, gap in zip(told, gaps, strict=True)
    )


def _describe(unknown: Sequence[Coordinate], values: Sequence[float]) -> str:
    return " with ".join(describe_coordinate(_posture_name(c), c.kind, x) for c, x in _numbers(unknown, values).items())


def _offsets(sizes: Any) -> list[int]:
    return [0, *itertools.accumulate(sizes)]

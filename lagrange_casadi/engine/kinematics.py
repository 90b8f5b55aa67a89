"""Loops: the undriven coordinates, their rates and accelerations, from the driven ones.

The loop equations Phi = 0 are solved block by block (:mod:`.blocks`). A dyad is solved in closed
form (:mod:`.loops`); any other block by Newton's method, iterated by whoever evaluates the graphs,
from the solution of the instant before. Rates and accelerations follow from the linear systems
Phi_z z' = -Phi_d d' and Phi_z z'' = -(Phi_d d'' + what the rates leave), whose matrix, transposed,
gives the multipliers too.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from ..base.scalars import column, graph
from ..base.vectors import AXES, Vector
from ..errors import AssemblyError, DeclarationError, MobilityError
from ..model.directions import most_across
from .blocks import Block, row_units, solving_order
from .iteration import CLOSED, Iterated, NewtonLoop, Start, place_roughly
from .linear import LinearSystem
from .loop_turns import Guide
from .loops import ClosedForm
from .multibody import Coordinate, Multibody
from .postures import Undecided, directions, is_angle, measured
from .residuals import lengths, loop_residual, redundancy_residual
from .screws import signed_volume
from .sizes import reach
from .spherical import SphericalCoordinates, axes_of
from .substitution import Expressions, Numbers
from .verdicts import DEAD

_WAYS = 32
"""Largest number of ways to close open loops that are tried if the first does not close the
others.
"""

_READ = {"angle": 12, "slide": 15}
"""Decimals of what is said of a coordinate [rad or m]."""


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The whole motion as graphs over ``inputs``, by name: the time t, the driven coordinates d,
    d', d'', the iterated unknowns z and the parameters p.

    ``found`` has the expression of every variable, rate and acceleration of a :class:`.Multibody`;
    ``systems`` are the blocks with their factorized Phi_z. ``closures`` are by joint the branch
    indicators of loops, zero at a dead centre; ``residuals`` [m] those of the equations of a block,
    ``redundancy_residuals`` those of redundant equations. ``wrapped`` names the joints whose angles
    are known modulo 2 pi; ``deviations`` are the differences between the angles of screws and the
    revolutions that are counted.
    """

    inputs: dict[str, Any]
    found: Expressions
    systems: tuple[tuple[Block, LinearSystem], ...]
    closures: dict[str, Any]
    residuals: dict[str, Any]
    redundancy_residuals: dict[str, Any]
    newton: NewtonLoop | None
    wrapped: frozenset[str]
    deviations: dict[str, Any]


def solve(multibody: Multibody, posture: Mapping[str, float], start: Start) -> Kinematics:
    """Close every loop, on the branch that is nearest to ``posture`` at the start of the motion.

    ``posture`` gives rough directions of links [rad] and coordinates of joints [rad or m], by the
    link's or the joint's name. Raises :class:`MobilityError` where drives and degrees of freedom do
    not match, :class:`PostureError` for a posture that leaves branches open, :class:`AssemblyError`
    where the mechanism cannot be assembled at the start, :class:`DeclarationError` for a motion
    that is no number there.
    """
    solver = _Solver(multibody, dict(posture), start)
    if multibody.loop_equations and not all(map(math.isfinite, start.driven)):
        raise DeclarationError(
            f"the motion is no number where it starts, at t = {start.t:.9g} s{solver.where()};"
            " loops cannot be closed there"
        )
    blocks = solving_order(multibody, solver.beginning(), solver.numbers)
    waiting: list[tuple[int, ...]] = []
    for left in reversed(range(_WAYS)):
        try:
            for block in blocks:
                solver.close(block)
            break
        except AssemblyError:
            # A loop whose way is open may have to be closed in the other one: the last such loop
            # first.
            undecided = solver.undecided.closures[len(solver.branches) :]
            for k, modes in enumerate(undecided):
                waiting += [
                    (*solver.branches, *(0,) * k, other) for other in reversed(range(1, len(modes)))
                ]
            if not waiting or not left:
                raise
            solver = _Solver(multibody, dict(posture), start, waiting.pop())
    if solver.undecided:
        raise solver.undecided.refusal(multibody)
    return solver.finish(blocks)


def begun(multibody: Multibody, posture: Mapping[str, float], start: Start) -> Numbers:
    """The numbers of all coordinates at the start of the motion: as loops are solved, in their
    order, until one is not, and of the others as the posture has them roughly, or zero.
    """
    solver = _Solver(multibody, dict(posture), start)
    with suppress(AssemblyError, MobilityError):
        for block in solving_order(multibody, solver.beginning(), solver.numbers):
            solver.close(block)
    return solver.roughly()


class _Solver:
    """Carries the expressions known so far, and their numbers at the start, while the blocks are
    closed in order.
    """

    def __init__(
        self,
        multibody: Multibody,
        posture: dict[str, float],
        start: Start,
        branches: tuple[int, ...] = (),
    ) -> None:
        self.branches = branches
        self.multibody = multibody
        self.posture = posture
        self.start = start
        driven = [c for c in multibody.coordinates if c.driven]
        self.d, self.dd, self.ddd = (
            ca.SX.sym(name, len(driven)) for name in ("d", "d_rate", "d_acceleration")
        )
        self.iterated = Iterated()
        self.residuals: list[Block] = []
        self.closures: dict[str, list[tuple[Any, bool]]] = {}
        self.wrapped: set[str] = set()
        self.deviations: dict[str, Any] = {}
        self.undecided = Undecided()
        self.length = reach(multibody.mechanism)
        self.found = Expressions()
        self.numbers = Numbers()
        self.numbers.note(multibody.mechanism.time, [start.t])
        self.numbers.note(multibody.mechanism.symbols, start.parameters)
        self.numbers.note(self.d, start.driven)
        self.known: dict[Coordinate, Any] = {}
        # All of them at once: directions are sums of many of them.
        variables = column(c.variables for c in driven)
        ends = [0, *itertools.accumulate(c.variables.numel() for c in driven)]
        placed = ca.substitute(
            column(c.by_values for c in driven), column(c.value for c in driven), self.d
        )
        self.found.note(variables, placed)
        self.numbers.note(variables, self.numbers.of(placed))
        self.known |= zip(driven, ca.vertsplit(placed, ends), strict=False)

    def beginning(self) -> dict[Coordinate, float]:
        """The rough posture, drives included."""
        rough = self._rough([c for c in self.multibody.coordinates if not c.driven], needed=False)
        return rough | dict(zip(self.known, self.start.driven, strict=True))

    def roughly(self) -> Numbers:
        """The numbers of all coordinates, rough ones of those that are not solved."""
        self.known = {c: v for c, v in self.known.items() if self.numbers.has(c.variables)}
        open_coordinates = [c for c in self.multibody.coordinates if c not in self.known]
        place_roughly(self.multibody, self._rough(open_coordinates), self.numbers, self.known)
        for symbols, direction in self._asides():
            self.numbers.note(symbols, direction)
        return self.numbers

    def _know(self, coordinate: Coordinate, value: ca.SX) -> None:
        self.known[coordinate] = value
        self.found.note(coordinate.variables, value)

    def close(self, block: Block) -> None:
        """Solve a block for its variables."""
        if block.forms and self.undecided.lacking:
            return  # it hangs on what cannot be placed
        if not block.forms:
            rough = self._rough(block.unknown)
            if missing := [c for c in block.unknown if c not in rough]:
                self.undecided.note_lacking(block, missing)
            elif block.unknown and not self.undecided.lacking:
                self._iterate(block, rough)
            return
        closures = [self._solved(block, form) for form in block.forms]
        for form, closure in zip(block.forms, closures, strict=True):
            if form.branches:
                self.wrapped |= {
                    c.name
                    for c in form.unknown
                    if c.kind == "angle" and c.name not in self.deviations
                }
            if closure is not None:
                self._note_closure(block, closure)

    def _solved(self, block: Block, form: ClosedForm) -> ca.SX | None:
        """Take note of what one closed form of a block solves, on the branch that is nearest to the
        posture; its closure.
        """
        closure, *variables = form.closure, *form.variables
        if form.branches:
            signs = ca.SX(ca.DM(self._signs(block, form)))
            closure, *variables = (
                ca.substitute(value, column(form.branches), signs)
                for value in (closure, *variables)
            )
        if closure is not None:
            closure = self.found.put_into(closure)
        for coordinate, value in zip(form.unknown, variables, strict=True):
            if coordinate.axis.move == "screw" and form.branches:
                value = self._with_turns(coordinate, value)
            self.numbers.note(coordinate.variables, self.numbers.of(value))
            self._know(coordinate, self.found.put_into(value))
        return closure

    def _with_turns(self, screw: Coordinate, variables: ca.SX) -> ca.SX:
        """The variables of a screw that a loop sets, with the turns of its angle: by each of them
        the screw slides.
        """
        c, s, _ = ca.vertsplit(variables)
        counted = column(
            known.value
            for known in self.known
            if known.kind == "angle" and known.name not in self.wrapped
        )
        guide = Guide.of(self.multibody, self.d, self.iterated.symbols, self.newton(), self.start)
        angles = [
            self.iterated.placed(self.found.put_into(part)) for part in (ca.atan2(s, c), counted)
        ]
        (rule,) = guide.rules(*angles)
        if rule is None:
            raise DeclarationError(
                f"joint '{screw.name}': the number of revolutions of the screw cannot be determined"
                " from the drives"
            )
        angle, deviation = rule.angle(c, s, counted)
        self.deviations[screw.name] = self.found.put_into(deviation)
        return ca.vertcat(c, s, angle)

    def _note_closure(self, block: Block, closure: ca.SX) -> None:
        """Note how far a block is from a dead centre: what iterates has the sine for its measure, a
        closed form its square.
        """
        self.closures.setdefault(block.name, []).append((closure, not block.forms))

    def _signs(self, block: Block, form: ClosedForm) -> tuple[int, ...]:
        """The signs of the branches with which a form is nearest to the posture."""
        form_values, branches = column([form.closure, *form.variables]), column(form.branches)
        every = {
            signs: self.numbers.of(ca.substitute(form_values, branches, ca.SX(ca.DM(signs))))
            for signs in itertools.product((1, -1), repeat=len(form.branches))
        }
        values = {
            signs: found
            for signs, (closure, *found) in every.items()
            if closure > DEAD["double"] and not any(map(math.isnan, found))
        }
        if not values:
            what = (
                "is at a dead centre"
                if any(abs(closure) <= DEAD["double"] for closure, *_ in every.values())
                else "cannot be closed"
            )
            raise AssemblyError(
                f"the loop closed by {block.joints} {what} at the start of the"
                f" motion{self.where()}{self.start.note}"
            )
        distance = {signs: self._distance(form, found) for signs, found in values.items()}
        least = min(distance.values())
        near = [
            signs
            for signs, residual in distance.items()
            if residual - least <= 1e-6 * (1.0 + least)
        ]
        if len(near) > 1:
            # No cylinder has a negative length: ways with one come last.
            near.sort(
                key=lambda signs: any(
                    c.kind == "slide" and x < 0.0
                    for c, x in _numbers(form.unknown, values[signs]).items()
                )
            )
            # Taken for now, so that the loops after it are looked at too.
            number = len(self.undecided.closures)
            first = self.branches[number] if number < len(self.branches) else 0
            near = near[first:] + near[:first]
            modes = [
                {
                    c: x if round(x, _READ[c.kind]) else 0.0
                    for c, x in _numbers(form.unknown, values[signs]).items()
                }
                for signs in near
            ]
            words = [
                " with ".join(
                    describe_coordinate(c.posture_key, c.kind, x) for c, x in mode.items()
                )
                for mode in modes
            ]
            self.undecided.note_ways(block, modes, words, self.numbers.of(self.length)[0])
        return near[0]

    def _distance(self, form: ClosedForm, values: Sequence[float]) -> float:
        """Distance of a solution from the posture, in everything that the posture gives."""
        (size,) = self.numbers.of(self.length)
        total, placed = 0.0, {*self.known, *form.unknown}
        self.numbers.note(column(c.variables for c in form.unknown), values)
        for name, (place, of) in self._measured.items():
            if of & set(form.unknown) and of <= placed:
                residual = self.numbers.of(place)[0] - self.posture[name]
                total += (
                    abs(math.remainder(residual, 2.0 * math.pi))
                    if is_angle(self.multibody, name)
                    else abs(residual) / size
                )
        return total

    @cached_property
    def _measured(self) -> dict[str, tuple[ca.SX, set[Coordinate]]]:
        return measured(self.multibody, self.posture)

    def _rough(
        self, coordinates: Sequence[Coordinate], *, needed: bool = True
    ) -> dict[Coordinate, float]:
        """Rough values of coordinates from the posture, by their own names, or else from angles
        through joints; some may be missing.

        Where it is not ``needed``, joints that hold directions are not looked through, for that
        takes time.
        """
        found = {
            c: self.posture[c.posture_key] for c in coordinates if c.posture_key in self.posture
        }
        angles = [c for c in coordinates if c.kind == "angle" and not c.relative and c not in found]
        if angles and (
            needed
            or any(
                n not in self.multibody.frames and is_angle(self.multibody, n) for n in self.posture
            )
        ):
            rough = directions(self.multibody, self.posture, self.numbers, self.known)
            found |= {c: rough[c.body] for c in angles if c.body in rough}
        return found

    def _iterate(self, block: Block, guess: Mapping[Coordinate, float]) -> None:
        sphericals = list(
            dict.fromkeys(c.spherical for c in block.unknown if c.spherical is not None)
        )
        if sphericals:
            rough = {c: self.posture.get(c.posture_key, 0.0) for c in self.multibody.coordinates}
            quaternions = place_roughly(
                self.multibody, rough | dict(guess), self.numbers, self.known
            )
        for coordinate in block.unknown:
            if coordinate.spherical is not None:
                continue
            counted = any(
                ca.depends_on(loop.residual, coordinate.value)
                for loop in self.multibody.loop_equations
            )
            turning = coordinate.kind == "angle" and not counted
            scale = 1 if coordinate.kind == "angle" else self.length
            symbol = self.iterated.add(
                coordinate.name, [guess[coordinate]], [scale], turning=turning
            )
            self._know(coordinate, coordinate.placed(symbol))
            if turning:
                self.wrapped.add(coordinate.name)
        for spherical in sphericals:
            quaternion = self.iterated.add(
                spherical.joint.name, quaternions[spherical], [1, 1, 1], spherical
            )
            axes = axes_of(quaternion)
            for number, coordinate in enumerate(
                c for c in block.unknown if c.spherical is spherical
            ):
                self.known[coordinate] = axes[3 * number : 3 * number + 3]
        self.residuals.append(block)
        self._settle()

    def _settle(self) -> None:
        """Iterate the guess at the start of the motion, so that every later evaluation begins on
        this branch.
        """
        loop = self.newton()
        assert loop is not None
        start = self.start
        guess, size = loop.closed(self.iterated.guess, start.t, start.driven, start.parameters)
        if not float(size) < CLOSED:
            raise AssemblyError(
                f"the loops closed by {loop.joints} cannot be assembled from the given posture at"
                f" the start of the motion{self.where()}{start.note}"
            )
        self.iterated.guess[:] = guess.full().ravel().tolist()
        self.numbers.note(self.iterated.symbols, self.iterated.guess)
        for coordinate in (c for block in self.residuals for c in block.unknown):
            self.numbers.note(coordinate.variables, self.numbers.of(self.known[coordinate]))

    def where(self) -> str:
        """Return the values of drives at the start, in words."""
        driven = [c for c in self.multibody.coordinates if c.driven]
        return where((c.name, c.kind, v) for c, v in zip(driven, self.start.driven, strict=True))

    def finish(self, blocks: tuple[Block, ...]) -> Kinematics:
        """Rates and accelerations, block by block, and the substitution of everything."""
        body, newton, found = self.multibody, self.newton(), self.found
        if body.sphericals:
            found.change(self.iterated.placed)
        for symbols, direction in self._asides():
            found.note(symbols, column(direction))
        for spherical in body.sphericals:
            found.note(spherical.side, ca.SX(self._side(spherical)))
            found.note(spherical.axes, self.iterated.placed(spherical.axes))
        driven = (
            column(c.rate for c in body.coordinates if c.driven),
            column(c.acceleration for c in body.coordinates if c.driven),
        )
        found.note(ca.vertcat(*driven), ca.vertcat(self.dd, self.ddd))
        systems: list[tuple[Block, LinearSystem]] = []
        residuals: dict[str, Any] = {}
        redundancy_residuals: dict[str, Any] = {}
        for block in blocks:
            rates = column(c.rate for c in block.unknown)
            accelerations = column(c.acceleration for c in block.unknown)
            still = ca.SX.zeros(len(block.unknown))
            # Of these it matters beside what equations are large, and what is left open.
            judged = block in self.residuals or len(block.equations) > len(block.unknown)
            units = found.put_into(lengths(body, block, self.length, sizes=False)) if judged else 1
            system = LinearSystem.of(found.put_into(block.jacobian), units)
            for symbols, residual in (
                (rates, block.residual_rate),
                (accelerations, block.residual_acceleration),
            ):
                remaining = found.put_into(ca.substitute(residual, symbols, still))
                found.note(symbols, system.solve(-remaining))
            systems.append((block, system))
            if block in self.residuals:
                volume = system.volume
                if system.free:
                    volume, signed = ca.fabs(volume), signed_volume(body, block, self.numbers)
                    if signed is not None:
                        volume = ca.copysign(volume, found.put_into(signed))
                self._note_closure(block, math.copysign(1.0, self.numbers.of(volume)[0]) * volume)
            if system.free or body.mechanism.rounding:
                missed = found.put_into(redundancy_residual(body, block))
                if block.name in redundancy_residuals:
                    missed = ca.fmax(missed, redundancy_residuals[block.name])
                redundancy_residuals[block.name] = missed
            else:
                residuals[block.name] = residuals.get(block.name, 0) + found.put_into(
                    loop_residual(body, block, self.length)
                )
        return Kinematics(
            inputs={
                "t": body.mechanism.time,
                "d": self.d,
                "d_rate": self.dd,
                "d_acceleration": self.ddd,
                "z": self.iterated.symbols,
                "p": body.mechanism.symbols,
            },
            found=found,
            systems=tuple(systems),
            closures={
                name: self.iterated.placed(_nearest(of)) for name, of in self.closures.items()
            },
            residuals=residuals,
            redundancy_residuals=redundancy_residuals,
            newton=newton,
            wrapped=frozenset(self.wrapped),
            deviations=self.deviations,
        )

    def _asides(self) -> Iterator[tuple[ca.SX, Vector]]:
        """The symbols of y axes of two-force links that were not declared, with the ground's axes
        that are most across these at the start.
        """
        for one in self.multibody.tree.two_force_links:
            if not one.aimed:
                axis = self.multibody.frames[one.link.name].rotation.x
                yield column(one.aside), AXES[most_across(self.numbers.of(column(axis)))]

    def _side(self, spherical: SphericalCoordinates) -> int:
        """The sign of the cosine of a ball's second turn with which its turns at the start are
        nearest to the posture.
        """
        rough = [
            self.posture.get(c.name, 0.0)
            for c in self.multibody.coordinates
            if c.spherical is spherical
        ]
        angles = ca.vertcat(*self.multibody.turns_of(spherical).angles)
        modes = {
            side: self.numbers.of(ca.substitute(angles, spherical.side, side)) for side in (1, -1)
        }
        apart = {
            side: sum(
                abs(math.remainder(a - b, math.tau))
                for a, b in zip(rough, modes[side], strict=True)
            )
            for side in modes
        }
        return -1 if apart[-1] < apart[1] else 1

    def newton(self) -> NewtonLoop | None:
        """The iteration of all blocks without a closed form, together."""
        if not self.residuals:
            return None
        residuals = self.found.put_into(column(block.residual for block in self.residuals))
        rows = [equation for block in self.residuals for equation in block.equations]
        correction, relative = self.iterated.step(residuals, row_units(self.multibody, rows))
        mechanism = self.multibody.mechanism
        inputs = {"z": self.iterated.symbols, "t": mechanism.time, "d": self.d}
        inputs["p"] = mechanism.symbols
        step = graph("loops", inputs, correction=correction, size=relative)
        names = tuple(block.name for block in self.residuals)
        joints = ", ".join(block.joints for block in self.residuals)
        return NewtonLoop(
            step, tuple(self.iterated.guess), tuple(self.iterated.turning), names, joints
        )


def where(coordinates: Iterable[tuple[str, str, float]]) -> str:
    """Coordinates by joint, kind and value, to end a message with; nothing where there are none."""
    listed = ", ".join(describe_coordinate(*coordinate) for coordinate in coordinates)
    return f", where {listed}" if listed else ""


def describe_coordinate(joint: str, kind: str, value: float) -> str:
    """A coordinate's value for a reader, to whom what is zero but for rounding is 0."""
    value = round(value, _READ[kind]) + 0.0
    return (
        f"{joint} = {value:.6g} rad ({math.degrees(value):.6g} deg)"
        if kind == "angle"
        else f"{joint} = {value:.6g} m"
    )


def _nearest(closures: Sequence[tuple[ca.SX, bool]]) -> ca.SX:
    """The least of closures of blocks that one joint closes, which are sines or squares of sines: a
    sine where one of them is.
    """
    sine = any(is_sine for _, is_sine in closures)
    return functools.reduce(
        ca.fmin, (ca.sqrt(value) if sine and not is_sine else value for value, is_sine in closures)
    )


def _numbers(unknown: Sequence[Coordinate], values: Sequence[float]) -> dict[Coordinate, float]:
    starts = itertools.accumulate((c.variables.numel() for c in unknown), initial=0)
    return {
        c: math.atan2(values[k + 1] + 0.0, values[k]) if c.kind == "angle" else values[k]
        for c, k in zip(unknown, starts, strict=False)
    }

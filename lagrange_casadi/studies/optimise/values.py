"""Quantities of a graph at a point as CasADi functions of the parameters, with derivatives of any
order.

A moment is given by its share of the time from the first instant to the last, so that instants may
go with the parameters.

Iterated coordinates are the solution of the loops there, by ``casadi.rootfinder``: its derivatives
are those of the implicit function theorem.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from typing import Any

import casadi as ca
import numpy as np

from ...base.arrays import Array, Expression
from ...base.quantities import Column, Output
from ...base.symbolic import symbolic, symbolic_property
from ...base.tables import table_of
from ...engine.program import Program
from ...engine.reciprocals import differentiable
from ...engine.section_function import Place
from ...errors import DeclarationError
from ...model.limits import END
from ...results.sensitivity.jacobian import resultant
from ..designs.design_times import DesignTimes
from .fatigue_limits import Tired
from .sampled_design import Point
from .terms import tired_link

_NUDGE, _NEAR, _REACH = 1e-2, 1e-2, 8.0
"""Steps between instants: of which second derivatives are taken, in which a smooth peak is where it
was found, and which it follows at most."""


@dataclass(frozen=True, eq=False)
class Followed:
    """A quantity at a point, which may follow its peak as parameters change.

    ``value(share, guess, p, xi, place)``; ``slopes`` of the same are its derivatives by share and
    xi (2,); ``moved`` is the value where one step of Newton's method leads, which takes ``turn``
    and ``reach`` too: less the inverse of the second derivatives, three numbers, and how far to go
    in share and in xi at most. ``place`` has ``size`` numbers.

    A peak of F(s, p) is at F_s = 0. With F_ss of the parameters that are known, s - F_s(s, p)/F_ss
    is there but for the square of what the parameters change, and F is the peak's value but for the
    fourth power.
    """

    value: Any
    slopes: Any
    moved: Any
    size: int

    def following(self, point: Point, p: Array, sign: float, step: float, *, free: bool) -> Point:
        """A local peak of the value times ``sign``, and how it follows as parameters change, unless
        it is at a kink or an end.

        ``free`` may xi be; ``step`` is that between instants.
        """
        at, nudges, size = (
            np.array([point.share, point.xi]),
            np.array([_NUDGE * step, _NUDGE]),
            1 + free,
        )
        if not (at[:size] > 0.0).all() or not (at[:size] < 1.0).all():
            return point
        guess, place = list(point.guess), point.where(self.size)

        def slopes(at: Array) -> Array:
            return np.asarray(self.slopes(at[0], guess, p, at[1], place).full().ravel()[:size])

        directions = np.eye(2)[:size] * nudges
        bend = np.array(
            [(slopes(at + nudge) - slopes(at - nudge)) / (2 * nudge.sum()) for nudge in directions]
        )
        bend = (bend + bend.T) / 2
        if not np.isfinite(bend).all() or not (np.linalg.eigvalsh(sign * bend) < 0.0).all():
            return point
        turn = np.zeros((2, 2))
        turn[:size, :size] = -np.linalg.inv(bend)
        away = turn[:, :size] @ slopes(at)
        if not (np.abs(away) <= _NEAR * np.array([step, 1.0])).all():
            return point
        reach = (_REACH * step, 0.1 if free else 0.0)
        rotation = (float(turn[0, 0]), float(turn[0, 1]), float(turn[1, 1]))
        return replace(
            point,
            share=float(point.share + away[0]),
            xi=float(point.xi + away[1]),
            turn=rotation,
            reach=reach,
        )

    @classmethod
    def of(cls, value: ca.Function, size: int) -> Followed:
        """Make it for a function."""
        smooth = value.is_a("SXFunction")
        kind, names = (ca.SX if smooth else ca.MX), ["share", "guess", "p", "xi", "place"]
        given: list[Any] = [kind.sym(name, value.size1_in(k)) for k, name in enumerate(names)]
        share, guess, p, xi, place = given
        turn, reach = (kind.sym(name, n) for name, n in (("turn", 3), ("reach", 2)))
        by = [ca.vertcat(share, xi)] if smooth else [share, xi]
        at = ca.vertcat(*(ca.densify(ca.gradient(value(*given), x)) for x in by))
        away: list[Any] = [turn[0] * at[0] + turn[1] * at[1], turn[1] * at[0] + turn[2] * at[1]]
        there = [
            x + ca.fmin(ca.fmax(far, -most), most)
            for x, far, most in zip((share, xi), away, (reach[0], reach[1]), strict=True)
        ]
        options = {"cse": True} if smooth else {}
        slopes = ca.Function("slopes", given, [at], options)
        moved = value(there[0], guess, p, there[1], place)
        return cls(
            value, slopes, ca.Function("moved", [*given, turn, reach], [moved], options), size
        )


@dataclass(frozen=True, eq=False)
class PointValues:
    """The functions of a graph's quantities at points."""

    program: Program
    times: DesignTimes

    @cached_property
    def of(self) -> Callable[[Output], Followed]:
        """A quantity at a point; it is made once.

        ``place`` has a 1 where a section force is meant, and 0 elsewhere: first at ``xi``, then at
        each side of each station.
        """
        return cache(self._made)

    @cached_property
    def tired(self) -> Callable[[str], Tired]:
        """A link whose utilisation against fatigue is a term; it is made once."""
        return cache(partial(Tired, self.program))

    @symbolic
    def _made(self, quantity: Output) -> Followed:
        t, d, rate, acceleration, z, p = inputs = self._instant.sx_in()
        xi = ca.SX.sym("xi")
        out = self._instant(*inputs)
        if name := tired_link(quantity):
            tired = self.tired(name)
            value = tired.cycle(
                self._at_time([*inputs, xi, ca.SX.sym("place")], tired.stresses(out, p, xi))
            )
            return Followed.of(value, value.numel_in(4))
        table = table_of(self.program.data.space)
        columns: dict[Column, Any] = {output: out[k] for output, k in self.program.outputs.items()}
        if quantity.group == "section":
            link = self.program.data.section(quantity.part, columns, p)
            places = [Place(xi), *(mark for mark in link.marks if mark.load_point)]
            names = table.parts("section", quantity.member)
            sizes = [
                resultant([link.at(name, place, END["double"]) for name in names])
                for place in places
            ]
        else:
            sizes = [
                resultant([columns[part] for part in quantity.components(table) if part in columns])
            ]
        place = ca.SX.sym("place", len(sizes))
        # What is not meant may have no value, as a size at zero has no slope.
        meant = sum((ca.if_else(place[k] > 0, size, 0) for k, size in enumerate(sizes)), ca.SX(0))
        return Followed.of(
            self._at_time([t, d, rate, acceleration, z, p, xi, place], ca.SX(meant)), len(sizes)
        )

    @symbolic
    def closures(self) -> ca.Function | None:
        """``value(share, guess, p, xi, place)``: the squares of the sines of all loops'
        transmission angles, None without loops.

        Of an iterated loop it is the square of its volume.
        """
        names = self.program.checks("closure")
        if not names:
            return None
        inputs = self._instant.sx_in()
        out = self._instant(*inputs)
        found = [
            out[k] * out[k] * ca.sign(out[k]) if self.program.iterates(name) else out[k]
            for name, k in names.items()
        ]
        return self._at_time([*inputs, ca.SX.sym("xi"), ca.SX.sym("place", 1)], ca.vertcat(*found))

    @symbolic_property
    def _instant(self) -> ca.Function:
        return differentiable(self.program.instant)

    def _at_time(self, inputs: list[Expression], value: Expression) -> ca.Function:
        """The function with its drives and loops inside."""
        program = self.program
        at_drives = ca.Function("at_drives", inputs, [ca.densify(value)], {"cse": True})
        smooth = program.newton is None
        kind = ca.SX if smooth else ca.MX
        sizes = [
            1,
            program.instant.size1_in("z"),
            program.instant.size1_in("p"),
            1,
            inputs[-1].numel(),
        ]
        given: list[Any] = [
            kind.sym(name, n)
            for name, n in zip(("share", "guess", "p", "xi", "place"), sizes, strict=True)
        ]
        share, guess, p, xi, place = given
        first, last = self._span(p)
        t = first + share * (last - first)
        d, rate, acceleration = program.laws.motion.call([t, p])
        z = guess
        if program.newton is not None:
            z = self._loops(guess, ca.vertcat(t, d, p))
        found = at_drives.call([t, d, rate, acceleration, z, p, xi, place])
        return ca.Function("at_time", given, found, {"cse": True} if smooth else {})

    @symbolic_property
    def _span(self) -> ca.Function:
        """The first and the last instant as functions of the parameters.

        Raises :class:`.DeclarationError` where a drive says when they are, and its motion can be
        inverted for numbers alone.
        """
        times, symbols = self.times, ca.SX.sym("p", len(self.program.data.parameters))
        if times.common:
            even = times.default[1]
            return ca.Function("span", [symbols], [ca.DM(float(even[0])), ca.DM(float(even[-1]))])
        ends: Any = times.timing.ends(symbols)
        if times.law is not None:
            if not times.law.steady:
                raise DeclarationError(
                    f"optimise: the motion of joint '{times.timing.joint}', which defines the"
                    " instants, depends on parameters and is not uniform; give t as expressions"
                    " of the parameters"
                )
            d, rate, _ = ca.vertsplit(times.law.law(0.0, symbols))
            ends = [(bound - d) / rate for bound in ends]
        return ca.Function("span", [symbols], [ca.densify(ca.SX(end)) for end in ends])

    @symbolic_property
    def _loops(self) -> ca.Function:
        """The loops' solution near a guess."""
        assert self.program.newton is not None
        step = self.program.newton.step
        z, t, d, p = step.sx_in()
        correction = step(z, t, d, p)[0]
        residual = ca.Function("residual", [z, ca.vertcat(t, d, p)], [correction])
        options = {"abstol": 1e-13, "max_iter": 50, "error_on_fail": False}
        return ca.rootfinder("loops", "newton", residual, options)

"""The nonlinear program of a search: a design's terms held at some points, solved by IPOPT with
exact derivatives.

A peak is the largest of what a quantity is at all times and places. The program knows some of these
points; the search adds those at which its solution exceeds a limit, until there are none. The
points are parameters of the program, so it is built once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.ipopt import ipopt
from ...base.symbolic import symbolic
from ..designs.energy import DriveEnergy
from ..designs.engine import DesignEngine
from .conditions import Conditions, conditions
from .problem import Box, Problem
from .sampled_design import Point
from .terms import Constraint, Term
from .values import PointValues

_NUMBERS = 8
"""Number of entries of a point, beside its place and its guess."""

_FEW, _LARGE = 8, 4000
"""Points of a term for which there is room at first; and instructions beyond which second
derivatives are not formed.
"""


@dataclass(frozen=True, eq=False)
class Held:
    """A ``constraint`` that is held at points; the limit of the objective does not count.

    ``scale`` is about how large its term is. ``points`` are those that are known.
    """

    constraint: Constraint
    scale: float
    points: list[tuple[Point, float]] = field(default_factory=list)

    @property
    def bound(self) -> float:
        """Upper bound of the term, times -1 if the limit is the least."""
        return -self.constraint.limit if self.constraint.least else self.constraint.limit

    def add(self, point: Point, sign: float, near: float) -> bool:
        """Hold the term at one point more, times ``sign``, unless it is as ``near`` one; whether it
        was added.
        """
        for other, its in self.points:
            same = its == sign and other.place == point.place
            if same and abs(other.share - point.share) <= near and abs(other.xi - point.xi) <= 1e-9:
                return False
        self.points.append((point, sign))
        return True


@dataclass(frozen=True)
class Found:
    """A solution of the program: shares ``x``, the largest ``objective`` at the points,
    multipliers, and how good it is.

    ``multipliers`` are by constraint what the objective gains for a unit of its limit, ``bounds``
    those of the shares. ``conditions`` are those of an optimum, ``status`` is what IPOPT says.
    """

    x: Array
    objective: float
    multipliers: tuple[float, ...]
    bounds: Array
    conditions: Conditions
    status: str


@dataclass(frozen=True, eq=False)
class _Built:
    """A program with room for some points of each term; ``rows`` are those of the constraints,
    objective first.
    """

    solver: Any
    slopes: Any
    rows: list[slice]


class Numbers(ca.Callback):
    """A number as a function of ``size`` parameters, evaluated as it is, with its ``slopes``; or
    these by themselves.
    """

    def __init__(
        self,
        value: Callable[[Array], npt.ArrayLike],
        size: int,
        slopes: Callable[[Array], npt.ArrayLike] | None = None,
        name: str = "number",
        options: dict[str, Any] | None = None,
    ) -> None:
        super().__init__()
        self.value, self.size, self.slopes = value, size, slopes
        self.kept: list[ca.Callback] = []
        self.construct(name, options or {})

    def get_n_in(self) -> int:
        """The parameters, and for slopes the number too."""
        return 1 if self.slopes else 2

    def get_sparsity_in(self, number: int) -> ca.Sparsity:
        """All parameters, and the number."""
        return ca.Sparsity.dense(1 if number else self.size)

    def get_sparsity_out(self, _: int) -> ca.Sparsity:
        """The number, or a row of slopes."""
        return ca.Sparsity.dense(1, 1 if self.slopes else self.size)

    def eval(self, arg: Sequence[Any]) -> list[Any]:
        """Evaluate it."""
        return [np.atleast_2d(self.value(np.asarray(arg[0], float).ravel()))]

    def has_jacobian(self) -> bool:
        """Return whether it has slopes."""
        return self.slopes is not None

    def get_jacobian(
        self, name: str, _inputs: Sequence[str], _outputs: Sequence[str], options: dict[str, Any]
    ) -> ca.Function:
        """The derivatives by all parameters."""
        assert self.slopes is not None
        self.kept.append(Numbers(self.slopes, self.size, None, name, options))
        return self.kept[-1]


class NonlinearProgram:
    """The program of a problem, whose limits are numbers that it is given; it is built once for
    each size.
    """

    @symbolic
    def __init__(
        self, engine: DesignEngine, values: PointValues, box: Box, problem: Problem, least: float
    ) -> None:
        self.values, self.box, self.instants, self.least_closure = values, box, engine.count, least
        self.objective, self.terms = problem.objective, problem.terms
        self.closures, self.averaged = values.closures(), any(one.averaged for one in self.terms)
        # The objective is the largest of several values, which a variable of its own is above.
        self.levelled = self.objective.kind in ("peak", "max")
        energies = {
            term: DriveEnergy(engine, term.output)
            for term in self.terms
            if term.output is not None and term.kind == "fluctuation"
        }
        self.energies = {
            term: Numbers(energy.fluctuation, box.p.size, energy.slopes)
            for term, energy in energies.items()
        }
        self.large = (
            values.program.instant.n_instructions() > _LARGE
            or values.program.instant.size1_in("z") > 0
            or bool(self.energies)
        )
        self.built: dict[int, _Built] = {}

    def solve(
        self, x: Array, held: Sequence[Held], closures: Sequence[Point], averages: Sequence[Point]
    ) -> Found:
        """The best design near shares ``x``, as far as points show: those of ``held`` terms,
        objective first, and of ``closures``.

        ``averages`` are all instants, for means.
        """
        many = max([len(each.points) for each in held] + [len(closures), 1])
        capacity = _FEW
        while capacity < many:
            capacity *= 2
        if capacity not in self.built:
            self.built[capacity] = self._build(held, capacity)
        built = self.built[capacity]
        given = np.concatenate(
            [np.array([(each.bound / each.scale, 1.0 / each.scale) for each in held]).ravel()]
            + [
                self._packed(each.points, capacity, self.values.of(output).size)
                for each in held
                if each.points and (output := each.constraint.term.output)
            ]
            + [self._packed([(point, 1.0) for point in closures], capacity, 1)]
            * (self.closures is not None)
            + [np.array([point.guess for point in averages]).ravel()] * bool(self.averaged)
        )
        n = x.size
        start, low, high = x, np.zeros(n), np.ones(n)
        if self.levelled:
            level = max(sign * point.value for point, sign in held[0].points) / held[0].scale
            start, low, high = np.append(x, level), np.append(low, -np.inf), np.append(high, np.inf)
        found = built.solver(x0=start, p=given, lbx=low, ubx=high, lbg=-np.inf, ubg=0.0)
        status = str(built.solver.stats()["return_status"])
        at, by_g, by_x = (found[name].full().ravel() for name in ("x", "lam_g", "lam_x"))
        scale = held[0].scale
        multipliers = tuple(
            float(np.sum(by_g[rows])) * scale / each.scale
            for rows, each in zip(built.rows[1:], held[1:], strict=True)
        )
        shares = np.clip(at[:n], 0.0, 1.0)
        found_conditions = conditions(
            built.slopes, at, float(found["f"]), by_g, by_x, given, n, formed=not self.large
        )
        return Found(
            shares,
            float(found["f"]) * scale,
            multipliers,
            by_x[:n] * scale,
            found_conditions,
            status,
        )

    def _packed(self, points: Sequence[tuple[Point, float]], capacity: int, size: int) -> Array:
        """Points of as many places as their ``size`` says, as many as there is room for; the first
        one stands for those that lack.
        """
        n = len(self.box.names)
        rows = np.zeros((capacity, _NUMBERS + n + size + self.values.program.instant.size1_in("z")))
        for k in range(capacity):
            point, sign = points[k if k < len(points) else 0]
            where = point.where(size)
            rows[k] = np.concatenate(
                [
                    [point.share, point.xi, sign],
                    point.turn,
                    point.reach,
                    point.drift or np.zeros(n),
                    where,
                    point.guess,
                ]
            )
        return rows.ravel()

    @symbolic
    def _build(self, held: Sequence[Held], capacity: int) -> _Built:
        box, n, nz = self.box, len(self.box.names), self.values.program.instant.size1_in("z")
        x, limits = ca.MX.sym("x", n), ca.MX.sym("limits", 2, len(held))
        level = ca.MX.sym("level", int(self.levelled))
        chosen = ca.DM.zeros(box.p.size, n)
        for k, place in enumerate(box.places):
            chosen[place, k] = box.high[k] - box.low[k]
        fixed = box.p.copy()
        fixed[list(box.places)] = box.low
        p = ca.DM(fixed) + ca.mtimes(chosen, x)
        given: list[Any] = [ca.vec(limits)]
        rows: list[Any] = []
        places: list[slice] = []

        def points(function: ca.Function, size: int, *, moved: bool) -> tuple[ca.MX, ca.MX]:
            """Values at as many points as there is room for, and their signs."""
            symbol = ca.MX.sym("points", _NUMBERS + n + size + nz, capacity)
            given.append(ca.vec(symbol))
            ends = np.cumsum([0, 1, 1, 1, 3, 2, n, size, nz]).tolist()
            share, xi, sign, turn, reach, drift, place, guess = ca.vertsplit(symbol, ends)
            share = ca.fmin(ca.fmax(share + ca.mtimes(x.T, drift), 0.0), 1.0)
            further = [turn, reach] if moved else []
            return (
                function.map(capacity)(
                    share, guess, ca.repmat(p, 1, capacity), xi, place, *further
                ),
                sign,
            )

        guesses = ca.MX.sym("guesses", nz, self.instants)
        best: Any = level
        for number, each in enumerate(held):
            term, (limit, over) = each.constraint.term, (limits[0, number], limits[1, number])
            if not term.pointed:
                if term in self.energies:
                    value = self.energies[term](p)
                elif term.averaged:
                    value = self._average(term, p, guesses)
                else:
                    value = term.of_parameters(self.values.program.data)(p)
                row = (-value if each.constraint.least else value) * over - limit
                best = value * over if number == 0 else best
                held_rows = ca.MX(0, 1) if number == 0 else row
            else:
                assert term.output is not None
                followed = self.values.of(term.output)
                value, sign = points(followed.moved, followed.size, moved=True)
                held_rows = ca.vec(sign * value * over - (level if number == 0 else limit))
            begin = places[-1].stop if places else 0
            rows.append(held_rows)
            places.append(slice(begin, begin + held_rows.numel()))
        if self.closures is not None:
            value, _ = points(self.closures, 1, moved=False)
            rows.append(ca.vec(self.least_closure - value))
        if self.averaged:
            given.append(ca.vec(guesses))
        variables, parameters, g = ca.vertcat(x, level), ca.vertcat(*given), ca.vertcat(*rows)
        options: dict[str, object] = {"tol": 1e-10, "max_iter": 200, "bound_relax_factor": 0.0}
        if self.large:
            options["hessian_approximation"] = "limited-memory"
        program = {"x": variables, "p": parameters, "f": best, "g": g}
        solver = ipopt("optimise", program, **options)
        by_g = ca.MX.sym("by_g", g.numel())
        slope = ca.gradient(best + ca.dot(by_g, g), variables)
        parts = ca.horzcat(ca.gradient(best, variables), ca.jtimes(g, variables, by_g, True))
        hessian = ca.MX(0, 0) if self.large else ca.densify(ca.jacobian(slope, variables))
        outputs = [slope, parts, g, ca.jacobian(g, variables), hessian]
        return _Built(solver, ca.Function("slopes", [variables, by_g, parameters], outputs), places)

    def _average(self, term: Term, p: ca.MX, guesses: ca.MX) -> ca.MX:
        """A mean over time, by trapezia, as sweeps have it."""
        assert term.output is not None
        followed, n = self.values.of(term.output), self.instants
        weights = np.ones(n)
        weights[[0, -1]] = 0.5 if n > 1 else 1.0
        place = ca.DM.zeros(followed.size, n)
        place[0, :] = 1
        shares = ca.DM(np.linspace(0.0, 1.0, n)).T
        values = followed.value.map(n)(
            shares, guesses, ca.repmat(p, 1, n), ca.DM.zeros(1, n), place
        )
        weighted = ca.DM(weights / weights.sum())
        average: ca.MX = (
            ca.mtimes(values, weighted)
            if term.kind == "mean"
            else ca.sqrt(ca.mtimes(values * values, weighted))
        )
        return average

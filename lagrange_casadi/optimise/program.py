"""The nonlinear program of a search: a design's terms held at some points, solved by IPOPT with exact derivatives.

A peak is the largest of what a quantity is at all times and places. The program knows some of these points; the search adds those
at which its solution exceeds a limit, until there are none. The points are parameters of the program, so it is built once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from ..declare.density import Array
from ..errors import DeclarationError
from .look import Point
from .terms import Constraint, Term
from .values import PointValues

_NUMBERS = 8
"""Of a point, beside its place and its guess."""

_FEW, _LARGE = 8, 4000
"""Points of a term for which there is room at first; and instructions beyond which second derivatives are not formed."""


@dataclass(frozen=True, eq=False)
class Box:
    """The parameters that are chosen: their ``places`` among all, bounds, and the values ``p`` of all others."""

    names: tuple[str, ...]
    places: tuple[int, ...]
    low: Array
    high: Array
    p: Array

    def all(self, x: Array) -> Array:
        """The values of all parameters, for shares ``x`` (n,) of the way from the low bounds to the high ones."""
        p: Array = self.p.copy()
        p[list(self.places)] = np.clip(self.low + x * (self.high - self.low), self.low, self.high)
        return p

    def holds(self, name: str, value: float) -> bool:
        """Whether a value of a parameter that is chosen is within its bounds."""
        k = self.names.index(name)
        return bool(self.low[k] <= value <= self.high[k])

    def share(self, p: Array) -> Array:
        """The shares for values of all parameters."""
        return np.asarray((p[list(self.places)] - self.low) / (self.high - self.low))


@dataclass(frozen=True, eq=False)
class Held:
    """A term that is held at points: not more than ``limit``, or less where ``least``; the objective has none.

    ``scale`` is about how large it is. ``points`` are those that are known.
    """

    term: Term
    limit: float | None
    scale: float
    least: bool = False
    points: list[tuple[Point, float]] = field(default_factory=list)

    @property
    def bound(self) -> float:
        """What the term, times -1 where the limit is the least, is held below."""
        assert self.limit is not None
        return -self.limit if self.least else self.limit

    def add(self, point: Point, sign: float, near: float) -> bool:
        """Hold the term at one point more, times ``sign``, unless it is as ``near`` one in time; whether it was added."""
        for other, its in self.points:
            if its == sign and other.place == point.place and abs(other.t - point.t) <= near and abs(other.xi - point.xi) <= 1e-9:
                return False
        self.points.append((point, sign))
        return True


@dataclass(frozen=True)
class Found:
    """A solution of the program: shares ``x``, the largest ``objective`` at the points, multipliers, and how good it is.

    ``multipliers`` are by constraint what the objective gains for a unit of its limit, ``bounds`` those of the shares. For
    ``residual`` and ``curvature`` see :class:`.Optimum`; ``status`` is what IPOPT says.
    """

    x: Array
    objective: float
    multipliers: tuple[float, ...]
    bounds: Array
    residual: float
    curvature: float
    status: str


class Program:
    """The program with room for some points of each term; it is built anew where there are more."""

    def __init__(
        self,
        values: PointValues,
        box: Box,
        objective: Term,
        constraints: Sequence[Constraint],
        instants: Array,
        least_closure: float,
    ) -> None:
        if not ca.has_nlpsol("ipopt"):
            raise DeclarationError("optimise: the CasADi at hand has no IPOPT; install CasADi from PyPI, whose wheel contains it")
        self.values, self.box, self.objective, self.constraints = values, box, objective, tuple(constraints)
        self.instants, self.least_closure = instants, least_closure
        self.closures = values.closures()
        terms = [term for term in (objective, *(c.term for c in constraints)) if term.output is not None]
        self.functions = {term.name: values.of(term.output) for term in terms if term.output is not None}
        self.room = 0
        self.solver: Any | None = None

    def solve(self, x: Array, held: Sequence[Held], closures: Sequence[Point], averages: Sequence[Point]) -> Found:
        """The best design near shares ``x``, as far as points tell: those of ``held`` terms, objective first, and of ``closures``.

        ``averages`` are all instants, for means.
        """
        many = max([len(term.points) for term in held] + [len(closures), 1])
        if self.solver is None or many > self.room:
            self.room = max(_FEW, 2 * many)
            self._build(held)
        assert self.solver is not None
        given = np.concatenate(
            [self._packed(term) for term in held if term.points]
            + [self._packed(Held(self.objective, None, 1.0, points=[(point, 1.0) for point in closures]), places=1)] * self.closed
            + [np.array([point.guess for point in averages]).ravel()] * bool(self.averaged)
        )
        start = np.append(x, self._level(held)) if self.levelled else x
        n = x.size
        low, high = np.zeros(start.size), np.ones(start.size)
        if self.levelled:
            low[n], high[n] = -np.inf, np.inf
        found = self.solver(x0=start, p=given, lbx=low, ubx=high, lbg=-np.inf, ubg=0.0)
        status = str(self.solver.stats()["return_status"])
        at, g_multipliers, x_multipliers = (found[name].full().ravel() for name in ("x", "lam_g", "lam_x"))
        residual, curvature = self._conditions(at, g_multipliers, x_multipliers, given)
        multipliers = []
        scale = held[0].scale
        for rows, term in zip(self.rows[1:], held[1:], strict=True):
            multipliers.append(float(np.sum(g_multipliers[rows])) * scale / term.scale)
        shares = np.clip(at[:n], 0.0, 1.0)
        return Found(shares, float(found["f"]) * scale, tuple(multipliers), x_multipliers[:n] * scale, residual, curvature, status)

    @property
    def levelled(self) -> bool:
        """Whether the objective is the largest of several values, which a variable of its own is above."""
        return self.objective.kind in ("peak", "max")

    def _level(self, held: Sequence[Held]) -> float:
        return max(sign * point.value for point, sign in held[0].points) / held[0].scale

    @property
    def closed(self) -> bool:
        """Whether there are loops."""
        return self.closures is not None

    @property
    def averaged(self) -> bool:
        """Whether some term is an average."""
        return any(term.averaged for term in (self.objective, *(c.term for c in self.constraints)))

    def _packed(self, held: Held, places: int | None = None) -> Array:
        """The points of a term, those there is room for; the first one stands for those that lack."""
        size = self.functions[held.term.name].size if places is None else places
        rows = np.zeros((self.room, _NUMBERS + size + self.values.graph.instant.size1_in("z")))
        for k in range(self.room):
            point, sign = held.points[k if k < len(held.points) else 0]
            where = np.zeros(size)
            where[min(point.place, size - 1)] = 1.0
            rows[k] = np.concatenate([[point.t, point.xi, sign], point.turn, point.reach, where, point.guess])
        return rows.ravel()

    def _build(self, held: Sequence[Held]) -> None:
        box, n, nz = self.box, len(self.box.names), self.values.graph.instant.size1_in("z")
        x = ca.MX.sym("x", n)
        level = ca.MX.sym("level", int(self.levelled))
        chosen = ca.DM.zeros(box.p.size, n)
        for k, place in enumerate(box.places):
            chosen[place, k] = box.high[k] - box.low[k]
        fixed = box.p.copy()
        fixed[list(box.places)] = box.low
        p = ca.DM(fixed) + ca.mtimes(chosen, x)
        given: list[Any] = []
        self.rows: list[slice] = []
        rows: list[Any] = []

        def points(function: Any, size: int, *, moved: bool) -> tuple[Any, Any]:
            """Values at as many points as there is room for, and their signs."""
            symbol = ca.MX.sym("points", _NUMBERS + size + nz, self.room)
            given.append(ca.vec(symbol))
            t, xi, sign, turn, reach, place, guess = ca.vertsplit(symbol, [0, 1, 2, 3, 6, 8, 8 + size, 8 + size + nz])
            further = [turn, reach] if moved else []
            return function.map(self.room)(t, guess, ca.repmat(p, 1, self.room), xi, place, *further), sign

        def hold(row: Any) -> None:
            start = sum(part.numel() for part in rows)
            rows.append(ca.vec(row))
            self.rows.append(slice(start, start + row.numel()))

        averages: list[tuple[int, Term]] = []
        best: Any = None
        for number, term in enumerate(held):
            if term.term.averaged:
                averages.append((number, term.term))
                hold(ca.MX(0, 1))
            elif term.term.output is None:
                value = term.term.of_parameters(self.values.graph.scene.mechanism)(p)
                if number == 0:
                    best = value / term.scale
                    hold(ca.MX(0, 1))
                else:
                    hold(self._beyond(value, term))
            else:
                followed = self.functions[term.term.name]
                value, sign = points(followed.moved, followed.size, moved=True)
                limit = level if number == 0 else term.bound / term.scale
                hold(sign * value / term.scale - limit)
        if self.closures is not None:
            value, _ = points(self.closures, 1, moved=False)
            hold(self.least_closure - value)
            self.rows.pop()
        if averages:
            guesses = ca.MX.sym("guesses", nz, self.instants.size)
            given.append(ca.vec(guesses))
            for number, averaged in averages:
                value = self._average(averaged, p, guesses)
                if number == 0:
                    best = value / held[0].scale
                else:
                    start = sum(part.numel() for part in rows)
                    rows.append(self._beyond(value, held[number]))
                    self.rows[number] = slice(start, start + 1)
        best = level if best is None else best
        variables, parameters, g = ca.vertcat(x, level), ca.vertcat(*given), ca.vertcat(*rows)
        large = self.values.graph.instant.n_instructions() > _LARGE or nz > 0
        options: dict[str, Any] = {"print_time": False, "error_on_fail": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
        options |= {"ipopt.tol": 1e-10, "ipopt.max_iter": 200, "ipopt.bound_relax_factor": 0.0, "show_eval_warnings": False}
        options |= {"ipopt.hessian_approximation": "limited-memory"} if large else {}
        problem = {"x": variables, "p": parameters, "f": best, "g": g}
        self.solver = ca.nlpsol("solver", "ipopt", problem, options)
        by_g = ca.MX.sym("by_g", g.numel())
        slope = ca.gradient(best + ca.dot(by_g, g), variables)
        parts = ca.horzcat(ca.gradient(best, variables), ca.jtimes(g, variables, by_g, True))
        hessian = ca.DM.nan(variables.numel(), variables.numel()) if large else ca.jacobian(slope, variables)
        self.slopes = ca.Function(
            "slopes", [variables, by_g, parameters], [slope, parts, ca.densify(hessian), ca.jacobian(g, variables)]
        )

    def _beyond(self, value: Any, held: Held) -> Any:
        return ((-value if held.least else value) - held.bound) / held.scale

    def _average(self, term: Term, p: Any, guesses: Any) -> Any:
        """A mean over time, by trapezia, as sweeps have it."""
        function, size = self.functions[term.name].value, self.functions[term.name].size
        n = self.instants.size
        weights = np.ones(n)
        weights[[0, -1]] = 0.5 if n > 1 else 1.0
        place = ca.DM.zeros(size, n)
        place[0, :] = 1
        values = function.map(n)(ca.DM(self.instants).T, guesses, ca.repmat(p, 1, n), ca.DM.zeros(1, n), place)
        weighted = ca.DM(weights / weights.sum())
        return ca.mtimes(values, weighted) if term.kind == "mean" else ca.sqrt(ca.mtimes(values * values, weighted))

    def _conditions(self, at: Array, by_g: Array, by_x: Array, given: Array) -> tuple[float, float]:
        """What is left of the first-order conditions, and the least curvature along what is free."""
        slope, parts, hessian, jacobian = (part.full() for part in self.slopes(at, by_g, given))
        size = max(float(np.abs(parts).max()), float(np.abs(by_x).max(initial=0.0)), np.finfo(float).tiny)
        residual = float(np.abs(slope.ravel() + by_x).max()) / size
        largest = max(float(np.abs(by_g).max(initial=0.0)), float(np.abs(by_x).max(initial=0.0)), np.finfo(float).tiny)
        active = [jacobian[k] for k in np.flatnonzero(np.abs(by_g) > 1e-6 * largest)]
        active += [np.eye(at.size)[k] for k in np.flatnonzero(np.abs(by_x) > 1e-6 * largest)]
        if not np.isfinite(hessian).all():
            return residual, float("nan")
        free = np.eye(at.size)
        if active:
            _, sizes, rows = np.linalg.svd(np.array(active))
            free = rows[int(np.sum(sizes > 1e-9 * sizes.max())) :].T
        if not free.size:
            return residual, float("nan")
        return residual, float(np.linalg.eigvalsh(free.T @ hessian @ free).min())

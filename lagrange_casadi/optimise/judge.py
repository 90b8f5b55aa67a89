"""A design as it is: the terms of a search by the engine of sweeps, with all that lies between instants."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..declare.density import Array
from ..designs.engine import DesignEngine
from ..instants.refusal import Status
from .look import Look
from .program import Program
from .terms import Constraint, Term
from .tops import Signed, told, top

HOLDS = 1e-7
"""Of its limit: by how much a constraint may be violated that holds."""

_PEAKS, _FEW = 24, 3
"""Local peaks that are held, the largest first, and those among which the largest is looked for."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A design as it is: the value of every term, objective first, and the worst excess over a limit; NaN without a result."""

    p: Array
    values: Array
    excess: float
    look: Look | None
    closure: float = math.nan
    points: tuple[tuple[Signed, ...], ...] = ()

    @property
    def merit(self) -> tuple[float, float]:
        """What a better design has less of."""
        if math.isnan(self.excess):
            return math.inf, math.inf
        return (max(self.excess, 0.0) if self.excess > HOLDS else 0.0), float(self.values[0])


@dataclass(eq=False)
class Judge:
    """What judges designs, by an engine that keeps the terms' quantities, and counts them."""

    engine: DesignEngine
    program: Program
    evaluations: int = 0

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """The constraints of the search."""
        return self.program.constraints

    @property
    def terms(self) -> tuple[Term, ...]:
        """All terms, objective first."""
        return (self.program.objective, *(c.term for c in self.constraints))

    def look(self, p: Array, *, closely: bool = True) -> Judged:
        """A design's terms, by the engine of sweeps; largest and smallest values by their local peaks."""
        self.evaluations += 1
        engine, graph = self.engine, self.program.values.graph
        found = engine.evaluate(p[None], threads=1)
        if found.status[0] != Status.OK:
            return Judged(p, np.full(len(self.terms), np.nan), math.nan, None)
        look, closure = None, math.nan
        if closely or any(term.kind in ("max", "min") for term in self.terms):
            look = Look.at(graph, engine.times.of(p[None])[0][0], p, engine.rung)
            closures = look.closures()
            closure = float(closures.min()) if closures.size else math.nan
            if closures.size and not closure > 0.0:
                return Judged(p, np.full(len(self.terms), np.nan), math.nan, None)
        values, points = [], []
        for term in self.terms:
            own: list[Signed] = []
            if look is not None and term.output is not None and not term.averaged:
                own = self._points(look, term)
                if term.kind == "peak":
                    k = engine.quantities.index(term.name)
                    own = [*told(own, look, float(found.value[0, k]), float(found.t[0, k]), float(found.xi[0, k])), *own]
            points.append(tuple(own))
            if term.output is None:
                values.append(float(term.of_parameters(engine.scene.mechanism)(p)))
            elif term.kind == "peak":
                values.append(abs(float(found.value[0, engine.quantities.index(term.name)])))
            elif term.averaged:
                values.append(float(getattr(found, term.kind)[0, engine.efforts.index(term.name)]))
            else:
                assert look is not None
                tops = self._exact(term, own[:_FEW], look)
                values.append(
                    max((sign * point.value for point, sign in tops), default=math.nan) * (-1 if term.kind == "min" else 1)
                )
        excess = max((c.excess(v) / scale_of(c, v) for c, v in zip(self.constraints, values[1:], strict=True)), default=-math.inf)
        if not math.isnan(closure):
            excess = max(excess, (self.program.least_closure - closure) / self.program.least_closure)
        excess = excess if np.isfinite(values).all() else math.nan
        return Judged(p, np.array(values), excess, look, closure, tuple(points))

    def _points(self, look: Look, term: Term) -> list[Signed]:
        """The local peaks of a term, the largest first, with the signs by which they count."""
        assert term.output is not None
        if term.kind != "peak":
            sign = -1.0 if term.kind == "min" else 1.0
            return [(point, sign) for point in look.points(term.output, sign)]
        return [(point, math.copysign(1.0, point.value)) for point in look.points(term.output, 0.0)]

    def exact(self, term: Term, points: Sequence[Signed], judged: Judged) -> list[Signed]:
        """Local peaks, the smooth ones where the derivatives by time and place are zero, and how they follow from there."""
        assert judged.look is not None
        return self._exact(term, points[:_PEAKS], judged.look)

    def _exact(self, term: Term, points: Sequence[Signed], look: Look) -> list[Signed]:
        followed = self.program.functions[term.name]
        step = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1)
        found = []
        for point, sign in points:
            where = np.zeros(followed.size)
            where[min(point.place, followed.size - 1)] = 1.0
            free = bool(term.output and term.output.group == "section" and point.place == 0 and 0.0 < point.xi < 1.0)
            found.append((top(followed, point, look.p, where, sign, step, (look.t[0], look.t[-1]), free=free), sign))
        return found


def scale_of(constraint: Constraint, value: float) -> float:
    """How large a term is beside which its excess is large or small."""
    return abs(constraint.limit) or abs(value) or 1.0

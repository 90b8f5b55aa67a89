"""A design as it is: the terms of a search by the engine of sweeps, with all that lies between instants."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.status import Status
from ..designs.engine import DesignEngine, Outcome
from .fatigue import tired_link
from .judged import Judged, Signed
from .look import Look, Point
from .problem import Box
from .terms import Term
from .tops import told, top
from .values import PointValues

_BESIDE, _BESIDE_MOST, _STILL = 1e-3, 0.05, 1e-8
"""Of the bounds: how far designs are beside one; and of the time, how far a peak goes there at most, and what is no way at all."""

_PEAKS, _FEW = 24, 3
"""Local peaks that are held, the largest first, and those among which the largest is looked for."""


@dataclass(eq=False)
class Judge:
    """What judges designs by ``terms``, with an engine that keeps their quantities, and counts them."""

    engine: DesignEngine
    values: PointValues
    terms: tuple[Term, ...]
    least_closure: float
    evaluations: int = 0

    def look(self, p: Array) -> Judged:
        """A design's terms, by the engine of sweeps; largest and smallest values by their local peaks."""
        self.evaluations += 1
        found = self.engine.evaluate(p[None], threads=1)
        look = None
        if found.status[0] == Status.OK:
            look = Look.at(self.engine.graph, self.engine.times.of(p[None])[0][0], p, self.engine.rung)
        return self._judged(p, found, 0, look)

    def screen(self, rows: Array) -> list[Judged]:
        """Many designs (n, parameters) at once, by what lanes of designs tell alone where that is enough."""
        self.evaluations += len(rows)
        found = self.engine.evaluate(rows)
        if not any(term.kind in ("max", "min") or tired_link(term.output) for term in self.terms):
            return [self._judged(p, found, k, None) for k, p in enumerate(rows)]
        judged = []
        for k, p in enumerate(rows):
            there = found.status[k] == Status.OK
            look = Look.at(self.engine.graph, self.engine.times.of(p[None])[0][0], p, self.engine.rung) if there else None
            judged.append(self._judged(p, found, k, look))
        return judged

    def _judged(self, p: Array, found: Outcome, row: int, look: Look | None) -> Judged:
        nothing = Judged(p, dict.fromkeys(self.terms, math.nan))
        if found.status[row] != Status.OK:
            return nothing
        closure, closing = math.nan, -math.inf
        if look is not None:
            closures = look.closures()
            if closures.size:
                closure = float(closures.min())
                closing = (self.least_closure - closure) / self.least_closure
                if not closure > 0.0:
                    return nothing
        values, points = {}, {}
        for term in self.terms:
            own: list[Signed] = []
            if look is not None and term.output is not None and not term.averaged:
                own = self._points(look, term)
                if term.kind == "peak" and not tired_link(term.output):
                    k = self.engine.quantities.index(term.name)
                    own = [*told(own, look, float(found.value[row, k]), float(found.t[row, k]), float(found.xi[row, k])), *own]
            points[term] = tuple(own)
            if term.output is None:
                values[term] = float(term.of_parameters(self.engine.graph.data)(p))
            elif link := tired_link(term.output):
                forces = [k for k, name in enumerate(self.engine.quantities) if name.startswith(f"section:{link}:")]
                values[term] = own[0][0].value if own and np.isfinite(found.value[row, forces]).all() else math.nan
            elif term.kind == "peak":
                values[term] = abs(float(found.value[row, self.engine.quantities.index(term.name)]))
            elif term.averaged:
                values[term] = float(getattr(found, term.kind)[row, self.engine.efforts.index(term.name)])
            else:
                assert look is not None
                tops = self.exact(term, own[:_FEW], look)
                values[term] = max((sign * point.value for point, sign in tops), default=math.nan) * (
                    -1 if term.kind == "min" else 1
                )
        judged = Judged(p, values, look, closure, closing, points)
        return judged if judged.has_result else nothing

    def _points(self, look: Look, term: Term) -> list[Signed]:
        """The local peaks of a term, the largest first, with the signs by which they count."""
        assert term.output is not None
        if link := tired_link(term.output):
            return [(point, 1.0) for point in self.values.tired(link).points(self._as_asked(look))]
        if term.kind != "peak":
            sign = -1.0 if term.kind == "min" else 1.0
            return [(point, sign) for point in look.points(term.output, sign)]
        return [(point, math.copysign(1.0, point.value)) for point in look.points(term.output, 0.0)]

    def _as_asked(self, look: Look) -> Look:
        """A design over the instants that are asked for, of which fatigue is, where these are not in equal steps of time."""
        asked = self.engine.times.of(look.p[None])[1][0]
        return look if np.array_equal(asked, look.t) else Look.at(self.engine.graph, asked, look.p, self.engine.rung)

    def drifting(self, term: Term, point: Point, p: Array, box: Box) -> Point:
        """A peak at a kink or a jump that goes with the chosen parameters, seen by designs beside this one.

        The told peak of each is by the same switch where it is near. What does not move is the point itself.
        """
        x, size = box.share(p), len(box.names)
        ways = np.where(x + _BESIDE <= 1.0, _BESIDE, -_BESIDE)
        rows = np.array([box.all(x + way * unit) for way, unit in zip(ways, np.eye(size), strict=True)])
        self.evaluations += size
        found = self.engine.evaluate(rows, threads=1)
        k = self.engine.quantities.index(term.name)
        even = self.engine.times.of(rows)[0]
        shares = (found.t[:, k] - even[:, 0]) / (even[:, -1] - even[:, 0])
        moved = np.where(np.abs(shares - point.share) <= _BESIDE_MOST, shares - point.share, 0.0)
        drift = np.where(np.abs(moved) > _STILL, moved / ways, 0.0)
        if not drift.any():
            return point
        return replace(point, share=float(point.share - drift @ x), drift=tuple(drift.tolist()))

    def exact(self, term: Term, points: Sequence[Signed], look: Look) -> list[Signed]:
        """Local peaks, the smooth ones where the derivatives by time and place are zero, and how they follow from there."""
        assert term.output is not None
        if tired_link(term.output):
            return list(points)
        followed = self.values.of(term.output)
        found = []
        for point, sign in points[:_PEAKS]:
            where = point.where(followed.size)
            free = term.output.group == "section" and point.place == 0 and 0.0 < point.xi < 1.0
            found.append((top(followed, point, look.p, where, sign, look.step, free=free), sign))
        return found

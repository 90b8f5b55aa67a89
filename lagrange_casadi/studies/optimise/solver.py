"""Solver of a search: designs as they are, the terms by the engine of sweeps, with all that lies
between instants; and programs made when they are first needed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.status import Status
from ...errors import DeclarationError
from ..designs.energy import DriveEnergy
from ..designs.engine import DesignEngine
from ..designs.outcome import Outcome
from .nonlinear_program import NonlinearProgram
from .problem import Problem, Question
from .sampled_design import EvaluatedDesign, Point, SampledDesign, Signed
from .terms import Term, tired_link
from .values import PointValues

_BESIDE, _BESIDE_MOST, _STILL = 1e-3, 0.05, 1e-8
"""Distances of neighbouring designs, relative to the bounds; the largest relative change of a
peak's time there, and the least.
"""


@dataclass(frozen=True, eq=False)
class SearchTask:
    """A way to go: a problem, values of all parameters to start from, and how large the problem's
    terms are about.
    """

    problem: Problem
    start: tuple[float, ...]
    scales: tuple[float, ...]


@dataclass(eq=False)
class Solver:
    """A question, ready to be answered: its ``engine`` keeps the quantities of the terms, whose
    ``values`` at points a program has; ``evaluations`` counts designs.
    """

    question: Question
    engine: DesignEngine
    values: PointValues
    programs: dict[Any, NonlinearProgram] = field(default_factory=dict)
    evaluations: int = 0

    @classmethod
    def of(cls, question: Question, engine: DesignEngine) -> Solver:
        """Compile what the question needs beside its engine."""
        solver = cls(question, engine, PointValues(engine.program, engine.times))
        solver.program(
            Problem(question.objectives[0], question.constraints)
        )  # what cannot be differentiated is refused at once
        matters = np.any([solver.depends(term) for term in question.terms], axis=0)
        box = question.box
        if idle := [n for n, k in zip(box.names, box.places, strict=True) if not matters[k]]:
            named = ", ".join(f"'{name}'" for name in idle)
            raise DeclarationError(
                f"over: no objective or limit depends on {named}; remove it from over="
            )
        return solver

    def depends(self, term: Term) -> npt.NDArray[np.bool_]:
        """Return whether a term depends on each parameter."""
        if term.output is None:
            found = term.of_parameters(self.engine.program.data).jac_sparsity(0, 0)
        else:
            found = self.values.of(term.output).value.jac_sparsity(0, 2)
        return np.diff(found.colind()) > 0

    def program(self, problem: Problem) -> NonlinearProgram:
        """Program of a problem, for any limits."""
        known = (problem.objective, *((c.term, c.least) for c in problem.constraints))
        if known not in self.programs:
            box, least = self.question.box, self.question.transmission**2
            self.programs[known] = NonlinearProgram(self.engine, self.values, box, problem, least)
        return self.programs[known]

    def evaluate(self, p: Array) -> EvaluatedDesign:
        """A design's terms, by the engine of sweeps; largest and smallest values by their local
        peaks.
        """
        self.evaluations += 1
        sampled = SampledDesign.at(self.engine, p)
        return self._evaluated(p, sampled.history.outcome, 0, sampled)

    def screen(self, rows: Array) -> list[EvaluatedDesign]:
        """Many designs (n, parameters) at once, by what lanes of designs give alone where that is
        enough.
        """
        self.evaluations += len(rows)
        found = self.engine.evaluate(rows)
        closely = any(
            term.kind in ("max", "min") or tired_link(term.output) for term in self.question.terms
        )
        looked = [closely and status == Status.OK for status in found.status]
        return [
            self._evaluated(p, found, k, SampledDesign.at(self.engine, p) if looked[k] else None)
            for k, p in enumerate(rows)
        ]

    def _evaluated(
        self, p: Array, found: Outcome, row: int, sampled: SampledDesign | None
    ) -> EvaluatedDesign:
        status = Status(int(found.status[row]))
        nothing = EvaluatedDesign(p, dict.fromkeys(self.question.terms, math.nan), status)
        if status != Status.OK:
            return nothing
        closure, closing = math.nan, -math.inf
        if sampled is not None:
            closures = sampled.closures()
            if closures.size:
                closure = float(closures.min())
                least = self.question.transmission**2
                closing = (least - closure) / least
                if not closure > 0.0:
                    return nothing
        values, points = {}, {}
        for term in self.question.terms:
            signed = self._points(sampled, term) if sampled is not None and term.pointed else []
            points[term] = tuple(signed)
            if term.output is None:
                values[term] = float(term.of_parameters(self.engine.program.data)(p))
            elif link := tired_link(term.output):
                forces = [
                    k
                    for k, name in enumerate(self.engine.quantities)
                    if name.startswith(f"section:{link}:")
                ]
                values[term] = (
                    signed[0][0].value
                    if signed and np.isfinite(found.value[row, forces]).all()
                    else math.nan
                )
            elif term.kind == "peak":
                values[term] = abs(float(found.value[row, self.engine.quantities.index(term.name)]))
            elif term.kind == "fluctuation":
                values[term] = DriveEnergy(self.engine, term.output).fluctuation(p)
            elif term.averaged:
                values[term] = float(
                    getattr(found, term.kind)[row, self.engine.efforts.index(term.name)]
                )
            else:
                values[term] = signed[0][0].value if signed else math.nan
        evaluated = EvaluatedDesign(p, values, status, sampled, closure, closing, points)
        return evaluated if evaluated.has_result else nothing

    def _points(self, sampled: SampledDesign, term: Term) -> list[Signed]:
        """The local peaks of a term, the largest first, with the signs by which they count."""
        assert term.output is not None
        if link := tired_link(term.output):
            return [(point, 1.0) for point in self.values.tired(link).points(sampled.as_asked())]
        sign = {"min": -1, "max": 1}.get(term.kind, 0)
        return [
            (point, float(sign or math.copysign(1.0, point.value)))
            for point in sampled.points(term.output, sign)
        ]

    def drifting(self, term: Term, point: Point, p: Array) -> Point:
        """A peak at a kink or a jump that goes with the chosen parameters, seen by designs beside
        this one.

        The reported peak of each is by the same switch where it is near. What does not move is the
        point itself.
        """
        box = self.question.box
        x, size = box.share(p), len(box.names)
        directions = np.where(x + _BESIDE <= 1.0, _BESIDE, -_BESIDE)
        rows = np.array(
            [box.all(x + sign * unit) for sign, unit in zip(directions, np.eye(size), strict=True)]
        )
        self.evaluations += size
        found = self.engine.evaluate(rows, threads=1)
        k = self.engine.quantities.index(term.name)
        even = self.engine.times.of(rows)[0]
        shares = (found.t[:, k] - even[:, 0]) / (even[:, -1] - even[:, 0])
        moved = np.where(np.abs(shares - point.share) <= _BESIDE_MOST, shares - point.share, 0.0)
        drift = np.where(np.abs(moved) > _STILL, moved / directions, 0.0)
        return replace(point, share=float(point.share - drift @ x), drift=tuple(drift.tolist()))

    def following(
        self, term: Term, points: Sequence[Signed], sampled: SampledDesign
    ) -> list[Signed]:
        """Local peaks, and how the smooth ones follow as parameters change."""
        assert term.output is not None
        if tired_link(term.output):
            return list(points)
        followed = self.values.of(term.output)
        found = []
        for point, sign in points:
            free = term.output.group == "section" and point.place == 0 and 0.0 < point.xi < 1.0
            found.append(
                (followed.following(point, sampled.p, sign, sampled.step, free=free), sign)
            )
        return found

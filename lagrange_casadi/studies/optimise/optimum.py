"""Result of a search for a design."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.brief import Brief
from .problem import Problem
from .sampled_design import EvaluatedDesign
from .search_run import CONVERGED, HOLDS, SearchRun
from .solver import Solver
from .terms import Constraint, Term, tired_link

_NEAR = 1e-5
"""Distance from its limit, relative to its scale, within which a term is active."""

_SAME = 1e-3
"""Distance of designs, relative to the bounds, that are one optimum."""

_STEEP = 1e-4
"""Relative change of a quantity in a step of time if its peak is not smooth."""


@dataclass(frozen=True)
class Limit:
    """A constraint at the optimum: the ``value`` of its term, whether it is ``active``, and what
    its ``multiplier`` is.

    That is by how much the objective falls for each unit by which the limit is relaxed, in the
    objective's unit over the term's.
    """

    constraint: Constraint
    value: float
    active: bool
    multiplier: float


@dataclass(frozen=True, eq=False)
class Start:
    """One start of a search: values of the parameters, the design it ended at, and how.

    ``excess`` is by how much the worst constraint is violated there, over its limit; ``ending``
    says why it ended.
    """

    values: Mapping[str, float]
    end: Mapping[str, float]
    objective: float
    excess: float
    ending: str


@dataclass(frozen=True, eq=False, repr=False)
class LocalOptimum(Brief):
    """A design at which ``starts`` starts have converged."""

    values: Mapping[str, float]
    objective: float
    starts: int


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(Brief):
    """The best design of a search.

    ``values`` are those of the parameters that were chosen, ``parameters`` those of all.
    ``objective`` is the value of ``minimised`` there. ``start`` is the start that led there,
    ``starts`` are all, ``optima`` where they have converged, the best first. ``transmission`` is
    the least sine of a loop's transmission angle, of an iterated loop the least volume; NaN without
    loops. ``feasible`` says whether every constraint holds, that of the transmission angle too,
    ``converged`` whether the conditions for an optimum do. ``residual`` is what is left of those of
    Karush, Kuhn and Tucker, over the largest of their terms or the objective. ``curvature`` is the
    least second derivative of the Lagrangian along what the active constraints leave free, over the
    bounds' widths: above zero at a strict minimum, infinite where nothing is left free, NaN where
    there is none. ``bounds`` are multipliers of the parameters' own bounds, by name: below zero at
    the low one. ``history`` (k, 4 + parameters) has a row for every step: number of the start,
    objective, excess, 1 where that design has a result, and the values. ``stopped`` says that the
    search was ended before its end, ``evaluations`` how many designs were looked at. ``unit`` is
    the objective's, ``notes`` what is worth a word.
    """

    case: str
    minimised: Term
    unit: str
    values: Mapping[str, float]
    parameters: Mapping[str, float]
    objective: float
    start: Start
    starts: tuple[Start, ...]
    optima: tuple[LocalOptimum, ...]
    limits: tuple[Limit, ...]
    bounds: Mapping[str, float]
    transmission: float
    feasible: bool
    converged: bool
    stopped: bool
    residual: float
    curvature: float
    history: Array
    evaluations: int
    notes: tuple[str, ...] = ()


def optimum_of(
    solver: Solver,
    problem: Problem,
    runs: Sequence[SearchRun],
    evaluations: int,
    *,
    stopped: bool,
) -> tuple[Optimum, EvaluatedDesign]:
    """Result of runs from starts, and the end of the best of them, evaluated closely."""
    best = min(runs, key=lambda run: run.merit)
    evaluated = solver.evaluate(np.array(best.end))
    box, engine = solver.question.box, solver.engine
    limits = []
    multipliers = best.multipliers or (math.nan,) * len(problem.constraints)
    for constraint, multiplier in zip(problem.constraints, multipliers, strict=True):
        value = evaluated.values[constraint.term]
        near = abs(constraint.excess(value)) <= _NEAR * constraint.scale(value)
        limits.append(Limit(constraint, value, bool(near), float(multiplier) if near else 0.0))
    active = [limit.constraint.term for limit in limits if limit.active]
    bounds = dict.fromkeys(box.names, math.nan)
    if best.bounds:
        x = box.share(evaluated.p)
        at_bound = np.minimum(x, 1.0 - x) <= 1e-6
        by_unit = np.where(at_bound, np.array(best.bounds) / (box.high - box.low), 0.0)
        bounds = dict(zip(box.names, by_unit.tolist(), strict=True))
    everything = dict(zip(engine.parameters, evaluated.p.tolist(), strict=True))
    excess = problem.excess(evaluated)
    optimum = Optimum(
        case=solver.engine.program.data.name,
        minimised=problem.objective,
        unit=problem.objective.unit(solver.engine.program.data),
        values={name: everything[name] for name in box.names},
        parameters=everything,
        objective=evaluated.values[problem.objective],
        start=_start(solver, best),
        starts=tuple(_start(solver, run) for run in runs),
        optima=_optima(solver, runs),
        limits=tuple(limits),
        bounds=bounds,
        transmission=math.sqrt(evaluated.closure) if evaluated.closure >= 0.0 else math.nan,
        feasible=excess <= HOLDS,
        converged=best.ending == CONVERGED,
        stopped=stopped,
        residual=best.residual,
        curvature=best.curvature,
        history=np.array([[k, *row] for k, run in enumerate(runs) for row in run.history]).reshape(
            -1, 4 + len(box.names)
        ),
        evaluations=evaluations,
        notes=tuple(_notes(solver, [problem.objective, *active], evaluated)),
    )
    return optimum, evaluated


def _start(solver: Solver, run: SearchRun) -> Start:
    box = solver.question.box

    def named(p: Sequence[float]) -> dict[str, float]:
        return {name: p[place] for name, place in zip(box.names, box.places, strict=True)}

    return Start(named(run.start), named(run.end), run.objective, run.excess, run.ending)


def _optima(solver: Solver, runs: Sequence[SearchRun]) -> tuple[LocalOptimum, ...]:
    """Designs to which runs have converged."""
    box = solver.question.box
    found: list[list[SearchRun]] = []
    for run in sorted((run for run in runs if run.ending == CONVERGED), key=lambda run: run.merit):
        share = box.share(np.array(run.end))
        for known in found:
            if np.abs(share - box.share(np.array(known[0].end))).max() <= _SAME:
                known.append(run)
                break
        else:
            found.append([run])
    return tuple(
        LocalOptimum(_start(solver, known[0]).end, known[0].objective, len(known))
        for known in found
    )


def _notes(solver: Solver, terms: Sequence[Term], evaluated: EvaluatedDesign) -> Iterator[str]:
    """Notes on peaks at a kink or a jump of the objective and of what is active, whose change the
    program has by differences.
    """
    sampled = evaluated.sampled
    assert sampled is not None
    for term in terms:
        points = evaluated.points[term]
        if not points or term.output is None or tired_link(term.output):
            continue
        point, _ = points[0]
        followed = solver.values.of(term.output)
        place = point.where(followed.size)
        rate = float(
            followed.slopes(point.share, list(point.guess), evaluated.p, point.xi, place)[0]
        )
        if abs(rate) * sampled.step > _STEEP * abs(point.value) and 0.0 < point.share < 1.0:
            time = sampled.time(point)
            yield (
                f"{term} is at a kink or a jump, at t = {time:.6g} s: the derivative of that time"
                " is taken by finite differences"
            )

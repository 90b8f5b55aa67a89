"""Result of a search for a design."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from .fatigue import tired_link
from .finder import Finder
from .judged import Judged
from .problem import Problem
from .terms import Constraint, Term
from .trail import CONVERGED, HOLDS, Trail

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


@dataclass(frozen=True, eq=False)
class LocalOptimum:
    """A design at which ``starts`` starts have converged."""

    values: Mapping[str, float]
    objective: float
    starts: int


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best design of a search.

    ``values`` are those of the parameters that were chosen, ``parameters`` those of all.
    ``objective`` is the value of ``minimised`` there. ``start`` is the start that led there,
    ``starts`` are all, ``optima`` where they have converged, the best first. ``transmission`` is
    the least sine of a loop's transmission angle, of an iterated loop the least volume; NaN without
    loops. ``feasible`` tells whether every constraint holds, that of the transmission angle too,
    ``converged`` whether the conditions for an optimum do. ``residual`` is what is left of those of
    Karush, Kuhn and Tucker, over the largest of their terms or the objective. ``curvature`` is the
    least second derivative of the Lagrangian along what the active constraints leave free, over the
    bounds' widths: above zero at a strict minimum, infinite where nothing is left free, NaN where
    there is none. ``bounds`` are multipliers of the parameters' own bounds, by name: below zero at
    the low one. ``history`` (k, 4 + parameters) has a row for every step: number of the start,
    objective, excess, 1 where that design has a result, and the values. ``stopped`` tells that the
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
    finder: Finder,
    problem: Problem,
    trails: Sequence[Trail],
    judged: Judged,
    evaluations: int,
    *,
    stopped: bool,
) -> Optimum:
    """Result of runs from starts; ``judged`` is the end of the best of them, evaluated closely."""
    best = min(trails, key=lambda trail: trail.merit)
    box, engine = finder.question.box, finder.engine
    limits = []
    multipliers = best.multipliers or (math.nan,) * len(problem.constraints)
    for constraint, multiplier in zip(problem.constraints, multipliers, strict=True):
        value = judged.value(constraint.term)
        near = abs(constraint.excess(value)) <= _NEAR * constraint.scale(value)
        limits.append(Limit(constraint, value, bool(near), float(multiplier) if near else 0.0))
    bounds = dict.fromkeys(box.names, math.nan)
    if best.bounds:
        x = box.share(judged.p)
        at_bound = np.minimum(x, 1.0 - x) <= 1e-6
        by_unit = np.where(at_bound, np.array(best.bounds) / (box.high - box.low), 0.0)
        bounds = dict(zip(box.names, by_unit.tolist(), strict=True))
    everything = dict(zip(engine.parameters, judged.p.tolist(), strict=True))
    excess = problem.excess(judged)
    return Optimum(
        case=finder.engine.graph.data.name,
        minimised=problem.objective,
        unit=problem.objective.unit(finder.engine.graph.data),
        values={name: everything[name] for name in box.names},
        parameters=everything,
        objective=judged.value(problem.objective),
        start=_start(finder, best),
        starts=tuple(_start(finder, trail) for trail in trails),
        optima=_optima(finder, trails),
        limits=tuple(limits),
        bounds=bounds,
        transmission=math.sqrt(judged.closure) if judged.closure >= 0.0 else math.nan,
        feasible=excess <= HOLDS,
        converged=best.ending == CONVERGED,
        stopped=stopped,
        residual=best.residual,
        curvature=best.curvature,
        history=np.array(
            [[k, *row] for k, trail in enumerate(trails) for row in trail.history]
        ).reshape(-1, 4 + len(box.names)),
        evaluations=evaluations,
        notes=tuple(_notes(finder, problem, judged)),
    )


def _start(finder: Finder, trail: Trail) -> Start:
    box = finder.question.box

    def told(p: Sequence[float]) -> dict[str, float]:
        return {name: p[place] for name, place in zip(box.names, box.places, strict=True)}

    return Start(told(trail.start), told(trail.end), trail.objective, trail.excess, trail.ending)


def _optima(finder: Finder, trails: Sequence[Trail]) -> tuple[LocalOptimum, ...]:
    """Designs to which runs have converged."""
    box = finder.question.box
    found: list[list[Trail]] = []
    for trail in sorted(
        (trail for trail in trails if trail.ending == CONVERGED), key=lambda trail: trail.merit
    ):
        share = box.share(np.array(trail.end))
        for known in found:
            if np.abs(share - box.share(np.array(known[0].end))).max() <= _SAME:
                known.append(trail)
                break
        else:
            found.append([trail])
    return tuple(
        LocalOptimum(_start(finder, known[0]).end, known[0].objective, len(known))
        for known in found
    )


def _notes(finder: Finder, problem: Problem, judged: Judged) -> Iterator[str]:
    """Notes on active peaks at a kink or a jump, whose change the program has by differences."""
    look = judged.look
    assert look is not None
    values = [
        None,
        *(
            c.excess(judged.value(c.term)) / c.scale(judged.value(c.term))
            for c in problem.constraints
        ),
    ]
    for term, excess in zip(problem.terms, values, strict=True):
        points = judged.points[term]
        if (
            not points
            or term.output is None
            or tired_link(term.output)
            or (excess is not None and abs(excess) > _NEAR)
        ):
            continue
        point, _ = points[0]
        followed = finder.judge.values.of(term.output)
        place = point.where(followed.size)
        rate = float(followed.slopes(point.share, list(point.guess), judged.p, point.xi, place)[0])
        if abs(rate) * look.step > _STEEP * abs(point.value) and 0.0 < point.share < 1.0:
            time = look.time(point)
            yield (
                f"{term} is at a kink or a jump, at t = {time:.6g} s: how that time changes is told"
                " by differences"
            )

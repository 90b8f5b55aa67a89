"""Several objectives: designs of which none is better in all of them, by the epsilon-constraint
method.

One objective is made small while the others are limits (Haimes, Lasdon and Wismer 1971; Chankong
and Haimes 1983). The ends of the front are found in the order of the objectives' ranks, so that
they are not dominated (Mavrotas 2009). Of two objectives, limits are halved where points are
farthest apart; of more they are those of a grid.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...base.arrays import Array
from ...base.brief import Brief
from ...errors import NoDesignError
from .optimum import Optimum
from .problem import Problem
from .sampled_design import EvaluatedDesign
from .searching import Search
from .terms import Constraint, Term

_END = 1e-4
"""Distance of the ends of a front from the least of an objective, relative to its range."""

_JUMP = 0.05
"""Distance of an objective below its limit at which the front jumps, relative to a stretch of
limits.
"""

_BETTER = 1e-6
"""Relative improvement of an objective beyond rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class FrontPoint(Brief):
    """A design of a front: its ``objectives``, and what the first one gains for a unit of each
    other one, ``trades``.

    ``optimum`` is the search that led there, in which the other objectives are limits.
    """

    objectives: tuple[float, ...]
    trades: tuple[float, ...]
    optimum: Optimum


@dataclass(frozen=True, eq=False, repr=False)
class Front(Brief):
    """Designs of which none is better in all ``minimised`` terms, from the least of the first one
    on.

    ``notes`` say what is worth a word. ``stopped`` says that the search was ended before its end.
    """

    case: str
    minimised: tuple[Term, ...]
    units: tuple[str, ...]
    points: tuple[FrontPoint, ...]
    stopped: bool
    evaluations: int
    notes: tuple[str, ...] = ()

    @cached_property
    def objectives(self) -> Array:
        """The objectives of all points, (points, terms)."""
        return np.array([point.objectives for point in self.points]).reshape(
            len(self.points), len(self.minimised)
        )

    @property
    def feasible(self) -> bool:
        """True if all points are within all limits."""
        return bool(self.points) and all(point.optimum.feasible for point in self.points)

    @property
    def converged(self) -> bool:
        """True if the optimality conditions hold at all points."""
        return bool(self.points) and all(point.optimum.converged for point in self.points)


@dataclass(eq=False)
class _Found:
    """A point as it is found."""

    optimum: Optimum
    evaluated: EvaluatedDesign
    values: Array


class FrontSearch:
    """A search for a front of ``count`` points, or fewer where it has not as many."""

    def __init__(self, search: Search, count: int) -> None:
        self.search, self.count = search, count
        question = search.solver.question
        self.terms, self.limits = question.objectives, question.constraints
        self.notes: list[str] = []
        self.kept: list[_Found] = []

    def front(self) -> Front:
        """The front, as far as an interrupt lets it grow.

        Raises :class:`NoDesignError` where that came before the first point.
        """
        try:
            self._grow()
        except KeyboardInterrupt:
            self.search.stopped = True
        if not self.kept:
            raise NoDesignError("optimise: stopped before a design was evaluated")
        return self.search.whole(self._result)

    def _result(self) -> Front:
        points = [self._front_point(one) for one in _efficient(self.kept)]
        data = self.search.solver.engine.program.data
        case, units = data.name, tuple(term.unit(data) for term in self.terms)
        notes = tuple(
            dict.fromkeys(
                [*self.notes, *(note for point in points for note in point.optimum.notes)]
            )
        )
        return Front(
            case,
            self.terms,
            units,
            tuple(points),
            self.search.stopped,
            self.search.evaluations,
            notes,
        )

    def _grow(self) -> None:
        """Find points, and keep those that are found; it ends early after an interrupt, or where
        limits hold nowhere.
        """
        least = self.kept
        for term in self.terms:
            problem = Problem(term, self.limits)
            least.append(self._solved(problem, self.search.begin(problem)))
            if self.search.stopped or not least[-1].optimum.feasible:
                return
        values = np.array([one.values for one in least])
        low = values.diagonal()
        if not (values - low > _BETTER * np.abs(low)).any():
            self.notes.append("one design is the best in all objectives: there is no front")
            self.kept = least[:1]
        elif len(self.terms) == 2:
            self._two(least)
        else:
            self._grid(least, low, values.max(axis=0))

    def _two(self, least: Sequence[_Found]) -> None:
        """A front of two objectives: its ends, and limits of the second one between them."""
        ends: list[_Found] = []
        for k, one in ((1, least[1]), (0, least[0])):
            # The least of one objective may be had by many designs: of those the best in the other
            # one.
            largest = max(end.values[k] for end in (*least, *ends))
            ends.insert(0, self._end(1 - k, k, one.values[k], largest, one))
            if self.search.stopped:
                return
        self.kept = row = ends
        closed = set[int]()
        while len(row) < self.count and not self.search.stopped:
            size = np.ptp([one.values for one in row], axis=0)
            gaps = [
                -1.0
                if id(a) in closed
                else float(np.hypot(*((a.values - b.values) / np.where(size > 0.0, size, 1.0))))
                for a, b in itertools.pairwise(row)
            ]
            k = int(np.argmax(gaps))
            if gaps[k] <= _BETTER:
                break
            left, right = row[k], row[k + 1]
            limit = float(left.values[1] + right.values[1]) / 2
            one = self._solved(self._limited(0, {1: limit}), [left.evaluated, right.evaluated])
            width = abs(float(left.values[1] - right.values[1]))
            if (
                not one.optimum.feasible
                or one.values[1] > left.values[1]
                or one.values[1] <= right.values[1] + _BETTER * width
            ):
                # Nothing is between limit and right: the front jumps there.
                closed.add(id(left))
                continue
            if one.values[1] < limit - _JUMP * width:
                closed.add(id(left))
            row.insert(k + 1, one)

    def _grid(self, least: Sequence[_Found], low: Array, high: Array) -> None:
        """A front of more objectives: the limits of a grid between their least values and the
        largest of the least designs'.
        """
        others = range(1, len(self.terms))
        self.kept = known = [
            least[0],
            *(self._end(0, k, low[k], high[k], least[k]) for k in others),
        ]
        many = max(2, math.ceil(self.count ** (1.0 / len(others))))
        axes = [np.linspace(high[k], low[k], many + 1)[:-1].tolist() for k in others]
        for limits in itertools.product(*axes):
            if self.search.stopped:
                return
            wanted = np.array([low[0], *limits])
            size = np.where(high > low, high - low, 1.0)
            near = min(known, key=lambda one: float(np.abs((one.values - wanted) / size).max()))
            one = self._solved(
                self._limited(0, dict(zip(others, limits, strict=True))), [near.evaluated]
            )
            if one.optimum.feasible:
                known.append(one)

    def _end(self, objective: int, other: int, low: float, high: float, one: _Found) -> _Found:
        """The best for an objective where another one is within a little of its least, at which
        ``one`` is.
        """
        best = self._solved(
            self._limited(objective, {other: low + _END * (high - low)}), [one.evaluated]
        )
        return best if best.optimum.feasible else one

    def _limited(self, objective: int, limits: dict[int, float]) -> Problem:
        """One objective, with others as limits."""
        held = [Constraint(self.terms[k], float(limit)) for k, limit in limits.items()]
        return Problem(self.terms[objective], (*held, *self.limits))

    def _solved(self, problem: Problem, starts: Sequence[EvaluatedDesign]) -> _Found:
        """A problem solved from some starts, and from the best of what was screened for it."""
        box = self.search.solver.question.box
        if (
            isinstance(self.search.starts, int)
            and self.search.screened
            and len(starts) < self.search.starts
        ):
            for one in self.search.begin(problem, 1):
                if all(
                    np.abs(box.share(one.p) - box.share(other.p)).max() > 1e-3 for other in starts
                ):
                    starts = [*starts, one]
        optimum, evaluated = self.search.solve(problem, starts)
        return _Found(optimum, evaluated, np.array([evaluated.values[term] for term in self.terms]))

    def _front_point(self, one: _Found) -> FrontPoint:
        # Where the first objective is the limit it is at its least: nothing is gained any more.
        limits = one.optimum.limits if one.optimum.minimised == self.terms[0] else ()
        trades = [
            sum(limit.multiplier for limit in limits if limit.constraint.term == term)
            for term in self.terms[1:]
        ]
        return FrontPoint(tuple(one.values.tolist()), tuple(trades), one.optimum)


def _efficient(found: Sequence[_Found]) -> list[_Found]:
    """Points than which no other one is better in all objectives, from the least of the first one
    on; of equal ones the first.
    """
    values = np.array([one.values for one in found])
    size = np.ptp(values, axis=0)
    little = _BETTER * np.where(size > 0.0, size, 1.0)
    kept = []
    for k, row in enumerate(values):
        no_worse = (values <= row + little).all(axis=1)
        better = no_worse & (values < row - little).any(axis=1)
        same = no_worse & ~better & (np.arange(len(values)) < k)
        feasible = found[k].optimum.feasible or not any(one.optimum.feasible for one in found)
        if feasible and not better.any() and not same.any():
            kept.append(k)
    return [found[k] for k in sorted(kept, key=lambda k: tuple(values[k]))]

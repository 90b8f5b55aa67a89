"""The way from one design to the best near it, by programs whose points grow until no peak between
them exceeds a limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import spread
from ...errors import AssemblyError
from .conditions import DOWN
from .nonlinear_program import Found, Held
from .sampled_design import KEEP, EvaluatedDesign, Point
from .search_run import CONVERGED, HOLDS, STOPPED, SearchRun, rounded
from .solver import SearchTask, Solver
from .terms import Constraint, tired_link

_ROUNDS, _HALVINGS = 40, 12
"""Programs that are solved at most; and how often a step is halved that leads to where loops do not
close.
"""

_CONDITIONS = 1e-6
"""Largest residual of the first-order conditions of an optimum."""

_NEAR = 1e-3
"""Distance from its limit, relative to its scale, within which later programs include a local
peak.
"""

_CLOSED = 12
"""Instants at which a program watches how its loops close, from the beginning."""

_STEPS = (0.1, 0.03, 0.01, 0.003)
"""Distances, relative to the bounds, at which a better design is sought beside a point that seems
to be no minimum.
"""

_SAME = 1e-6
"""Distance of two points, in steps between instants, that are one."""

_SOLVED = "Solve_Succeeded"
"""Answer of IPOPT for a program that it solved."""

Progress = Callable[[float, float], None]
"""Hears the objective and the worst excess of each design on the way."""


@dataclass(frozen=True)
class _Iterate:
    """A design on the way, the program that led there, if any, and how the way would end here."""

    evaluated: EvaluatedDesign
    by: Found | None
    ending: str


@dataclass(eq=False)
class Descent:
    """A way from the start of a ``task``.

    Nothing of it depends on other ways, so that it is the same wherever it is gone.
    """

    solver: Solver
    task: SearchTask
    progress: Progress
    history: list[tuple[float, ...]] = field(default_factory=list)
    iterates: list[_Iterate] = field(default_factory=list)

    def go(self) -> SearchRun:
        """Go from the start, which has a result, to the best near it; after an interrupt, as far as
        it went.
        """
        first, stopped = self.solver.evaluate(np.array(self.task.start)), False
        before = self.solver.evaluations
        self.iterates.append(_Iterate(first, None, "start"))
        try:
            self._descend(first)
        except KeyboardInterrupt:
            stopped = True
        except AssemblyError as error:
            self.iterates.append(_Iterate(first, None, str(error)))
        best = self._best()
        found = best.by
        return SearchRun(
            start=tuple(first.p.tolist()),
            end=tuple(best.evaluated.p.tolist()),
            objective=best.evaluated.values[self.task.problem.objective],
            excess=self.task.problem.excess(best.evaluated),
            scale=self.task.scales[0],
            ending=STOPPED if stopped else best.ending,
            history=tuple(self.history),
            multipliers=found.multipliers if found else (),
            bounds=tuple(found.bounds.tolist()) if found else (),
            residual=found.conditions.residual if found else math.nan,
            curvature=found.conditions.curvature if found else math.nan,
            evaluations=self.solver.evaluations - before,
        )

    def _best(self) -> _Iterate:
        """The best design on the way; of those that are as good, as far as limits that hold show,
        the one that converged.
        """
        best = min(reversed(self.iterates), key=lambda one: self._merit(one.evaluated))
        excess, objective = self._merit(best.evaluated)
        for one in reversed(self.iterates):
            if one.ending == CONVERGED and one.by is not None:
                # Another one may seem better by a violation that passes as none.
                gains = sum(
                    abs(gain) * scale
                    for gain, scale in zip(one.by.multipliers, self.task.scales[1:], strict=True)
                )
                if self._merit(one.evaluated) <= (
                    excess,
                    objective + HOLDS * (self.task.scales[0] + gains),
                ):
                    return one
        return best

    def _merit(self, evaluated: EvaluatedDesign) -> tuple[float, float]:
        """A merit less its last digits, so that of designs as good the
        one that converged is taken.
        """
        excess, objective = self.task.problem.merit(evaluated)
        return excess, rounded(objective, self.task.scales[0])

    def _note(self, evaluated: EvaluatedDesign) -> None:
        """Keep a design in the history, and report it."""
        objective, excess = (
            evaluated.values[self.task.problem.objective],
            self.task.problem.excess(evaluated),
        )
        row = (
            objective,
            excess,
            float(evaluated.has_result),
            *evaluated.p[list(self.solver.question.box.places)].tolist(),
        )
        self.history.append(row)
        self.progress(objective, excess)

    def _better(self, evaluated: EvaluatedDesign, by: Found | None, ending: str) -> None:
        """Keep a design that is no worse than those before."""
        converged = by is not None and ending == CONVERGED
        if converged or self.task.problem.merit(evaluated) <= self.task.problem.merit(
            self.iterates[-1].evaluated
        ):
            self.iterates.append(_Iterate(evaluated, by, ending))

    def _descend(self, first: EvaluatedDesign) -> None:
        self._note(first)
        sampled, box, problem = first.sampled, self.solver.question.box, self.task.problem
        program = self.solver.program(problem)
        assert sampled is not None
        every = Constraint(problem.objective, 0.0), *problem.constraints
        held = [Held(one, scale) for one, scale in zip(every, self.task.scales, strict=True)]
        closures = [sampled.instant(k) for k in spread(sampled.t.size, _CLOSED).tolist()]
        self._learn(held, closures, first, everything=True)
        current, tried = first, 0
        for _ in range(_ROUNDS):
            there = current.sampled if program.averaged else None
            instants = [] if there is None else [there.instant(k) for k in range(there.t.size)]
            found = program.solve(box.share(current.p), held, closures, instants)
            x = found.x
            if not np.isfinite(x).all():
                self._better(
                    current,
                    None,
                    "the program has no solution: a derivative is missing at an evaluated point",
                )
                return
            following = self.solver.evaluate(box.all(x))
            self._note(following)
            back = 0
            while following.sampled is None and back < _HALVINGS:
                # Between the points loops do not close, or there is no result: go back until there
                # is one, and look there from then on.
                back += 1
                x = (x + box.share(current.p)) / 2
                following = self.solver.evaluate(box.all(x))
            if following.sampled is None:
                why = following.status.meaning if following.status else "loops do not close"
                self._better(current, None, f"a design beside it fails: {why}")
                return
            added = self._learn(held, closures, following, everything=back > 0)
            done = not back and self._settled(found, following)
            moved = float(np.abs(box.share(following.p) - box.share(current.p)).max())
            if done and found.conditions.least < DOWN and (lower := self._lower(found, following)):
                self._note(lower)
                self._better(lower, None, "beyond a saddle")
                self._learn(held, closures, lower, everything=True)
                current = lower
                continue
            unsettled = f"IPOPT: {found.status}"
            if found.status == _SOLVED:
                unsettled = "the peaks of its last design are not those of the program"
            self._better(following, None if back else found, CONVERGED if done else unsettled)
            if done and found.status == _SOLVED:
                return
            tried = tried + 1 if moved <= 1e-9 and not added else 0
            current = following
            if tried >= 2:
                return

    def _lower(self, found: Found, evaluated: EvaluatedDesign) -> EvaluatedDesign | None:
        """A better design beside one that seems to be no minimum, along the way that it is left;
        None where it is one after all.

        A program holds some peaks where they are, so that its second derivatives may be less than
        those of the peaks.
        """
        direction = found.conditions.direction / (np.abs(found.conditions.direction).max() or 1.0)
        excess, objective = self._merit(evaluated)
        for step in (share * sign for share in _STEPS for sign in (1.0, -1.0)):
            tried = self.solver.evaluate(
                self.solver.question.box.all(np.clip(found.x + step * direction, 0.0, 1.0))
            )
            if self._merit(tried) < (excess, objective):
                return tried
        return None

    def _settled(self, found: Found, evaluated: EvaluatedDesign) -> bool:
        """Return whether a program's solution holds with all peaks, also those that the program did
        not include.
        """
        value = evaluated.values[self.task.problem.objective]
        gap = abs(value - found.objective) / (abs(value) or 1.0)
        return (
            self.task.problem.excess(evaluated) <= HOLDS
            and gap <= HOLDS
            and found.conditions.residual <= _CONDITIONS
        )

    def _learn(
        self,
        held: Sequence[Held],
        closures: list[Point],
        evaluated: EvaluatedDesign,
        *,
        everything: bool,
    ) -> bool:
        """Hold terms at the peaks of a design that programs do not know; whether there were any."""
        added, sampled = False, evaluated.sampled
        assert sampled is not None
        near = _SAME * sampled.step
        for k, each in enumerate(held):
            term, points = each.constraint.term, evaluated.points[each.constraint.term]
            if not points:
                continue
            largest = points[0][1] * points[0][0].value
            least = KEEP * largest if largest > 0.0 else largest / KEEP
            if not everything:
                # Only what may exceed what the program found.
                level = largest if k == 0 else each.bound
                least = max(least, level - _NEAR * each.scale)
            high = [(point, sign) for point, sign in points if sign * point.value >= least]
            found = self.solver.following(term, high or points[:1], sampled)
            first, sign = found[0]
            if (
                term.kind == "peak"
                and not tired_link(term.output)
                and not any(first.turn)
                and 0.0 < first.share < 1.0
            ):
                # Where it is, a kink has no derivative; along its way it has one.
                found[0] = (
                    self.solver.drifting(term, first, evaluated.p),
                    sign,
                )
            for point, sign in found if high else ():
                added |= each.add(point, sign, near)
            if not each.points:
                added |= each.add(*found[0], near)
        for row in sampled.closures():
            k = int(np.argmin(row))
            point = sampled.instant(k)
            if row[k] < 4 * self.solver.question.transmission**2 and all(
                abs(point.share - other.share) > near for other in closures
            ):
                closures.append(point)
                added = True
        return added

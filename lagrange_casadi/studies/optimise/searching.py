"""A search under way: ways that are gone or known, and what they come to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from ...base.publish import uninterrupted
from ...errors import NoDesignError
from .finder import Errand, Finder
from .hands import Hands
from .journal import Journal
from .judged import Judged
from .optimum import Optimum, optimum_of
from .problem import Problem
from .starts import Starts, chosen, named, screen
from .trail import STOPPED, Trail

_T = TypeVar("_T")

Progress = Callable[[int, float, float], None]
"""Hears the number of the way, and the objective and the worst excess over a limit of a design on
it.
"""


@dataclass(eq=False)
class Search:
    """A finder, what is known of its ways, and who goes the others; ``stopped`` tells that an
    interrupt came.
    """

    finder: Finder
    journal: Journal
    hands: Hands
    progress: Progress
    starts: Starts
    many: int
    screened: list[Judged] = field(default_factory=list)
    evaluations: int = 0
    gone: int = 0
    stopped: bool = False

    def begin(self, problem: Problem, count: int | None = None) -> list[Judged]:
        """The designs to start from: those that are named, or the best of many; ``count`` of them,
        or as many as were asked for.
        """
        before = self.finder.judge.evaluations
        if not isinstance(self.starts, int):
            found = named(self.finder, self.starts)
        else:
            self.screened = self.screened or screen(self.finder, self.many)
            found = chosen(
                self.finder, problem, self.screened, self.starts if count is None else count
            )
        self.evaluations += self.finder.judge.evaluations - before
        return found

    def solve(self, problem: Problem, starts: Sequence[Judged]) -> Optimum:
        """The best that ways from some starts lead to.

        Raises :class:`NoDesignError` where an interrupt came before the first.
        """
        trails = self._ways(problem, starts)
        if not trails:
            raise NoDesignError("optimise: stopped before a design was looked at")
        self.evaluations += sum(trail.evaluations + 1 for trail in trails)
        best = min(trails, key=lambda trail: trail.merit)
        stopped = self.stopped
        return self.whole(
            lambda: optimum_of(
                self.finder, problem, trails, self.look(best.end), self.evaluations, stopped=stopped
            )
        )

    def whole(self, action: Callable[[], _T]) -> _T:
        """Run an action to its end, whatever interrupts come.

        One that came meanwhile ends what follows.
        """
        found: list[_T] = []
        try:
            with uninterrupted():
                found.append(action())
        except KeyboardInterrupt:
            self.stopped = True
            if not found:
                raise
        return found[0]

    def look(self, p: Sequence[float]) -> Judged:
        """A design, looked at closely."""
        return self.finder.judge.look(np.array(p))

    def _ways(self, problem: Problem, starts: Sequence[Judged]) -> list[Trail]:
        """The ways from starts, in their order; after an interrupt those that were begun."""
        scales = problem.scales(starts[0])
        errands = [Errand(problem, tuple(start.p.tolist()), scales) for start in starts]
        found: dict[int, Trail] = {
            k: trail for k, errand in enumerate(errands) if (trail := self.journal.get(errand))
        }
        missing = [k for k in range(len(errands)) if k not in found]
        first, self.gone = self.gone, self.gone + len(errands)

        def told(number: int, objective: float, excess: float) -> None:
            self.progress(first + missing[number], objective, excess)

        try:
            for number, trail in self.hands.go(self.finder, [errands[k] for k in missing], told):
                found[missing[number]] = trail
                if trail.ending == STOPPED:
                    self.stopped = True
                    break
                self.journal.put(errands[missing[number]], trail)
        except KeyboardInterrupt:
            self.stopped = True
        return [found[k] for k in sorted(found)]

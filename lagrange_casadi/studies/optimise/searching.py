"""A search under way: ways that are gone or known, and what they come to."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from typing import TypeAlias, TypeVar

from ...base.arrays import Json
from ...base.files import digest
from ...base.interrupts import uninterrupted
from ...errors import ClusterError, NoDesignError
from ...results.store.untrusted import parsed
from ..checkpoint import Checkpoint
from ..sweep.design_blocks import Queue
from ..sweep.workers import Asked, Executor, by_workers, check_same, made, making
from .descent import Descent
from .optimum import Optimum, optimum_of
from .problem import Problem
from .sampled_design import EvaluatedDesign
from .search_run import STOPPED, SearchRun
from .solver import SearchTask, Solver
from .starts import Starts, chosen, named, screen

_T = TypeVar("_T")

Progress = Callable[[int, float, float], None]
"""Hears the number of the way, and the objective and the worst excess over a limit of a design on
it.
"""


Runs: TypeAlias = Callable[
    [Solver, Sequence[SearchTask], Progress], Iterator[tuple[int, SearchRun]]
]
"""Function that gives the runs of tasks with their numbers, in any order; one that was interrupted
says so, and is the last.
"""


def one_by_one(
    solver: Solver, tasks: Sequence[SearchTask], progress: Progress
) -> Iterator[tuple[int, SearchRun]]:
    """The runs of tasks, in this process."""
    for number, task in enumerate(tasks):
        yield number, Descent(solver, task, partial(progress, number)).go()


def by_executor(
    executor: Executor, solver: Solver, tasks: Sequence[SearchTask], progress: Progress
) -> Iterator[tuple[int, SearchRun]]:
    """The runs of tasks, by the workers of an executor; those that an interrupt stopped are left
    out.
    """
    call = pickle.dumps(partial(Solver.of, solver.question, solver.engine))
    words = solver.question.words(solver.engine)

    def asked(start: int, _stop: int) -> Asked:
        return Asked(_descend, (call, words, tasks[start]))

    for done in by_workers(executor, asked, Queue((k, k + 1) for k in range(len(tasks)))):
        if done is not None:
            number, _, run = done
            progress(number, run.objective, run.excess)
            yield number, run


def _descend(call: bytes, words: Mapping[str, Json], task: SearchTask) -> SearchRun:
    """Run a start on a worker: a solver is at one run at a time."""
    with making:
        solver: Solver = made(call)
        check_same(words, solver.question.words(solver.engine))
        run = Descent(solver, task, lambda *_: None).go()
    if run.ending == STOPPED:
        raise ClusterError("a worker was interrupted")
    return run


@dataclass(eq=False)
class Search:
    """A solver, ``parts`` of a file, which are finished runs, and what runs the others;
    ``stopped`` says that an interrupt came.
    """

    solver: Solver
    parts: Checkpoint | None
    runs: Runs
    progress: Progress
    starts: Starts
    many: int
    screened: list[EvaluatedDesign] = field(default_factory=list)
    evaluations: int = 0
    gone: int = 0
    stopped: bool = False

    def begin(self, problem: Problem, count: int | None = None) -> list[EvaluatedDesign]:
        """The designs to start from: those that are named, or the best of many; ``count`` of them,
        or as many as were asked for.
        """
        before = self.solver.evaluations
        if not isinstance(self.starts, int):
            found = named(self.solver, self.starts)
        else:
            self.screened = self.screened or screen(self.solver, self.many)
            found = chosen(
                self.solver, problem, self.screened, self.starts if count is None else count
            )
        self.evaluations += self.solver.evaluations - before
        return found

    def solve(
        self, problem: Problem, starts: Sequence[EvaluatedDesign]
    ) -> tuple[Optimum, EvaluatedDesign]:
        """The best that ways from some starts lead to, and its design.

        Raises :class:`NoDesignError` where an interrupt came before the first.
        """
        runs = self._ways(problem, starts)
        if not runs:
            raise NoDesignError("optimise: stopped before a design was evaluated")
        self.evaluations += sum(run.evaluations + 1 for run in runs)
        return self.whole(
            partial(optimum_of, self.solver, problem, runs, self.evaluations, stopped=self.stopped)
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

    def _ways(self, problem: Problem, starts: Sequence[EvaluatedDesign]) -> list[SearchRun]:
        """The ways from starts, in their order; after an interrupt those that were begun."""
        scales = problem.scales(starts[0])
        tasks = [SearchTask(problem, tuple(start.p.tolist()), scales) for start in starts]
        found: dict[int, SearchRun] = {
            k: run for k, task in enumerate(tasks) if (run := self._known(task))
        }
        missing = [k for k in range(len(tasks)) if k not in found]
        first, self.gone = self.gone, self.gone + len(tasks)

        def report(number: int, objective: float, excess: float) -> None:
            self.progress(first + missing[number], objective, excess)

        try:
            for number, run in self.runs(self.solver, [tasks[k] for k in missing], report):
                found[missing[number]] = run
                if run.ending == STOPPED:
                    self.stopped = True
                    break
                if self.parts is not None:
                    words = json.dumps(asdict(run)).encode()
                    self.parts.commit(_name(tasks[missing[number]]), [words])
        except KeyboardInterrupt:
            self.stopped = True
        return [found[k] for k in sorted(found)]

    def _known(self, task: SearchTask) -> SearchRun | None:
        """The run of a task that was finished before."""
        words = self.parts and self.parts.read(_name(task))
        return parsed(words, SearchRun) if words else None


def _name(task: SearchTask) -> str:
    """Name of the part of a task."""
    problem = task.problem
    limits = [limit.words for limit in problem.constraints]
    words = [str(problem.objective), limits, task.start, task.scales]
    return digest(json.dumps(words).encode())

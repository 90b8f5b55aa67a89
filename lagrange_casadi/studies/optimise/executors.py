"""Executors of a search's runs: this process, or others with the same finder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Protocol

from .search_run import SearchRun
from .solver import SearchTask, Solver

Progress = Callable[[int, float, float], None]
"""Hears the number of the way, and the objective and the worst excess of a design on it."""


class Executor(Protocol):
    """Executor of runs."""

    def go(
        self, solver: Solver, tasks: Sequence[SearchTask], progress: Progress
    ) -> Iterator[tuple[int, SearchRun]]:
        """The ways of errands with their numbers, in any order.

        One that was interrupted says so, and is the last.
        """


class LocalExecutor:
    """The present process, one start after another."""

    def go(
        self, solver: Solver, tasks: Sequence[SearchTask], progress: Progress
    ) -> Iterator[tuple[int, SearchRun]]:
        """The ways of errands."""
        for number, task in enumerate(tasks):
            yield number, solver.descend(task, partial(progress, number))

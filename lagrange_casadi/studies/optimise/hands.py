"""Executors of a search's runs: this process, or others with the same finder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Protocol

from .finder import Errand, Finder
from .trail import Trail

Told = Callable[[int, float, float], None]
"""Hears the number of the way, and the objective and the worst excess of a design on it."""


class Hands(Protocol):
    """Executor of runs."""

    def go(
        self, finder: Finder, errands: Sequence[Errand], told: Told
    ) -> Iterator[tuple[int, Trail]]:
        """The ways of errands with their numbers, in any order.

        One that was interrupted says so, and is the last.
        """


class Here:
    """This process, one way after another."""

    def go(
        self, finder: Finder, errands: Sequence[Errand], told: Told
    ) -> Iterator[tuple[int, Trail]]:
        """The ways of errands."""
        for number, errand in enumerate(errands):
            yield number, finder.descend(errand, partial(told, number))

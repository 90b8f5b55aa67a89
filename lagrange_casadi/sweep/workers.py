"""Who evaluates blocks: here, the threads of this process."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Protocol

from .blocks import Cutter
from .plan import Plan

_AHEAD = 2

Block = tuple[int, int, list[Any]]
"""Designs from and to before, and their columns."""


class Workers(Protocol):
    """Whoever evaluates blocks."""

    def results(self, plan: Plan, cutter: Cutter) -> Iterator[Block | None]:
        """Evaluate what is cut, in any order; what was begun before the cutter was stopped is still given.

        None where nothing was done for a while, so that whoever waits may stop.
        """


@dataclass(frozen=True)
class Threads:
    """Threads of this process, by default one a core; one block is committed while the next is evaluated."""

    count: int | None = None

    def results(self, plan: Plan, cutter: Cutter) -> Iterator[Block]:
        """Evaluate what is cut, one block after another."""

        def evaluate(start: int, stop: int) -> tuple[float, list[Any]]:
            begun = time.perf_counter()
            columns = plan.harvest.evaluate(plan.block(start, stop), self.count)
            return time.perf_counter() - begun, columns

        with ThreadPoolExecutor(1) as pool:
            pending: deque[tuple[int, int, Any]] = deque()
            while True:
                while len(pending) < _AHEAD and (block := cutter.cut()):
                    pending.append((*block, pool.submit(evaluate, *block)))
                if not pending:
                    return
                start, stop, future = pending.popleft()
                if cutter.stopped and future.cancel():
                    continue
                seconds, columns = future.result()
                cutter.took(stop - start, seconds)
                yield start, stop, columns

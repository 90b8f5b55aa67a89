"""Who evaluates blocks: here, the threads of this process."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Protocol

from ..codegen import cores
from .blocks import Queue
from .plan import Plan

Block = tuple[int, int, list[bytes]]
"""Designs from and to before, and their columns as the file keeps them."""

Blocks = Generator[Block | None, None, None]
"""Blocks as they are done; None where nothing was done for a while, so that whoever waits may stop."""


class Workers(Protocol):
    """Whoever evaluates blocks."""

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue, in any order; what was begun before it was stopped is still given."""


@dataclass(frozen=True)
class Threads:
    """Threads of this process, by default one a core, each at a block of its own."""

    count: int | None = None

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue."""
        count = self.count or cores()

        def evaluated(start: int, stop: int) -> list[bytes]:
            return plan.harvest.chunks(plan.block(start, stop), plan.room)

        pool, pending = ThreadPoolExecutor(count), deque[tuple[int, int, Any]]()
        try:
            while True:
                while len(pending) <= count and (block := queue.take()):
                    pending.append((*block, pool.submit(evaluated, *block)))
                if not pending:
                    return
                start, stop, future = pending.popleft()
                if not (queue.stopped and future.cancel()):
                    yield start, stop, future.result()
        finally:
            pool.shutdown(cancel_futures=True)

"""Evaluation of blocks by the threads of this process."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, wait
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any, Protocol, TypeVar

from ...base.space import cores, memory
from .blocks import Queue
from .plan import Plan

Block = tuple[int, int, list[bytes]]
"""Designs from and to before, and their columns as the file keeps them."""

Blocks = Generator[Block | None, None, None]
"""Blocks as they are done; None where nothing was done for a while, so
that whoever waits may stop.
"""


PULSE, PATIENCE = 0.1, 0.7
"""Seconds after which whoever waits hears that nothing came, and in which blocks that are under way
may still end.
"""


class Workers(Protocol):
    """Executor of blocks."""

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue, in any order; what was begun when it is stopped is given
        if it ends within patience.
        """


@dataclass(frozen=True)
class Threads:
    """Threads of this process, by default one a core, each at a block of its own; fewer where
    memory does not hold as many.
    """

    count: int | None = None

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue."""
        count = max(
            1, int(min(self.count or cores(), memory() / max(1, plan.harvest.engine.capacity)))
        )

        def evaluated(start: int, stop: int) -> list[bytes]:
            return plan.harvest.chunks(plan.block(start, stop), plan.capacity)

        pool, pending = ThreadPool(count), deque[tuple[int, int, Future[list[bytes]]]]()
        try:
            while True:
                while len(pending) <= count and (block := queue.take()):
                    pending.append((*block, pool.give(evaluated, *block)))
                if not pending:
                    return
                start, stop, future = pending[0]
                if queue.stopped:
                    yield from _last(pending)
                    return
                if not wait([future], PULSE).done:
                    yield None
                    continue
                pending.popleft()
                yield start, stop, future.result()
        finally:
            for _, _, future in pending:
                future.cancel()
            pool.dismiss()


def _last(pending: Iterable[tuple[int, int, Future[list[bytes]]]]) -> Blocks:
    """Yield the blocks that were begun and still end; no other one begins."""
    begun = [(start, stop, future) for start, stop, future in pending if not future.cancel()]
    ended = wait([future for _, _, future in begun], PATIENCE).done
    for start, stop, future in begun:
        if future in ended:
            yield start, stop, future.result()


_Result = TypeVar("_Result")


class ThreadPool:
    """So many threads that do what they are given, in its order.

    Once dismissed they begin nothing more.
    """

    def __init__(self, count: int) -> None:
        self._given: SimpleQueue[tuple[Future[Any], Callable[..., Any], tuple[Any, ...]] | None] = (
            SimpleQueue()
        )
        self._count = count
        for _ in range(count):
            threading.Thread(target=self._work, daemon=True).start()

    @classmethod
    def alone(cls, work: Callable[..., _Result], *arguments: object) -> Future[_Result]:
        """Future of one piece of work, by a thread of its own."""
        pool = cls(1)
        future = pool.give(work, *arguments)
        pool.dismiss()
        return future

    def give(self, work: Callable[..., _Result], *arguments: object) -> Future[_Result]:
        """Start a piece of work, and return its future."""
        future: Future[_Result] = Future()
        self._given.put((future, work, arguments))
        return future

    def dismiss(self) -> None:
        """Let each go home when it is done."""
        for _ in range(self._count):
            self._given.put(None)

    def _work(self) -> None:
        while given := self._given.get():
            future, work, arguments = given
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(work(*arguments))
                except BaseException as error:
                    future.set_exception(error)
            del given, future, arguments

"""Work shared by threads."""

from __future__ import annotations

import functools
import os
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor

from ..base.space import MOST_THREADS


@functools.cache
def _pool() -> ThreadPoolExecutor:
    """The threads that wait for work: to wake one takes a fifth of the time to start one."""
    return ThreadPoolExecutor(MOST_THREADS)


if hasattr(os, "register_at_fork"):  # a child process has none of these threads
    os.register_at_fork(after_in_child=_pool.cache_clear)


def in_threads(run: Callable[[int], None], starts: Iterable[int], threads: int) -> None:
    """Run what begins at each of the starts, by so many threads, of which the caller's is one: each
    takes the next start when it is done. Raises what a run raises; no other is then begun.

    A thread that has not woken before all is done is not waited for.
    """
    remaining = iter(starts)

    def work() -> None:
        try:
            for start in remaining:
                run(start)
        finally:
            deque(remaining, maxlen=0)  # after a failure there is nothing left for others

    others = list[Future[None]]()
    try:
        for _ in range(threads - 1):
            others.append(_pool().submit(work))
        work()
    finally:
        deque(remaining, maxlen=0)
        failures = [one.exception() for one in others if not one.cancel()]
    for failure in failures:
        if failure is not None:
            raise failure

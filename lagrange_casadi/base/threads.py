"""Work shared by threads."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable


def in_threads(run: Callable[[int], None], starts: Iterable[int], threads: int) -> None:
    """Run what begins at each of the starts, by so many threads, of which the caller's is one: each
    takes the next start when it is done. Raises what a run raises; no other is then begun.
    """
    remaining, failures = iter(starts), list[BaseException]()

    def work() -> None:
        try:
            for start in remaining:
                run(start)
        except BaseException as failure:
            failures.append(failure)
            _drop(remaining)

    others = [threading.Thread(target=work) for _ in range(threads - 1)]
    try:
        for other in others:
            other.start()
        work()
        for other in others:
            other.join()
    finally:
        _drop(remaining)
    if failures:
        raise failures[0]


def _drop(starts: Iterable[int]) -> None:
    for _ in starts:
        pass

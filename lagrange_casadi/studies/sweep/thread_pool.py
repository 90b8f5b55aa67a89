"""Threads that nobody has to wait for: not who is interrupted, nor a program that ends while they
are still at it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeVar

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

"""Work shared by threads."""

from __future__ import annotations

import _thread
import os
import threading
from collections import deque
from collections.abc import Callable, Iterable
from queue import Empty, SimpleQueue

_WAITS = 1.0
"""Seconds for which a thread waits for other work before it ends."""


def in_threads(run: Callable[[int], None], starts: Iterable[int], threads: int) -> None:
    """Run what begins at each of the starts, by so many threads, of which the caller's is one: each
    takes the next start when it is done. Raises what a run raises; no other is then begun.

    The other threads wait a moment for the next call: to wake one takes a fifth of the time to
    start one. A thread that has not woken before all is done is not waited for.
    """
    remaining, failures = iter(starts), list[BaseException]()

    def work() -> None:
        try:
            for start in remaining:
                run(start)
        except BaseException as failure:
            failures.append(failure)
            _drop(remaining)

    given = [_Work(work) for _ in range(threads - 1)]
    try:
        for one in given:
            _helper().given.put(one)
        work()
        for one in given:
            if not one.begun.acquire(blocking=False):
                one.running.acquire()
    finally:
        _drop(remaining)
    if failures:
        raise failures[0]


class _Work:
    """Work of one thread. The first to acquire ``begun`` does it, or makes sure that nobody does;
    ``running`` is free when it is done.
    """

    def __init__(self, work: Callable[[], None]) -> None:
        self.work, self.begun, self.running = work, threading.Lock(), threading.Lock()
        self.running.acquire()


class _Helper:
    """A thread that does what it is given, one work after another."""

    def __init__(self) -> None:
        self.given = SimpleQueue[_Work]()
        _thread.start_new_thread(self._help, ())

    def _help(self) -> None:
        while True:
            try:
                given = self.given.get(timeout=_WAITS)
            except Empty:
                try:
                    _waiting.remove(self)
                except ValueError:  # it is about to be given work
                    continue
                return
            if begun := given.begun.acquire(blocking=False):
                given.work()
            _waiting.append(self)
            if begun:
                given.running.release()
            del given  # and the arrays that it holds


_waiting = deque[_Helper]()
if hasattr(os, "register_at_fork"):  # a child process has none of these threads
    os.register_at_fork(after_in_child=_waiting.clear)


def _helper() -> _Helper:
    try:
        return _waiting.pop()
    except IndexError:
        return _Helper()


def _drop(starts: Iterable[int]) -> None:
    for _ in starts:
        pass

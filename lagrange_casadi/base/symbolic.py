"""One thread at a time makes and drops expressions of CasADi.

CasADi keeps each constant of its expressions once for the whole process. A thread that asks for one
may be given it while another drops the last expression that has it, for no lock spans both, and the
interpreter's own is released: the process then crashes.
"""

from __future__ import annotations

import functools
import inspect
import threading
from collections import deque
from collections.abc import Callable
from contextlib import ContextDecorator
from typing import TYPE_CHECKING, Any, TypeVar

from .brief import no_attribute

Thing = TypeVar("Thing", bound=Callable[..., Any])
Value = TypeVar("Value")

_lock = threading.RLock()
_dropped: deque[dict[str, Any]] = deque()


class _Symbolic(ContextDecorator):
    """A context in which expressions are made and dropped; and a decorator of functions, and of
    classes' methods, that do so.
    """

    def __enter__(self) -> None:
        _lock.acquire()

    def __exit__(self, *_: object) -> None:
        try:
            while _dropped:
                _dropped.popleft()
        finally:
            _lock.release()

    def __call__(self, thing: Thing) -> Thing:
        if not isinstance(thing, type):
            return super().__call__(thing)
        for name, method in list(vars(thing).items()):
            if inspect.isfunction(method) and (
                not name.startswith("_") or name in ("__init__", "__post_init__")
            ):
                setattr(thing, name, super().__call__(method))
        return thing


symbolic = _Symbolic()


class symbolic_property(functools.cached_property[Value]):  # noqa: N801 - like cached_property
    """Property that makes expressions when it is first read, and is kept with its object.

    Until Python 3.12 a ``cached_property`` has a lock of its own. Two threads that take it and that
    of expressions in turn would wait for each other; here that of expressions is always taken
    first.
    """

    if not TYPE_CHECKING:

        def __get__(self, instance, owner=None):
            """Return the value, which is made once."""
            with symbolic:
                return super().__get__(instance, owner)


class Graphs:
    """Holder of expressions that any thread may drop: they are freed when a thread makes others."""

    if not TYPE_CHECKING:
        __getattr__ = no_attribute

    def __del__(self, later: Callable[[dict[str, object]], None] = _dropped.append) -> None:
        later(vars(self))

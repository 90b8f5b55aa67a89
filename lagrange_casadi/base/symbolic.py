"""One thread at a time makes and drops expressions of CasADi.

CasADi keeps each constant of its expressions once for the whole process. A thread that asks for one may be given it while another
drops the last expression that has it, for no lock spans both, and the interpreter's own is released: the process then crashes.
"""

from __future__ import annotations

import functools
import inspect
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar, cast

Thing = TypeVar("Thing", bound=Callable[..., Any])

_lock = threading.RLock()
_dropped: deque[dict[str, Any]] = deque()


class _Symbolic:
    """A context in which expressions are made and dropped; and a decorator of functions, and of classes' methods, that do so."""

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
            return cast(Thing, self._alone(thing))
        for name, method in list(vars(thing).items()):
            if inspect.isfunction(method) and (not name.startswith("_") or name in ("__init__", "__post_init__")):
                setattr(thing, name, self._alone(method))
        return thing

    def _alone(self, function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def called(*given: Any, **named: Any) -> Any:
            with self:
                return function(*given, **named)

        return called


symbolic = _Symbolic()


class Graphs:
    """What holds expressions, and may be dropped by any thread: they go when a thread makes others."""

    def __del__(self, later: Callable[[dict[str, Any]], None] = _dropped.append) -> None:
        later(vars(self))

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
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, cast, overload

from .brief import no_attribute

if TYPE_CHECKING:
    from typing_extensions import Self

Thing = TypeVar("Thing", bound=Callable[..., Any])
Value = TypeVar("Value")
_P = ParamSpec("_P")

_lock = threading.RLock()
_dropped: deque[dict[str, Any]] = deque()


class _Symbolic:
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
            return cast(Thing, self._alone(thing))
        for name, method in list(vars(thing).items()):
            if inspect.isfunction(method) and (
                not name.startswith("_") or name in ("__init__", "__post_init__")
            ):
                setattr(thing, name, self._alone(method))
        return thing

    def _alone(self, function: Callable[_P, Value]) -> Callable[_P, Value]:
        @functools.wraps(function)
        def called(*given: _P.args, **named: _P.kwargs) -> Value:
            with self:
                return function(*given, **named)

        return called


symbolic = _Symbolic()


class symbolic_property(functools.cached_property[Value]):  # noqa: N801 - like cached_property
    """Property that makes expressions when it is first read, and is kept with its object.

    Until Python 3.12 a ``cached_property`` has a lock of its own. Two threads that take it and that
    of expressions in turn would wait for each other; here there is one lock.
    """

    @overload
    def __get__(self, instance: None, owner: type | None = None) -> Self: ...

    @overload
    def __get__(self, instance: object, owner: type | None = None) -> Value: ...

    def __get__(self, instance: object, owner: type | None = None) -> Self | Value:
        """Return the value, which is made once."""
        if instance is None:
            return self
        with symbolic:
            kept, name = vars(instance), str(self.attrname)
            if name not in kept:
                kept[name] = self.func(instance)
            value: Value = kept[name]
            return value


class Graphs:
    """Holder of expressions that any thread may drop: they are freed when a thread makes others."""

    if not TYPE_CHECKING:
        __getattr__ = no_attribute

    def __del__(self, later: Callable[[dict[str, object]], None] = _dropped.append) -> None:
        later(vars(self))

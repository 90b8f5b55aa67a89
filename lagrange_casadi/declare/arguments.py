"""Arguments that a declaration does not take, as those of a plane in space or the reverse, told in a line that names the part."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from ..errors import DeclarationError

Class = TypeVar("Class", bound=type)


def told_arguments(cls: Class) -> Class:
    """The class, whose public methods raise :class:`DeclarationError` for arguments that they do not take, and list their own."""
    for name, method in list(vars(cls).items()):
        if inspect.isfunction(method) and not name.startswith("_"):
            setattr(cls, name, _told(method))
    return cls


def _told(method: Callable[..., Any]) -> Callable[..., Any]:
    signature = inspect.signature(method)

    @functools.wraps(method)
    def called(mechanism: Any, *given: Any, **named: Any) -> Any:
        try:
            return method(mechanism, *given, **named)
        except TypeError:
            try:
                signature.bind(mechanism, *given, **named)
            except TypeError as wrong:
                part = f" '{given[0]}'" if given and isinstance(given[0], str) else ""
                where = "space" if mechanism.space else "a plane"
                valid = ", ".join(list(signature.parameters)[1:])
                raise DeclarationError(f"{method.__name__}{part}: {wrong}; in {where} it takes {valid}") from None
            raise

    return called

"""Compiled graphs as text: dataclasses that hold CasADi functions, plain data and each other.

A text names only kinds that its reader lists, so reading one calls nothing else.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import casadi as ca
import numpy as np

from .arrays import Json

_READ: dict[str, Callable[[Any], object]] = {
    "tuple": tuple,
    "mapping": dict,
    "flags": lambda values: np.array(values, bool),
    "function": ca.Function.deserialize,
    "symbol": ca.SX.sym,
}
"""Readers of what JSON does not know, by the one key that an object of JSON has here."""


def dumps(value: object) -> str:
    """Write plain data, functions, symbols by their names, and dataclasses of these."""
    return json.dumps(_plain(value))


def loads(text: str, kinds: tuple[type[Any], ...]) -> Any:
    """Read what :func:`dumps` wrote, whose dataclasses, and numbers of kinds of their own, are of
    ``kinds``.
    """
    known = {kind.__name__: kind for kind in kinds}

    def read(written: dict[str, Any]) -> object:
        ((name, content),) = written.items()
        return known[name](*content) if name in known else _READ[name](content)

    return json.loads(text, object_hook=read)


def _plain(value: Any) -> Json:
    if value is None or type(value) in (bool, int, str) or isinstance(value, float):
        plain: Json = value
        return plain
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if isinstance(value, tuple):
        return {"tuple": [_plain(one) for one in value]}
    if isinstance(value, Mapping):
        return {"mapping": [[_plain(key), _plain(one)] for key, one in value.items()]}
    if isinstance(value, np.ndarray) and value.dtype == bool:
        return {"flags": value.tolist()}
    if isinstance(value, ca.Function):
        return {"function": value.serialize()}
    if isinstance(value, ca.SX):
        return {"symbol": value.name()}
    kind = type(value).__name__
    if isinstance(value, int):
        return {kind: [int(value)]}
    if not is_dataclass(value):
        raise TypeError(f"{kind} cannot be written as text")
    return {kind: [_plain(getattr(value, field.name)) for field in fields(value)]}

"""Types of values: arrays, expressions, what may be either, and what JSON holds; and arrays over
time, cut.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Numbers in double precision."""

Flags = npt.NDArray[np.bool_]
"""True or False for each of some things."""

Expression: TypeAlias = Any
"""An expression of CasADi, or a number in its place. CasADi's own types have no such union: its
functions take one or the other.
"""

Operand: TypeAlias = Any
"""A number, an array or an expression, for formulas that are written once for all of them."""

Json: TypeAlias = str | float | Sequence["Json"] | Mapping[str, "Json"] | None
"""A value that JSON holds."""


def as_json(content: object) -> Any:
    """Return what a file of JSON with some content is read as: rows are lists."""
    return json.loads(json.dumps(content))


Instants: TypeAlias = slice | list[int] | npt.NDArray[np.generic]
"""Some of the instants: a slice, their numbers, or True and False."""


def during(value: Operand, instants: Instants) -> Operand:
    """A value at some of the instants: all arrays over time that it is, or that mappings, rows and
    dataclasses hold, or that it cuts by a method of this name. Anything else stays.
    """
    if isinstance(value, np.ndarray):
        return value[instants]
    if isinstance(value, Mapping):
        return {key: during(one, instants) for key, one in value.items()}
    if isinstance(value, tuple | list):
        return tuple(during(one, instants) for one in value)
    if hasattr(value, "during"):
        return value.during(instants)
    if is_dataclass(value) and not isinstance(value, type):
        held = {entry.name: getattr(value, entry.name) for entry in fields(value)}
        return replace(value, **during(held, instants))
    return value


def every(size: int, most: int) -> slice:
    """The numbers 0, k, 2 k, ... of ``size`` things, at most ``most`` of them, as a slice."""
    return slice(None, None, 1 + size // most)


def spread(size: int, most: int) -> npt.NDArray[np.intp]:
    """The numbers of so many things, or of at most so many of them that are evenly spread, the
    first and the last among them.
    """
    many = min(size, most)
    return np.arange(many) * (size - 1) // max(many - 1, 1)

"""Objects in a line that a notebook can show."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, NoReturn

import casadi as ca
import numpy as np

from ..errors import NoAttributeError, shown

LONGEST = 200
"""Characters of a line at most."""

_FEW = 4
"""Numbers of an array, and entries of a collection, that are written out."""

_VALUE = 60
"""Characters that a field takes at most."""

_WORDS = ("name", "link", "joint", "case")
"""Fields by which an object is known, the first that it has."""


def no_attribute(owner: object, name: str) -> NoReturn:
    """Raise :class:`.NoAttributeError`, which lists the attributes that an object has."""
    if name.startswith("_"):  # what Python, NumPy and notebooks look for
        raise AttributeError(f"'{type(owner).__name__}' object has no attribute '{name}'")
    if hasattr(type(owner), name):  # its property has raised this, and says why
        object.__getattribute__(owner, name)
    valid = [word for word in dir(owner) if not word.startswith("_")]
    raise NoAttributeError(f"attribute of {type(owner).__name__}", name, valid)


class Brief:
    """A dataclass that Python writes in a line, as ``Name(field=value, ...)``: of an array its
    shape, and from where to where its numbers are; of another object its kind and name; of a large
    collection the number of its entries.
    """

    if not TYPE_CHECKING:
        __getattr__ = no_attribute

    def __repr__(self) -> str:
        each = [
            f"{entry.name}={_brief(getattr(self, entry.name, None))}"
            for entry in fields(self)  # type: ignore[arg-type]
            if entry.repr
        ]
        text = f"{type(self).__name__}({', '.join(each)})"
        if len(text) > LONGEST:
            text = f"{text[: LONGEST - 6].rpartition(', ')[0]}, ...)"
        return text


def _brief(value: object) -> str:
    """A value in few characters."""
    if isinstance(value, np.ndarray) and value.size > _FEW:
        shape = " x ".join(map(str, value.shape))
        if value.dtype.kind not in "iuf" or not np.isfinite(value).any():
            return f"<{shape} of {value.dtype}>"
        return f"<{shape} from {np.nanmin(value):.5g} to {np.nanmax(value):.5g}>"
    if isinstance(value, Brief):
        return _known(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        pairs = (f"{shown(key)}: {_brief(one)}" for key, one in value.items())
        return _few(value, lambda: f"{{{', '.join(pairs)}}}")
    if isinstance(value, tuple | list | set | frozenset):
        return _few(value, lambda: f"({', '.join(map(_brief, value))}{',' * (len(value) == 1)})")
    if isinstance(value, ca.SX) and (not value.is_scalar() or ca.n_nodes(value) > _FEW):
        return f"<SX of {' x '.join(map(str, value.shape))}>"
    if hasattr(value, "__qualname__"):
        return f"<{getattr(value, '__name__', 'function')}>"
    text = shown(value)
    return text if len(text) <= _VALUE else _known(value)


def _known(value: object) -> str:
    """An object's kind, and the name by which it is known if it has one."""
    word = next((getattr(value, word) for word in _WORDS if hasattr(value, word)), "")
    return f"<{type(value).__name__}{f' {word}' if isinstance(word, str) and word else ''}>"


def _few(values: Collection[object], written: Callable[[], str]) -> str:
    """A collection as it is ``written``, or the number of its entries where that is long."""
    if len(values) <= _FEW and len(text := written()) <= _VALUE:
        return text
    return f"<{len(values)} entries>"

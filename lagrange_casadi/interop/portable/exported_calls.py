"""The functions of an exported program, in the order in which they are called: what each takes and
fills, for every language, and how C calls it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Call:
    """A call of a function: the vectors that it takes, and those that it fills."""

    takes: tuple[str, ...]
    fills: tuple[str, ...]

    def places(self, function: ca.Function) -> Iterator[tuple[str, str, int]]:
        """Yield of each vector its place in C, its name, and its length by the function."""
        for k, vector in enumerate(self.takes):
            yield f"arg[{k}]", vector, function.size1_in(k)
        for k, vector in enumerate(self.fills):
            yield f"res[{k}]", vector, function.size1_out(k)


PREPARE = {
    "sound": Call(("parameters",), ("sound_of",)),
    "constants_of": Call(("parameters",), ("constants",)),
    "matter": Call(("parameters",), ("matter",)),
}
"""Calls for new parameters: margins of what must not be negative, and what else they set."""

INSTANT = {
    "count": Call(("moment", "parameters"), ("counted",)),
    "loops": Call(("z", "counted", "parameters"), ("correction", "size")),
    "instant": Call(("counted", "rate", "acceleration", "loops", "constants"), ("evaluated",)),
    "status": Call(("y", "matter", "iterated"), ("rule",)),
}
"""Calls for an instant: ``moment`` are its time and coordinates. ``loops`` is called again until
its size is small: it corrects ``z``, from which the next instant starts. ``rule`` is the number of
the first rule that is broken.
"""

CALLS = {
    **PREPARE,
    "law": Call(("at", "parameters"), ("d", "rate", "acceleration")),
    "beyond": Call(("at", "parameters"), ("far",)),
    **INSTANT,
    "closing": Call(
        ("counted", "rate", "acceleration", "loops", "parameters"), ("squares", "rates", "slopes")
    ),
    "slopes_of": Call(("time", "d", "rate", "acceleration", "loops", "parameters"), ("s",)),
}
"""All calls. Of a time, ``law`` is the motion of the drives, ``beyond`` how far that is beyond the
ends of its curves; ``closing`` is for a place between two instants, see :func:`.closing_of`, and
``slopes_of`` are the derivatives of the outputs of an instant.
"""

MODEL = ("parameters", "constants", "matter", "loops")
"""Vectors that a model keeps between calls."""

_POINTERS = {name: f"model->{name}" for name in MODEL}
_POINTERS |= {name: f"&{name}" for name in ("size", "iterated", "rule", "time")}
"""Vectors of C that are no arrays of the function that calls."""


def call(functions: Mapping[str, ca.Function], name: str, **pointers: str) -> Iterator[str]:
    """Yield the statements of C that call one of some functions by way of ``arg`` and ``res``;
    ``pointers`` are vectors that have other names in C.
    """
    yield from given(functions, name, **pointers)
    yield f"{name}(arg, res);"


def given(functions: Mapping[str, ca.Function], name: str, **pointers: str) -> Iterator[str]:
    """Yield the statements before a call: a vector without elements is 0."""
    known = _POINTERS | pointers
    for place, vector, size in CALLS[name].places(functions[name]):
        yield f"{place} = {known.get(vector, vector) if size else '0'};"

"""Upper bound of the stack of straight C of this package's style: the declarations of its
functions, along the deepest calls.
"""

from __future__ import annotations

import functools
import math
import re

_DEFINITION = re.compile(
    r"^(?:static )?[\w \*]*?\b(\w+)\([^;{}]*\) \{(?:([^\n]*)\}\n|\n(.*?)^\}\n)",
    re.DOTALL | re.MULTILINE,
)
_DECLARATION = re.compile(
    r"^ +(?:const )?(?:casadi_real|int|long|double|float|\w+_(?:real|status|parameters))\b(\*?)"
    r" ?([^()=;]*(?:=[^;]*)?);",
    re.MULTILINE,
)
_CALL = re.compile(r"\b(\w+)\(")
_SLOT = 8
_FRAME = 192
"""Bytes of a call and saved registers, with a margin."""

_LARGE, _PART = 128, 3
"""Number of variables from which a compiler that runs out of registers keeps other values too, and
the fraction of these.
"""


def deepest(source: str) -> int:
    """Bytes, with 8 for every variable, also where a compiler keeps it in a register."""
    bodies = {found[1]: found[2] or found[3] or "" for found in _DEFINITION.finditer(source)}
    sizes = {
        name: _FRAME + _SLOT * _kept(sum(_slots(x[2]) for x in _DECLARATION.finditer(body)))
        for name, body in bodies.items()
    }
    calls = {
        name: sorted(set(_CALL.findall(body)) & bodies.keys()) for name, body in bodies.items()
    }

    @functools.cache
    def depth(name: str) -> int:
        return sizes[name] + max(map(depth, calls[name]), default=0)

    return max(map(depth, bodies))


def _kept(slots: int) -> int:
    """Number of slots of a function that declares so many."""
    return slots if slots < _LARGE else slots + slots // _PART


def _slots(declarators: str) -> int:
    """Number of slots of a declaration's variables."""
    words = re.split(r",(?![^\[{(]*[\]})])", declarators)
    arrays = (re.findall(r"\[([^\]]+)\]", word.partition("=")[0]) for word in words)
    return sum(math.prod(eval(n, {"__builtins__": {}}) for n in sizes) for sizes in arrays)

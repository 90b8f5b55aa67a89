"""Python as a person writes it: short numbers, calls that are broken into lines, comments."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from textwrap import TextWrapper

import numpy as np

from ...base.arrays import Array
from ...errors import escaped
from .posture import EXACT

WIDTH = 96
"""Characters of a line of a function, at most, where it can be broken."""

Place = tuple[float, float, float]


def text_of(value: float) -> str:
    """Return a number as Python writes it; zero has no sign."""
    return repr(float(value) + 0.0)


def of_pi(value: float) -> str:
    """Return a number as text: as a simple multiple of pi where it is one to the last digits."""
    for part in (1, 2, 3, 4, 6):
        whole = value / math.pi * part
        near = round(whole)
        if near and abs(near) < 1000 and abs(whole - near) < 4e-16 * abs(whole):
            times = {1: "pi", -1: "-pi"}.get(near, f"{near} * pi")
            return times if part == 1 else f"{times} / {part}"
    return text_of(value)


def signed(value: float) -> str:
    """Return a number as a term of a sum; nothing for zero."""
    return "" if not value else f" + {of_pi(value)}" if value > 0 else f" - {of_pi(-value)}"


@dataclass(frozen=True)
class Call:
    """A call, or a tuple if the function has no name."""

    function: str
    arguments: Sequence[object]

    def __str__(self) -> str:
        comma = "," if not self.function and len(self.arguments) == 1 else ""
        return f"{self.function}({', '.join(map(str, self.arguments))}{comma})"

    def lines(self, after: str = "", width: int = WIDTH) -> list[str]:
        """Return one line, or a line for each argument, these broken like it."""
        if len(line := f"{self}{after}") <= width or len(self.arguments) < 2:
            return [line]
        lines = [f"{self.function}("]
        for one in self.arguments:
            broken = one.lines(",", width - 4) if isinstance(one, Call) else [f"{one},"]
            lines += [f"    {line}" for line in broken]
        return [*lines, f"){after}"]


def vector(values: Iterable[float], name: str = "") -> Call:
    """Return numbers as a tuple, as the argument of a name if it has one."""
    return Call(f"{name}=" if name else "", [text_of(one) for one in values])


def safe(text: str) -> str:
    """Return a text that ends neither a comment nor a docstring."""
    return escaped(text).replace("\\", "/").replace('"', "'")


def comment(text: str) -> list[str]:
    """Return the lines of a comment."""
    lines = TextWrapper(WIDTH, "# ", "#   ", break_long_words=False, break_on_hyphens=False)
    return lines.wrap(" ".join(safe(text).split()))


def short(values: Array, size: float | None = None) -> Array:
    """Return numbers without the rounding of sums, as far as it is of a size, else of the largest:
    those that are short but for it as short ones.
    """
    scale = float(np.abs(values).max()) if size is None else size
    if not scale:
        return np.zeros_like(values)
    found = np.round(values, 8 - math.floor(math.log10(scale)))
    return np.asarray(np.where(np.abs(values - found) <= EXACT * scale, found, values) + 0.0)


def direction(axis: Array, name: str = "") -> Call:
    """Return a unit vector as a tuple."""
    return vector(short(axis, 1.0).tolist(), name)

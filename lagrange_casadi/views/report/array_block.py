"""Arrays in a page: one block of 64-bit numbers, in which each array has its place."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...base.arrays import Array


@dataclass(eq=False)
class Arrays:
    """Arrays that are added one by one, each of which gets a number; one whose values are all the
    same takes no room.

    ``of`` has for each the full names of the outputs that it is, or the size of; none where it is
    anything else.
    """

    places: list[dict[str, Any]] = field(default_factory=list)
    of: list[tuple[str, ...]] = field(default_factory=list)
    _blocks: list[Array] = field(default_factory=list)
    _size: int = 0

    def add(self, values: Array, *of: str) -> int:
        """Take an array (n,), and return its number. Values that are not finite become NaN."""
        self.of.append(of)
        values = np.where(np.isfinite(values), np.asarray(values, np.float64), np.nan) + 0.0
        if values.size and np.isfinite(values[0]) and (values == values[0]).all():
            self.places.append({"count": values.size, "value": float(values[0])})
        else:
            self.places.append({"count": values.size, "at": self._size})
            self._blocks.append(values)
            self._size += values.size
        return len(self.places) - 1

    def block(self) -> str:
        """All values one after another, little-endian, in base 64."""
        joined = np.concatenate(self._blocks) if self._blocks else np.empty(0)
        return base64.b64encode(joined.astype("<f8").tobytes()).decode("ascii")


def finite(value: float | None) -> float | None:
    """A number that JSON can hold, None for any other and for none."""
    return None if value is None or not math.isfinite(value) else float(value)

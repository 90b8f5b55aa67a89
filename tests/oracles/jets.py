"""Numbers with their first and second derivative by time: truncated power series."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from splines import by_hand


@dataclass(slots=True, eq=False)
class Jet:
    """A number with its first and second derivative by time.

    ``d`` may also be an array: the derivatives along several directions at once, of which only
    these first ones have a meaning.
    """

    v: Any
    d: Any = 0.0
    a: Any = 0.0

    __array_ufunc__: ClassVar = None  # a NumPy number on the left leaves the operation to the jet

    def __add__(self, o):
        return (
            Jet(self.v + o.v, self.d + o.d, self.a + o.a)
            if isinstance(o, Jet)
            else Jet(self.v + o, self.d, self.a)
        )

    def __sub__(self, o):
        return (
            Jet(self.v - o.v, self.d - o.d, self.a - o.a)
            if isinstance(o, Jet)
            else Jet(self.v - o, self.d, self.a)
        )

    def __mul__(self, o):
        if not isinstance(o, Jet):
            return Jet(self.v * o, self.d * o, self.a * o)
        return Jet(
            self.v * o.v,
            self.d * o.v + o.d * self.v,
            self.a * o.v + 2 * self.d * o.d + o.a * self.v,
        )

    def __truediv__(self, o):
        return self * (o.through(1 / o.v, -1 / o.v**2, 2 / o.v**3) if isinstance(o, Jet) else 1 / o)

    def __rtruediv__(self, o):
        return Jet(o) / self

    def __rsub__(self, o):
        return self * -1 + o

    def __neg__(self):
        return self * -1

    def __pow__(self, n):
        return self.through(
            self.v**n, n * self.v ** (n - 1), n * (n - 1) * self.v ** (n - 2) if n > 1 else 0
        )

    def __gt__(self, o):
        return float(self.v > o)

    def __lt__(self, o):
        return float(self.v < o)

    __radd__ = __add__
    __rmul__ = __mul__

    def through(self, value, slope, bend):
        """A function of this number, from its value and its first and second derivative there."""
        return Jet(value, self.d * slope, self.a * slope + self.d * self.d * bend)


def sin(x):
    s, c = math.sin(x.v), math.cos(x.v)
    return x.through(s, c, -s)


def cos(x):
    s, c = math.sin(x.v), math.cos(x.v)
    return x.through(c, -s, -c)


def sqrt(x):
    root = math.sqrt(x.v)
    return x.through(root, 1 / (2 * root), -1 / (4 * root**3))


def table(x, places, values, beyond):
    """A table by straight lines: only value and slope between its points."""
    if beyond == "hold" and not places[0] <= x.v <= places[-1]:
        return x * 0.0 + values[0 if x.v < places[0] else -1]
    k = min(max(bisect.bisect_right(places, x.v), 1), len(places) - 1)
    slope = (values[k] - values[k - 1]) / (places[k] - places[k - 1])
    return (x - places[k - 1]) * slope + values[k - 1]


def curve(x, y, periodic):
    found = by_hand(np.array(x), np.array(y), periodic)
    return lambda place: place.through(*found(place.v))


FUNCTIONS = {one.__name__: one for one in (curve, sin, cos, sqrt, table)}
"""Functions of jets, by name."""

"""Constraints and non-holonomic rows as the user wrote them, evaluated on a motion that is given in numbers.

What a solution is checked by must not be what made it: here are the declared expressions themselves, over what they measure, and
nothing of the graphs that loops were solved from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..base.arrays import Array
from ..declare.stated import Stated
from .touching import Touch


@dataclass(frozen=True)
class Entry:
    """One number that an equation measures: a joint's coordinate, x, y or z of a point of a body, or a link's direction."""

    kind: Literal["coordinate", "x", "y", "z", "direction"]
    part: str
    point: tuple[float, ...] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Written:
    """A constraint Phi = 0, or a row A q' + b = 0 where ``row``: its entries, and its functions over them and parameters ``p``.

    ``values`` and ``slopes`` are those of :class:`.Stated`. Of a transmission, ``touches`` say where and how its multiplier acts.
    """

    name: str
    row: bool
    entries: tuple[Entry, ...]
    values: Any
    slopes: Any
    p: Array
    touches: tuple[Touch, ...] = ()

    def at(self, motion: Sequence[tuple[Array, Array, Array]], t: Array) -> tuple[Array, ...]:
        """The equation over instants, and of a constraint its derivatives; each entry's motion is its place, rate, acceleration."""
        return tuple(np.asarray(row).ravel() for row in self.values(*_stacked(motion, t), t[None], self.p).full())

    def slopes_at(self, motion: Sequence[tuple[Array, Array, Array]], t: Array) -> Array:
        """What it changes by each entry, (entries, t)."""
        places, rates, _ = _stacked(motion, t)
        return np.asarray(self.slopes(places, rates, t[None], self.p).full())


def written(stated: Stated, p: Array) -> tuple[Written, ...]:
    """Return all constraints and rows of a mechanism, for parameters ``p``."""
    told = stated.template.placed(stated.template.content, p)["equations"]
    return tuple(
        Written(
            equation["name"],
            equation["row"],
            tuple(Entry(entry["kind"], entry["part"], tuple(entry["point"]) or (0.0, 0.0)) for entry in equation["entries"]),
            values,
            slopes,
            p,
            tuple(map(Touch.of, equation["meshes"])),
        )
        for equation, values, slopes in zip(told, stated.values, stated.slopes, strict=True)
    )


def _stacked(motion: Sequence[tuple[Array, Array, Array]], t: Array) -> list[Array]:
    """Places, rates and accelerations of all entries, each (entries, t)."""
    return [np.array([entry[k] for entry in motion]).reshape(len(motion), t.size) for k in range(3)]

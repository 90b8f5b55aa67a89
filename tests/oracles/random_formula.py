"""Formulas of a random mechanism: the text that a user writes, and its value by the oracle's places
of points, as jets.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import oracle
from jets import FUNCTIONS, Jet


class Number(NamedTuple):
    """A number as it is written, perhaps by parameters, and its value."""

    text: str
    value: float


def literal(value: float) -> Number:
    """A number written as it is."""
    return Number(repr(float(value)), float(value))


@dataclass(frozen=True)
class Measure:
    """What a name in a formula stands for: x or y of a point, the angle of a body, or a joint's
    coordinate; or its rate.
    """

    kind: str
    of: Any
    rate: bool = False

    def jet(self, place) -> Jet:
        """Its value with its derivatives, from the places of points."""
        if self.kind == "coordinate":
            return joint_coordinate(self.of, place)
        return place(self.of)["xya".index(self.kind[0])]

    def does(self, place, size) -> list[tuple[Any, Any, Any, Any]]:
        """What a multiplier of this size does along it, as (point, fx, fy, mz)."""
        if self.kind == "x":
            return [(self.of, size, 0.0, 0.0)]
        if self.kind == "y":
            return [(self.of, 0.0, size, 0.0)]
        if self.kind == "angle":
            return [((self.of[0], 0.0, 0.0), 0.0, 0.0, size)]
        joint = self.of
        if not joint.slides:
            return [(joint.child, 0.0, 0.0, size), (joint.parent, 0.0, 0.0, size * -1)]
        fx, fy = (along.v * size for along in axis_of(joint, place))
        return [(joint.child, fx, fy, 0.0), (under(joint, place), fx * -1, fy * -1, 0.0)]


def axis_of(joint: oracle.Joint, place) -> tuple[Jet, Jet]:
    """The axis that a joint's parent carries, in ground axes."""
    body, (ax, ay) = joint.parent[0], joint.axis
    (ox, oy, _), (ex, ey, _) = place((body, 0.0, 0.0)), place((body, ax, ay))
    return ex - ox, ey - oy


def under(joint: oracle.Joint, place) -> tuple[str, Any, Any]:
    """The point of a sliding joint's parent at which the child's point is."""
    x, y, _ = place(joint.child)
    return joint.parent[0], *seen(place, joint.parent[0], (x.v, y.v))


def seen(place, body: str, at) -> tuple[Any, Any]:
    """A place in a body's axes."""
    (bx, by, _), (x, y, _) = place((body, 0.0, 0.0)), place((body, 1.0, 0.0))
    c, s, dx, dy = x.v - bx.v, y.v - by.v, at[0] - bx.v, at[1] - by.v
    return c * dx + s * dy, c * dy - s * dx


def joint_coordinate(joint: oracle.Joint, place) -> Jet:
    """The coordinate of a joint: the child's angle less the parent's, or
    the place along the axis.
    """
    (px, py, pa), (cx, cy, ca) = place(joint.parent), place(joint.child)
    if not joint.slides:
        return ca - pa
    ax, ay = axis_of(joint, place)
    return ax * (cx - px) + ay * (cy - py)


@dataclass(frozen=True)
class Formula:
    """A text over names: ``t``, sin, cos, sqrt, parameters and measures."""

    text: str
    names: Mapping[str, Measure]
    parameters: Mapping[str, float]

    def jet(self, place, t) -> Jet:
        """Its value with its derivatives by time; of rates only the values are known."""
        known = {}
        for name, measure in self.names.items():
            found = measure.jet(place)
            known[name] = Jet(found.d) if measure.rate else found
        return self._value(known, Jet(t, 1.0))

    def effect(self, place, t) -> list[tuple[Any, Any, Any, Any]]:
        """What a unit multiplier of this formula does: its slope by each measure, or by the rates
        where it is a row, along it.
        """
        known, row_of_rates = {}, any(m.rate for m in self.names.values())
        for row, (name, measure) in zip(np.eye(len(self.names)), self.names.items(), strict=True):
            found = measure.jet(place)
            known[name] = Jet(found.d if measure.rate else found.v, row)
        slopes = np.broadcast_to(self._value(known, Jet(t)).d, len(self.names))
        acting = [
            (m, x)
            for m, x in zip(self.names.values(), slopes, strict=True)
            if m.rate == row_of_rates
        ]
        return [part for measure, size in acting for part in measure.does(place, size)]

    def _value(self, known, t):
        value = eval(_compiled(self.text), {**FUNCTIONS, **self.parameters, **known, "t": t})
        return value if isinstance(value, Jet) else Jet(float(value))


@functools.cache
def _compiled(text):
    return compile(text, text, "eval")

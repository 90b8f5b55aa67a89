"""Constraints and non-holonomic rows as the user wrote them, evaluated on a motion that is given in numbers.

What a solution is checked by must not be what made it: here are the declared expressions themselves, over what they measure, and
nothing of the graphs that loops were solved from.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.symbolic import symbolic
from ..declare.mechanism import Mechanism
from ..declare.parts import Point
from .touching import Touch, touches_of


@dataclass(frozen=True)
class Entry:
    """One number that an equation measures: a joint's coordinate, x, y or z of a point of a body, or a link's direction."""

    kind: Literal["coordinate", "x", "y", "z", "direction"]
    part: str
    point: tuple[float, ...] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Written:
    """A constraint Phi = 0, or a row A q' + b = 0 where ``row``: its entries, and its expression over them, as functions.

    ``values(places, rates, accelerations, t)`` gives the equation and, of a constraint, its first and second total time derivative;
    ``slopes(places, rates, t)`` what it changes by an entry: by its place, or of a row by its rate.
    Of a transmission, ``touches`` say where and how its multiplier acts.
    """

    name: str
    row: bool
    entries: tuple[Entry, ...]
    values: Any
    slopes: Any
    touches: tuple[Touch, ...] = ()

    def at(self, motion: Sequence[tuple[Array, Array, Array]], t: Array) -> tuple[Array, ...]:
        """The equation over instants, and of a constraint its derivatives; each entry's motion is its place, rate, acceleration."""
        return tuple(np.asarray(row).ravel() for row in self.values(*_stacked(motion, t), t[None]).full())

    def slopes_at(self, motion: Sequence[tuple[Array, Array, Array]], t: Array) -> Array:
        """What it changes by each entry, (entries, t)."""
        places, rates, _ = _stacked(motion, t)
        return np.asarray(self.slopes(places, rates, t[None]).full())


@symbolic
def written(mechanism: Mechanism, values: Mapping[str, float]) -> tuple[Written, ...]:
    """All constraints and rows of a mechanism, for values of its parameters."""
    given = [
        replace(_written(mechanism, values, c.name, c.phi, False), touches=touches_of(mechanism, values, c.transmission))
        for c in mechanism.constraints.values()
    ]
    return (*given, *(_written(mechanism, values, row.name, row.expression, True) for row in mechanism.rows.values()))


def _written(mechanism: Mechanism, values: Mapping[str, float], name: str, expression: Any, row: bool) -> Written:
    numbers = ca.DM([values[key] for key in mechanism.parameters])
    expression = ca.substitute(ca.SX(expression), mechanism.symbols, ca.SX(numbers))
    told = list(_entries(mechanism, values))
    found = [entry for entry in told if any(ca.depends_on(expression, symbol) for symbol in (entry[1], entry[2]))]
    places, rates = ca.vertcat(ca.SX(0, 1), *(e[1] for e in found)), ca.vertcat(ca.SX(0, 1), *(e[2] for e in found))
    accelerations, t = ca.SX.sym("accelerations", len(found)), mechanism.time
    moving, speed = ca.vertcat(places, rates, t), ca.vertcat(rates, accelerations, 1)
    changes = [expression]
    for _ in range(0 if row else 2):
        changes.append(ca.jtimes(changes[-1], moving, speed))
    slopes = ca.densify(ca.jacobian(expression, rates if row else places).T)
    return Written(
        name,
        row,
        tuple(entry for entry, *_ in found),
        ca.Function("values", [places, rates, accelerations, t], [ca.densify(ca.vertcat(*changes))]),
        ca.Function("slopes", [places, rates, t], [slopes]),
    )


def _entries(mechanism: Mechanism, values: Mapping[str, float]) -> Iterator[tuple[Entry, Any, Any]]:
    """All that is measured, with the symbols of places and rates."""
    for measure in mechanism.measures.asked:
        of = measure.of
        if isinstance(of, Point):
            point = tuple(mechanism.number(x, values) for x in of.place[: len(measure.places)])
            components: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")
            for component, place, rate in zip(components, measure.places, measure.rates, strict=False):
                yield Entry(component, of.body.name, point), place, rate
        elif measure.axis is not None:
            yield Entry("coordinate", measure.axis.coordinate), measure.places[0], measure.rates[0]
        else:
            yield Entry("direction", of.name), measure.places[0], measure.rates[0]


def _stacked(motion: Sequence[tuple[Array, Array, Array]], t: Array) -> list[Array]:
    """Places, rates and accelerations of all entries, each (entries, t)."""
    return [np.array([entry[k] for entry in motion]).reshape(len(motion), t.size) for k in range(3)]

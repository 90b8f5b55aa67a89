"""Utilisation of a link with a beam at an instant, and its stresses, largest along the link.

Between two load points, or breaks of the density or of the cross-section, section forces are
polynomials. Each such part is evaluated at both ends and at places in between. The search for the
largest value begins at the local maxima whose parabola through three neighbours is highest. It
continues with parabolas through ever nearer places. The result is the stress at one of the places,
so it is never above the largest stress. If more than two local maxima of one part are equal within
the error of the first parabolas, a hundredth, the result may be below the largest by as much.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Expression, Operand
from ..base.quantities import Column, Output
from ..base.tables import table_of
from ..model.beams.properties import Properties
from ..model.declared_parts import Link
from ..model.limits import END
from ..model.link_density import Density
from ..model.mechanism import Mechanism
from ..model.polynomials import value_at
from . import buckling
from .section_function import Section, edge
from .section_stress import KINDS, CrossSections, squared

_SAMPLES, _MAXIMA, _NEARER = 9, 2, 8.0
"""Places at which a part is looked at, how many of its summits are followed, and how much nearer
places come.
"""

_MORE = 6
"""More places where the cross-section changes."""

_SLACK = END["single"]
"""Distance of a load point at which it is at a section: one graph serves both precisions."""


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a link between two ratios, the cell of its cross-section, and its section forces as
    polynomials from 0 to 1.
    """

    low: Any
    width: Any
    cell: int
    forces: Mapping[str, Sequence[Any]] = field(default_factory=dict)

    def force(self, name: str, x: Expression) -> Expression:
        """A section force at a place from 0 to 1."""
        return value_at(self.forces[name], x)


class Loaded:
    """A link with a beam, its section forces and stresses as expressions."""

    def __init__(self, space: bool, link: Link, columns: Mapping[Column, Expression]) -> None:
        assert link.beam is not None
        assert isinstance(link.mass, Density)
        self.link, self.space = link, space
        self.beam, self.course = link.beam, link.beam.course
        self.cross = CrossSections(link.beam, space)
        self.section = Section(link.name, table_of(space), columns, link.length, link.mass)
        self.marks = [place.ratio for place in self.section.marks if place.side == "tip"]
        self.marks += [ca.SX(b) for b in link.mass.breaks[1:-1]]
        self.degree = max(
            max(map(len, link.mass.cells)) + 2,
            *(many + 1 for many in self.section.distributed_loads.values()),
            0,
        )

    @cached_property
    def parts(self) -> list[Part]:
        """Parts of the link, with their section forces."""
        return [replace(part, forces=self._polynomials(part)) for part in self.spans]

    @property
    def spans(self) -> list[Part]:
        """Parts between stations, ends of loads along the link, and breaks of its density and its
        cross-section.
        """
        found = []
        for cell, (low, high) in enumerate(itertools.pairwise(self.course.breaks)):
            inner = _in_order([ca.fmin(ca.fmax(ca.SX(mark), low), high) for mark in self.marks])
            for a, b in itertools.pairwise([ca.SX(low), *inner, ca.SX(high)]):
                if not (a - b).is_zero():
                    found.append(Part(a, b - a, cell))
        return found

    def force_within(self, name: str, part: Part, x: Operand) -> Operand:
        """A section force at a place of a part from 0 to 1, by the link's law."""
        return self.section.force(name, part.low + part.width * x, edge(part.low, _SLACK))

    def _polynomials(self, part: Part) -> dict[str, list[Expression]]:
        nodes = (1.0 - np.cos(math.pi * np.arange(self.degree + 1) / self.degree)) / 2
        inverse = np.linalg.inv(np.vander(nodes, increasing=True))
        found = {}
        for name in self.cross.forces:
            values = [self.force_within(name, part, x) for x in nodes.tolist()]
            found[name] = [
                sum(w * value for w, value in zip(row.tolist(), values, strict=True))
                for row in inverse
            ]
        return found

    def degree_along(self, part: Part) -> int:
        """The degree of polynomials that stresses along a part are about as smooth as."""
        first, last = self.course.cells[part.cell]
        return self.degree + (0 if first is last else _MORE)

    def at(self, part: Part, x: Operand) -> Properties:
        """The cross-section at a place of a part."""
        return self.cross.properties(part.cell, part.low + part.width * x)

    def square(self, part: Part, x: Expression) -> ca.SX:
        """The largest square of von Mises' stresses at a place of a part."""
        forces = [part.force(name, x) for name in self.cross.forces]
        needed = self.cross.fibres(part.cell).needed
        found = self.cross.stresses(part.cell, part.low + part.width * x, needed, forces)
        return most(ca.vertsplit(squared(found, KINDS["von_mises"])))


def stresses(
    mechanism: Mechanism, name: str, columns: Mapping[Column, Expression]
) -> dict[Column, ca.SX]:
    """Von Mises' stress that is largest along a link [Pa]; nothing in space where torsion has no
    formula.
    """
    link = Loaded(mechanism.space, mechanism.links[name], columns)
    if link.space and any(shape.properties().torsion is None for shape in link.course.shapes):
        return {}
    return {Output("stress", name, "von_mises"): ca.sqrt(_largest(link, link.square))}


def utilisation(
    mechanism: Mechanism,
    name: str,
    columns: Mapping[Column, Expression],
    effective: tuple[float, float],
) -> dict[Column, ca.SX]:
    """Utilisation of a link against yielding and against buckling: one over the factors of safety
    at an instant.

    ``effective`` are the effective lengths as a column over its own. For buckling see
    :mod:`.buckling`.
    """
    found: dict[Column, Any] = {}
    link = Loaded(mechanism.space, mechanism.links[name], columns)
    material = link.beam.material
    if material.yield_strength is None:
        return found
    stress = stresses(mechanism, name, columns).get(Output("stress", name, "von_mises"))
    if stress is not None:
        found[Output("utilisation", name, "yield")] = stress / material.yield_strength
    if material.elasticity is not None:
        found[Output("utilisation", name, "buckling")] = _buckling(link, effective)
    return found


def _buckling(link: Loaded, effective: tuple[float, float]) -> Expression:
    """Utilisation of a link as a column, with the largest compression and the largest moments along
    it.
    """
    compression = _largest(link, lambda part, x: -part.force("axial", x))
    names = ("bending_z", "bending_y") if link.space else ("bending",)
    moments = [ca.sqrt(_largest(link, functools.partial(_squared, name))) for name in names]
    return buckling.used(
        buckling.Column.of(link.cross, link.link.length, effective), compression, moments
    )


def _squared(name: str, part: Part, x: Expression) -> Expression:
    return part.force(name, x) ** 2


def _largest(link: Loaded, value: Callable[[Part, Expression], Expression]) -> ca.SX:
    """The largest value along a link, of those at all places that are looked at."""
    found: list[Any] = []
    for part in link.parts:
        found += sampled(functools.partial(value, part), link.degree_along(part))
    return most(found)


def sampled(value: Callable[[Expression], Expression], degree: int) -> list[ca.SX]:
    """The values of a function of a degree at both ends of a part, between them, and beside its
    summits.
    """
    count = max(_SAMPLES, degree + 4) - 1
    places = [(1.0 - math.cos(math.pi * k / count)) / 2 for k in range(count + 1)]
    found = [ca.SX(value(x)) for x in places]
    best: list[tuple[Any, Any]] = []
    for k in range(1, count):
        before, here, after = found[k - 1 : k + 2]
        bend = 2.0 * here - before - after
        gain = (after - before) ** 2 / (8.0 * ca.if_else(bend > 0.0, bend, 1.0))
        maximum = ca.logic_and(here >= before, here >= after)
        # Beside what is higher there is more than a summit that is lower than both.
        best = _ranked(best, ca.if_else(maximum, here + gain, ca.fmin(before, after)), places[k])
    for _, place in best:
        found += _followed(value, place, 1.0 / (2 * count))
    return found


def _followed(
    value: Callable[[Expression], Expression], place: Expression, reach: float
) -> Iterator[ca.SX]:
    """The values of a function from 0 to 1 ever nearer to its summit, from a place and others at a
    ``reach`` on, by parabolas.
    """
    for _ in range(2):
        place = ca.fmin(ca.fmax(place, reach), 1.0 - reach)
        before, here, after = (ca.SX(value(x)) for x in (place - reach, place, place + reach))
        yield here
        bend = 2.0 * here - before - after
        away = (after - before) / (2.0 * ca.if_else(bend > 0.0, bend, 1.0))
        away = ca.if_else(bend > 0.0, ca.fmin(ca.fmax(away, -2.0), 2.0), 0.0)
        place = place + reach * away
        reach /= _NEARER
    yield ca.SX(value(ca.fmin(ca.fmax(place, 0.0), 1.0)))


def _ranked(
    best: list[tuple[Operand, Operand]], top: Operand, place: Operand
) -> list[tuple[Operand, Operand]]:
    """The highest summits and their places, with one more."""
    found = []
    for kept, at in best:
        higher = top > kept
        found.append((ca.if_else(higher, top, kept), ca.if_else(higher, place, at)))
        top, place = ca.if_else(higher, kept, top), ca.if_else(higher, at, place)
    return [*found, (top, place)][:_MAXIMA]


def _in_order(marks: Sequence[ca.SX]) -> list[ca.SX]:
    """Marks from the base to the tip, compared as they move."""
    found = list(marks)
    for end in range(len(found) - 1, 0, -1):
        for k in range(end):
            found[k], found[k + 1] = (
                ca.fmin(found[k], found[k + 1]),
                ca.fmax(found[k], found[k + 1]),
            )
    return found


def most(values: Sequence[Expression]) -> ca.SX:
    """The largest of values."""
    return ca.SX(functools.reduce(ca.fmax, values))

"""How near a link with a beam is to its limits, at an instant: stresses largest along it, and utilisation.

Between two stations, breaks of its density and of its cross-section, section forces are polynomials. Such a part is looked at at
both ends and at places in between; from the summits that promise most, by the parabola through each and its neighbours, the largest
value is followed by parabolas through places ever nearer. So what is told is the stress at some place, never above the largest.
Where more than two summits of one part are as high within what the first parabolas err, a hundredth, it may be below by as much.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import casadi as ca
import numpy as np

from ..base.quantities import Output
from ..base.tables import table_of
from ..beams.beam import SLIGHT, Beam
from ..beams.properties import Properties
from ..beams.shape import between
from ..declare.density import Density
from ..declare.limits import END
from ..declare.mechanism import Mechanism
from ..declare.parts import Link
from .checks import Column
from .section_function import Place, Section, Side, edge

FORCES = {False: {"axial": 0, "shear": 1, "bending": 5}, True: {"axial": 0, "shear_y": 1, "shear_z": 2, "torsion": 3}}
FORCES[True] |= {"bending_y": 4, "bending_z": 5}
"""The section forces that stresses are linear in, and their places in :meth:`.Properties.rows`."""

_LOOKS, _SUMMITS, _NEARER = 9, 2, 8.0
"""Places at which a part is looked at, how many of its summits are followed, and how much nearer places come."""

_MORE = 6
"""More places where the cross-section changes."""

_PLACES = 17
"""Places at which the thinnest cross-section is sought."""

_SLACK = END["single"]
"""How near a station is at a section: one graph serves both precisions."""

_DEEP = 4
"""How much of an expression is compared to see that two fibres are alike."""


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a link between two ratios, the cell of its cross-section, and its section forces as polynomials from 0 to 1."""

    low: Any
    width: Any
    cell: int
    forces: Mapping[str, Sequence[Any]]

    def force(self, name: str, x: Any) -> Any:
        """A section force at a place from 0 to 1."""
        *others, found = self.forces[name]
        for coefficient in reversed(others):
            found = found * x + coefficient
        return found


class Loaded:
    """A link with a beam, its section forces and stresses as expressions."""

    def __init__(self, space: bool, link: Link, columns: Mapping[Column, Any]) -> None:
        assert link.beam is not None
        assert isinstance(link.mass, Density)
        self.link, self.space = link, space
        self.beam: Beam = link.beam
        self.course = link.beam.course
        self.section = Section(link.name, table_of(space), columns, link.length, link.mass)
        self.marks = [place.ratio for place in self.section.marks if place.side == "tip"]
        self.marks += [ca.SX(b) for b in link.mass.breaks[1:-1]]
        self.degree = max(max(map(len, link.mass.cells)) + 2, *(many + 1 for many in self.section.spreads.values()), 0)

    @property
    def told(self) -> bool:
        """Whether stresses have a formula: in space torsion must have one."""
        return not self.space or all(shape.properties().torsion is not None for shape in self.course.shapes())

    @cached_property
    def parts(self) -> list[Part]:
        """The parts between stations, ends of loads along the link, and breaks of its density and its cross-section."""
        found = []
        for cell, (low, high) in enumerate(itertools.pairwise(self.course.breaks)):
            inner = _in_order([ca.fmin(ca.fmax(ca.SX(mark), low), high) for mark in self.marks])
            for a, b in itertools.pairwise([ca.SX(low), *inner, ca.SX(high)]):
                if not (a - b).is_zero():
                    found.append(Part(a, b - a, cell, self._polynomials(a, b)))
        return found

    def force_at(self, name: str, u: Any, side: Side) -> Any:
        """A section force at a ratio; at a station on a ``side`` of it."""
        return self.section.at(name, Place(u, side=side), _SLACK)

    def _polynomials(self, a: Any, b: Any) -> dict[str, list[Any]]:
        nodes = (1.0 - np.cos(math.pi * np.arange(self.degree + 1) / self.degree)) / 2
        inverse = np.linalg.inv(np.vander(nodes, increasing=True))
        found = {}
        for name in FORCES[self.space]:
            values = [self.section.force(name, a + (b - a) * x, edge(a, _SLACK)) for x in nodes.tolist()]
            found[name] = [sum(w * value for w, value in zip(row.tolist(), values, strict=True)) for row in inverse]
        return found

    def properties(self, cell: int, u: Any) -> Properties:
        """The cross-section at a ratio within a cell."""
        (first, last), low, high = self.course.cells[cell], self.course.breaks[cell], self.course.breaks[cell + 1]
        return between(first, last, (u - low) / (high - low)).properties(space=self.space)

    def at(self, part: Part, x: Any) -> Properties:
        """The cross-section at a place of a part."""
        first, last = self.course.cells[part.cell]
        return self._constant[part.cell] if first is last else self.properties(part.cell, part.low + part.width * x)

    def square(self, part: Part, x: Any) -> Any:
        """The largest square of von Mises' stresses at a place of a part."""
        p = self.at(part, x)
        forces = {place: part.force(name, x) for name, place in FORCES[self.space].items()}
        found = []
        for fibre in self._needed[part.cell]:
            normal, *shears = (
                sum(number * forces[k] for k, number in enumerate(row) if k in forces) for row in p.rows(p.fibres[fibre])
            )
            found.append(normal * normal + 3.0 * sum(shear * shear for shear in shears))
        return most(found)

    @cached_property
    def _constant(self) -> list[Properties]:
        return [first.properties(space=self.space) for first, _ in self.course.cells]

    @cached_property
    def _needed(self) -> list[list[int]]:
        """Of each cell the fibres, those left out that have the normal stress of another one, and no shear."""
        return [self._differing(cell, lower=True) for cell in range(len(self.course.cells))]

    @cached_property
    def alone(self) -> list[list[int]]:
        """Of each cell the fibres, those left out that are like another one."""
        return [self._differing(cell, lower=False) for cell in range(len(self.course.cells))]

    def _differing(self, cell: int, *, lower: bool) -> list[int]:
        first, last = self.course.cells[cell]
        shapes = [first] if first is last else [first, last]
        every = [[_plain(p.rows(f), self.space) for f in p.fibres] for p in (s.properties(space=self.space) for s in shapes)]
        numbers, kept = range(len(every[0])), list[int]()
        for k in numbers:
            alike = (all(_same(rows[k], rows[other]) for rows in every) for other in kept)
            below = (all(_below(rows[k], rows[other]) for rows in every) for other in numbers if lower and other != k)
            if not any(alike) and not any(below):
                kept.append(k)
        return kept


def stresses(mechanism: Mechanism, name: str, columns: Mapping[Column, Any]) -> dict[Column, Any]:
    """Von Mises' stress that is largest along a link [Pa]; nothing where there is no formula."""
    link = Loaded(mechanism.space, mechanism.links[name], columns)
    if not link.told:
        return {}
    return {Output("stress", name, "von_mises"): ca.sqrt(_largest(link, link.square))}


def utilisation(
    mechanism: Mechanism, name: str, columns: Mapping[Column, Any], effective: tuple[float, float]
) -> dict[Column, Any]:
    """How far a link is used against yielding and against buckling: one over the factors of safety at an instant.

    ``effective`` are the effective lengths as a column over its own. For buckling see :mod:`.buckling`.
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


def _buckling(link: Loaded, effective: tuple[float, float]) -> Any:
    """The largest u with N/(N_cr u) + M_z/(M_y,z (u - N/N_e,z)) + M_y/(M_y,y (u - N/N_e,y)) = 1."""
    material = link.beam.material
    elasticity, strength = material.needs("buckling", "elasticity", "yield_strength")
    area, second, modulus = _thinnest(link)
    lengths = [k * link.link.length for k in effective]
    euler = [math.pi**2 * elasticity * i / length**2 for i, length in zip(second, lengths, strict=True)]
    half = strength * area / 2
    critical = [ca.if_else(e <= half, e, strength * area * (1.0 - strength * area / (4.0 * e))) for e in euler]

    n = _largest(link, lambda part, x: -part.force("axial", x))
    names = ("bending_z", "bending_y") if link.space else ("bending",)
    bent = [ca.sqrt(_largest(link, partial(_squared, name))) for name in names]
    compressed = ca.fmax(n, 0.0)
    share = compressed / ca.fmin(*critical)
    shares = [compressed / e for e in euler]
    moments = [b / (w * strength) for b, w in zip(bent, modulus, strict=False)]
    found = most([_alone(share, c, b) for c, b in zip(shares, moments, strict=False)] + shares)
    if link.space:
        # From the left, where it is convex and falls, Newton's method rises to the solution.
        for _ in range(_ROUNDS):
            gaps = [ca.fmax(found - c, _TINY * found) for c in shares]
            over = share / found + sum(b / gap for b, gap in zip(moments, gaps, strict=True)) - 1.0
            slope = share / found**2 + sum(b / gap**2 for b, gap in zip(moments, gaps, strict=True))
            found = found + ca.fmax(over / slope, 0.0)
    return ca.if_else(share > SLIGHT, found, 0.0)


_ROUNDS, _TINY = 8, 1e-12


def _alone(a: Any, c: Any, b: Any) -> Any:
    """The larger u of a/u + b/(u - c) = 1."""
    total = a + b + c
    return (total + ca.sqrt(ca.fmax(total * total - 4.0 * a * c, 0.0))) / 2


def _thinnest(link: Loaded) -> tuple[Any, list[Any], list[Any]]:
    """The least area, second moments and moduli about z and y."""
    areas, seconds, moduli = [], [list[Any](), list[Any]()], [list[Any](), list[Any]()]
    for cell, (first, last) in enumerate(link.course.cells):
        low, high = link.course.breaks[cell : cell + 2]
        places = [low] if first is last else [low + (high - low) * k / (_PLACES - 1) for k in range(_PLACES)]
        for u in places:
            p = link.properties(cell, u)
            half, turned = (p.iz + p.iy) / 2, ca.sqrt(((p.iz - p.iy) / 2) ** 2 + p.iyz**2)
            straight = ca.SX(p.iyz).is_zero()
            areas.append(ca.SX(p.area))
            for k, (second, modulus) in enumerate(
                zip((p.iz, p.iy) if straight else [half - turned] * 2, (p.wz, p.wy), strict=True)
            ):
                seconds[k].append(ca.SX(second))
                moduli[k].append(ca.SX(modulus))
    return _least(areas), [_least(each) for each in seconds], [_least(each) for each in moduli]


def _squared(name: str, part: Part, x: Any) -> Any:
    return part.force(name, x) ** 2


def _largest(link: Loaded, value: Callable[[Part, Any], Any]) -> Any:
    """The largest value along a link, of those at all places that are looked at."""
    found: list[Any] = []
    for part in link.parts:
        first, last = link.course.cells[part.cell]
        found += looked(partial(value, part), link.degree + (0 if first is last else _MORE))
    return most(found)


def looked(value: Callable[[Any], Any], degree: int) -> list[Any]:
    """The values of a function of a degree at both ends of a part, between them, and beside its summits."""
    count = max(_LOOKS, degree + 4)
    places = [(1.0 - math.cos(math.pi * k / (count - 1))) / 2 for k in range(count)]
    found = [ca.SX(value(x)) for x in places]
    best: list[tuple[Any, Any]] = []
    for k in range(1, count - 1):
        before, here, after = found[k - 1 : k + 2]
        bend = 2.0 * here - before - after
        gain = (after - before) ** 2 / (8.0 * ca.if_else(bend > 0.0, bend, 1.0))
        summit = ca.logic_and(here >= before, here >= after)
        # Beside what is higher there is more than a summit that is lower than both.
        best = _ranked(best, ca.if_else(summit, here + gain, ca.fmin(before, after)), places[k])
    for _, place in best:
        reach = 1.0 / (2 * (count - 1))
        for _ in range(2):
            place = ca.fmin(ca.fmax(place, reach), 1.0 - reach)
            before, here, after = (ca.SX(value(x)) for x in (place - reach, place, place + reach))
            found.append(here)
            bend = 2.0 * here - before - after
            away = (after - before) / (2.0 * ca.if_else(bend > 0.0, bend, 1.0))
            place = place + reach * ca.if_else(bend > 0.0, ca.fmin(ca.fmax(away, -2.0), 2.0), 0.0)
            reach /= _NEARER
        found.append(ca.SX(value(ca.fmin(ca.fmax(place, 0.0), 1.0))))
    return found


def _ranked(best: list[tuple[Any, Any]], top: Any, place: Any) -> list[tuple[Any, Any]]:
    """The highest summits and their places, with one more."""
    found = []
    for kept, at in best:
        higher = top > kept
        found.append((ca.if_else(higher, top, kept), ca.if_else(higher, place, at)))
        top, place = ca.if_else(higher, kept, top), ca.if_else(higher, at, place)
    return [*found, (top, place)][:_SUMMITS]


def _in_order(marks: Sequence[Any]) -> list[Any]:
    """Marks from the base to the tip: by numbers where they are numbers, else compared as they move."""
    found = list(marks)
    if all(mark.is_constant() for mark in found):
        return sorted(found, key=float)
    for end in range(len(found) - 1, 0, -1):
        for k in range(end):
            found[k], found[k + 1] = ca.fmin(found[k], found[k + 1]), ca.fmax(found[k], found[k + 1])
    return found


def most(values: Sequence[Any]) -> Any:
    """The largest of values."""
    found = values[0]
    for value in values[1:]:
        found = ca.fmax(found, value)
    return ca.SX(found)


def _least(values: Sequence[Any]) -> Any:
    found = values[0]
    for value in values[1:]:
        found = ca.fmin(found, value)
    return found


def _plain(row: tuple[tuple[Any, ...], ...], space: bool) -> tuple[list[Any], list[Any]]:
    """What a fibre takes for its normal stress, and for its shear stress: in the plane alone the square of this counts."""
    if space:
        return [ca.SX(x) for x in row[0]], [ca.SX(x) for each in row[1:] for x in each]
    return [ca.SX(row[0][k]) for k in (0, 5)], [ca.SX(row[1][1] ** 2 + row[2][1] ** 2)]


def _same(a: tuple[list[Any], list[Any]], b: tuple[list[Any], list[Any]]) -> bool:
    return all(ca.is_equal(x, y, _DEEP) for x, y in zip([*a[0], *a[1]], [*b[0], *b[1]], strict=True))


def _below(a: tuple[list[Any], list[Any]], b: tuple[list[Any], list[Any]]) -> bool:
    """Whether a fibre has the normal stress of another one, no shear stress, and the other some."""
    same = all(ca.is_equal(x, y, _DEEP) for x, y in zip(a[0], b[0], strict=True))
    return same and all(x.is_zero() for x in a[1]) and not all(x.is_zero() for x in b[1])

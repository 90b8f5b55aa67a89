"""A design looked at over its whole motion: where its quantities have peaks, and how near its loops are to a dead centre."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.tables import table_of
from ...equations.program import Program
from ...instants.backends import Evaluated, run
from ...instants.rung import Rung
from ...instants.signals import section_forces
from ...instants.sizes import size_of


@dataclass(frozen=True)
class Point:
    """A moment and a place of a quantity: a ratio ``xi``, and which of the places of :meth:`.PointValues.of` is meant.

    ``share`` is the moment's share of the time from the first instant to the last: these may go with the parameters. ``value`` is
    the quantity there, ``guess`` the iterated coordinates. ``turn`` and ``reach`` say how the point follows its peak: see
    :class:`.Followed`. ``drift`` is by how much the share changes with that of each chosen parameter, counted from zero. Of a
    swing ``xi`` is the share of its other instant, and ``second`` the iterated coordinates there.
    """

    share: float
    xi: float
    place: int
    value: float
    guess: tuple[float, ...]
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    reach: tuple[float, float] = (0.0, 0.0)
    drift: tuple[float, ...] = ()
    second: tuple[float, ...] = ()

    def where(self, size: int) -> Array:
        """Its place as the ``size`` numbers that :meth:`.PointValues.of` takes."""
        found = np.zeros(size)
        found[min(self.place, size - 1)] = 1.0
        found[size - len(self.second) :] = self.second
        return found


@dataclass(frozen=True, eq=False)
class Look:
    """A design over instants: ``t`` (t,), the graph's columns (columns, t) and iterated coordinates (z, t) there."""

    graph: Program
    t: Array
    p: Array
    found: Evaluated

    @classmethod
    def at(cls, graph: Program, t: Array, p: Array, rung: Rung) -> Look:
        """A design looked at; what has no result is NaN there."""
        found, _ = run(graph, t, p, rung)
        return cls(graph, t, p, found)

    @property
    def shares(self) -> Array:
        """What share of the time from the first instant to the last each instant is at."""
        return np.linspace(0.0, 1.0, self.t.size)

    @property
    def step(self) -> float:
        """The share of a step between instants."""
        return 1.0 / max(self.t.size - 1, 1)

    def share(self, t: float) -> float:
        """That of a time."""
        span = float(self.t[-1] - self.t[0])
        return min(max((t - float(self.t[0])) / span, 0.0), 1.0) if span else 0.0

    def time(self, point: Point) -> float:
        """The time of a point [s]."""
        return float(self.t[0] + point.share * (self.t[-1] - self.t[0]))

    def points(self, output: Output, sign: float) -> list[Point]:
        """The local peaks over time of a quantity times ``sign``, or of its size where that is 0, the largest first."""
        found: list[Point] = []
        for number, (places, values) in enumerate(zip(*self._curves(output), strict=True)):
            sized = np.abs(values) if sign == 0.0 else sign * values
            sized = np.where(np.isfinite(sized), sized, -np.inf)
            padded = np.concatenate([[-np.inf], sized, [-np.inf]])
            tops = (sized >= padded[:-2]) & (sized > padded[2:]) | (sized > padded[:-2]) & (sized >= padded[2:])
            if sized.size == 1:
                tops = np.isfinite(sized)
            for k in np.flatnonzero(tops & np.isfinite(sized)).tolist():
                found.append(self._point(k, float(places[k]), self._place(output, number), float(values[k])))
        return sorted(found, key=lambda point: -(abs(point.value) if sign == 0.0 else sign * point.value))

    def closures(self) -> Array:
        """The squares of the sines of the transmission angles (loops, t), NaN or below zero where loops do not close."""
        names = self.graph.checks("closure")
        rows = [self.found.out[k] for k in names.values()]
        rows = [row * np.abs(row) if self.graph.iterates(name) else row for name, row in zip(names, rows, strict=True)]
        return np.array(rows).reshape(len(rows), self.t.size)

    @property
    def instants(self) -> list[Point]:
        """All of them, as points."""
        return [self.instant(k) for k in range(self.t.size)]

    def instant(self, k: int) -> Point:
        """An instant by its number, as a point."""
        return self._point(k, 0.0, 0, 0.0)

    def _point(self, k: int, xi: float, place: int, value: float) -> Point:
        return Point(self.share(float(self.t[k])), xi, place, value, tuple(self.found.iterated[:, k].tolist()))

    def _curves(self, output: Output) -> tuple[Sequence[Array], Sequence[Array]]:
        """Ratios and values of a quantity's curves, (t,) each."""
        out, data = np.asarray(self.found.out, float), self.graph.data
        if output.group != "section":
            rows = out[[self.graph.outputs[part] for part in output.components(table_of(data.space)) if part in self.graph.outputs]]
            return [np.zeros(self.t.size)], [rows[0] if len(rows) == 1 else size_of(rows)]
        description = data.at(self.p)
        with np.errstate(all="ignore"):
            force = section_forces(description, output.part, self.graph.outputs)[output.member]
            places, curves = force.curves(out)
        return list(places), list(curves)

    def _place(self, output: Output, curve: int) -> int:
        """Which place of :meth:`.PointValues.of` a curve of :meth:`.SectionLaw.curves` is at: after the ends come the stations."""
        stations = sum(1 for o in self.graph.outputs if o.group == "station" and o.part == output.part and o.member == "station")
        return curve - 1 if output.group == "section" and 2 <= curve < 2 + 2 * stations else 0

"""A design looked at over its whole motion: where its quantities have peaks, and how near its loops
are to a dead centre; and the values of terms there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.status import Status
from ...engine.codegen.peak_search import Listed
from ...engine.mobility import load_points_of
from ..designs.engine import DesignEngine
from ..designs.outcome import History
from .terms import Term

KEEP = 0.7
"""Fraction of the largest peak from which local peaks are examined."""

_ALL = 0.51
"""Fraction for values that are largest or smallest: all of them."""


@dataclass(frozen=True)
class Point:
    """A moment and a place of a quantity: a ratio ``xi``, and which of the places of
    :meth:`.PointValues.of` is meant.

    ``share`` is the moment's share of the time from the first instant to the last: these may go
    with the parameters. ``value`` is the quantity there, ``guess`` the iterated coordinates.
    ``turn`` and ``reach`` say how the point follows its peak: see :class:`.Followed`. ``drift`` is
    by how much the share changes with that of each chosen parameter, counted from zero. Of a swing
    ``xi`` is the share of its other instant, and ``second`` the iterated coordinates there.
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
        """Place as the ``size`` numbers that :meth:`.PointValues.of` takes."""
        found = np.zeros(size)
        found[min(self.place, size - 1)] = 1.0
        found[size - len(self.second) :] = self.second
        return found


@dataclass(frozen=True, eq=False)
class SampledDesign:
    """A design by an ``engine``: its parameters (parameters,), and its history over instants in
    equal steps of time.
    """

    engine: DesignEngine
    p: Array
    history: History

    @classmethod
    def at(cls, engine: DesignEngine, p: Array) -> SampledDesign:
        """A design looked at; what has no result is NaN there."""
        return cls(engine, p, engine.history(p, Listed(KEEP)))

    def as_asked(self) -> SampledDesign:
        """Point over the instants as defined, if these are not in equal steps of time."""
        asked = self.engine.times.of(self.p[None])[1][0]
        return (
            self
            if np.array_equal(asked, self.t)
            else replace(self, history=self.engine.history(self.p))
        )

    @property
    def t(self) -> Array:
        """The instants (t,)."""
        return self.history.t

    @property
    def step(self) -> float:
        """The share of a step between instants."""
        return 1.0 / max(self.t.size - 1, 1)

    def share(self, t: float) -> float:
        """Fraction of the time from the first instant to the last."""
        span = float(self.t[-1] - self.t[0])
        return min(max((t - float(self.t[0])) / span, 0.0), 1.0) if span else 0.0

    def time(self, point: Point) -> float:
        """The time of a point [s]."""
        return float(self.t[0] + point.share * (self.t[-1] - self.t[0]))

    def points(self, output: Output, sign: int) -> list[Point]:
        """The local peaks over time of a quantity times ``sign``, or of its size where that is 0,
        the largest first.
        """
        history = self.engine.history(self.p, Listed(_ALL, sign)) if sign else self.history
        found: list[Point] = []
        for curve, t, xi, value in history.tops[self.engine.quantities.index(str(output))].tolist():
            if curve == curve:
                near = self.instant(int(np.argmin(np.abs(self.t - t))))
                place = self._place(output, int(curve))
                found.append(
                    replace(
                        near,
                        share=self.share(t),
                        xi=0.0 if xi != xi else xi,
                        place=place,
                        value=value,
                    )
                )
        return sorted(found, key=lambda point: -(sign * point.value if sign else abs(point.value)))

    def closures(self) -> Array:
        """The squares of the sines of the transmission angles (loops, t), NaN or below zero where
        loops do not close.
        """
        program = self.engine.program
        names = program.checks("closure")
        rows = [self.history.columns[k] for k in names.values()]
        rows = [
            row * np.abs(row) if program.iterates(name) else row
            for name, row in zip(names, rows, strict=True)
        ]
        return np.array(rows).reshape(len(rows), self.t.size)

    def instant(self, k: int) -> Point:
        """An instant by its number, as a point."""
        return Point(
            self.share(float(self.t[k])), 0.0, 0, 0.0, tuple(self.history.iterated[:, k].tolist())
        )

    def _place(self, output: Output, curve: int) -> int:
        """Place of :meth:`.PointValues.of` for a curve of :meth:`.SectionLaw.curves`: after the
        ends come the load points.
        """
        load_points = len(load_points_of(self.engine.program.outputs, output.part))
        return curve - 1 if output.group == "section" and 2 <= curve < 2 + 2 * load_points else 0


Signed = tuple[Point, float]
"""A point, and the sign by which its value counts."""


@dataclass(frozen=True, eq=False)
class EvaluatedDesign:
    """A design after its evaluation: the value of every term, NaN without a result, and the
    ``status`` by which there may be none.

    ``closure`` is the least square of the sine of a transmission angle, NaN without loops;
    ``closing`` by how much it is below its limit, relative to the limit. ``sampled`` and the local
    ``points`` of the terms, the largest first, are None and empty unless they were asked for.
    """

    p: Array
    values: Mapping[Term, float]
    status: Status
    sampled: SampledDesign | None = None
    closure: float = math.nan
    closing: float = -math.inf
    points: Mapping[Term, tuple[Signed, ...]] = field(default_factory=dict)

    @property
    def has_result(self) -> bool:
        """True if there is a result."""
        return all(math.isfinite(value) for value in self.values.values())

"""Symbols by which loads and constraints see the motion: of a joint, of a point, or of a link's
direction.
"""

from __future__ import annotations

import operator
from dataclasses import dataclass, field

import casadi as ca

from ..base.scalars import column
from .declared_parts import Link, Point
from .joints import Axis, Joint


@dataclass(frozen=True, eq=False)
class Measure:
    """Measured quantity, the symbols of its value, and those of its rate and acceleration.

    A joint has its coordinate along an ``axis``, a point its x and y, and in space its z, a link of
    a plane the angle of its axis.
    """

    of: Joint | Point | Link
    places: tuple[ca.SX, ...]
    rates: tuple[ca.SX, ...]
    accelerations: tuple[ca.SX, ...]
    axis: Axis | None = None


@dataclass(frozen=True, eq=False)
class Measures:
    """The measures that a mechanism's loads and constraints have asked for, each once."""

    asked: list[Measure] = field(default_factory=list)
    components: str = "xy"

    def joint(self, joint: Joint, axis: Axis) -> Measure:
        """The measure of a joint's coordinate along an axis."""
        return self._find(joint, (axis.coordinate,), axis)

    def link(self, link: Link) -> Measure:
        """The measure of a link's direction."""
        return self._find(link, (f"{link.name}_angle",))

    def point(self, point: Point) -> Measure:
        """The measure of a point's place."""
        for measure in self.asked:
            known = measure.of
            if (
                isinstance(known, Point)
                and known.body is point.body
                and all(map(operator.is_, known.place, point.place))
            ):
                return measure
        return self._find(
            point, tuple(f"{point.body.name}_{component}" for component in self.components)
        )

    @property
    def places(self) -> ca.SX:
        """All symbols of coordinates, places and directions, one column."""
        return column(symbol for measure in self.asked for symbol in measure.places)

    @property
    def rates(self) -> ca.SX:
        """All symbols of rates and velocities, one column."""
        return column(symbol for measure in self.asked for symbol in measure.rates)

    @property
    def accelerations(self) -> list[ca.SX]:
        """All symbols of accelerations, one by one."""
        return [symbol for measure in self.asked for symbol in measure.accelerations]

    @property
    def symbols(self) -> list[ca.SX]:
        """All symbols of places and rates, one by one."""
        return [symbol for measure in self.asked for symbol in (*measure.places, *measure.rates)]

    def _find(
        self, of: Joint | Point | Link, names: tuple[str, ...], axis: Axis | None = None
    ) -> Measure:
        for measure in self.asked:
            if measure.of is of and (measure.axis and measure.axis.coordinate) == (
                axis and axis.coordinate
            ):
                return measure
        places, rates, changes = (
            tuple(ca.SX.sym(f"{name}{end}") for name in names)
            for end in ("", "_rate", "_acceleration")
        )
        self.asked.append(Measure(of, places, rates, changes, axis))
        return self.asked[-1]

"""Symbols by which loads and constraints see the motion: of a joint, of a point, or of a link's
direction.
"""

from __future__ import annotations

from collections.abc import Hashable
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

    asked: dict[Hashable, Measure] = field(default_factory=dict)
    components: str = "xy"

    def joint(self, joint: Joint, axis: Axis) -> Measure:
        """The measure of a joint's coordinate along an axis."""
        return self._found((axis.coordinate,), joint, (axis.coordinate,), axis)

    def link(self, link: Link) -> Measure:
        """The measure of a link's direction."""
        return self._found((link.name, "angle"), link, (f"{link.name}_angle",))

    def point(self, point: Point) -> Measure:
        """The measure of a point's place."""
        names = tuple(f"{point.body.name}_{component}" for component in self.components)
        place = (x if isinstance(x, float) else x.element_hash() for x in point.place)
        return self._found((point.body.name, *place), point, names)

    @property
    def places(self) -> ca.SX:
        """All symbols of coordinates, places and directions, one column."""
        return column(symbol for measure in self.asked.values() for symbol in measure.places)

    @property
    def rates(self) -> ca.SX:
        """All symbols of rates and velocities, one column."""
        return column(symbol for measure in self.asked.values() for symbol in measure.rates)

    @property
    def accelerations(self) -> list[ca.SX]:
        """All symbols of accelerations, one by one."""
        return [symbol for measure in self.asked.values() for symbol in measure.accelerations]

    def _found(
        self,
        key: Hashable,
        of: Joint | Point | Link,
        names: tuple[str, ...],
        axis: Axis | None = None,
    ) -> Measure:
        if key not in self.asked:
            places, rates, changes = (
                tuple(ca.SX.sym(f"{name}{end}") for name in names)
                for end in ("", "_rate", "_acceleration")
            )
            self.asked[key] = Measure(of, places, rates, changes, axis)
        return self.asked[key]

"""Symbols by which loads and constraints see the motion: of a joint, of a point, or of a link's direction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from .parts import Joint, Link, Point


@dataclass(frozen=True, eq=False)
class Measure:
    """What is measured, the symbols of where it is, and those of their rates and accelerations.

    A joint has its coordinate, a point its x and y, a link the angle of its axis.
    """

    of: Joint | Point | Link
    places: tuple[Any, ...]
    rates: tuple[Any, ...]
    accelerations: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Measures:
    """The measures that a mechanism's loads and constraints have asked for, each once."""

    asked: list[Measure] = field(default_factory=list)

    def joint(self, joint: Joint) -> Measure:
        """The measure of a joint's coordinate."""
        return self._find(joint, (joint.name,))

    def link(self, link: Link) -> Measure:
        """The measure of a link's direction."""
        return self._find(link, (f"{link.name}_angle",))

    def point(self, point: Point) -> Measure:
        """The measure of a point's place."""
        for measure in self.asked:
            known = measure.of
            if isinstance(known, Point) and known.body is point.body and known.x is point.x and known.y is point.y:
                return measure
        return self._find(point, (f"{point.body.name}_x", f"{point.body.name}_y"))

    @property
    def places(self) -> Any:
        """All symbols of coordinates, places and directions, one column."""
        return ca.vertcat(ca.SX(0, 1), *(symbol for measure in self.asked for symbol in measure.places))

    @property
    def rates(self) -> Any:
        """All symbols of rates and velocities, one column."""
        return ca.vertcat(ca.SX(0, 1), *(symbol for measure in self.asked for symbol in measure.rates))

    @property
    def accelerations(self) -> list[Any]:
        """All symbols of accelerations, one by one."""
        return [symbol for measure in self.asked for symbol in measure.accelerations]

    @property
    def symbols(self) -> list[Any]:
        """All symbols of places and rates, one by one."""
        return [symbol for measure in self.asked for symbol in (*measure.places, *measure.rates)]

    def _find(self, of: Joint | Point | Link, names: tuple[str, ...]) -> Measure:
        for measure in self.asked:
            if measure.of is of:
                return measure
        symbols = (tuple(ca.SX.sym(f"{name}{end}") for name in names) for end in ("", "_rate", "_acceleration"))
        self.asked.append(Measure(of, *symbols))
        return self.asked[-1]

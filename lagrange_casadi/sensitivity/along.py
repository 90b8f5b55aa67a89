"""Section forces as expressions: of the columns of a graph, of the ratio xi/l, and of the parameters.

They are those of :class:`.SectionLaw`, which has them as numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.quantities import Output
from ..base.tables import Terms, table_of
from ..equations.checks import Column
from ..equations.mobility import stations_of
from ..equations.model_data import ModelData
from ..equations.own import sight
from ..equations.spreads import felt_along, spreads_of


@dataclass(frozen=True, eq=False)
class Place:
    """A place along a link, as an expression: ``station`` where something acts there, and whether a section there sees that."""

    ratio: Any
    station: str = ""
    seen: bool = False


class Along:
    """The section forces of a link, of columns and parameters ``p`` that are expressions."""

    def __init__(self, data: ModelData, link: str, columns: Mapping[Column, Any], p: Any) -> None:
        self.link, self.columns, self.table = link, columns, table_of(data.space)
        self.length, self.density = data.matter(link, p)
        outputs = [column for column in columns if isinstance(column, Output)]
        self.stations: Sequence[str] = stations_of(outputs, link)
        self.spreads = spreads_of(outputs, link)

    @property
    def marks(self) -> list[Place]:
        """Both sides of every station, and where loads along the link begin and end: places that may move as parameters change."""
        found = [Place(self._of("station", "station", name), name, seen) for name in self.stations for seen in (False, True)]
        for name in self.spreads:
            width, end = (self.columns[Output("spread", self.link, member, name)] for member in ("width", "end"))
            found += [Place(end), Place(end - width)]
        return found

    def force(self, name: str, place: Place) -> Any:
        """A section force at a place: one of the table's own, no resultant."""
        terms, u = self.table.sections[name], place.ratio
        length = self.length
        t0, t1, t2 = self.density.tails(ca.SX(u), length)
        if terms.arm:
            rows = [1.0, *(terms.arm * row for row in (length * (1.0 - u), length * t1, length * length * (u * t1 + t2)))]
        else:
            rows = [1.0, t0, length * (u * t0 + t1)]
        law = [self.columns[Output("law", self.link, member)] for member in terms.coefficients]
        value = sum(column * row for column, row in zip(law, rows, strict=False))
        value += sum(self._beyond(terms, station, place) for station in self.stations)
        return ca.SX(sum(felt_along(self.columns, self.link, length, terms, u), value))

    def _beyond(self, terms: Terms, station: str, place: Place) -> Any:
        """What a section feels of what acts at a station, where that is towards the tip."""
        u, at = place.ratio, self._of("station", "station", station)
        value = self._of("station", terms.acting, station)
        if terms.arm:
            across = self._of("station", self.table.sections[terms.shear].acting, station)
            value = value + terms.arm * self.length * across * (at - u)
        near = sight(u, "double")
        return ca.if_else(near <= at if station == place.station and place.seen else near < at, value, 0.0)

    def _of(self, group: str, member: str, station: str) -> Any:
        return self.columns[Output(group, self.link, member, station)]

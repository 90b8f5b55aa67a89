"""What acts on a link at a station, in the plane and in space."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TypeVar

from ..base.arrays import Array


@dataclass(frozen=True, eq=False)
class StationLoad:
    """What acts on a link at a station: force along ``n`` and across ``f`` the axis [N], moment ``m`` [N m], each (t,).

    ``station`` is the ratio xi/l, (t,): it moves where something slides along the link.
    """

    name: str
    station: Array
    n: Array
    f: Array
    m: Array

    def during(self, instants: slice) -> StationLoad:
        """The same at some of the instants."""
        return _cut(self, instants)


@dataclass(frozen=True, eq=False)
class SpatialStationLoad:
    """The same in space: force ``n`` along the link's axis, ``fy``, ``fz`` across [N], moments ``mx``, ``my``, ``mz`` [N m]."""

    name: str
    station: Array
    n: Array
    fy: Array
    fz: Array
    mx: Array
    my: Array
    mz: Array

    def during(self, instants: slice) -> SpatialStationLoad:
        """The same at some of the instants."""
        return _cut(self, instants)


AnyStationLoad = StationLoad | SpatialStationLoad
_Load = TypeVar("_Load", StationLoad, SpatialStationLoad)


def station_load(name: str, members: Mapping[str, Array]) -> AnyStationLoad:
    """What acts at a station, by the names of its members: those of the plane or those of space."""
    return StationLoad(name, **members) if "f" in members else SpatialStationLoad(name, **members)


def _cut(load: _Load, instants: slice) -> _Load:
    return replace(load, **{entry.name: getattr(load, entry.name)[instants] for entry in fields(load) if entry.name != "name"})

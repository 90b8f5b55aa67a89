"""The section law of a link as numbers: its forces at any ratio xi/l, and where along the link they peak.

With u = xi/l the forces are those of the material beyond the section, whose moments :mod:`.density` gives, and of what acts on the
link beyond it: at the tip (n0, f0, m0), and at stations in between, each seen by the sections on its base side.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ..declare.density import Array, NumericDensity
from ..quantities import FORCES, PLACE_FIRST, Output
from ..system.room import cores, require
from . import grids

MEMBERS = {
    "axial": (("n0", "n1", "n2"), ("n",)),
    "shear": (("f0", "f1", "f2"), ("f",)),
    "bending": (("m0", "f0", "f1", "f2"), ("m", "f")),
}
"""The coefficients of a force, and what of the loads at stations goes into it."""

Side = Literal["base", "tip"]
_SIDES: tuple[Side, ...] = ("tip", "base")

_HALVINGS = 60
_BLOCK = 1 << 15


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
        return StationLoad(self.name, *(values[instants] for values in (self.station, self.n, self.f, self.m)))


@dataclass(frozen=True, eq=False)
class Basis:
    """Ratios ``u`` along a link, and there the functions that its forces are combined of: a row each, of shape (terms, u...)."""

    u: Array
    force: Array
    bending: Array


@dataclass(frozen=True, eq=False)
class SectionLaw:
    """The law of one link: ``coefficients`` by name (n0 ... m0), each (t,); length [m], density, and loads at stations."""

    length: float
    density: NumericDensity
    coefficients: Mapping[str, Array]
    loads: tuple[StationLoad, ...] = ()

    def basis(self, xi: Array) -> Basis:
        """The functions along the link at ratios ``xi`` of any shape; they serve every force, and the law at any instants."""
        xi = np.asarray(xi, dtype=float)
        t0, t1, t2 = self.density.tails(xi)
        l, one = self.length, np.ones_like(t0)
        bending = [one, l * (1.0 - xi), l * t1, l * l * (xi * t1 + t2)]
        return Basis(xi, np.stack([one, t0, l * (xi * t0 + t1)]), np.stack(bending))

    def on_grid(self, force: str, xi: Array | Basis, out: Array | None = None, threads: int | None = None) -> Array:
        """A force at every instant and every ratio ``xi``, of shape (t, xi), in ``out`` where given; at a station, on its tip side.

        Where several forces are wanted, a :meth:`basis` of the ratios serves all. By default one thread a core shares a grid that
        is worth it; the bits do not depend on it. Raises :class:`SizeError` where there is less memory than that.
        """
        size = (self.coefficients["n0"].size, xi.u.size if isinstance(xi, Basis) else xi.size)
        if out is None:
            require(f"a grid of {force}", size)
        basis = xi if isinstance(xi, Basis) else self.basis(xi)
        columns, rows = self._terms(force, basis)
        out = grids.empty(f"a grid of {force}", size) if out is None else out
        grids.fill(columns, rows, [self._acting(force, load) for load in self.loads], basis.u, out, threads or cores())
        return out

    def largest(self, force: str, basis: Basis) -> Array:
        """Of n laws, whose members are (n, t), length and density (n, 1): a force, largest in size over the instants, (n, xi).

        It has its sign, the positive one where both are as large, and is NaN of a law that is not finite throughout.
        """
        columns, rows = self._terms(force, basis)
        return grids.largest(columns, rows, [self._acting(force, load) for load in self.loads], basis.u)

    def during(self, instants: slice) -> SectionLaw:
        """The law at some of the instants."""
        coefficients = {name: values[instants] for name, values in self.coefficients.items()}
        return replace(self, coefficients=coefficients, loads=tuple(load.during(instants) for load in self.loads))

    def at(self, force: str, xi: Any, side: Side = "tip") -> Array:
        """A force at ratios of shape (t, ...), one row an instant; ``side`` tells which value is meant at a station."""
        u = np.asarray(xi, dtype=float)
        values = self._smooth(force, u)
        for load in self.loads:
            station = _column(load.station, u)
            values = values + self._beyond(force, load, u, _seen(u, station, side))
        return values

    def of(self, link: str, outputs: Mapping[Output, Array]) -> SectionLaw:
        """The law of the same link with other numbers in it, (..., t)."""
        coefficients = {name: outputs[Output("law", link, name)] for name in self.coefficients}
        loads = tuple(
            StationLoad(load.name, *(outputs[Output("station", link, member, load.name)] for member in PLACE_FIRST))
            for load in self.loads
        )
        return replace(self, coefficients=coefficients, loads=loads)

    def changed(self, changes: SectionLaw, xi: Array) -> dict[str, tuple[Array, Array]]:
        """By how much every force changes with its coefficients, loads and stations, and the sizes of all its terms added up.

        ``changes`` has the changes in the places of the numbers, each (..., t). They are looked at at ratios ``xi`` (n,) and at
        every station, from both sides: (..., t, n + stations, sides). The sizes are (t, n + stations, sides). A section sees what
        it saw before the change: that a station moves is no change by itself.
        """
        stations = [np.clip(load.station, 0.0, 1.0) for load in self.loads]
        u = np.stack([*(np.full_like(self.coefficients["n0"], ratio) for ratio in xi), *stations], axis=-1)
        seen = [[_seen(u, load.station[:, None], side) for side in _SIDES] for load in self.loads]
        basis, found = self.basis(u), {}
        for force in FORCES:
            columns, rows = self._terms(force, basis)
            gaps = sum(change[..., None] * row for change, row in zip(changes._terms(force, basis)[0], rows, strict=True))
            sizes = sum(np.abs(column[:, None] * row) for column, row in zip(columns, rows, strict=True))
            gaps, sizes = (np.repeat(values[..., None], len(_SIDES) if self.loads else 1, axis=-1) for values in (gaps, sizes))
            for load, change, there in zip(self.loads, changes.loads, seen, strict=True):
                station, constant, slope = (values[:, None] for values in self._acting(force, load))
                moved, more, steeper = (values[..., None] for values in self._acting(force, change))
                gap, size = more + steeper * (station + moved - u) + slope * moved, np.abs(constant) + np.abs(slope * (station - u))
                for k, visible in enumerate(there):
                    gaps[..., k] += np.where(visible, gap, 0.0)
                    sizes[..., k] += np.where(visible, size, 0.0)
            found[force] = gaps, sizes
        return found

    def along(self, force: str, xi: Any, side: Side = "tip") -> Array:
        """The derivative of a force by the ratio, at ratios of shape (t, ...)."""
        u = np.asarray(xi, dtype=float)
        if force == "bending":
            return -self.length * self.at("shear", u, side)
        _, first, second = (_column(column, u) for column in self._terms(force, self.basis(u))[0])
        return -self.density.at(u) * (first + self.length * u * second)

    def rate(self, force: str, rates: SectionLaw, xi: Any, side: Side = "tip") -> Array:
        """The time derivative of a force at ratios of shape (t, ...) that stand still, or, at a station, move with it.

        ``rates`` has the time derivatives of coefficients, loads and stations in their places.
        """
        u = np.asarray(xi, dtype=float)
        pairs = list(zip(self.loads, rates.loads, strict=True))
        # A station that moves takes its force's arm with it.
        loads = (replace(r, station=load.station, m=r.m + load.f * self.length * r.station) for load, r in pairs)
        still = replace(rates, loads=tuple(loads)).at(force, u, side)
        going = sum(np.where(u == _column(load.station, u), _column(r.station, u), 0.0) for load, r in pairs)
        return still + going * self.along(force, u, side) if pairs else still

    def bound(self, force: str, xi: Array) -> float:
        """The largest size that a force may have at ratios ``xi`` where coefficients and loads have any sign."""
        columns, rows = self._terms(force, self.basis(xi))
        size = sum(np.abs(column)[:, None] * np.abs(row) for column, row in zip(columns, rows, strict=True))
        for load in self.loads:
            _, constant, slope = self._acting(force, load)
            size = size + (np.abs(constant) + np.abs(slope))[:, None]
        return float(np.max(size, initial=0.0))

    def extreme(self, force: str) -> tuple[Array, Array]:
        """The ratio at which a force is largest in size, and the force there, at every instant, both of shape (t,)."""
        n = self.coefficients["n0"].size
        blocks = [self.during(slice(i, i + _BLOCK))._extreme(force) for i in range(0, n, _BLOCK)]
        return np.concatenate([place for place, _ in blocks]), np.concatenate([value for _, value in blocks])

    def reached(self, force: str) -> tuple[Array, Array]:
        """Where along a link a force is smallest, largest, and largest in size as by :meth:`extreme`, and what it is: (3, t)."""
        n = self.coefficients["n0"].size
        blocks = [self.during(slice(i, i + _BLOCK))._reached(force) for i in range(0, n, _BLOCK)]
        return np.concatenate([place for place, _ in blocks], axis=1), np.concatenate([value for _, value in blocks], axis=1)

    def _reached(self, force: str) -> tuple[Array, Array]:
        places, values = self.curves(force)
        columns = np.stack([np.argmin(values, axis=1), np.argmax(values, axis=1), np.argmax(np.abs(values), axis=1)])
        every = np.arange(len(values))
        return places[every, columns], values[every, columns]

    def _extreme(self, force: str) -> tuple[Array, Array]:
        places, values = self.curves(force)
        best = np.argmax(np.abs(values), axis=1)[:, None]
        return np.take_along_axis(places, best, 1)[:, 0], np.take_along_axis(values, best, 1)[:, 0]

    def curves(self, force: str) -> tuple[Array, Array]:
        """Ratios among which a force is largest in size at every instant, and the force there, both of shape (t, k).

        They are those of the base, the tip, every station, once for each of its sides, and between two stations that at which the
        force turns along the link, or else the end that is next to that. So each is a smooth curve over time, as long as no station
        passes another one.
        """
        still = np.zeros_like(self.coefficients["n0"])
        stations = [np.clip(load.station, 0.0, 1.0) for load in self.loads]
        places = np.stack([still, still + 1.0, *(station for station in stations for _ in range(2))], axis=1)
        values = self.at(force, places)
        values[:, 3::2] = self.at(force, places[:, 3::2], side="base")
        inner = np.sort(np.stack([still, *stations, still + 1.0], axis=1), axis=1)
        low, high = inner[:, :-1], inner[:, 1:]
        seen = [low + high < 2 * station[:, None] for station in stations]

        def within(name: str, u: Array) -> Array:
            beyond = (self._beyond(name, load, u, mask) for load, mask in zip(self.loads, seen, strict=True))
            return np.asarray(self._smooth(name, u) + sum(beyond))

        found = self._turning(force, functools.partial(within, "shear"), low, high)
        return np.hstack([places, *found]), np.hstack([values, *(within(force, place) for place in found)])

    def _terms(self, force: str, basis: Basis) -> tuple[list[Array], Array]:
        return [self.coefficients[name] for name in MEMBERS[force][0]], basis.bending if force == "bending" else basis.force

    def _smooth(self, force: str, u: Array) -> Array:
        columns, rows = self._terms(force, self.basis(u))
        return np.asarray(sum(_column(column, u) * row for column, row in zip(columns, rows, strict=True)))

    def _acting(self, force: str, load: StationLoad) -> grids.Load:
        if force == "axial":
            return load.station, load.n, np.zeros_like(load.n)
        if force == "shear":
            return load.station, load.f, np.zeros_like(load.f)
        return load.station, load.m, load.f * self.length

    def _beyond(self, force: str, load: StationLoad, u: Array, seen: Any) -> Array:
        station, constant, slope = (_column(values, u) for values in self._acting(force, load))
        return np.where(seen, constant + slope * (station - u), 0.0)

    def _turning(self, force: str, shear: Callable[[Array], Array], low: Array, high: Array) -> list[Array]:
        """Where between two stations the force's derivative along the link is zero, or nearest to it: of bending, first where the
        shear rises through zero, then where it falls.
        """
        c, l = self.coefficients, self.length
        first, second = ("n1", "n2") if force == "axial" else ("f1", "f2")
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            turning = -c[first] / (c[second] * l)
            if force == "bending" and self.density.uniform and not self.loads:
                return [np.clip(np.where(np.isnan(zero), 0.0, zero)[:, None], 0.0, 1.0) for zero in self._zeros_of_uniform_shear()]
        middle = np.clip(np.where(np.isnan(turning), 0.0, turning)[:, None], low, high)
        return [middle] if force != "bending" else self._zeros_of_shear(shear, low, middle, high)

    def _zeros_of_uniform_shear(self) -> list[Array]:
        """f0 + b v + a v^2 = 0 with v = 1 - u; the root that would cancel comes from the other one."""
        c, l, m = self.coefficients, self.length, self.density.cells[0][0]
        a, b = -c["f2"] * m * l / 2, c["f1"] * m + c["f2"] * m * l
        q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * c["f0"], 0.0)), b)) / 2
        rising, falling = q / a, c["f0"] / q
        return [1.0 - np.where(b < 0.0, falling, rising), 1.0 - np.where(b < 0.0, rising, falling)]

    @staticmethod
    def _zeros_of_shear(shear: Callable[[Array], Array], low: Array, middle: Array, high: Array) -> list[Array]:
        """Shear is monotonic on either side of its turning point, whatever the density: halve that.

        Where it has no zero there, that end is taken at which it is nearer to zero.
        """
        places = [low, middle, high]
        ends = [shear(u) for u in places]
        zeros = []
        for k in (0, 1):
            a, b = places[k : k + 2]
            negative, nearer = ends[k] <= 0.0, np.where(np.abs(ends[k]) <= np.abs(ends[k + 1]), a, b)
            none = negative == (ends[k + 1] <= 0.0)
            for _ in range(_HALVINGS):
                half = (a + b) / 2
                lower = (shear(half) <= 0.0) == negative
                a, b = np.where(lower, half, a), np.where(lower, b, half)
            zeros.append(np.where(none, nearer, (a + b) / 2))
        rises = (ends[1] > ends[0]) | ((ends[1] == ends[0]) & (ends[2] < ends[1]))
        return [np.where(rises, zeros[0], zeros[1]), np.where(rises, zeros[1], zeros[0])]


def made_of(outputs: Iterable[Output], link: str, force: str) -> list[Output]:
    """The outputs, among others, that a force of a link is made of; without the places of stations."""
    coefficients, members = MEMBERS[force]
    own = (output for output in outputs if output.along and output.part == link)
    return [output for output in own if output.member in (members if output.station else coefficients)]


def _seen(u: Array, station: Array, side: Side) -> Any:
    """Whether a section sees what acts at a station: from its base side, and at the very tip always."""
    return ((u < station) if side == "tip" else (u <= station)) | ((u >= 1.0) & (station >= 1.0))


def _column(values: Array, like: Array) -> Array:
    """A row an instant, shaped to go with an array whose first axis is time."""
    return values.reshape((-1,) + (1,) * (like.ndim - 1))

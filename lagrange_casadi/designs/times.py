"""The instants of many designs: the same for all, or those that each one's parameters give."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..declare.density import Array
from ..declare.even_points import are_even
from ..declare.reaching import Reaching
from ..declare.scene import Scene
from ..declare.times import Timing, reaching


@dataclass(frozen=True, eq=False)
class DesignTimes:
    """How the instants of a scene's designs are asked for."""

    scene: Scene
    timing: Timing

    @cached_property
    def law(self) -> Reaching | None:
        """The law of the drive that they go by, if any."""
        joint = self.timing.joint
        return reaching(self.scene.mechanism, self.scene.motion[joint]) if joint else None

    @property
    def common(self) -> bool:
        """Whether all designs have the same."""
        return self.timing.fixed and (self.law is None or not self.law.varies)

    @cached_property
    def default(self) -> tuple[Array, Array]:
        """Those of the parameters' defaults as they are asked for, and as many in equal steps of time, each (t,).

        Raises :class:`.DeclarationError` where there are none.
        """
        asked = self.scene.instants(self.timing, self.scene.mechanism.values()).t
        return asked, asked if are_even(asked) else np.linspace(asked[0], asked[-1], asked.size)

    def asked(self, p: Array) -> Array:
        """The instants of designs ``p`` (n, parameters), (n, t), one row where all have the same; NaN of those that have none."""
        if self.common:
            return self.default[0][None]
        start, stop, around = self.timing.bounds(p)
        if self.law is None or self.law.steady:
            return self.even(p)
        way = self.law.way(start, stop, p, around)
        found = self.law.times(way, self._steps(start, stop), p)
        found[~np.isfinite(self.even(p)[:, 0])] = np.nan
        return found

    def even(self, p: Array) -> Array:
        """As many in equal steps of time from the first to the last, between which peaks are sought."""
        if self.common:
            return self.default[1][None]
        start, stop, around = self.timing.bounds(p)
        if self.law is not None:
            way = self.law.way(start, stop, p, around)
            start, stop = way.first, way.last
        lone = self.timing.count == 1
        with np.errstate(invalid="ignore"):
            there = np.isfinite(start) & np.isfinite(stop) & ((stop == start) if lone else (stop > start))
            for law in self.scene.motion.values():
                there &= (start >= law.span[0]) & (stop <= law.span[1])
        return np.where(there[:, None], self._steps(start, stop), np.nan)

    def at_drive(self, t: Array, p: Array) -> Array:
        """The drive's coordinates at times (n, q) of designs (n, parameters)."""
        assert self.law is not None
        if not self.law.steady:
            return self.law.at(t, p)[0]
        d, rate, _ = self.law.at(np.zeros((len(p), 1)), p)
        return d + rate * t

    def _steps(self, start: Array, stop: Array) -> Array:
        numbers = np.arange(self.timing.count)
        with np.errstate(invalid="ignore"):
            found = numbers * ((stop - start) / max(numbers.size - 1, 1))[:, None] + start[:, None]
        found[:, -1] = stop
        return found

"""The instants of many designs: the same for all, or those that each one's parameters give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.symbolic import symbolic_property
from ...model.even_points import are_even
from ...model.motion_inverse import MotionInverse
from ...model.sampled_laws import Laws
from ...model.times import Timing, instants_of

_SAMPLES = 65
"""Least number of times at which a motion is checked for reversal."""


@dataclass(frozen=True, eq=False)
class DesignTimes:
    """Instants of designs, whose motions are ``laws`` and whose default parameters are
    ``values``.
    """

    laws: Laws
    values: Mapping[str, float]
    timing: Timing

    @symbolic_property
    def law(self) -> MotionInverse | None:
        """The law of the drive that they go by, if any."""
        joint = self.timing.joint
        return MotionInverse.of(self.laws, joint) if joint else None

    @symbolic_property
    def common(self) -> bool:
        """True if all designs have the same instants."""
        if self.law is None or not self.timing.fixed:
            return self.timing.fixed
        return not self.law.varies and (self.law.steady or not isinstance(self.timing.around, str))

    @symbolic_property
    def default(self) -> tuple[Array, Array]:
        """Instants of the default parameters as they are defined, and as many in equal steps of
        time, each (t,).

        Raises :class:`.DeclarationError` where there are none.
        """
        asked = instants_of(self.laws, self.timing, self.values).t
        return asked, asked if are_even(asked) else np.linspace(asked[0], asked[-1], asked.size)

    def of(self, p: Array, *, asked: bool = True) -> tuple[Array, Array]:
        """The instants of designs ``p`` (n, parameters), (n, t), one row where all have the same;
        NaN of those that have none.

        First as many as are asked for in equal steps of time, between which peaks are sought; then
        those that are asked for themselves, the same array where they are no others, or are not
        wanted (``asked``).
        """
        if self.common:
            instants, even = (row[None] for row in self.default)
            return even, instants if asked and self.default[0] is not self.default[1] else even
        start, stop, around = self.timing.bounds(p)
        if self.law is None:
            even = self._steps(*self._valid(start, stop))
            return even, even
        passage = self.law.passage(start, stop, p, around, samples=max(_SAMPLES, self.timing.count))
        even = self._steps(*self._valid(passage.first, passage.last))
        if self.law.steady or not asked:
            return even, even
        found = self.law.times(passage, self._steps(start, stop), p)
        found[np.isnan(even[:, 0])] = np.nan
        return even, found

    def even(self, p: Array) -> Array:
        """The instants (t,) of a design (parameters,) in equal steps of time."""
        return np.asarray(self.of(p[None], asked=False)[0][0])

    def _valid(self, start: Array, stop: Array) -> tuple[Array, Array]:
        """The first and last instants; NaN where they are none, or samples
        of a motion end before.
        """
        with np.errstate(invalid="ignore"):
            there = np.isfinite(stop - start) & (
                (stop == start) if self.timing.count == 1 else (stop > start)
            )
            for low, high in self.laws.spans:
                there &= (start >= low) & (stop <= high)
        return np.where(there, start, np.nan), np.where(there, stop, np.nan)

    def at_drive(self, t: Array, p: Array) -> Array:
        """The drive's coordinates at times (n, q) of designs (n, parameters)."""
        assert self.law is not None
        if not self.law.steady:
            return np.asarray(self.law.at(t, p)[0])
        d, rate, _ = self.law.at(np.zeros((len(p), 1)), p)
        return np.asarray(d + rate * t)

    def _steps(self, start: Array, stop: Array) -> Array:
        numbers = np.arange(self.timing.count)
        with np.errstate(invalid="ignore"):
            found = numbers * ((stop - start) / max(numbers.size - 1, 1))[:, None] + start[:, None]
        found[:, -1] = stop
        return found

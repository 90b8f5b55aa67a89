"""Derivatives of peaks and means by parameters, to first and second order.

A smooth peak of F(s, p) is where F_s = 0, in time and along the link. To first order its value
changes as F does there: the envelope theorem. It moves by s' = -F_ss^-1 F_sp, and its value has the
second derivatives F_pp + F_ps s'. A peak at the first or the last instant goes with that instant. A
peak at a kink or a jump goes with the time of what switches there. What goes so, at T(p), has the
derivatives of F(T(p), p).
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Flags
from ...base.vocabulary import Precision
from ...engine.codegen.peak_search import NOTHING, SIDE, SPACING
from ...engine.sharpness import Kind, Watch
from ..statistics import counted, shares
from .ends import Ends, implicit_bends
from .jacobian import SAME_PLACE
from .slopes import Bends, Numbers, Slopes

AS_LARGE: dict[Precision, float] = {"double": 1e-9, "single": 1e-5}
"""Largest relative difference of two peaks that tie."""

_STEEP = 1e-5
"""Relative change of a quantity in a step of time if its peak is not smooth."""

_TINY = float(np.finfo(float).tiny)

_NUDGE = 1e-3
"""Step of differences: relative to a step between instants, and as a ratio to the length."""

_NEAR_T, _NEAR_XI, _NEARER_XI = 1e-2, 1e-4, 1e-5
"""Largest distance of a smooth peak from the place where it was found: in steps between instants,
and as a ratio to the length; less for differences, which may be across a kink.
"""

_FLAT, _STILL = 1e-9, 1e-6
"""Relative change over the whole span, or length, up to which a peak is level; and the largest
change of a level peak's slope.
"""

_ASIDE, _NEARER = 1e-9, 0.5
"""Relative change of a peak's value that shows the other side of a jump; and the part of it that
may remain on its own side.
"""

_REACHES = (1.0, 8.0, 64.0, 512.0)
"""So far from a jump its sides are looked for: of what a peak may be beside it."""

_OTHERWISE = 1e-4
"""Relative difference of two slopes that differ."""

_NOISE, _FAINT = 1e-9, 1e-12
"""Fraction of the largest slope by a parameter, and of the peak, that counts as no slope."""

Peaks = tuple[Array, Array, Array]
"""Value, time and ratio xi/l of q peaks, (q,) each."""


class PeakKind(enum.IntEnum):
    """Kind of a peak's place."""

    SMOOTH = 0
    """The quantity is stationary in time there."""
    END = 1
    """The first or the last instant."""
    SWITCH = 2
    """A kink or a jump, whose time is known."""
    UNKNOWN = 3
    """A kink or a jump of which it is not known what makes it, or none: there is no derivative."""
    LINK_END = 4
    """The base or the tip of the link; in time the quantity is stationary there."""


class PeakSlopes(NamedTuple):
    """Derivatives of q peaks by all parameters, (q, parameters), and the kind of each one's place,
    (q,).

    ``moved`` (q, parameters) are those of the times of peaks that go with an end or a switch,
    ``switch`` (q,) is the number of that switch, or -1. ``t`` (q,) are the times at which they were
    taken: on the peaks' side of a jump.
    """

    slopes: Array
    kinds: npt.NDArray[np.int8]
    moved: Array
    switch: Numbers
    t: Array


class MeanSlopes(NamedTuple):
    """The derivatives of means over time, and of roots of mean squares, by all parameters, (e,
    parameters); NaN of a root of 0.
    """

    mean: Array
    rms: Array


@dataclass(frozen=True, eq=False)
class MovingPeaks:
    """Quantities over the time of some instants, which are in equal steps between the ``ends``, and
    how their peaks change with the parameters.
    """

    slopes: Slopes
    ends: Ends

    @property
    def instants(self) -> Array:
        """The instants, (t,)."""
        return self.ends.instants

    @property
    def p(self) -> Array:
        """The parameters."""
        return self.ends.p

    @cached_property
    def span(self) -> float:
        """The time from the first to the last instant [s]."""
        return float(self.instants[-1] - self.instants[0])

    @cached_property
    def step(self) -> float:
        """The time between two instants [s]."""
        return self.span / max(self.instants.size - 1, 1)

    @cached_property
    def near(self) -> float:
        """Distance from a kink, a jump or an end within which a peak is at it [s]."""
        return SIDE["double"] * self.step + 2 * SPACING * max(
            abs(float(self.instants[k])) for k in (0, -1)
        )

    def gradient(self, chosen: Numbers, peaks: Peaks, nothing: Flags) -> PeakSlopes:
        """The derivatives of peaks of what is ``chosen``.

        ``nothing`` (q,) marks the peaks that are zero within rounding: with them nothing moves.
        """
        value, t, xi = peaks
        unknown = ~(np.isfinite(value) & np.isfinite(t))
        t = np.where(unknown, self.instants[0], t)
        peaks = value, t, xi
        at_first, at_last = t - self.instants[0] <= self.near, self.instants[-1] - t <= self.near
        going = at_first | at_last
        here, lacking, z, off = self._found(chosen, peaks, going | nothing)
        times = self._on_their_side(chosen, peaks, off)
        if (times != t).any():
            here, lacking, z, _ = self._found(chosen, (value, times, xi), going | nothing)
        steep = (np.abs(here[:, 0]) * self.step > _STEEP * np.abs(value)) & ~(going | nothing)
        at_end = (xi <= SAME_PLACE) | (xi >= 1.0 - SAME_PLACE)
        kinds = np.where(at_end, PeakKind.LINK_END, PeakKind.SMOOTH).astype(np.int8)
        kinds[going] = PeakKind.END
        moved, switch = np.zeros((t.size, self.p.size)), np.full(t.size, -1, np.intc)
        moved[at_last], moved[at_first] = self.ends.slopes[::-1]
        if steep.any():
            moved[steep], switch[steep] = self._switching(t[steep], z[steep])
            kinds[steep] = PeakKind.SWITCH
            unknown |= steep & np.isnan(moved).any(axis=1)
            going |= steep
        total = here[:, 2:] + np.where(going[:, None], here[:, :1] * moved, lacking)
        total[unknown], kinds[unknown] = np.nan, PeakKind.UNKNOWN
        return PeakSlopes(total, kinds, moved, switch, times)

    def _found(
        self, chosen: Numbers, peaks: Peaks, stay: Flags
    ) -> tuple[Array, Array, Array, Array]:
        """The gradients at peaks, what the derivatives by parameters lack to those at the smooth
        peaks, the iterated coordinates, and how far the values there are from the peaks'.

        A search by values knows the place of a smooth peak to the root of its rounding only. What
        is known to ``stay`` (q,) where it is lacks nothing. How derivatives change along time and
        along the link is found by differences.
        """
        value, t, xi = peaks
        free = ~stay
        q, moving = t.size, free.nonzero()[0]
        inner = (free & (np.abs(xi - 0.5) < 0.5 - _NUDGE)).nonzero()[0]
        later_on = q + moving.size
        of = np.concatenate([np.arange(q), moving, inner])
        times, places = t[of], xi[of]
        nudge = _NUDGE * self.step
        later = np.where(t[moving] + nudge <= self.instants[-1], nudge, -nudge)
        times[q:later_on] += later
        places[later_on:] += _NUDGE
        z = self.slopes.loops.at(self.instants, self.p, times)
        found = self.slopes.at(times, z, self.p, chosen[of], places, value[of])
        gradient = found.gradient
        here, after, further = gradient[:q], gradient[q:later_on], gradient[later_on:]
        changes, free_xi = np.zeros((q, 2, here.shape[1])), np.zeros(q, bool)
        changes[moving, 0] = (after - here[moving]) / later[:, None]
        changes[inner, 1] = (further - here[inner]) / _NUDGE
        # A place that moves with a station has no slope along the link.
        free_xi[inner] = here[inner, 1] != 0.0
        _, away, _ = self._turned(Bends(here, changes), free, free_xi, value, _NEARER_XI)
        lacking = -(away[0][:, None] * changes[:, 0, 2:] + away[1][:, None] * changes[:, 1, 2:])
        lacking[~np.isfinite(lacking).all(axis=1)] = 0.0
        return here, lacking, z[:q], np.abs(found.value[:q] - value)

    def _turned(
        self, there: Bends, free_t: Flags, free_xi: Flags, value: Array, near: float
    ) -> tuple[tuple[Array, Array, Array], tuple[Array, Array], Flags]:
        """The inverse of the second derivatives where these turn: by time twice, by both, by xi/l
        twice, (q,) each; how far in time and along the link places are from the peaks by one step
        of Newton's method; and which of those that are free to move along the link are near them.

        It is zero along what does not turn, as of a level peak.
        """
        size, sign = np.abs(value), np.sign(value)
        span = max(self.span, _TINY)
        tt, tx, xx = there.changes[:, 0, 0], there.changes[:, 1, 0], there.changes[:, 1, 1]
        by_t, by_xi = there.gradient[:, 0], there.gradient[:, 1]
        with np.errstate(all="ignore"):
            turns_t = free_t & (sign * tt * span**2 < -_FLAT * size)
            bends_xi, det = sign * xx < -_FLAT * size, tt * xx - tx * tx
            for _ in range(2):
                turns_xi = free_xi & bends_xi
                both = turns_t & turns_xi & (det > 0.0)
                inner_t = np.where(both, xx / det, np.where(turns_t, 1.0 / tt, 0.0))
                across = np.where(both, -tx / det, 0.0)
                inner_xi = np.where(both, tt / det, np.where(turns_xi & ~turns_t, 1.0 / xx, 0.0))
                away_t, away_xi = inner_t * by_t + across * by_xi, across * by_t + inner_xi * by_xi
                far = np.abs(away_xi) > near
                if not far.any():
                    break
                free_xi = free_xi & ~far
        far = ~(np.abs(away_t) <= _NEAR_T * self.step)
        away_t[far], away_xi[far] = 0.0, 0.0
        return (inner_t, across, inner_xi), (away_t, away_xi), free_xi & ~far

    def _on_their_side(self, chosen: Numbers, peaks: Peaks, off: Array) -> Array:
        """The times (q,) at which derivatives of peaks are those of their side of a jump.

        A peak that is at a jump is so near to it that rounding decides on which side its time is:
        what was found there, ``off`` (q,) by so much, may be of the other one. It is as large as
        the peak a little before or after.
        """
        value, t, xi = peaks
        times: Array = t.copy()
        remaining = np.flatnonzero(off > _ASIDE * np.abs(value))
        for reach in _REACHES:
            if not remaining.size:
                break
            beside = np.clip(
                t[remaining] + reach * self.near * np.array([[-1.0], [1.0]]),
                self.instants[0],
                self.instants[-1],
            ).ravel()
            twice = np.concatenate([remaining, remaining])
            z = self.slopes.loops.at(self.instants, self.p, beside)
            there = self.slopes.at(beside, z, self.p, chosen[twice], xi[twice], value[twice])
            gaps = np.abs(there.value - value[twice]).reshape(2, -1)
            side = np.argmin(np.where(np.isnan(gaps), np.inf, gaps), axis=0)
            here = np.arange(remaining.size)
            nearer = gaps[side, here] < _NEARER * off[remaining]
            times[remaining[nearer]] = beside.reshape(2, -1)[side, here][nearer]
            remaining = remaining[~nearer]
        return times

    def _switching(self, t: Array, z: Array) -> tuple[Array, Numbers]:
        """The derivatives by all parameters of the times (n,) at which something switches, (n,
        parameters), NaN where nothing does; and the number of the switch, -1 where a motion's knot
        or nothing does.
        """
        switches, first = self.slopes.points.switches, len(self.slopes.points.quantities)
        times, at, back = np.unique(t, return_index=True, return_inverse=True)
        knots = np.array(
            [knot for knots in self.slopes.points.program.laws.knots for knot in knots]
        )
        found = np.full((times.size, self.p.size), np.nan)
        which = np.full(times.size, -1, np.intc)
        if switches:
            many = len(switches)
            chosen = np.tile(np.arange(first, first + many, dtype=np.intc), times.size)
            there = self.slopes.at(
                np.repeat(times, many),
                np.repeat(z[at], many, axis=0),
                self.p,
                chosen,
                np.zeros(chosen.size),
            )
            value, rate = there.value.reshape(-1, many), there.rate.reshape(-1, many)
            gaps = np.stack([_gap(watch, value[:, k]) for k, watch in enumerate(switches)], axis=1)
            with np.errstate(all="ignore"):
                away = np.where(rate != 0.0, np.abs(gaps / rate), np.inf)
            for row in range(times.size):
                k = int(np.argmin(away[row]))
                if away[row, k] <= 2 * self.near:
                    found[row], which[row] = -there.slopes[row * many + k] / rate[row, k], k
        if knots.size:
            at_knots = (np.abs(times[:, None] - knots) <= 2 * self.near).any(axis=1)
            found[at_knots], which[at_knots] = 0.0, -1
        return found[back], which[back]

    def curvature(
        self, chosen: Numbers, peaks: Peaks, first_order: PeakSlopes, nothing: Flags
    ) -> Array:
        """The second derivatives (q, parameters, parameters) of peaks whose gradient is
        ``first_order``.

        NaN where a peak has none; one that is ``nothing`` (q,) but rounding stays where it is.
        """
        value, t, xi = peaks
        sound = np.isfinite(first_order.slopes).all(axis=1) & np.isfinite(value)
        if not sound.any() or not self.p.size:
            return np.full((t.size, self.p.size, self.p.size), np.nan)
        first, last = self.instants[[0, -1]]
        smooth = np.isin(first_order.kinds, (PeakKind.SMOOTH, PeakKind.LINK_END))
        inside = (xi > SAME_PLACE) & (xi < 1.0 - SAME_PLACE)
        free_t, free_xi = smooth & (self.step > 0.0) & ~nothing, inside & ~nothing
        # The search knows a place to the root of its rounding: one step of Newton's method leads
        # there.
        there = self._bends(chosen, first_order.t, xi, value)
        _, away, free_xi = self._turned(there, free_t, free_xi, value, _NEAR_XI)
        there = self._bends(
            chosen,
            np.clip(first_order.t - away[0], first, last),
            np.where(np.isnan(xi), xi, xi - away[1]),
            value,
        )
        (inner_t, across, inner_xi), *_ = self._turned(there, free_t, free_xi, value, np.inf)
        # What moves with an end or a switch, along each way of a parameter.
        moved = first_order.moved
        changes = there.changes[:, 2:]
        pulled = changes[:, :, :2] + np.einsum("qw,qi->qwi", moved, there.changes[:, 0, :2])
        inner = np.array([[inner_t, across], [across, inner_xi]])
        along = -np.einsum("ijq,qwj->qwi", inner, pulled)
        along[:, :, 0] += moved
        whole = changes + np.einsum("qwi,qij->qwj", along, there.changes[:, :2])
        second = (
            whole[:, :, 2:]
            + whole[:, :, :1] * moved[:, None, :]
            + there.gradient[:, :1, None] * self._moved_bends(first_order)
        )
        # A level peak that slopes elsewhere for other parameters jumps there.
        level = free_t & (inner_t == 0.0)
        tilts = np.abs(pulled[:, :, 0] * self.p) * (last - first) > _STILL * np.abs(value)[:, None]
        second[~sound | (level & tilts.any(axis=1))] = np.nan
        return np.asarray((second + np.swapaxes(second, 1, 2)) / 2)

    def _bends(self, chosen: Numbers, t: Array, xi: Array, value: Array | None) -> Bends:
        """The second derivatives by time, xi/l and all parameters of what is ``chosen``."""
        z = self.slopes.loops.at(self.instants, self.p, t)
        return self.slopes.bends(t, z, self.p, chosen, xi, value, np.eye(2 + self.p.size))

    def _moved_bends(self, first_order: PeakSlopes) -> Array:
        """The second derivatives (q, parameters, parameters) of the times of peaks that go with an
        end or a switch; else 0.
        """
        first, last = self.instants[[0, -1]]
        found = np.zeros((first_order.t.size, self.p.size, self.p.size))
        at_end = first_order.kinds == PeakKind.END
        sooner = first_order.t[at_end] - first <= last - first_order.t[at_end]
        found[at_end] = np.where(sooner[:, None, None], *self.ends.bends)
        some = np.flatnonzero(first_order.switch >= 0)
        if some.size:
            chosen = len(self.slopes.points.quantities) + first_order.switch[some]
            there = self._bends(chosen, first_order.t[some], np.full(some.size, np.nan), None)
            second = np.delete(np.delete(there.changes, 1, axis=1), 1, axis=2)
            found[some] = implicit_bends(there.gradient[:, 0], second, first_order.moved[some])
        return found

    def ties(self, chosen: Numbers, value: Array, first_order: PeakSlopes, others: Array) -> Flags:
        """Return which of the peaks (q,), whose gradient is ``first_order``, tie with another one
        of their quantity, which is as large and changes differently with the parameters.

        The largest of both then has a kink at these parameters, and no derivative. What is as large
        and changes alike, as the same peak in the next turn, is no tie. ``others`` (q, n, 4) are
        the local peaks that are as large, as :class:`.Listed` has them.
        """
        found = np.zeros(value.size, bool)
        there = (
            ~np.isnan(others[..., 0])
            & (np.isfinite(value) & np.isfinite(first_order.slopes).all(axis=1))[:, None]
        )
        # Of one there is no other.
        there &= np.count_nonzero(there, axis=1)[:, None] > 1
        if not there.any() or not self.p.size:
            return found
        numbers, (_, t, xi, values) = np.nonzero(there)[0], others[there].T
        sizes = np.zeros(numbers.size, bool)
        changed = self.gradient(chosen[numbers], (values, t, xi), sizes).slopes
        sized = np.sign(values)[:, None] * changed
        direct = np.sign(value[numbers])[:, None] * first_order.slopes[numbers]
        # What rounding leaves of a slope that is nothing is no difference.
        noise = _NOISE * np.nanmax(np.abs(first_order.slopes), axis=0) + _FAINT * np.abs(
            value[numbers, None]
        ) / np.where(self.p == 0.0, 1.0, np.abs(self.p))
        other = (
            np.abs(sized - direct) > _OTHERWISE * np.maximum(np.abs(sized), np.abs(direct)) + noise
        )
        found[numbers[other.any(axis=1)]] = True
        return found

    def means(self, chosen: Numbers) -> MeanSlopes:
        """The derivatives of means of what is ``chosen`` (e,): of sums by trapezia, whose instants
        may move.
        """
        instants, (first, last) = self.instants, self.ends.slopes
        share = np.linspace(0.0, 1.0, instants.size)[:, None]
        moved = (1.0 - share) * first + share * last
        z = self.slopes.loops.at(instants, self.p, instants)
        nowhere = np.full_like(instants, np.nan)
        found = []
        for number in chosen:
            every = np.full(instants.size, number, np.intc)
            there = self.slopes.at(instants, z, self.p, every, nowhere)
            changes = there.slopes + there.rate[:, None] * moved
            found.append(mean_slopes(instants, there.value, changes))
        size = (2, chosen.size, self.p.size)
        mean, rms = np.array(found).swapaxes(0, 1) if found else np.empty(size)
        return MeanSlopes(mean, rms)


def mean_slopes(t: Array, value: Array, changes: Array) -> MeanSlopes:
    """The derivatives of the mean of values (t,), which have ``changes`` (t, parameters), over the
    instants that count.
    """
    counts = counted(value)
    weights, value = shares(t, counts), np.where(counts, value, 0.0)
    whole = np.where(counts[:, None], changes, 0.0)
    with np.errstate(all="ignore"):
        rms = (weights * value) @ whole / np.sqrt(weights @ value**2)
    return MeanSlopes(weights @ whole, rms)


def faint(value: Array, largest: Array) -> Flags:
    """Return which peaks are zero within rounding, relative to the ``largest`` of the unit of
    each.
    """
    return np.asarray(np.abs(value) <= NOTHING * largest)


def _gap(watch: Watch, values: Array) -> Array:
    """Distance of a watched function from the nearest number at which it makes a kink or a jump."""
    if watch.kind is Kind.STEP:
        return np.asarray(values - np.round(values))
    gaps = values[:, None] - np.array(watch.at)
    return np.take_along_axis(gaps, np.abs(gaps).argmin(axis=1)[:, None], 1)[:, 0]

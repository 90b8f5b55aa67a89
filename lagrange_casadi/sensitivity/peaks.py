"""Derivatives of peaks by parameters.

A smooth peak moves as a parameter changes. To first order its value changes as that of the quantity
does where the peak is: the envelope theorem. A peak at the first or the last instant goes with that
instant. A peak at a kink or a jump goes with the time of what switches there.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..summits.panels import SIDE, SPACING
from ..summits.sharpness import Kind, Watch
from .nearby import at_peaks, on_their_side
from .points import SAME_PLACE
from .slopes import Numbers, Slopes

_STEEP = 1e-5
"""Relative change of a quantity in a step of time if its peak is not smooth."""


class PeakKind(enum.IntEnum):
    """Kind of a peak's place."""

    SMOOTH = 0
    """The quantity is stationary in time there."""
    END = 1
    """The first or the last instant."""
    SWITCH = 2
    """A kink or a jump, whose time is known."""
    UNTOLD = 3
    """A kink or a jump of which it is not known what makes it, or none: there is no derivative."""
    LINK_END = 4
    """The base or the tip of the link; in time the quantity is stationary there."""


_SMOOTH, _END, _SWITCH, _UNTOLD, _LINK_END = map(int, PeakKind)


@dataclass(frozen=True, eq=False)
class PeakSlopes:
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


def peak_slopes(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    peaks: tuple[Array, Array, Array],
    ends: Array,
    nothing: npt.NDArray[np.bool_],
) -> PeakSlopes:
    """Derivatives of peaks, (value, t, xi), (q,) each, of the ``chosen`` quantities.

    They are peaks over the time of the ``instants``, which are in equal steps; ``ends`` (2,
    parameters) says how the first and the last move. ``nothing`` (q,) tells which peaks are zero
    but for rounding: with them nothing moves.
    """
    value, t, xi = peaks
    sound = np.isfinite(value) & np.isfinite(t)
    if not sound.all():
        found, kinds = np.full((t.size, p.size), np.nan), np.full(t.size, _UNTOLD, np.int8)
        moved, switch, times = np.zeros((t.size, p.size)), np.full(t.size, -1, np.intc), t.copy()
        inner = peak_slopes(
            slopes,
            instants,
            p,
            chosen[sound],
            (value[sound], t[sound], xi[sound]),
            ends,
            nothing[sound],
        )
        found[sound], kinds[sound], moved[sound], switch[sound] = (
            inner.slopes,
            inner.kinds,
            inner.moved,
            inner.switch,
        )
        times[sound] = inner.t
        return PeakSlopes(found, kinds, moved, switch, times)
    first, last = instants[0], instants[-1]
    step = (last - first) / max(instants.size - 1, 1)
    near = _near(step, instants)
    at_first, at_last = t - first <= near, last - t <= near
    going = at_first | at_last
    here, lacking, z = at_peaks(slopes, instants, p, chosen, (value, t, xi), step, going | nothing)
    times = on_their_side(slopes, instants, p, chosen, peaks, here.value, near)
    if (times != t).any():
        here, lacking, z = at_peaks(
            slopes, instants, p, chosen, (value, times, xi), step, going | nothing
        )
    steep = (np.abs(here.rate) * step > _STEEP * np.abs(value)) & ~(going | nothing)
    kinds = np.where((xi <= SAME_PLACE) | (xi >= 1.0 - SAME_PLACE), _LINK_END, _SMOOTH).astype(
        np.int8
    )
    kinds[going] = _END
    moved, switch = np.zeros_like(here.slopes), np.full(t.size, -1, np.intc)
    moved[at_last], moved[at_first] = ends[1], ends[0]
    if steep.any():
        moved[steep], switch[steep] = _switching(slopes, t[steep], z[steep], p, 2 * near)
        kinds[steep] = np.where(np.isnan(moved[steep]).any(axis=1), _UNTOLD, _SWITCH)
        going |= steep
    return PeakSlopes(
        here.slopes + np.where(going[:, None], here.rate[:, None] * moved, lacking),
        kinds,
        moved,
        switch,
        times,
    )


def _near(step: float, instants: Array) -> float:
    """Distance from a kink, a jump or an end within which a peak is at it [s]."""
    return SIDE * step + 2 * SPACING * float(np.abs(instants).max())


def _switching(slopes: Slopes, t: Array, z: Array, p: Array, near: float) -> tuple[Array, Numbers]:
    """The derivatives by all parameters of the times (n,) at which something switches, (n,
    parameters), NaN where nothing does; and the number of the switch, -1 where a motion's knot or
    nothing does."""
    switches, first = slopes.points.switches, len(slopes.points.quantities)
    times, at, back = np.unique(t, return_index=True, return_inverse=True)
    knots = np.array([knot for knots in slopes.graph.laws.knots for knot in knots])
    found, which = np.full((times.size, p.size), np.nan), np.full(times.size, -1, np.intc)
    if switches:
        many = len(switches)
        chosen = np.tile(np.arange(first, first + many, dtype=np.intc), times.size)
        there = slopes.at(
            np.repeat(times, many), np.repeat(z[at], many, axis=0), p, chosen, np.zeros(chosen.size)
        )
        value, rate = there.value.reshape(-1, many), there.rate.reshape(-1, many)
        gaps = np.stack([_gap(watch, value[:, k]) for k, watch in enumerate(switches)], axis=1)
        with np.errstate(all="ignore"):
            away = np.where(rate != 0.0, np.abs(gaps / rate), np.inf)
        for row in range(times.size):
            k = int(np.argmin(away[row]))
            if away[row, k] <= near:
                found[row], which[row] = -there.slopes[row * many + k] / rate[row, k], k
    if knots.size:
        at_knots = (np.abs(times[:, None] - knots) <= near).any(axis=1)
        found[at_knots], which[at_knots] = 0.0, -1
    return found[back], which[back]


def _gap(watch: Watch, values: Array) -> Array:
    """Distance of a watched function from the nearest number at which it makes a kink or a jump."""
    if watch.kind is Kind.STEP:
        return np.asarray(values - np.round(values))
    gaps = values[:, None] - np.array(watch.at or (0.0,))
    return np.take_along_axis(gaps, np.abs(gaps).argmin(axis=1)[:, None], 1)[:, 0]

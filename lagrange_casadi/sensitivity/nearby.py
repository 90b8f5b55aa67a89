"""What is at peaks, taken a step of Newton's method further.

A search by values knows the place of a smooth peak to the root of its rounding only. What the place is off by, times how the
derivatives change along time and along the link, is added to them: all from differences.
"""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt

from ..declare.density import Array
from .slopes import AtPoints, Numbers, Slopes

_NUDGE_T, _NUDGE_XI = 1e-3, 1e-3
"""By how much a place is moved for differences: of a step between instants, and as a ratio to the length."""

_NEAR_T, _NEAR_XI = 1e-2, 1e-5
"""How far a smooth peak is from where it was found at most, likewise."""


def at_peaks(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    peaks: tuple[Array, Array, Array],
    step: float,
    stay: npt.NDArray[np.bool_],
) -> tuple[AtPoints, Array, Array]:
    """What is at peaks (value, t, xi), what its slopes lack to those at the smooth peaks, and the iterated coordinates there.

    The peaks are in the span of the ``instants``, a ``step`` apart. What is known to ``stay`` (q,) where it is lacks nothing.
    """
    value, t, xi = peaks
    q, inner, moving = t.size, ((xi > _NUDGE_XI) & (xi < 1.0 - _NUDGE_XI)).nonzero()[0], (~stay).nonzero()[0]
    nudge = _NUDGE_T * step
    later = np.where(t + nudge <= instants[-1], nudge, -nudge)
    times = np.concatenate([t, (t + later)[moving]])
    places = np.concatenate([xi, xi[moving], xi[inner] + _NUDGE_XI, xi[inner] - _NUDGE_XI])
    z = slopes.iterated(instants, p, times)
    own = np.arange(q)
    of = np.concatenate([own, moving, inner, inner])
    where = np.concatenate([own, q + np.arange(moving.size), inner, inner])
    found = slopes.at(times[where], z[where], p, chosen[of], places, value[of])
    ends = np.cumsum([0, q, moving.size, inner.size, inner.size]).tolist()
    here, after, further, nearer = (
        AtPoints(found.value[a:b], found.rate[a:b], found.slopes[a:b]) for a, b in itertools.pairwise(ends)
    )
    lacking = np.zeros_like(here.slopes)
    if not step > 0.0:
        return here, lacking, z[:q]
    tt = np.full(q, np.nan)
    with np.errstate(all="ignore"):
        tt[moving] = (after.rate - here.rate[moving]) / later[moving]
        by_t = -here.rate / tt
        by_xi = _along(here, further, nearer, inner, tt, by_t, np.sign(value)) if inner.size else None
        lacking[moving] = (after.slopes - here.slopes[moving]) * (by_t / later)[moving, None]
        if by_xi is not None:
            lacking[inner] += (further.slopes - nearer.slopes) * (by_xi / (2.0 * _NUDGE_XI))[:, None]
        sound = (value * tt < 0.0) & (np.abs(by_t) <= _NEAR_T * step) & np.isfinite(lacking.sum(axis=1))
    lacking[~sound] = 0.0
    return here, lacking, z[:q]


def _along(
    here: AtPoints, further: AtPoints, nearer: AtPoints, inner: npt.NDArray[np.intp], tt: Array, by_t: Array, sign: Array
) -> Array:
    """How far the ``inner`` peaks are from the smooth ones along the link; and in time, ``by_t``, of those that turn there."""
    rate, bend = here.rate[inner], tt[inner]
    xx = (further.value - 2.0 * here.value[inner] + nearer.value) / _NUDGE_XI**2
    x, tx = (further.value - nearer.value) / (2.0 * _NUDGE_XI), (further.rate - nearer.rate) / (2.0 * _NUDGE_XI)
    det = bend * xx - tx * tx
    by_xi = (tx * rate - bend * x) / det
    turns = (sign[inner] * xx < 0.0) & (det > 0.0) & (np.abs(by_xi) <= _NEAR_XI)
    by_t[inner[turns]] = ((tx * x - xx * rate) / det)[turns]
    return np.where(turns, by_xi, 0.0)

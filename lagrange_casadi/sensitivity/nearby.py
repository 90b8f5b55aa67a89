"""Values at peaks after one more step of Newton's method.

A search by values knows the place of a smooth peak to the root of its rounding only. What the place
is off by, times how the derivatives change along time and along the link, is added to them: all
from differences.
"""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from .slopes import AtPoints, Numbers, Slopes

_NUDGE_T, _NUDGE_XI = 1e-3, 1e-3
"""Steps of differences: relative to a step between instants, and as a ratio to the length."""

_NEAR_T, _NEAR_XI = 1e-2, 1e-5
"""Largest distance of a smooth peak from the place where it was found, likewise."""

_ASIDE, _NEARER = 1e-9, 0.5
"""Relative change of a peak's value that shows the other side of a jump; and the part of it that
may remain on its own side.
"""

_REACHES = (1.0, 8.0, 64.0, 512.0)
"""So far from a jump its sides are looked for: of what a peak may be beside it."""


def at_peaks(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    peaks: tuple[Array, Array, Array],
    step: float,
    stay: npt.NDArray[np.bool_],
) -> tuple[AtPoints, Array, Array]:
    """Corrected peaks (value, t, xi), the change of slopes to those at the smooth peaks, and the
    iterated coordinates there.

    The peaks are in the span of the ``instants``, a ``step`` apart. What is known to ``stay`` (q,)
    where it is lacks nothing.
    """
    value, t, xi = peaks
    q, inner, moving = (
        t.size,
        ((xi > _NUDGE_XI) & (xi < 1.0 - _NUDGE_XI)).nonzero()[0],
        (~stay).nonzero()[0],
    )
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
        AtPoints(found.value[a:b], found.rate[a:b], found.slopes[a:b])
        for a, b in itertools.pairwise(ends)
    )
    lacking = np.zeros_like(here.slopes)
    if not step > 0.0:
        return here, lacking, z[:q]
    tt = np.full(q, np.nan)
    with np.errstate(all="ignore"):
        tt[moving] = (after.rate - here.rate[moving]) / later[moving]
        by_t = -here.rate / tt
        by_xi = (
            _along(here, further, nearer, inner, tt, by_t, np.sign(value)) if inner.size else None
        )
        lacking[moving] = (after.slopes - here.slopes[moving]) * (by_t / later)[moving, None]
        if by_xi is not None:
            lacking[inner] += (further.slopes - nearer.slopes) * (by_xi / (2.0 * _NUDGE_XI))[
                :, None
            ]
        sound = (
            (value * tt < 0.0) & (np.abs(by_t) <= _NEAR_T * step) & np.isfinite(lacking.sum(axis=1))
        )
    lacking[~sound] = 0.0
    return here, lacking, z[:q]


def on_their_side(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    peaks: tuple[Array, Array, Array],
    found: Array,
    near: float,
) -> Array:
    """The times (q,) at which derivatives of peaks (value, t, xi) are those of their side of a
    jump.

    A peak that is at a jump is so ``near`` to it that rounding tells on which side its time is:
    what is ``found`` (q,) there may be of the other one. It is as large as the peak a little before
    or after.
    """
    value, t, xi = peaks
    times: Array = t.copy()
    off = np.abs(found - value)
    left = np.flatnonzero(off > _ASIDE * np.abs(value))
    for reach in _REACHES:
        if not left.size:
            break
        beside = np.clip(
            t[left] + reach * near * np.array([[-1.0], [1.0]]), instants[0], instants[-1]
        ).ravel()
        twice = np.concatenate([left, left])
        z = slopes.iterated(instants, p, beside)
        there = slopes.at(beside, z, p, chosen[twice], xi[twice], value[twice])
        gaps = np.abs(there.value - value[twice]).reshape(2, -1)
        side = np.argmin(np.where(np.isnan(gaps), np.inf, gaps), axis=0)
        here = np.arange(left.size)
        nearer = gaps[side, here] < _NEARER * off[left]
        times[left[nearer]] = beside.reshape(2, -1)[side, here][nearer]
        left = left[~nearer]
    return np.asarray(times)


def _along(
    here: AtPoints,
    further: AtPoints,
    nearer: AtPoints,
    inner: npt.NDArray[np.intp],
    tt: Array,
    by_t: Array,
    sign: Array,
) -> Array:
    """Distance of the ``inner`` peaks from the smooth ones along the link; and in time, ``by_t``,
    for those that turn there.
    """
    rate, bend = here.rate[inner], tt[inner]
    xx = (further.value - 2.0 * here.value[inner] + nearer.value) / _NUDGE_XI**2
    x, tx = (
        (further.value - nearer.value) / (2.0 * _NUDGE_XI),
        (further.rate - nearer.rate) / (2.0 * _NUDGE_XI),
    )
    det = bend * xx - tx * tx
    by_xi = (tx * rate - bend * x) / det
    turns = (sign[inner] * xx < 0.0) & (det > 0.0) & (np.abs(by_xi) <= _NEAR_XI)
    by_t[inner[turns]] = ((tx * x - xx * rate) / det)[turns]
    return np.where(turns, by_xi, 0.0)

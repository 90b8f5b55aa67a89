"""Second derivatives of peaks by parameters.

A smooth peak of F(s, p) is where F_s = 0, in time and along the link. It moves by s' = -F_ss^-1
F_sp, and its value has the second derivatives F_pp + F_ps s'. A peak that goes with an end or a
switch, at T(p), has those of F(T(p), p).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from .curvatures import Bends, Curvatures, unit_ways
from .ends import implicit_bends
from .peaks import PeakKind, PeakSlopes
from .points import SAME_PLACE
from .slopes import Numbers

_NEAR_T, _NEAR_XI = 1e-2, 1e-4
"""Largest distance of a smooth peak from the place where it was found: in steps between instants,
and as a ratio to the length.
"""

_FLAT, _STILL = 1e-9, 1e-6
"""Relative change over the whole span, or length, up to which a peak is level; and the largest
change of a level peak's slope.
"""

_SMOOTH = (PeakKind.SMOOTH, PeakKind.LINK_END)


def peak_bends(
    curvatures: Curvatures,
    instants: Array,
    p: Array,
    chosen: Numbers,
    peaks: tuple[Array, Array, Array],
    own: PeakSlopes,
    ends: Array,
    nothing: npt.NDArray[np.bool_],
) -> Array:
    """The second derivatives (q, parameters, parameters) of peaks, (value, t, xi), of what is
    ``chosen``: see :func:`.peak_slopes`, which gave ``own``.

    ``ends`` (2, parameters, parameters) are the second derivatives of the first and the last
    instant. NaN where a peak has none; one that is ``nothing`` (q,) but rounding stays where it is.
    """
    value, t, xi = peaks
    found = np.full((t.size, p.size, p.size), np.nan)
    sound = np.isfinite(own.slopes).all(axis=1) & np.isfinite(value)
    if not sound.any() or not p.size:
        return found
    value, t, xi, moved = (array[sound] for array in (value, own.t, xi, own.moved))
    chosen, kinds = chosen[sound], own.kinds[sound]
    first, last = instants[0], instants[-1]
    step = (last - first) / max(instants.size - 1, 1)
    ways, sign = unit_ways(range(p.size), p.size), np.sign(value)
    free_t, span = (
        np.isin(kinds, _SMOOTH) & (step > 0.0) & ~nothing[sound],
        max(last - first, np.finfo(float).tiny),
    )
    free_xi = (xi > SAME_PLACE) & (xi < 1.0 - SAME_PLACE) & ~nothing[sound]

    def look(times: Array, places: Array) -> Bends:
        z = curvatures.slopes.iterated(instants, p, times)
        return curvatures.at(times, z, p, chosen, places, value, ways)

    # The search knows a place to the root of its rounding: one step of Newton's method leads there.
    there = look(t, xi)
    inner = _inner(there, sign * free_t, sign * free_xi, span, np.abs(value))
    away = np.einsum("qij,qj->qi", inner, there.gradient[:, :2])
    near = (np.abs(away) <= [_NEAR_T * step, _NEAR_XI]).all(axis=1)
    free_xi &= near
    away[~near] = 0.0
    there = look(np.clip(t - away[:, 0], first, last), np.where(np.isnan(xi), xi, xi - away[:, 1]))
    inner = _inner(there, sign * free_t, sign * free_xi, span, np.abs(value))
    # What moves with an end or a switch, along each way of a parameter.
    along, bends = (
        np.zeros((t.size, p.size, 2)),
        _moved_bends(curvatures, instants, t, p, own, sound, ends),
    )
    along[:, :, 0] = moved
    changes = there.changes[:, 2:]
    pulled = changes[:, :, :2] + np.einsum("qw,qi->qwi", moved, there.changes[:, 0, :2])
    along -= np.einsum("qij,qwj->qwi", inner, pulled)
    whole = changes + np.einsum("qwi,qij->qwj", along, there.changes[:, :2])
    second = (
        whole[:, :, 2:] + whole[:, :, :1] * moved[:, None, :] + there.gradient[:, :1, None] * bends
    )
    # A level peak that slopes elsewhere for other parameters jumps there.
    level = free_t & (inner[:, 0, 0] == 0.0)
    tilts = (np.abs(pulled[:, :, 0] * p) * span > _STILL * np.abs(value)[:, None]).any(axis=1)
    second[level & tilts] = np.nan
    found[sound] = (second + np.swapaxes(second, 1, 2)) / 2
    return found


def _inner(there: Bends, by_t: Array, by_xi: Array, span: float, size: Array) -> Array:
    """The inverse of the second derivatives by time and xi/l where these turn, zero along what does
    not, as of a level peak.

    ``by_t`` and ``by_xi`` are the peak's sign, 0 of a peak that is held there.
    """
    tt, tx, xx = there.changes[:, 0, 0], there.changes[:, 0, 1], there.changes[:, 1, 1]
    turns_t, turns_xi = by_t * tt * span**2 < -_FLAT * size, by_xi * xx < -_FLAT * size
    both = turns_t & turns_xi & (tt * xx - tx * tx > 0.0)
    found = np.zeros((size.size, 2, 2))
    with np.errstate(all="ignore"):
        found[:, 0, 0] = np.where(both, xx / (tt * xx - tx * tx), np.where(turns_t, 1.0 / tt, 0.0))
        found[:, 1, 1] = np.where(
            both, tt / (tt * xx - tx * tx), np.where(turns_xi & ~turns_t, 1.0 / xx, 0.0)
        )
        found[:, 0, 1] = found[:, 1, 0] = np.where(both, -tx / (tt * xx - tx * tx), 0.0)
    return found


def _moved_bends(
    curvatures: Curvatures,
    instants: Array,
    t: Array,
    p: Array,
    own: PeakSlopes,
    sound: npt.NDArray[np.bool_],
    ends: Array,
) -> Array:
    """The second derivatives (q, parameters, parameters) of the times of peaks that go with an end
    or a switch; else 0.
    """
    kinds, moved, switch = own.kinds[sound], own.moved[sound], own.switch[sound]
    found = np.zeros((t.size, p.size, p.size))
    at_end = kinds == PeakKind.END
    found[at_end] = np.where(
        (t[at_end] - instants[0] <= instants[-1] - t[at_end])[:, None, None], ends[0], ends[1]
    )
    some = np.flatnonzero(switch >= 0)
    if some.size:
        z, numbers = (
            curvatures.slopes.iterated(instants, p, t[some]),
            len(curvatures.slopes.points.quantities) + switch[some],
        )
        nowhere, ways = np.full(some.size, np.nan), unit_ways(range(p.size), p.size)
        there = curvatures.at(t[some], z, p, numbers.astype(np.intc), nowhere, nowhere, ways)
        second = np.delete(np.delete(there.changes, 1, axis=1), 1, axis=2)
        found[some] = implicit_bends(there.gradient[:, 0], second, moved[some])
    return found

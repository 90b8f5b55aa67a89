"""Whether another peak of a quantity is as large as the one that is told, and changes otherwise with parameters.

The largest of both then has a kink at these parameters, and no derivative. What is as large and changes alike, as the same peak in
the next turn, is no tie.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from .peaks import PeakSlopes, peak_slopes
from .slopes import Numbers, Slopes

AS_LARGE, OTHERWISE = 1e-9, 1e-4
"""What a peak may be below another that it ties with, of itself; and by what of a slope two slopes differ."""

_NOISE, _FAINT = 1e-9, 1e-12
"""What of the largest slope by a parameter, and of the peak, is no slope."""

_RISE = 0.25
"""How far a smooth peak may be above the largest value at instants, of what that is above the lower one beside it."""

_TRIALS, _NUDGE = 5, 1e-3
_MOST = 16
"""Local peaks of a curve that are looked at."""

Curve = tuple[Array, Array]
"""A ratio xi/l, which may be NaN, and a value, over instants."""


class _Candidate(NamedTuple):
    """A local peak of a curve of the quantity ``number``, with the ``value`` at the instant ``at``."""

    number: int
    at: int
    value: float
    places: Array


def ties(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    value: Array,
    own: PeakSlopes,
    ends: Array,
    nothing: npt.NDArray[np.bool_],
    curves: Callable[[int], Sequence[Curve]],
) -> npt.NDArray[np.bool_]:
    """Which of the peaks (q,) of what is ``chosen`` tie with another one: see :func:`.peak_slopes`, which gave ``own``.

    ``curves`` of a quantity, by its number, are over the ``instants``. A peak at a kink between two instants is not looked for.
    """
    found = np.zeros(value.size, bool)
    some = np.flatnonzero(np.isfinite(value) & np.isfinite(own.slopes).all(axis=1) & ~nothing)
    candidates = [candidate for k in some for curve in curves(int(k)) for candidate in _tops(int(k), abs(value[k]), *curve)]
    if not candidates or not p.size:
        return found
    numbers = np.array([candidate.number for candidate in candidates])
    t, xi, values = _refined(slopes, instants, p, chosen[numbers], candidates)
    large = np.abs(values) >= (1.0 - AS_LARGE) * np.abs(value[numbers])
    numbers, t, xi, values = numbers[large], t[large], xi[large], values[large]
    if not numbers.size:
        return found
    others = peak_slopes(slopes, instants, p, chosen[numbers], (values, t, xi), ends, np.zeros(numbers.size, bool)).slopes
    sized, told = np.sign(values)[:, None] * others, np.sign(value[numbers])[:, None] * own.slopes[numbers]
    # What rounding leaves of a slope that is nothing is no difference.
    noise = _NOISE * np.nanmax(np.abs(own.slopes), axis=0) + _FAINT * np.abs(value[numbers, None]) / np.where(
        p == 0.0, 1.0, np.abs(p)
    )
    found[numbers[(np.abs(sized - told) > OTHERWISE * np.maximum(np.abs(sized), np.abs(told)) + noise).any(axis=1)]] = True
    return found


def _tops(number: int, largest: float, places: Array, values: Array) -> list[_Candidate]:
    """The local peaks of a curve that may reach the largest size."""
    sized = np.where(np.isfinite(values), np.abs(values), -np.inf)
    before, after = np.concatenate([sized[:1], sized[:-1]]), np.concatenate([sized[1:], sized[-1:]])
    with np.errstate(invalid="ignore"):
        above = sized + _RISE * np.nan_to_num(sized - np.minimum(before, after), posinf=0.0)
    tops = np.flatnonzero((sized >= before) & (sized >= after) & (above >= (1.0 - AS_LARGE) * largest))
    if tops.size > _MOST:
        tops = tops[np.linspace(0, tops.size - 1, _MOST).round().astype(int)]
    return [_Candidate(number, int(k), float(values[k]), places) for k in tops]


def _refined(slopes: Slopes, t: Array, p: Array, chosen: Numbers, candidates: Sequence[_Candidate]) -> tuple[Array, Array, Array]:
    """Time, ratio and value of the smooth peaks that are near, by Newton's method; what is not smooth stays at its instant."""
    at = np.array([candidate.at for candidate in candidates])
    first, last = np.maximum(at - 1, 0), np.minimum(at + 1, t.size - 1)
    low, high, sampled = t[first], t[last], np.array([candidate.value for candidate in candidates])
    step = np.maximum(high - low, np.finfo(float).tiny)

    def place(times: Array) -> Array:
        rows = [
            np.interp(time, t[a : b + 1], c.places[a : b + 1]) for time, a, b, c in zip(times, first, last, candidates, strict=True)
        ]
        return np.where(np.isfinite(rows), rows, [c.places[c.at] for c in candidates])

    def look(times: Array) -> tuple[Array, Array]:
        found = slopes.at(times, slopes.iterated(t, p, times), p, chosen, place(times), sampled)
        return found.value, found.rate

    times, nudge = t[at].copy(), _NUDGE * step
    best, where = np.full(times.size, -np.inf), times.copy()
    values = np.full(times.size, np.nan)
    for _ in range(_TRIALS):
        value, rate = look(times)
        better = np.abs(value) > best
        best, where, values = np.where(better, np.abs(value), best), np.where(better, times, where), np.where(better, value, values)
        rates = [look(np.clip(times + way * nudge, low, high))[1] for way in (-1, 1)]
        bend = (rates[1] - rates[0]) / np.maximum(np.clip(times + nudge, low, high) - np.clip(times - nudge, low, high), 1e-300)
        with np.errstate(all="ignore"):
            moved = np.where(np.sign(value) * bend < 0.0, times - rate / bend, times)
        times = np.clip(np.where(np.isfinite(moved), moved, times), low, high)
    return where, place(where), values

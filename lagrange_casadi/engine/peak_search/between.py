"""Behaviour of curves between equal steps of time, from their values at these: their range, and
where they may do anything.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from .sharpness import Kind, Watch

Flags = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.intp]

RATE = 0.3
"""An angle [rad] that a step may turn: less than a twentieth of a turn, so that harmonics show."""

CHANGE = 0.75
"""Largest change of an argument near which a function is steep, in a step."""

DIP = 0.5
"""Relative distance from zero to which a divisor may seem to come between two steps."""

RISE = 0.5
"""Rise of an exponent above both ends of a step."""

STRAIGHT = 4.0
"""Factor by which an argument goes further beyond its ends than it may seem to, in a step through
which it goes straight on.
"""

NEGLIGIBLE = 40.0
"""Distance of an exponent below the largest from which the power is negligible."""


QUIET = 10
"""Number of values from whose differences rounding is estimated."""

NOISE = 1e-6
"""Largest relative error of a quantity by rounding, as near a dead centre."""

_NUMBERED = (Kind.SWITCH, Kind.KNOT)
EVEN = 0.3
"""Least change in a step, of that in it and the steps beside, of what passes a number once."""

SWITCHING = (*_NUMBERED, Kind.ROOT, Kind.STEP)


def highest(y: Array) -> Array:
    """An upper bound of curves in every step, (..., n - 1), of their values (..., n) at five or
    more times.

    Where it bends downwards at both ends of a step, a curve is below the chords of the steps beside
    it; where upwards, below its own. Where it bends both ways, and in the first step and the last,
    it rises above an end at most as far as a kink in the middle would that bends it as much. To all
    this comes what the flanks of a kink bend upwards; so beside an inflection, through which the
    chord rises though the curve may fall.
    """
    a, b = y[..., :-1], y[..., 1:]
    inner = -np.diff(y, 2)
    bend = np.concatenate([2 * inner[..., :1], inner, 2 * inner[..., -1:]], axis=-1)
    left, right, upward = bend[..., :-1], bend[..., 1:], np.maximum(-inner, 0.0)
    flanks = np.zeros_like(a)
    flanks[..., 2:-2] = upward[..., :-3] + upward[..., 3:]
    beside = np.zeros_like(a)
    beside[..., 2:] += upward[..., :-1]
    beside[..., :-2] += upward[..., 1:]
    flanks[..., :2], flanks[..., -2:] = 2 * np.abs(inner[..., 1:3]), 2 * np.abs(inner[..., -3:-1])
    with np.errstate(all="ignore"):
        up, down = left + (b - a), right - (b - a)
        tip = np.where(
            (up > 0.0) & (down > 0.0),
            a + up * (right / (left + right)) + flanks,
            np.maximum(a, b) + beside,
        )
        either = np.maximum(a + np.abs(left) / 2, b + np.abs(right) / 2) + flanks
        concave, convex = (left >= 0.0) & (right >= 0.0), (left <= 0.0) & (right <= 0.0)
    concave[..., [0, -1]] = convex[..., [0, -1]] = False
    return np.where(concave, tip, np.where(convex, np.maximum(a, b), either))


def reach(y: Array) -> Array:
    """Return how far curves reach beside their values (..., n) at three or more times, in size.

    From a value that is no further than half of what bends it there takes it; at an end, what bends
    it twice as much as its neighbour is bent.
    """
    ends, near, third = y[..., [0, -1]], y[..., [1, -2]], y[..., [2, -3]]
    beyond = 2 * ends - near - np.copysign(2 * np.abs(2 * near - ends - third), ends)
    before = np.concatenate([beyond[..., :1], y[..., :-1]], axis=-1)
    after = np.concatenate([y[..., 1:], beyond[..., 1:]], axis=-1)
    return np.asarray(np.abs(4 * y - (before + after)) / 2)


def scatter(row: Array) -> float:
    """Return the rounding error of values so near to each other that they differ by nothing else
    but their slope.
    """
    return 3 * float(np.median(np.abs(np.diff(row, 3))))


def shaken(row: Array, step: int) -> float:
    """Return the rounding error of a row's values beside a step; zero where none shows.

    Third differences show rounding where they are no smaller than second ones, and change their
    sign to and fro: those of a steep flank do not.
    """
    if row.size < QUIET:
        return 0.0
    first = min(max(step - QUIET // 2 + 1, 0), row.size - QUIET)
    row = row[first : first + QUIET]
    thirds, second = np.diff(row, 3), float(np.median(np.abs(np.diff(row, 2))))
    reversals = np.count_nonzero(np.sign(thirds[1:]) * np.sign(thirds[:-1]) < 0.0)
    return scatter(row) if reversals >= 2 and 3 * second <= scatter(row) else 0.0


def gaps(watch: Watch, x: Array) -> Array:
    """Distance of a watched function from the nearest number at which it switches."""
    at = np.round(x) if watch.kind is Kind.STEP else np.array(watch.at or (0.0,))[:, None]
    return np.asarray(np.abs(x - at).reshape(-1, x.size).min(axis=0))


def side(watch: Watch, x: Array) -> Array:
    """On which side of the numbers at which it switches a watched function is: twice as many as are
    below it, and one more at one.
    """
    if watch.kind is Kind.STEP:
        return np.asarray(2 * np.floor(x) + (np.floor(x) == x))
    at = np.array(watch.at)[:, None]
    return np.asarray((2 * (at < x) + (at == x)).sum(axis=0))


def undecided(row: Array, watch: Watch, noise: float) -> Flags:
    """Steps, (n - 1,), in which rounding, ``noise``, decides on which side of a number a watched
    function is: both ends are no further from that, or those of the step beside are.
    """
    found = np.zeros(row.size - 1, bool)
    if noise > 0.0:
        near = gaps(watch, row) <= noise
        found = near[:-1] & near[1:]
    return found | _beside(found)


def unresolved(
    rows: Array,
    watches: Sequence[Watch],
    step: float,
    vague: Flags,
    kinks: npt.NDArray[np.intp] | None = None,
    finest: bool = False,
) -> tuple[Flags, Flags, Flags]:
    """Steps of time in which something may rise and fall unseen, (n - 1,), from the watched
    functions (watches, n); those with kinks; and where a watched function switches by rounding,
    (watches, n - 1), which is none: ``vague`` are the steps that are :func:`undecided`.

    ``kinks`` are how many more kinks are known to be in each step. One in a step shows, two or one
    in each of two steps may not. In the ``finest`` steps they do: there rounding makes as many,
    where what is watched is nearly zero, and poles alone hide more.
    """
    found, rounded = np.zeros(rows.shape[1] - 1, bool), np.zeros_like(vague)
    count = np.zeros(found.size, np.intp) if kinks is None else kinks.copy()
    with np.errstate(all="ignore"):
        for k, (row, watch) in enumerate(zip(rows, watches, strict=True)):
            bounded, kinked = _unresolved(row, watch, step, found | (count > 0))
            rounded[k] = vague[k] & (bounded | (kinked > 0))
            if not finest or watch.kind is Kind.POLE:
                found |= bounded & ~vague[k]
            count += np.where(vague[k], 0, kinked)
    if finest:
        return found, count > 0, rounded
    return found | (count > 1) | ((count > 0) & _beside(count > 0)), count > 0, rounded


def lingers(row: Array, watch: Watch, step: int) -> bool:
    """Return whether a watched function may be at a number at which it switches in more than a
    point of a step: it comes near to one, but does not go on from one side to another.
    """
    ends, around = row[step : step + 2], row[max(step - 1, 0) : step + 3]
    change, whole = abs(ends[1] - ends[0]), np.ptp(around)
    passes = np.ptp(side(watch, around[[0, -1]])) >= 2 and change >= EVEN * whole
    near = change / 2 + abs(whole - (around.size - 1) * change)
    return bool(gaps(watch, ends).min() <= near and not passes)


def hiding_at(
    rows: Array, watches: Sequence[Watch], length: float, vague: Flags, step: int
) -> Flags:
    """Return which watched functions may hide something in a step, alone or with another kink there
    or beside it, (watches,).
    """
    found, none = np.zeros(len(watches), bool), np.zeros(rows.shape[1] - 1, bool)
    for k, (row, watch) in enumerate(zip(rows, watches, strict=True)):
        bounded, kinked = _unresolved(row, watch, length, none)
        kinked[vague[k]] = 0
        found[k] = (bounded & ~vague[k])[step] or kinked[max(step - 1, 0) : step + 2].any()
    return found


def passed(
    rows: Array, watches: Sequence[Watch], step: int, length: float, vague: Flags
) -> Iterator[tuple[int, float]]:
    """Watched functions, by number, that have a kink or a jump in a step as they pass a number, and
    that number.

    Nothing where something else may hide there. Whole numbers come first, for where they are passed
    others jump. ``vague`` says which functions pass theirs by rounding.
    """
    bent = np.zeros(rows.shape[1] - 1, bool)
    others = [
        (row, watch)
        for row, watch, none in zip(rows, watches, vague, strict=True)
        if watch.kind not in (Kind.STEP, *_NUMBERED) and not none
    ]
    if any(_unresolved(row, watch, length, bent)[0][step] for row, watch in others):
        return
    for kinds in ((Kind.STEP,), _NUMBERED):
        for k, watch in enumerate(watches):
            low, high = sorted(rows[k, step : step + 2].tolist())
            kind = watch.kind
            if kind not in kinds or vague[k] or not math.isfinite(high - low):
                continue
            whole = (math.floor(high),) if math.floor(high) == math.floor(low) + 1 else ()
            yield from (
                (k, float(at))
                for at in (whole if kind is Kind.STEP else watch.at)
                if beyond(kind, low, at) < beyond(kind, high, at)
            )


def beyond(kind: Kind, value: float, at: float) -> bool:
    """Return whether an argument has passed a number."""
    return value >= at if kind is Kind.STEP else value > at


def _unresolved(
    row: Array, watch: Watch, step: float, bent: Flags
) -> tuple[Flags, npt.NDArray[np.intp]]:
    """Steps in which one of the watched functions is unresolved, and the number of its kinks in
    each step; it may have one itself in ``bent`` ones.
    """
    kind, none = watch.kind, np.zeros(row.size - 1, np.intp)
    if kind is Kind.RATE:
        return _either(np.abs(row) * step > RATE), none
    if kind is Kind.TURN:
        turned = np.diff(row)
        wide = np.abs(turned - math.tau * np.round(turned / math.tau)) > RATE
        return wide | _beside(wide), none
    a, b = row[:-1], row[1:]
    low, high = _between(row, bent)
    if kind in (Kind.POLE, Kind.ROOT):
        nearest = np.where(a > 0.0, low, -high)
        crossed = (a > 0.0) != (b > 0.0)
        if kind is Kind.ROOT:
            return np.zeros(none.size, bool), (crossed | (nearest < 0.0)).astype(np.intp)
        beyond = (np.isinf(a) | np.isinf(b)) & ~np.isinf(row).all()
        return beyond | crossed | (nearest < DIP * np.minimum(np.abs(a), np.abs(b))), none
    if kind in _NUMBERED:
        crossed, touched = passed_or_touched(np.sort(watch.at), a, b, low, high)
        return (
            (np.zeros(none.size, bool), crossed + touched)
            if kind is Kind.KNOT
            else (touched > 0, crossed)
        )
    if kind is Kind.STEP:
        first, last = np.floor(a), np.floor(b)
        beyond = (np.floor(high) > np.maximum(first, last)) | (
            np.floor(low) < np.minimum(first, last)
        )
        passed = np.abs(last - first)
        return beyond, np.where(np.isfinite(passed), np.minimum(passed, 2), 0).astype(np.intp)
    if kind is Kind.SOFT:
        reach = watch.at[0]
        first, last = np.minimum(a, b), np.maximum(a, b)
        reverses = (
            ((high > last + CHANGE) | (low < first - CHANGE)) & (low < reach) & (high > -reach)
        )
        return reverses, ((last - first > CHANGE) & (first < reach) & (last > -reach)).astype(
            np.intp
        )
    return (high > np.maximum(a, b) + RISE) & (
        high > np.max(row[~np.isnan(row)], initial=-np.inf) - NEGLIGIBLE
    ), none


def passed_or_touched(
    at: Array, a: Array, b: Array, low: Array, high: Array
) -> tuple[Numbers, Numbers]:
    """Number of the rising numbers ``at`` that an argument passes from ``a`` to ``b``, and of
    others that it may touch.

    It stays between ``low`` and ``high``. What is not a number passes as what is below all.
    """
    first, last = (np.searchsorted(at, np.where(np.isnan(end), -np.inf, end)) for end in (a, b))
    under, over = np.minimum(first, last), np.maximum(first, last)
    below = np.where(np.isnan(low), under, np.searchsorted(at, low, side="right"))
    above = np.where(np.isnan(high), over, np.searchsorted(at, high))
    return over - under, np.maximum(under - below, 0) + np.maximum(above - over, 0)


def _between(row: Array, bent: Flags) -> tuple[Array, Array]:
    """Bounds of an argument in every step.

    Unless it may have a kink there, one that bends little stays between its ends.
    """
    low, high = -highest(-row), highest(row)
    least, most = np.minimum(row[:-1], row[1:]), np.maximum(row[:-1], row[1:])
    straight = ~bent & (most - least >= STRAIGHT * ((high - most) + (least - low)))
    return np.where(straight, least, low), np.where(straight, most, high)


def _either(ends: Flags) -> Flags:
    return np.asarray(ends[:-1] | ends[1:])


def _beside(steps: Flags) -> Flags:
    found = np.zeros_like(steps)
    found[1:] |= steps[:-1]
    found[:-1] |= steps[1:]
    return found

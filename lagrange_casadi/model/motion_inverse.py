"""Times at which the motion of a drive is at given coordinates: laws of motion inverted, for many
values of the parameters at once.

Where the rate does not depend on time, the time follows by one subtraction and one division. Any
other law is followed from a time at which it is known, by steps in which the coordinate changes
little, until it passes what is looked for; Newton's method, held between the two last steps, then
finds the time to its last bits. A law that turns back on its way is not inverted.
"""

from __future__ import annotations

import enum
import functools
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.scalars import called, graph, inputs_of
from .one_sided_limits import Numbers, halved
from .sampled_laws import Laws

_SHARE = 1 / 32
"""Fraction of the distance by which the coordinate changes in a step."""

_FIRST, _LEAST = 1e-12, 1e-20
"""First step from where a law rests with neither rate nor acceleration, from which no time of its
own follows: a fraction of the time there, and seconds at the least. Steps double until the law
moves.
"""

_STEPS = 5000
"""Largest number of steps along a motion."""

_NEWTON, _TRIALS = 60, 200
"""Largest number of Newton steps for a time, and of trials in all; the rest are halvings."""

_ROUNDING = 16 * float(np.finfo(float).eps)
"""Relative rounding error of a coordinate."""

_RESTS = 1e-9
"""Fraction of the largest rate below which a rate of the wrong sign is rounding."""

_CAPACITY = 1 << 16
"""Number of times that are kept at once."""


class Missed(enum.IntEnum):
    """Reason why a coordinate has no time."""

    REACHED = 0
    STANDS_STILL = 1
    OTHER_WAY = 2
    TURNS_BACK = 3
    ENDS = 4
    NEVER = 5


@dataclass(frozen=True, eq=False)
class Passage:
    """The stretch of time in which motions go from one coordinate to another, for n values of the
    parameters, each (n,).

    ``first`` and ``last`` are its ends [s], NaN where ``missed`` says why there is none; ``t`` and
    ``d`` then are a time and the coordinate at which that is seen.
    """

    first: Array
    last: Array
    missed: Numbers
    t: Array
    d: Array


@dataclass(frozen=True, eq=False)
class MotionInverse:
    """A law of motion to be inverted: ``law(t, p)`` is a column of coordinate, rate and
    acceleration, defined within ``span`` [s].

    ``steady`` says that its rate does not depend on time, ``varies`` that the law depends on
    parameters.
    """

    law: ca.Function
    steady: bool
    varies: bool
    span: tuple[float, float]

    @classmethod
    @functools.lru_cache(maxsize=64)
    def of(cls, laws: Laws, joint: str) -> MotionInverse:
        """Return the law of a drive, to be inverted."""
        one = laws.only([joint])
        given = inputs_of(one.motion)
        d, rate, bend = one.motion(*given.values())
        law = graph("law", given, law=ca.vertcat(d, rate, bend))
        steady = not (one.knots[0] or ca.depends_on(rate, given["t"]))
        varies = bool(given["p"].numel()) and bool(ca.depends_on(d, given["p"]))
        return cls(law, steady, varies, one.spans[0])

    def at(self, t: Array, p: Array) -> Array:
        """Coordinate, rate and acceleration (3, n, k) at times (n, k) for parameters (n,
        parameters).
        """
        found = called(self.law, t.reshape(1, -1), np.repeat(p, t.shape[1], axis=0).T)
        return found.reshape(3, *t.shape)

    def passage(
        self, start: Array, stop: Array, p: Array, around: Array, *, samples: int
    ) -> Passage:
        """Times at which the motion goes from ``start`` to ``stop``, (n,), all the way in one
        direction.

        ``p`` is (n, parameters). A law that is not steady is followed from the times ``around``
        (n,) [s], or from where it is defined; ``samples`` times between show that it does not turn
        back.
        """
        parts = []
        for some in _parts(np.arange(len(p)), samples):
            given = start[some], stop[some], p[some]
            parts.append(
                self._steady(*given)
                if self.steady
                else self._followed(*given, around[some], samples)
            )
        first, last, missed, t, d = map(np.concatenate, zip(*parts, strict=True))
        bad = missed != Missed.REACHED
        return Passage(np.where(bad, np.nan, first), np.where(bad, np.nan, last), missed, t, d)

    def times(self, passage: Passage, targets: Array, p: Array) -> Array:
        """The times (n, k) at which the motion is at ``targets`` (n, k), from the start of a way to
        its end; NaN without one.
        """
        found = np.full(targets.shape, np.nan)
        for some in _parts(np.flatnonzero(passage.missed == Missed.REACHED), targets.shape[1]):
            if self.steady:
                d, rate, _ = self.at(np.zeros((some.size, 1)), p[some])
                found[some] = (targets[some] - d) / rate
            else:
                ends = passage.first[some], passage.last[some]
                found[some] = self._between(*ends, targets[some], p[some])
        return found

    def _steady(self, start: Array, stop: Array, p: Array) -> tuple[Any, ...]:
        """Ends of a way, why there is none, and where that is seen: as of a :class:`Passage`."""
        zero = np.zeros((len(p), 1))
        d, rate, _ = self.at(zero, p)[..., 0]
        with np.errstate(all="ignore"):
            first, last = (start - d) / rate, (stop - d) / rate
        reached = np.isfinite(first) & np.isfinite(last)
        why = [rate == 0.0, np.sign(stop - start) * rate < 0.0, ~reached]
        missed = np.select(why, [Missed.STANDS_STILL, Missed.OTHER_WAY, Missed.NEVER])
        return first, last, missed, zero[:, 0], d

    def _followed(
        self, start: Array, stop: Array, p: Array, around: Array, samples: int
    ) -> tuple[Any, ...]:
        """As :meth:`_steady`, of a law that is not steady."""
        sense, rows = np.sign(stop - start), np.arange(len(p))
        way, ways, begun = (np.tile(x, 2) for x in (np.abs(stop - start), sense, around))
        reached = self._reached(np.append(start, stop), way, ways, begun, np.tile(p, (2, 1)))
        (first, last), why, at, there = (x.reshape(2, -1) for x in reached)
        which = np.where(why[0] == Missed.REACHED, 1, 0)
        missed, t, d = (x[which, rows] for x in (why, at, there))
        grid = first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, samples)
        values, rates, _ = self.at(grid, p)
        with np.errstate(all="ignore"):
            back = sense[:, None] * rates < -_RESTS * np.abs(rates).max(axis=1, keepdims=True)
            rounding = _ROUNDING * np.abs(values).max(axis=1, keepdims=True)
            back[:, 1:] |= ~(sense[:, None] * np.diff(values) >= -rounding)
        turned, places = back.any(axis=1) & (missed == Missed.REACHED), np.argmax(back, axis=1)
        missed = np.where(turned, Missed.TURNS_BACK, missed)
        t, d = np.where(turned, grid[rows, places], t), np.where(turned, values[rows, places], d)
        return first, last, missed, t, d

    def _reached(
        self, target: Array, passage: Array, sense: Array, around: Array, p: Array
    ) -> tuple[Array, Numbers, Array, Array]:
        """Time at which the motion through its place at ``around`` is at a target; or the reason
        why there is none, and its time.
        """
        low, high = self.span
        here = np.clip(around, low, high)
        d, rate, bend = self.at(here[:, None], p)[..., 0]
        rounding = _ROUNDING * np.maximum(np.maximum(np.abs(target), np.abs(d)), passage)
        onward = np.where(sense * (target - d) >= 0.0, 1.0, -1.0)
        share = _SHARE * np.maximum(passage, np.abs(target - d))
        step = _step(rate, bend, share, np.full(here.size, np.inf))
        step = np.where(np.isfinite(step), step, np.maximum(_FIRST * np.abs(here), _LEAST))
        missed = np.where(np.isfinite(d), Missed.REACHED, Missed.NEVER)
        there = d == target
        visited, at, held = here.copy(), d.copy(), np.array([here, here])
        for _ in range(_STEPS):
            going = np.flatnonzero(~there & (missed == Missed.REACHED))
            if not going.size:
                break
            with np.errstate(over="ignore"):
                now = np.clip(here[going] + onward[going] * step[going], low, high)
                was = here[going]
            found, speed, bent = self.at(now[:, None], p[going])[..., 0]
            ahead = onward[going] * sense[going]
            passed = ahead * (found - target[going]) >= 0.0
            turned = ~passed & (
                (ahead * (found - d[going]) < -rounding[going]) | (sense[going] * speed < 0.0)
            )
            lost = ~np.isfinite(found) | ~np.isfinite(now)
            ended = ~passed & (now == was)
            visited[going], at[going], some = now, found, turned & ~lost
            which = going[some]
            visited[which], at[which] = self._turning(was[some], now[some], sense[which], p[which])
            near = np.abs(at[going] - target[going]) <= rounding[going]
            stays = np.abs(d[going] - target[going]) <= rounding[going]
            # A target at which the motion rests is met where it comes to rest.
            reached = (turned & near) | ((ended | lost) & stays)
            ends = np.where(passed, [was, now], held[:, going])
            held[:, going] = np.where(reached, np.where(turned, visited[going], was), ends)
            there[going] = (passed & ~lost) | reached
            missed[going] = np.select(
                [there[going], lost, ended, turned],
                [Missed.REACHED, Missed.NEVER, Missed.ENDS, Missed.TURNS_BACK],
            )
            here[going], d[going] = now, found
            with np.errstate(over="ignore"):
                step[going] = _step(speed, bent, share[going], 2.0 * step[going])
        missed[~there & (missed == Missed.REACHED)] = Missed.NEVER
        begin, end = np.sort(held, axis=0)[..., None]
        time = self._solved(target[:, None], begin, end, begin, sense[:, None], p)[:, 0]
        first_way = (missed == Missed.TURNS_BACK) & (visited == np.clip(around, low, high))
        missed[first_way] = Missed.OTHER_WAY
        return np.where(missed == Missed.REACHED, time, np.nan), missed, visited, at

    def _turning(self, was: Array, now: Array, sense: Array, p: Array) -> tuple[Array, Array]:
        """Time of reversal between two times, and the coordinate there."""

        def onward(share: Array) -> Flags:
            rate = self.at((was + share * (now - was))[:, None], p)[1, :, 0]
            return np.asarray(sense * rate > 0.0)

        near = was + halved(onward, np.zeros(was.size), np.ones(was.size))[0] * (now - was)
        return near, self.at(near[:, None], p)[0, :, 0]

    def _between(self, first: Array, last: Array, targets: Array, p: Array) -> Array:
        """The times at targets (n, k) between the ends of a way, from a table of the motion."""
        count, sense = targets.shape[1], np.sign(targets[:, -1:] - targets[:, :1])
        grid = first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, count)
        grid[:, -1] = last
        values = sense * self.at(grid, p)[0]
        values = np.maximum.accumulate(values, axis=1)
        each = zip(values, sense * targets, strict=True)
        place = np.array([np.searchsorted(row, u) for row, u in each], int).reshape(targets.shape)
        place = np.clip(place, 1, count - 1)
        rows = np.arange(len(p))[:, None]
        lower, upper = grid[rows, place - 1], grid[rows, place]
        rise = values[rows, place] - values[rows, place - 1]
        with np.errstate(all="ignore"):
            share = np.clip(
                np.nan_to_num((sense * targets - values[rows, place - 1]) / rise), 0.0, 1.0
            )
        found = self._solved(targets, lower, upper, lower + share * (upper - lower), sense, p)
        found[:, 0], found[:, -1] = first, last
        d, rate, _ = self.at(found, p)
        off = np.abs(d - targets) - np.abs(rate) * 4 * np.spacing(np.abs(found))
        sound = off <= _ROUNDING * np.maximum(
            np.abs(values).max(axis=1, keepdims=True), np.abs(targets)
        )
        found[~(sound.all(axis=1) & (np.diff(found) > 0.0).all(axis=1))] = np.nan
        return found

    def _solved(
        self, targets: Array, lower: Array, upper: Array, t: Array, sense: Array, p: Array
    ) -> Array:
        """The times at targets between others, all (n, k): Newton's method, and halving where that
        leaves them or takes long.
        """
        count = targets.shape[1]
        rows = np.repeat(np.arange(len(p)), count)
        sign, aim = np.broadcast_to(sense, targets.shape).ravel(), targets.ravel()
        low, high, now = (np.array(x, float).ravel() for x in (lower, upper, t))
        best, least, going = now.copy(), np.full(now.size, np.inf), np.arange(now.size)
        for trial in range(_TRIALS):
            d, rate, _ = self.at(now[going, None], p[rows[going]])[..., 0]
            miss = sign[going] * (d - aim[going])
            better = np.abs(miss) < least[going]
            best[going] = np.where(better, now[going], best[going])
            least[going] = np.where(better, np.abs(miss), least[going])
            low[going] = np.where(miss <= 0.0, now[going], low[going])
            high[going] = np.where(miss >= 0.0, now[going], high[going])
            with np.errstate(all="ignore"):
                new = now[going] - miss / (sign[going] * rate)
            halve = ~((new >= low[going]) & (new <= high[going])) | (trial >= _NEWTON)
            new = np.where(halve, low[going] + (high[going] - low[going]) / 2, new)
            stays = (
                (miss == 0.0)
                | ~np.isfinite(miss)
                | (np.abs(new - now[going]) <= 2 * np.spacing(np.abs(new)))
            )
            now[going] = new
            going = going[~stays]
            if not going.size:
                break
        d = self.at(now[:, None], p[rows])[0, :, 0]
        return np.where(np.abs(d - aim) < least, now, best).reshape(targets.shape)


def _parts(which: Numbers, count: int) -> list[Numbers]:
    """Numbers of designs, in parts of which so many times each are kept; one part at least."""
    size = max(1, _CAPACITY // count)
    return [which[k : k + size] for k in range(0, max(which.size, 1), size)]


def _step(rate: Array, bend: Array, share: Array, most: Array) -> Array:
    """Seconds in which a coordinate changes by about ``share``; at ``most`` so many."""
    with np.errstate(all="ignore"):
        seconds = 2.0 * share / (np.abs(rate) + np.sqrt(rate**2 + 2.0 * np.abs(bend) * share))
    return np.where(seconds < most, seconds, most)

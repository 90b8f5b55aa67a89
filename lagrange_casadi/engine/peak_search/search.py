"""The largest size of curves over all times of a span, by their values at equal steps, and at more
times where these leave it open.

A panel is a row of equal steps with the values at their ends. In each step :mod:`.between` bounds
every curve. What could rise above the largest size so far is looked at: a polynomial through seven
values around a summit says where, and what it misses there says whether it is to be believed. A
step that this leaves open, or in which something may hide, becomes a panel of its own, or two where
it is known when in it a kink or a jump is, of steps a ninth as long, and so on, until all are
closed, or so short that nothing but a jump, a kink or a pole is left in them. Where that takes too
many panels, or a quantity keeps growing slowly, its peak is not reported.

Where friction at rest leaves a curve open at an instant, the steps beside it are searched by
themselves from where, or up to where, it is a number.

The C does the same (``engine/codegen/search.c`` and its neighbours), and is tested against this,
which serves where no compiler is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ...base.arrays import Array
from . import fits
from .between import NOISE, QUIET, Flags, highest, reach, shaken, unresolved
from .intervals import (
    INNER,
    SIDE,
    SPACING,
    Candidate,
    Curves,
    CurveSource,
    Interval,
    Listed,
    Peaks,
    Samples,
    joined,
    sides,
)
from .listing import Counted, Tops, base_of
from .switches import Switches

DEEPEST = 14
"""Panels within each other: the last one's steps are 4e-14 of those between the instants."""

FINEST = 10
"""Panels within each other: in steps of this one, 3e-10 of those between the instants, nothing
hides but beside a pole.
"""

BESIDE_REST = 3
"""Panels within each other beside an instant at which friction at rest leaves a curve open."""

INTERVALS = 2048
"""Panels of a search, and four more for each instant."""

ROUNDING = 1e-13
"""Relative error of a peak that is worth no further refinement."""

BESIDE = 1e-2
"""Fraction of a unit's largest size that counts as a quantity's own size for its rounding."""

NOTHING = 1e-12
"""Relative size, of the largest of a unit, that is zero within rounding."""

TRUST, TRUST_ASIDE = 1e-5, 1e-6
"""Largest relative error of a polynomial, in its middle and near its ends: if it is larger, the
slope may have other errors as well.
"""

CLOSE = 8 * float(np.finfo(float).eps)
"""Rounding of a value, relative to its largest size."""

STRETCH = 1e-4
"""Largest error of a polynomial in the middle of an end step, relative to its least slope there,
which is then off by nine times that.
"""

ENDLESS, LAST = 0.1, 1e-11
"""Relative growth of a quantity over the last step towards a pole, and the growth at which it has
come to its end.
"""

RAGGED = 0.3
"""Relative second differences of values that are nothing but rounding."""

ROUGH = 0.1
"""Largest relative sixth difference of a polynomial that is believed."""


def peaks(
    source: CurveSource,
    curves: Curves,
    t: Array,
    samples: Samples,
    hiding: Flags,
    listed: Listed | None = None,
    sampled: bool = False,
) -> Peaks:
    """The peaks of quantities over the span of equally spaced instants ``t``, of which ``samples``
    are.

    ``hiding`` (n - 1,) marks the steps in which samples are known to miss something. No peak is
    below the largest sample. Of several peaks that are equal within rounding the first is reported;
    otherwise rounding would choose the sign. A quantity that is NaN at all instants, because of
    friction at rest, has no peak. ``listed`` says which local peaks are reported too. ``sampled``
    peaks are those at the instants, with an error.
    """
    base, direction = np.zeros(len(curves.units)), listed.sign if listed else 0
    if direction:
        base = base_of(np.array(curves.quantities), direction * samples.values, base.size)
        source = Counted(source, direction, base[list(curves.quantities), None])
        samples = source.counted(samples)
    given, lacks = samples, np.isnan(samples.values)
    samples = samples._replace(values=np.where(lacks, 0.0, samples.values))
    search = _Search(source, curves, t, samples, lacks[:, :-1] | lacks[:, 1:], listed)
    interval, error = Interval(t, samples), None
    if sampled:
        error = search.error(interval, hiding)
    elif t.size > 1:
        search.interval(interval, 0, hiding)
    found = search.found(t, given)
    none = np.full(found.value.size, np.nan)
    none[search.quantity[~lacks.all(axis=1)]] = 0.0
    value, tops = found.value + none, None
    if listed:
        least, rounding = search.least[search.quantity], search.rounding[search.quantity]
        tops = search.tops.listing(t, given, least, search.limit, rounding)
    if tops is not None and direction:
        tops[tops[..., 3] < 0.0] = np.nan
        value, tops[..., 3] = direction * (value + base), direction * (tops[..., 3] + base[:, None])
    error = None if error is None else error + none
    return Peaks(value, found.t + none, found.xi + none, found.resolved, tops, error)


class _Search:
    """State of a search for each quantity: its largest size, and the place where one as large was
    found first.
    """

    def __init__(
        self,
        source: CurveSource,
        curves: Curves,
        t: Array,
        samples: Samples,
        lacking: Flags,
        listed: Listed | None,
    ) -> None:
        self.lacking, self.begin = lacking, float(t[0])
        self.share = listed.share if listed else None
        self.source, self.curves = source, curves
        self.quantity, self.knots = np.array(curves.quantities, dtype=int), np.array(curves.knots)
        self.best = np.zeros(len(curves.units))
        np.maximum.at(self.best, self.quantity, np.abs(samples.values).max(axis=1))
        scales = np.zeros(max(curves.units) + 1)
        np.maximum.at(scales, np.array(curves.units), self.best)
        scales[: len(curves.scales)] = np.fmax(scales[: len(curves.scales)], curves.scales)
        self.scale = scales[list(curves.units)]
        self.size, self.t, self.xi, self.sign = (
            np.full(self.best.size, x) for x in (-1.0, np.inf, np.nan, 1.0)
        )
        self.resolved, self.going = np.ones(self.best.size, bool), np.zeros(self.best.size)
        self.samples, self.hidden = samples.values, 0
        self.switches = Switches(source, curves, t, samples.watched)
        self.step = float(t[-1] - t[0]) / max(t.size - 1, 1)
        self.budget = self.quota = INTERVALS + 4 * t.size
        self.tops = Tops(self.quantity, self.best.size, self.step)

    @property
    def rounding(self) -> Array:
        """Size of rounding of each quantity."""
        return ROUNDING * (self.best + BESIDE * self.scale)

    @property
    def least(self) -> Array:
        """Least size of a maximum of each quantity that matters."""
        return np.asarray(
            self.best - self.rounding if self.share is None else self.share * self.best
        )

    @property
    def limit(self) -> Array:
        """Limit above which each curve matters; none for a curve that is nothing beside others of
        its unit, or of which the search has ended.
        """
        limit = np.where(
            (self.best > NOTHING * self.scale) & self.resolved,
            self.best + self.rounding if self.share is None else self.least,
            np.inf,
        )
        return np.asarray(limit[self.quantity])

    def ends(self, values: Array) -> Array:
        """Limit of each curve in each step: both its ends."""
        sizes = np.abs(values)
        return np.asarray(
            np.maximum(sizes[:, :-1], sizes[:, 1:]) + self.rounding[self.quantity, None]
        )

    def note(self, curve: int, value: float, t: float, xi: float) -> None:
        """Take in what a curve is at a time; what is nothing has its peak at an instant."""
        q, size = self.quantity[curve], abs(value)
        rounding = float(self.rounding[q])
        if not math.isfinite(size) or self.lacks(t)[curve]:
            return
        if self.share is not None and size >= self.least[q]:
            self.tops.add(curve, value, t, xi)
        if size > self.best[q]:
            self.best[q] = size
            taken = not (self.size[q] >= size - rounding and self.t[q] < t - self.step / 2)
        else:
            there = self.best[q] > NOTHING * self.scale[q]
            taken = there and size >= self.best[q] - rounding and t < self.t[q] - self.step / 2
        if taken:
            self.size[q] = size
            self.t[q] = t
            self.xi[q] = xi
            self.sign[q] = math.copysign(1.0, value)

    def note_all(self, t: Array, samples: Samples) -> None:
        """Take in what all curves are at some times."""
        counts = self.switches.counts(t, samples.watched)[self.quantity]
        for j, time in enumerate(t):
            for curve in np.flatnonzero(counts[:, j]).tolist():
                self.note(curve, samples.values[curve, j], time, samples.places[curve, j])

    def toward_ends(self, interval: Interval, vague: Flags, rounded: Flags) -> None:
        """Sample ever closer to both ends of steps in a row in which a watched function switches
        by rounding: what it switches is largest at one of them.
        """
        for row, switches in zip(
            vague[~self.switches.ignored], rounded[~self.switches.ignored], strict=True
        ):
            ends = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
            for first, last in ends.reshape(-1, 2).tolist():
                if switches[first:last].any():
                    a, b = interval.t[[first, last]]
                    steps = (b - a) / (INNER + 1.0) ** np.arange(1, INNER + 1)
                    t = np.concatenate([a + steps, b - steps])
                    self.note_all(t, self.source.at(t))

    def lacks(self, t: float) -> Flags:
        """Curves that are not sought at a time: in steps beside rest those that are indeterminate
        there are left out.
        """
        return np.asarray(
            self.lacking[
                :, int(min(max((t - self.begin) // self.step, 0), self.lacking.shape[1] - 1))
            ]
        )

    def found(self, t: Array, samples: Samples) -> Peaks:
        """The peaks; of those at instants, only now the first is sought, among those at which there
        is a number.
        """
        for q in np.flatnonzero(np.isfinite(self.best)):
            rows, least = np.flatnonzero(self.quantity == q), self.best[q] - self.rounding[q]
            sizes = np.nan_to_num(np.abs(samples.values[rows]), nan=-1.0, posinf=np.inf)
            i = int(np.argmax((sizes >= least).any(axis=0)))
            row = int(rows[np.argmax(sizes[:, i])])
            if sizes[:, i].max() >= least and (
                self.size[q] < least or t[i] < self.t[q] - self.step / 2
            ):
                self.t[q] = t[i]
                self.xi[q] = samples.places[row, i]
                self.sign[q] = math.copysign(1.0, samples.values[row, i])
        resolved = (self.resolved & (self.going <= self.best / 2)) | np.isinf(self.best)
        return Peaks(np.copysign(self.best, self.sign), self.t, self.xi, resolved)

    def error(self, interval: Interval, hiding: Flags) -> Array:
        """Return how much larger each quantity may be between instants than at them; infinite where
        something may hide there.
        """
        values, nothing = interval.samples.values, NOTHING * self.scale
        if interval.t.size == 1:
            return np.where(self.best > nothing, self.rounding, nothing)
        if interval.t.size < fits.SEVEN:
            return np.full(self.best.size, np.inf)
        watched, watches = interval.samples.watched, self.curves.watches
        if (
            hiding | unresolved(watched, watches, interval.step, self.switches.vague(watched))[0]
        ).any():
            return np.full(self.best.size, np.inf)
        furthest = self.best.copy()
        np.maximum.at(furthest, self.quantity, reach(values).max(axis=1))
        return np.where(self.best > nothing, furthest - self.best + self.rounding, nothing)

    def interval(self, interval: Interval, depth: int, hiding: Flags) -> None:
        """Search a panel; in ``hiding`` steps something is known to hide."""
        n, values = interval.t.size, interval.samples.values
        if n < fits.SEVEN:
            hiding, bound = np.ones(n - 1, bool), np.full((values.shape[0], n - 1), -np.inf)
        else:
            kinks = np.histogram(self.knots, interval.t)[0] if depth and self.knots.size else None
            watched, watches = interval.samples.watched, self.curves.watches
            vague = self.switches.vague(watched)
            unseen, kinked, rounded = unresolved(
                watched, watches, interval.step, vague, kinks, depth >= FINEST
            )
            hiding = hiding | unseen
            if depth < FINEST:
                self.toward_ends(interval, vague, rounded)
            bound = np.fmax(highest(values), highest(-values))
            closed = (vague.T @ self.curves.depending).T[self.quantity]
            bound[closed | (bound <= self.ends(values))] = -np.inf
            self.hidden += np.count_nonzero(hiding) if depth == 0 else 0
            self.stretches(interval, bound, hiding | kinked)
            self.settle(interval, bound)
            bound[closed] = -np.inf
            unsettled = (bound > self.limit[:, None]).any(axis=1)
            bound[
                [curve for curve in np.flatnonzero(unsettled).tolist() if self.rounded(curve)]
            ] = -np.inf
        size = np.fmax(self.best, np.finfo(float).tiny)[self.quantity]
        while True:
            rise = np.fmax.reduce((bound - self.limit[:, None]) / size[:, None], axis=0)
            step = int(np.argmax(rise if rise.max() > 0.0 else hiding))
            if not (rise[step] > 0.0 or hiding[step]):
                return
            risen = bound[:, step] > self.limit
            if not risen.any() and self.switches.is_ignored(interval, step):
                hiding[step] = False
            elif depth == DEEPEST or interval.step <= SPACING * np.abs(interval.t).max():
                self.end(interval, step, risen, depth == DEEPEST)
            elif self.budget > 0:
                self.budget -= 1
                if depth == 0:
                    self.switches.measure(step)
                self.inside(interval, step, depth)
                self.switches.step = self.switches.step if depth else -1
            else:
                self.give_up(interval, step, risen, bool(hiding[step]))
            hiding[step], bound[:, step] = False, -np.inf

    def give_up(self, interval: Interval, step: int, risen: Flags, hides: bool) -> None:
        """End the search of the quantities for which a step takes too many panels, and ignore the
        functions that hide something there; half as many panels are left for other quantities.
        """
        found = self.switches.hiding_at(interval, step) & hides
        self.switches.ignored |= found
        ended = self.curves.depending[found].any(axis=0) if found.any() else hides
        self.resolved[ended | np.isin(np.arange(self.resolved.size), self.quantity[risen])] = False
        self.quota //= 2
        self.budget = self.quota

    def inside(self, interval: Interval, step: int, depth: int) -> None:
        """Search a step as a panel of its own, or as two if it is known where in it a kink or a
        jump is.
        """
        start, stop = interval.t[step], interval.t[step + 1]
        first = interval.samples.some(slice(step, step + 1))
        last = interval.samples.some(slice(step + 1, step + 2))
        beside = SIDE * self.step
        vague = self.switches.vague(interval.samples.watched)[:, step]
        found = sides(self.source, interval, step, self.curves.watches, beside, vague)
        if found is None:
            self.part(start, stop, first, last, depth)
            return
        t, samples = found
        self.note_all(t, samples)
        self.budget -= 1
        if t[0] - start > 2 * beside:
            self.part(start, t[0], first, samples.some(slice(0, 1)), depth)
        if stop - t[1] > 2 * beside:
            self.part(t[1], stop, samples.some(slice(1, 2)), last, depth)

    def part(self, a: float, b: float, first: Samples, last: Samples, depth: int) -> None:
        """Search what is between two times as a panel; beside rest, where what switches is no
        number, only so deep.
        """
        lacks = self.lacks((a + b) / 2)
        if depth >= BESIDE_REST and lacks.any():
            return
        t = np.append(a + np.arange(INNER + 1) * ((b - a) / (INNER + 1)), b)
        samples = self.source.at(t[1:-1])
        # What has no value is nothing, and hides what is beside it.
        values, places, watched = joined(first, samples, last)
        values[lacks] = 0.0
        broken = np.asarray(~np.isfinite(values).all(axis=0))
        values = np.where(np.isfinite(values), values, 0.0)
        counts = self.switches.counts(t, watched)[self.quantity, 1:-1]
        for curve in range(values.shape[0]):
            known = (self.best if self.share is None else self.least)[self.quantity[curve]]
            for j in np.flatnonzero((np.abs(values[curve, 1:-1]) > known) & counts[curve]) + 1:
                self.note(curve, values[curve, j], t[j], places[curve, j])
        self.interval(
            Interval(t, Samples(values, places, watched)), depth + 1, broken[:-1] | broken[1:]
        )

    def end(self, interval: Interval, step: int, risen: Flags, deepest: bool) -> None:
        """End the search in a step of the shortest length: at a kink, a jump, or growth without an
        end.
        """
        for curve in np.flatnonzero(risen):
            q, row, endless = self.quantity[curve], interval.samples.values[curve], -1
            for at, along in ((step, -1), (step + 1, 1), (step, 1), (step + 1, -1)):
                near = at + along * np.arange(3)
                if near.min() < 0 or near.max() >= row.size:
                    continue
                # Towards a pole both steps grow, of two beside this one or of this one and the
                # next; at a jump at most one does.
                sizes = np.abs(row[near])
                growth = sizes[:2] - sizes[1:]
                if (
                    sizes[0] >= self.best[q] / 2
                    and sizes[2] > NOISE * sizes[0]
                    and (growth > ENDLESS * sizes[:2]).all()
                ):
                    endless = at
                beside = (at == step) == (along < 0)
                if (
                    beside
                    and deepest
                    and sizes[0] >= self.best[q] / 2
                    and (growth > LAST * self.best[q]).all()
                ):
                    self.going[q] = max(self.going[q], sizes[0])
            if endless >= 0:
                self.best[q] = np.inf
                self.t[q] = interval.t[endless]
                self.xi[q] = interval.samples.places[curve, endless]
                self.sign[q] = math.copysign(1.0, row[endless])

    def stretches(self, interval: Interval, bound: Array, kinked: Flags) -> None:
        """Look at the middles of the end steps, where polynomials go through them straight on, and
        close those that do.
        """
        t, n = interval.t, interval.t.size
        for step, end in (
            (0, slice(0, fits.SEVEN)),
            (n - 2, slice(n - 1, n - fits.SEVEN - 1 if n > fits.SEVEN else None, -1)),
        ):
            if kinked[step] or ((self.knots > t[step]) & (self.knots < t[step + 1])).any():
                continue
            curves = np.flatnonzero(bound[:, step] > self.limit)
            y = interval.samples.values[curves][:, end].T
            middle, least = fits.stretch(y)
            rounding = self.rounding[self.quantity[curves]]
            straight = (least > 0.0) & (
                np.abs(np.diff(y, 6, axis=0))[0] <= rounding + ROUGH * least
            )
            if not straight.any():
                continue
            time = (t[step] + t[step + 1]) / 2
            values, places, watched = self.source.at(np.array([time]))
            counts = self.switches.counts(np.array([time]), watched)[self.quantity, 0]
            straight &= counts[curves]
            for curve in curves[straight].tolist():
                self.note(curve, values[curve, 0], time, places[curve, 0])
            passed = straight & (
                np.abs(values[curves, 0] - middle) <= np.maximum(rounding, STRETCH * least)
            )
            bound[curves[passed], step] = -np.inf

    def settle(self, interval: Interval, bound: Array) -> None:
        """Look for the summits of curves that may rise above what is known; what this closes is
        bounded no more.
        """
        candidates = list(self.candidates(interval, bound))
        opened = [candidate for candidate in candidates if not candidate.closed]
        found = self.sample(
            [
                (candidate, t)
                for candidate in opened
                for t in (candidate.t, *(t for t, _ in candidate.kink))
            ]
        )
        for candidate in opened:
            first, kink = next(found), [abs(next(found) - size) for _, size in candidate.kink]
            tipped = bool(kink) and np.max(kink) <= self.rounding[self.quantity[candidate.curve]]
            candidate.closed = self.closed(interval, candidate, first) or tipped
        again = [candidate for candidate in opened if candidate.again and not candidate.closed]
        for candidate, size in zip(
            again, self.sample([(candidate, candidate.t) for candidate in again]), strict=True
        ):
            missed = abs(size - candidate.size)
            rounding = self.rounding[self.quantity[candidate.curve]]
            # What was missed now bends the slope in turn.
            candidate.closed = (
                missed <= rounding
                or 10 * missed**2 * (1 + candidate.steep**2) <= -candidate.bend * rounding
            )
        for candidate in candidates:
            if candidate.closed:
                bound[candidate.curve, max(candidate.at - 1, 0) : candidate.at + 1] = -np.inf
            else:
                for t in (candidate.t, *(t for t, _ in candidate.kink)):
                    bound[
                        candidate.curve,
                        np.clip(
                            np.searchsorted(interval.t, t, side="right") - 1, 0, interval.t.size - 2
                        ),
                    ] = np.inf

    def candidates(self, interval: Interval, bound: Array) -> Iterator[Candidate]:
        """The summits of curves that may rise above what is known."""
        found: list[tuple[int, int]] = []
        n = interval.t.size
        for curve in np.flatnonzero((bound > self.limit[:, None]).any(axis=1)).tolist():
            row, limit = interval.samples.values[curve], self.limit[curve]
            sizes, ends = np.abs(row), self.ends(interval.samples.values)[curve]
            bound[curve, self.known_before(interval.samples.values, curve)] = -np.inf
            for step in np.flatnonzero(bound[curve] > limit).tolist():
                if bound[curve, step] <= max(limit, ends[step]) + self.noise(curve, row, step):
                    bound[curve, step] = -np.inf
                    continue
                for at in (step, step + 1):
                    top = (at == 0 or sizes[at - 1] < sizes[at]) and (
                        at == n - 1 or sizes[at] >= sizes[at + 1]
                    )
                    if top and (curve, at) not in found[-1:]:
                        found.append((curve, at))
        if not found:
            return
        signs = [math.copysign(1.0, interval.samples.values[curve, at]) for curve, at in found]
        firsts = [fits.window(at, n) for _, at in found]
        ys = [
            interval.samples.values[curve, first : first + fits.SEVEN]
            for (curve, _), first in zip(found, firsts, strict=True)
        ]
        ys = [sign * y for sign, y in zip(signs, ys, strict=True)]
        fit = fits.vertices(
            np.stack(ys, axis=1), *np.transpose([fits.bounds(at, n) for _, at in found])
        )
        for k, (curve, at) in enumerate(found):
            x, size, slope, bend, steep, rough = (float(values[k]) for values in fit)
            start, q = interval.t[firsts[k]], self.quantity[curve]
            trust = TRUST if abs(x) < 2.0 else TRUST_ASIDE
            kink = fits.kink(ys[k]) if firsts[k] == at - fits.SEVEN // 2 else []
            times = [(float(interval.t[at] + interval.step * place), tip) for place, tip in kink]
            t = float(start + interval.step * (x + fits.SEVEN // 2))
            candidate = Candidate(
                curve, at, signs[k], t, size, slope, bend, steep, rough, trust, times
            )
            candidate.closed = (
                bend < 0.0 and rough <= -ROUGH * bend and size + rough < self.least[q]
            )
            yield candidate

    def known_before(self, values: Array, curve: int) -> Flags:
        """Steps in which a curve equals others of its quantity all around: as one that turns only
        beyond its link's end.
        """
        others = np.flatnonzero(self.quantity[:curve] == self.quantity[curve])
        same = np.ones(values.shape[1] + 2, bool)
        same[1:-1] = (
            np.abs(values[others] - values[curve]) <= self.rounding[self.quantity[curve]]
        ).any(axis=0)
        return np.asarray(same[:-3] & same[1:-2] & same[2:-1] & same[3:])

    def noise(self, curve: int, row: Array, step: int) -> float:
        """Rounding error of a curve's values beside a step."""
        off, q = shaken(row, step), self.quantity[curve]
        return off if off <= 3 * NOISE * (self.best[q] + BESIDE * self.scale[q]) else 0.0

    def rounded(self, curve: int) -> bool:
        """Return whether a curve is nothing but rounding: it zigzags at the instants, though
        between most of them nothing hides.
        """
        row = self.samples[curve]
        if row.size < 2 * QUIET or 2 * self.hidden > row.size:
            return False
        bends, sizes = np.diff(row, 2), np.abs(row)
        ragged = np.abs(bends) > RAGGED * np.fmax(sizes[1:-1], np.fmax(sizes[:-2], sizes[2:]))
        reversals = ragged[:-1] & ragged[1:] & ((bends[:-1] > 0.0) != (bends[1:] > 0.0))
        return bool(2 * np.count_nonzero(reversals) >= row.size)

    def sample(self, places: Sequence[tuple[Candidate, float]]) -> Iterator[float]:
        """The sizes of curves where they are looked at; NaN for what does not count."""
        if not places:
            return
        times = np.array([t for _, t in places])
        values, ratios, watched = self.source.at(times)
        counts = self.switches.counts(times, watched)[self.quantity]
        for k, (candidate, t) in enumerate(places):
            curve = candidate.curve
            if not counts[curve, k]:
                yield math.nan  # which closes nothing
                continue
            self.note(curve, values[curve, k], t, ratios[curve, k])
            yield candidate.sign * values[curve, k]

    def closed(self, interval: Interval, candidate: Candidate, found: float) -> bool:
        """Return whether a result closes both steps beside a maximum; else, if it is worth another
        sample, its place.
        """
        rounding = float(self.rounding[self.quantity[candidate.curve]])
        missed = found - candidate.size
        if not (candidate.bend < 0.0 and candidate.rough <= rounding - ROUGH * candidate.bend):
            return False
        if not (abs(missed) <= rounding or abs(missed) <= -candidate.trust * candidate.bend):
            return False
        # What is missed by rounding says nothing of the slope, however near a value is.
        slope = candidate.slope + (
            missed * candidate.steep
            if abs(missed) > CLOSE * self.best[self.quantity[candidate.curve]]
            else 0.0
        )
        gain = slope**2 / (-2 * candidate.bend)
        if not math.isfinite(slope) or gain <= rounding:
            return True
        # At an end from which it falls there is nothing more to find.
        if (candidate.at == 0 and slope < 0.0) or (
            candidate.at == interval.t.size - 1 and slope > 0.0
        ):
            return bool(
                found < candidate.sign * interval.samples.values[candidate.curve, candidate.at]
            )
        if abs(slope) > -candidate.bend:
            return False
        candidate.again = True
        candidate.t -= interval.step * slope / candidate.bend
        candidate.size = found + gain
        return False

"""The search for peaks by itself, on drawn curves whose peaks many more times show: what the search
finds, and at how many times it evaluates curves for that.

Each kind of curve has the watched arguments that a graph of its operations would have.
"""

import math
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from internals import codegen, compiler

search = codegen.peak_search
Kind, Listed = search.Kind, search.Listed

T = np.linspace(-1.0, 1.0, 41)
STEP = 0.05


class Curve(NamedTuple):
    """A function of time, its watched arguments, each a kind, numbers and a function of time, and
    times near which the function may be largest.
    """

    at: Callable
    watched: tuple = ()
    places: tuple = ()


def sine(x):
    """The sine by sums and products, whose bits depend on no library."""
    x = x - math.tau * np.floor(x / math.tau + 0.5)
    total, term = x, x
    for k in range(1, 14):
        term = term * (-x * x / ((2 * k) * (2 * k + 1)))
        total = total + term
    return total


def polynomial(draw):
    c = draw.uniform(-1, 1, draw.integers(3, 9))
    return lambda t: np.polynomial.chebyshev.chebval(t, c)


def place(draw):
    return float(draw.uniform(-0.97, 0.97))


def curved(draw):
    """A rising function, straight or not."""
    bend = draw.choice([0.0, draw.uniform(-0.45, 0.45)])
    return lambda t: t + bend * t * t


def smooth(draw):
    return Curve(polynomial(draw))


def pole(draw):
    """A bump of any width."""
    base, c, w, h = polynomial(draw), place(draw), 10 ** draw.uniform(-3, 0), draw.uniform(-4, 4)

    def divisor(t):
        return 1 + ((t - c) / w) ** 2

    return Curve(lambda t: base(t) + h / divisor(t), ((Kind.POLE, (), divisor),), (c,))


def root(draw):
    """One kink or two, near each other or not."""
    base, c, f = polynomial(draw), place(draw), curved(draw)
    d = float(np.clip(c + 10 ** draw.uniform(-3, 0) * draw.choice([-1, 1]), -0.99, 0.99))
    a, b = draw.uniform(-4, 4, 2) * [1, draw.integers(2)]
    u, v = lambda t: f(t) - f(c), lambda t: f(t) - f(d)
    watched = ((Kind.ROOT, (0.0,), u), (Kind.ROOT, (0.0,), v))[: 2 if b else 1]
    return Curve(lambda t: base(t) + a * np.abs(u(t)) + b * np.abs(v(t)), watched, (c, d))


def switch(draw):
    """A jump at each of two numbers."""
    base, c, (a, b) = polynomial(draw), place(draw), draw.uniform(-2, 2, 2)
    f, d, s = curved(draw), c + 10 ** draw.uniform(-3, -0.5), draw.choice([0.5, 1.0, 3.0])
    u, number = lambda t: s * (f(t) - f(c)), s * (f(d) - f(c))
    return Curve(
        lambda t: base(t) + a * (u(t) > 0) + b * (u(t) > number),
        ((Kind.SWITCH, (0.0, number), u),),
        tuple(x + k * 1e-15 for x in (c, d) for k in range(-2, 3)),
    )


def knot(draw):
    """A kink in the slope, or in what bends a curve."""
    base, c, a, k = polynomial(draw), place(draw), draw.uniform(-6, 6), draw.integers(1, 4)

    def kinked(t):
        return base(t) + a * np.maximum(t - c, 0.0) ** k

    return Curve(kinked, ((Kind.KNOT, (c,), lambda t: t),), (c,))


def steps(draw):
    """A sawtooth of jumps that may be nearer to each other than two instants."""
    base, s, b = polynomial(draw), draw.uniform(0.5, 12), draw.uniform(-1, 1)

    def u(t):
        return s * t + b

    jumps = (np.arange(math.floor(b - s) + 1, math.floor(b + s) + 1) - b) / s
    return Curve(
        lambda t: base(t) + 0.3 * np.floor(u(t)) - 0.25 * s * t,
        ((Kind.STEP, (), u),),
        tuple(x + k * 1e-15 for x in jumps for k in range(-2, 3)),
    )


def rate(draw):
    """Waves, slow or faster than the instants."""
    base, q = polynomial(draw), draw.uniform(0, 0.5)
    w = draw.choice([draw.uniform(3, 8), 10 ** draw.uniform(0.5, 2.0)])
    phase, h = draw.uniform(0, 6), draw.uniform(0.1, 2)

    def angle(t):
        return w * t * (1 + q * t) + phase

    watched = ((Kind.RATE, (), lambda t: w * (1 + 2 * q * t)), (Kind.TURN, (), angle))
    return Curve(lambda t: base(t) + h * sine(angle(t)), watched)


def soft(draw):
    """A steep change."""
    base, c, w = polynomial(draw), place(draw), 10 ** draw.uniform(-3, 0)

    def u(t):
        return (t - c) / w

    def steep(t):
        return base(t) * u(t) / np.sqrt(1 + u(t) ** 2)

    return Curve(steep, ((Kind.SOFT, (20.0,), u),), (c,))


def power(draw):
    base, c, w = polynomial(draw), place(draw), 10 ** draw.uniform(-2.5, 0)

    def u(t):
        return -(((t - c) / w) ** 2)

    return Curve(lambda t: base(t) + 4 * np.exp(u(t)), ((Kind.POWER, (), u),), (c,))


def mixed(draw):
    """A sum of two or three of these."""
    parts = [draw.choice(ALONE)(draw) for _ in range(draw.integers(2, 4))]
    watched = tuple(each for part in parts for each in part.watched)
    places = tuple(x for part in parts for x in part.places)
    return Curve(lambda t: sum(part.at(t) for part in parts), watched, places)


def swinging(draw):
    """A jump each time a wave passes a number."""
    base, a, w = polynomial(draw), draw.uniform(-2, 2), draw.uniform(0.1, 0.9) / STEP
    number, phase = draw.uniform(-0.9, 0.9), draw.uniform(0, 6)

    def u(t):
        return sine(w * t + phase)

    turns = 2 * np.pi * np.arange(-4, 6) - phase
    passes = np.concatenate([turns + np.arcsin(number), turns + np.pi - np.arcsin(number)]) / w
    near = np.add.outer(passes[np.abs(passes) < 1], np.arange(-9, 10) * 1e-15).ravel()
    return Curve(
        lambda t: base(t) + a * (u(t) > number), ((Kind.SWITCH, (number,), u),), tuple(near)
    )


ALONE = (smooth, pole, root, switch, knot, steps, rate, soft, power)
KINDS = {kind.__name__: kind for kind in (*ALONE, mixed, swinging)}

WORK = {
    "smooth": 45,
    "pole": 1184,
    "root": 467,
    "switch": 1635,
    "knot": 90,
    "steps": 2649,
    "rate": 24562,
    "soft": 4554,
    "power": 1263,
    "mixed": 5215,
    "swinging": 6878,
}
"""Times at which the search evaluates forty drawn curves of each kind, those of the instants not
counted. A search that takes fewer is better.
"""


class Source:
    """Curves, at ratios of their own or none, and the number of times at which they are taken."""

    def __init__(self, curves, ratios):
        self.curves, self.ratios, self.times = curves, ratios, 0

    def at(self, t):
        self.times += t.size
        return search.Samples(
            np.array([curve.at(t) for curve in self.curves]),
            np.array([ratio + 0.1 * t for ratio in self.ratios]),
            np.array([u(t) for c in self.curves for _, _, u in c.watched]).reshape(-1, t.size),
        )


def searched(curves, quantities=(0,), units=(0,), ratios=None, listed=None):
    """Peaks of some curves, and the number of times at which the search evaluates them."""
    source = Source(curves, [math.nan] * len(curves) if ratios is None else ratios)
    samples = source.at(T)
    watched = [(quantities[k], each) for k, c in enumerate(curves) for each in c.watched]
    depends = np.array([[q == own for q in range(len(units))] for own, _ in watched], bool)
    made = search.Curves(
        tuple(quantities),
        tuple(units),
        tuple(search.Watch(kind, at) for _, (kind, at, _) in watched),
        depends.reshape(-1, len(units)),
    )
    find = search.load_search(compiler.find_compiler("c++"))
    peaks = find.peaks(source, made, T, samples, np.zeros(T.size - 1, bool), listed)
    return peaks, source.times - T.size


def dense(curve):
    """Many times, more near the places of a curve."""
    near = np.add.outer(curve.places, np.linspace(-1e-2, 1e-2, 201)).ravel()
    t = np.unique(np.concatenate([np.linspace(-1, 1, 10_001), near, curve.places]))
    return t[np.abs(t) <= 1]


def largest(curve):
    """The largest size over many times, and over ever more around the largest of these."""
    t = dense(curve)
    sizes = np.nan_to_num(np.abs(curve.at(t)))
    best = sizes.max()
    for k in np.argsort(sizes)[-4:]:
        low, high = t[max(k - 1, 0)], t[min(k + 1, t.size - 1)]
        for _ in range(12):
            near = np.linspace(low, high, 41)
            size = np.nan_to_num(np.abs(curve.at(near)))
            best = max(best, size.max())
            low, high = near[max(size.argmax() - 1, 0)], near[min(size.argmax() + 1, 40)]
    return best


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.quick] * (WORK[name] < 6000))  # others take a second
        for name in KINDS
    ],
)
def test_the_largest_is_found_in_as_few_times(name, monkeypatch):
    """However many are evaluated together."""
    draw, work = np.random.default_rng([*KINDS].index(name)), Counter()
    for _ in range(40):
        curve = KINDS[name](draw)
        best = largest(curve)
        for together in (64, 2):
            monkeypatch.setattr(search, "_TOGETHER", together)
            peaks, times = searched([curve])
            work[together] += times
            assert peaks.resolved[0]
            assert peaks.value[0] == curve.at(peaks.t)[0]
            assert best * (1 - 1e-11) <= abs(peaks.value[0]) <= best * (1 + 1e-9)
    assert work == {64: WORK[name], 2: WORK[name]}


def sizes_of(curve, t, sign):
    """Sizes of values; of one ``sign``, their distance from as far below the least instant as the
    largest is above it.
    """
    if not sign:
        return np.abs(curve.at(t))
    instants = sign * curve.at(T)
    return sign * curve.at(t) - (2 * instants.min() - instants.max())


@pytest.mark.parametrize("sign", [pytest.param(0, marks=pytest.mark.quick), 1, -1])
@pytest.mark.parametrize("kind", [smooth, pole, root, rate])
def test_local_peaks_are_listed(kind, sign):
    """All that are two steps or more from larger ones, down to a share of the largest: as many as
    there is room for.
    """
    draw, share = np.random.default_rng(3), 0.75
    for _ in range(40):
        curve = kind(draw)
        peaks, _ = searched([curve], listed=Listed(share, sign))
        rows = peaks.tops[0][peaks.tops[0, :, 0] == 0]
        np.testing.assert_allclose(rows[:, 3], curve.at(rows[:, 1]), rtol=1e-12, atol=1e-13)
        t = dense(curve)
        sizes = sizes_of(curve, t, sign)
        best = sizes.max()
        assert np.all(sizes_of(curve, rows[:, 1], sign) >= best * (share - 1e-6))
        tops = np.flatnonzero((sizes[1:-1] > sizes[:-2]) & (sizes[1:-1] >= sizes[2:])) + 1
        tops = [k for k in tops if sizes[k] > share * best * (1 + 1e-6)]
        tops = [k for k in tops if sizes[k] == sizes[np.abs(t - t[k]) <= 2 * STEP].max()]
        if len(tops) > search.TOPS:
            continue
        for k in tops:
            there = rows[np.abs(rows[:, 1] - t[k]) < 1e-3]
            assert len(there) == 1
            assert sizes_of(curve, there[:, 1], sign)[0] >= sizes[k] * (1 - 1e-9)


@pytest.mark.parametrize("speed", [pytest.param(7.0, marks=pytest.mark.quick), 31.0, 55.0])
def test_of_tops_as_large_the_first_is_told(speed):
    """Whatever rounding says of tops and troughs."""
    for phase in np.linspace(0.0, math.pi, 24, endpoint=False):
        watched = ((Kind.RATE, (), lambda t: speed + 0 * t),)
        peaks, _ = searched([Curve(lambda t, x=phase: sine(speed * t + x), watched)])
        turns = math.ceil((phase - speed) / math.pi - 0.5)
        assert peaks.t[0] == pytest.approx(((turns + 0.5) * math.pi - phase) / speed, abs=1e-6)


def test_quantities_of_several_curves_at_places():
    """A quantity's peak is that of the curve of its own that goes furthest, at the place of it."""
    draw, curves, quantities = np.random.default_rng(8), [], []
    for quantity in range(30):
        for _ in range(draw.integers(1, 4)):
            curves.append(mixed(draw))
            quantities.append(quantity)
    ratios = np.where(
        draw.uniform(size=len(curves)) < 0.7, draw.uniform(0.2, 0.8, len(curves)), math.nan
    )
    units = [quantity % 3 for quantity in range(30)]
    peaks, work = searched(curves, quantities, units, ratios)
    assert peaks.resolved.all()
    for quantity, value in enumerate(np.abs(peaks.value)):
        own = [k for k, q in enumerate(quantities) if q == quantity]
        sizes = np.array([largest(curves[k]) for k in own])
        assert sizes.max() * (1 - 1e-11) <= value <= sizes.max() * (1 + 1e-9)
        furthest = own[sizes.argmax()]
        np.testing.assert_allclose(
            peaks.xi[quantity], ratios[furthest] + 0.1 * peaks.t[quantity], rtol=1e-12
        )
    assert work == 4720


@pytest.mark.parametrize("kind", [smooth, pole, root, switch, rate])
def test_steps_beside_a_rest_are_left_out(kind):
    """Where a curve is no number its peak is that of all other steps; one that is a number nowhere
    has no peak.
    """
    draw = np.random.default_rng(11)
    for _ in range(40):
        curve, c, w = kind(draw), place(draw), draw.choice([0.03, 0.2, 3.0])
        resting = curve._replace(
            at=lambda t, at=curve.at, c=c, w=w: np.where(np.abs(t - c) <= w, math.nan, at(t)),
            places=(*curve.places, c - w, c + w, np.nextafter(c - w, -2), np.nextafter(c + w, 2)),
        )
        peaks, _ = searched([resting])
        numbers = np.isfinite(resting.at(T))
        if not numbers.any():
            assert math.isnan(peaks.value[0])
            continue
        t, size = dense(resting), abs(peaks.value[0])
        i = np.clip(((t + 1) / STEP).astype(int), 0, T.size - 2)
        sizes = np.where(numbers[i] & numbers[i + 1], np.abs(resting.at(t)), 0.0)
        assert size >= sizes.max() * (1 - 1e-12)
        assert size >= np.nanmax(np.abs(resting.at(T)))
        assert size <= largest(resting) * (1 + 1e-9)


@pytest.mark.quick
def test_a_jump_that_is_no_number_hides_neither_side():
    draw = np.random.default_rng(11)
    for _ in range(40):
        curve = switch(draw)
        at, c = curve.at, curve.places[2]
        hole = curve._replace(
            at=lambda t, at=at, c=c: np.where(np.abs(t - c) <= 1e-13, np.nan, at(t))
        )
        peaks, _ = searched([hole])
        best = largest(hole)
        assert best * (1 - 1e-11) <= abs(peaks.value[0]) <= best * (1 + 1e-9)


def test_what_zigzags_by_rounding_is_not_searched():
    sizes = np.random.default_rng(0).uniform(0.5e-16, 1e-16, 1009)

    def zigzag(t):
        return sizes[(1e9 * (t + 1)).astype(int) % sizes.size] * (-1) ** np.rint((t + 1) / STEP)

    peaks, work = searched([Curve(zigzag)])
    assert peaks.resolved.all()
    assert work < 20


def test_what_rounding_raises_is_not_searched():
    """Where a curve is all but level, rounding far below its size is all that rises."""
    draw, work = np.random.default_rng(5), 0
    for _ in range(40):
        base = polynomial(draw)
        peaks, times = searched([Curve(lambda t, of=base: 1 + of(t) / 1000 + wild(t) / 1e8)])
        assert peaks.resolved.all()
        work += times
    assert work == 894


def wild(t):
    return (1e9 * (t + 1)).astype(int) * 2654435761 % 1009 / 1009


def test_a_wild_curve_ends_its_own_search_alone():
    calm = Curve(lambda t: t * (1 - t))
    assert searched([Curve(wild), calm], (0, 1), (0, 1))[0].resolved.tolist() == [False, True]

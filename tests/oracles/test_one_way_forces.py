"""Forces that a comparison switches, on laws whose rates have multiple zeros: there rounding alone
decides on which side of zero the computed rate is.

The reference knows the side of each interval of time from the law, and compares nothing.
"""

import casadi as ca
import numpy as np
import pytest
from stepped import one_way

from lagrange_casadi import Mechanism, Scene, evaluate, motion, optimise, refine
from lagrange_casadi.cli import main
from lagrange_casadi.errors import NoDesignError

POLYNOMIAL = np.polynomial.polynomial
RISES = {"345": (0, 0, 0, 10, -15, 6), "septic": (0, 0, 0, 0, 35, -84, 70, -20)}
LENGTH = 0.5


def horner(coefficients, u):
    value = 0 * u
    for coefficient in reversed(coefficients):
        value = value * u + coefficient
    return value


def sums(coefficients, u):
    return sum(c * u**k for k, c in enumerate(coefficients))


def polynomial(coefficients, size=1.0, start=0.0, width=1.0, add=0.0):
    """Position, rate and acceleration of ``add + size p((t - start)/width)``."""
    rows = [POLYNOMIAL.polyder(coefficients, k) for k in range(3)]
    return [
        lambda t, k=k: (
            size / width**k * POLYNOMIAL.polyval((t - start) / width, rows[k])
            + (add if k == 0 else 0.0)
        )
        for k in range(3)
    ]


def clipped(u):
    return ca.fmin(ca.fmax(u, 0), 1)


def law(rng):
    """An expression of time, and its pieces: begin, end, position, rate and acceleration, and the
    rate's sign.
    """
    kind, form = rng.choice(["rise", "dwell", "cosine", "power", "inside"]), rng.choice([0, 1])
    form, h = (horner, sums)[form], float(rng.choice([0.02, 0.3, 1.0, -0.3]))
    sign, rise = int(np.sign(h)), RISES[rng.choice(list(RISES))]
    a, b, d, e = (
        rng.uniform(*ends) for ends in ((0.05, 0.3), (0.4, 0.6), (0.65, 0.75), (0.8, 0.95))
    )
    if kind == "rise":
        return kind, h, lambda t: h * form(rise, t), [(0, 1, *polynomial(rise, h), sign)]
    if kind == "dwell":
        back = h if rng.random() < 0.5 else 0.0

        def moved(t):
            return h * form(rise, clipped((t - a) / (b - a))) - back * form(
                rise, clipped((t - d) / (e - d))
            )

        pieces = [
            (0, a, *polynomial([0.0]), 0),
            (a, b, *polynomial(rise, h, a, b - a), sign),
            (b, d, *polynomial([0.0], add=h), 0),
            (d, e, *polynomial(rise, -back, d, e - d, h), -sign if back else 0),
            (e, 1, *polynomial([0.0], add=h - back), 0),
        ]
        return kind, h, moved, pieces
    if kind == "cosine":
        w = np.pi / (b - a)
        rows = (
            lambda t: h / 2 * (1 - np.cos(w * (t - a))),
            lambda t: h / 2 * w * np.sin(w * (t - a)),
            lambda t: h / 2 * w**2 * np.cos(w * (t - a)),
        )
        pieces = [
            (0, a, *polynomial([0.0]), 0),
            (a, b, *rows, sign),
            (b, 1, *polynomial([0.0], add=h), 0),
        ]
        return kind, h, lambda t: h / 2 * (1 - ca.cos(ca.pi * clipped((t - a) / (b - a)))), pieces
    n, zero = int(rng.integers(3, 7)), 1.0
    if kind == "inside":
        n, zero = int(rng.integers(3, 6)), float(rng.choice([0.25, 0.375, 0.5]))
    p = POLYNOMIAL.polypow([-zero, 1.0], n)
    p[0] = 0.0
    rows, before = polynomial(p, h), sign if n % 2 else -sign
    pieces = [(0, zero, *rows, before), (zero, 1, *rows, sign)][: 2 if zero < 1.0 else 1]
    return f"{kind}{n}", h, lambda t: h * form(p, t), pieces


def force(rng):
    """A one-way force of position, rate and time, and the same with the rate's sign given."""
    size = float(rng.choice([1.0, 100.0, 1e4])) * rng.uniform(0.5, 1.5)
    other = size * rng.uniform(-1.0, 1.0)
    kinds = {
        ">": (lambda x, v, t: size * (v > 0), lambda x, v, t, s: size * (s > 0)),
        ">=": (lambda x, v, t: size * (v >= 0), lambda x, v, t, s: size * (s >= 0)),
        "<": (lambda x, v, t: size * (v < 0), lambda x, v, t, s: size * (s < 0)),
        "sign": (lambda x, v, t: size * ca.sign(v), lambda x, v, t, s: size * s),
        "if_else": (
            lambda x, v, t: ca.if_else(v > 0, size, other),
            lambda x, v, t, s: size if s > 0 else other,
        ),
        "fmax": (lambda x, v, t: size * ca.fmax(0, v), lambda x, v, t, s: size * v * (s > 0)),
        "fabs": (lambda x, v, t: size * ca.fabs(v), lambda x, v, t, s: size * v * s),
        "friction": (
            lambda x, v, t: size * ca.sign(v) + other * v,
            lambda x, v, t, s: size * s + other * v,
        ),
        "time": (
            lambda x, v, t: size * (1 + t) * (v > 0),
            lambda x, v, t, s: size * (1 + t) * (s > 0),
        ),
        "place": (
            lambda x, v, t: size * (1 + x) * (v > 0),
            lambda x, v, t, s: size * (1 + x) * (s > 0),
        ),
    }
    kind = rng.choice(list(kinds))
    return kind, *kinds[kind]


def largest(f, a, b):
    """The largest size of a smooth function of time between two times."""
    t = np.linspace(a, b, 20_001)
    sizes = np.abs(f(t) + 0 * t)
    k = int(sizes.argmax())
    low, high = t[max(k - 1, 0)], t[min(k + 1, t.size - 1)]
    for _ in range(60):
        first, second = low + 0.382 * (high - low), low + 0.618 * (high - low)
        low, high = (first, high) if abs(f(first)) < abs(f(second)) else (low, second)
    return max(float(sizes.max()), float(abs(f((low + high) / 2))))


def drawn(seed):
    """A rod upright on a slide, pushed at its tip by a one-way force; and its peaks, between the
    instants where the rate has a sign, and at those where it has none.
    """
    rng = np.random.default_rng(seed)
    kind, _, moved, pieces = law(rng)
    compared, made, known = force(rng)
    mass, stiffness = float(rng.choice([0.05, 1.0])), float(rng.choice([0.0, 30.0]))
    m = Mechanism("one_way")
    rod = m.link("rod", length=LENGTH, mass=m.parameter("mass", mass, "kg", low=1e-3))
    way = m.prismatic("way", m.ground, rod, axis=(1, 0), angle=np.pi / 2)
    m.force("work", rod.tip, x=made(m.coordinate(way), m.rate(way), m.time))
    m.force("spring", rod, x=-stiffness * m.coordinate(way))
    m.output("steady", 2.0 + ca.sin(m.time), unit="N")
    scene = Scene(
        m, {"way": motion.expression(moved)}, t=(0, 1, int(rng.choice([37, 51, 101, 360])))
    )

    def curves(x, v, a, s):
        def pushed(t):
            return known(x(t), v(t), t, s) + 0.0 * t

        def shear(t):
            return pushed(t) - mass * a(t)

        def inside(t):
            with np.errstate(all="ignore"):
                ratio = pushed(t) / (mass * a(t) + 0.0 * t)
                return np.where((ratio > 0) & (ratio < 1), pushed(t) * ratio * LENGTH / 2, 0.0)

        yield "effort:way", lambda t: mass * a(t) + stiffness * x(t) - pushed(t)
        yield from (("load:work:fx", pushed), ("section:rod:shear", pushed))
        yield "section:rod:shear", shear
        yield "section:rod:bending", lambda t: LENGTH * (pushed(t) - mass * a(t) / 2)
        yield "section:rod:bending", inside
        yield "motion:way", x

    peaks = {"reaction:way:fy": mass * 9.81, "output:steady": 2.0 + np.sin(1.0)}
    at_rest = {}
    for begin, end, x, v, a, s in pieces:
        for name, curve in curves(x, v, a, s):
            peaks[name] = max(peaks.get(name, 0.0), largest(curve, begin, end))
        for name, curve in curves(x, lambda t: 0.0 * t, a, 0):
            at_rest.setdefault(name, []).extend(
                float(abs(curve(np.array(t)))) for t in (begin, end)
            )
    return f"{kind} {compared} {scene.timing().count}", scene, peaks, at_rest


def wrong(found, peaks, at_rest, tolerance=1e-10):
    """Names and values of peaks that are none; where the rate is zero at an instant, the value
    there may be larger.
    """
    scale = max(peaks.values())
    return {
        name: (found[name], peak)
        for name, peak in peaks.items()
        if not any(
            abs(abs(found[name]) - right) <= tolerance * right + 1e-13 * scale
            for right in (peak, *(other for other in at_rest.get(name, ()) if other > peak))
        )
    }


SEEDS = [10, 12, 15, 18, 21, 22, 24, 28, 34, 36, 41]


@pytest.mark.parametrize(
    "seed", [*SEEDS, *(pytest.param(k, marks=pytest.mark.long) for k in range(100, 300))]
)
def test_peaks_are_those_of_known_sides(seed):
    name, scene, peaks, at_rest = drawn(seed)
    found = refine(scene, evaluate(scene, certificate=False), list(peaks))
    assert not wrong({peak.name: peak.value for peak in found}, peaks, at_rest), name


def test_a_design_is_found():
    """Of 20 kg, on the 3-4-5 law of 1 m in 1 s: 10/sqrt(3) m/s2."""
    scene = one_way(lambda rate: rate > 0)
    found = optimise(
        scene, minimise="peak:effort:way", over={"mass": (10.0, 30.0)}, starts=1, screen=4
    )
    assert found.objective == pytest.approx(100.0 + 10.0 * 10.0 / np.sqrt(3), rel=1e-6)


def test_a_peak_that_cannot_be_located_spoils_no_other():
    """Of 200 000 teeth, which the work has and the weight has not."""
    scene = one_way(lambda rate: ca.fmod(rate, 1e-5))
    solution = evaluate(scene, certificate=False)
    found = {peak.name: peak.value for peak in refine(scene, solution)}
    assert np.isnan(found["load:work:fx"])
    assert np.isnan(found["effort:way"])
    assert found["reaction:way:fy"] == pytest.approx(20.0 * 9.81, rel=1e-13)
    assert found["motion:way"] == pytest.approx(1.0, rel=1e-13)


CASE = """
import casadi as ca
from stepped import one_way
scene = lambda: one_way(lambda rate: ca.fmod(rate, 1e-5))
"""


def test_messages_say_what_switches_too_often(tmp_path, monkeypatch, capsys):
    scene = one_way(lambda rate: ca.fmod(rate, 1e-5))
    with pytest.raises(NoDesignError, match=r"peak cannot be located .* smooth the load"):
        optimise(scene, minimise="peak:effort:way", over={"mass": (10.0, 30.0)}, starts=1, screen=2)
    (tmp_path / "case.py").write_text(CASE)
    monkeypatch.chdir(tmp_path)
    main(["run", ".", "--refine-peaks", "--no-figures"])
    assert "(effort:way): load 'work' switches too often" in capsys.readouterr().out

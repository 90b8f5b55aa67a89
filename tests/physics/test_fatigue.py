"""Fatigue: a textbook's solved problems, rainflow counting beside the standard and a public
library, critical planes against closed forms, and damage that exported C counts step by step.
"""

from __future__ import annotations

import math
import subprocess

import casadi as ca
import numpy as np
import pytest
import strong
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import codegen

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    evaluate,
    export,
    strength,
    table,
)
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

# Budynas and Nisbett, Shigley's Mechanical Engineering Design, 8th edition, problems 6-12 to 6-15
# and their solutions: a bar with Se = 276, Sy = 413, Sut = 551 MPa; f = 0.9.
BAR = beams.Material("bar", 7850.0, 207e9, yield_strength=413e6, ultimate=551e6, endurance=276e6)

PROBLEMS = [
    # normal: mean, amplitude; shear: mean, amplitude [MPa]; factors against yield, by Goodman, by
    # Gerber
    ((0, 172), (103, 0), 1.67, 1.06, 1.31),
    ((0, 69), (138, 0), 1.66, 1.46, 1.73),
    ((0, 83), (103, 69), 1.34, 1.18, 1.47),
]


def shaft(normal, shear=lambda t: 0.0 * t, material=BAR, count=101):
    """Evaluate a round bar at rest that has these stresses [MPa] at all its outermost fibres, as
    functions of the time from 0 to 1.
    """
    m, d = SpatialMechanism("shaft"), 0.02
    m.set_gravity(0.0, 0.0, 0.0)
    bar = m.link("bar", length=0.3, beam=beams.Beam(beams.round_bar(d), material))
    m.weld("wall", m.ground, bar)
    m.force("pull", bar.tip, x=1e6 * normal(m.time) * math.pi / 4 * d**2)
    m.torque("twist", bar.tip, x=1e6 * shear(m.time) * math.pi / 16 * d**3)
    return evaluate(Scene(m, {}, t=(0.0, 1.0, count)), certificate=False)


def wave(mean, amplitude, phase=0.0):
    return lambda t: mean + amplitude * ca.cos(math.tau * t - phase)


@pytest.mark.parametrize(("normal", "shear", "yields", "goodman", "gerber"), PROBLEMS)
def test_solved_problems_of_a_textbook(normal, shear, yields, goodman, gerber):
    solution = shaft(wave(*normal), wave(*shear))
    for criterion, told in (("goodman", goodman), ("gerber", gerber)):
        found = solution.safety("bar", criterion=criterion)
        assert found.against("fatigue") == pytest.approx(told, abs=0.006)
    assert found.against("yield") == pytest.approx(yields, abs=0.006)


def test_the_life_of_a_solved_problem():
    """Problem 6-15: an amplitude of 358.5 MPa is borne 45 800 times."""
    solution = shaft(wave(0, 0), wave(0, 207))
    assert solution.life("bar").cycles == pytest.approx(45_800, rel=2e-3)
    assert solution.safety("bar").against("fatigue") == pytest.approx(0.77, abs=0.005)


@pytest.mark.parametrize(("phase", "size"), [(math.pi / 2, 1.0), (0.0, math.sqrt(2.0))])
def test_out_of_phase_is_not_in_phase(phase, size):
    """A circle in the plane of s and sqrt(3) t has its radius as amplitude; in phase it would be
    1.41 times that.
    """
    solution = shaft(wave(0, 100), wave(0, 100 / math.sqrt(3), phase), count=361)
    assert solution.safety("bar").against("fatigue") == pytest.approx(2.76 / size, rel=1e-4)


@pytest.mark.parametrize("criterion", strength.CRITERIA)
@given(st.floats(1e5, 5e8), st.floats(-5e8, 3e8))
def test_at_its_factor_a_load_is_worth_the_endurance_limit(criterion, amplitude, mean):
    """A mean in compression counts as none; one that is too much alone leaves no life."""
    n = float(strength.factor(amplitude, mean, BAR, criterion))
    worth = strength.reversed_amplitude(n * amplitude, n * mean, BAR, criterion)
    assert worth == pytest.approx(BAR.endurance, rel=1e-9)
    if mean <= 0.0:
        assert n == pytest.approx(BAR.endurance / amplitude, rel=1e-12)
    assert strength.cycles(strength.reversed_amplitude(1e6, 900e6, BAR, criterion), BAR) == 0.0


def test_lives_are_on_the_line_and_endless_below_it():
    assert strength.cycles(0.9 * 551e6, BAR) == pytest.approx(1e3)
    assert strength.cycles(276e6 * (1 + 1e-9), BAR) == pytest.approx(1e6, rel=1e-6)
    assert strength.cycles(276e6, BAR) == strength.cycles(0.0, BAR.but(endless=False)) == np.inf
    slope = 3 / math.log10(0.9 * 551 / 276)
    assert strength.cycles(138e6, BAR.but(endless=False)) == pytest.approx(1e6 * 2**slope)
    morrow = (
        strength.factor(1e8, 1e8, BAR, "morrow"),
        strength.factor(1e8, 1e8, BAR.but(fatigue_strength=1e9), "morrow"),
    )
    assert morrow == pytest.approx((1 / (1 / 2.76 + 100 / 896), 1 / (1 / 2.76 + 0.1)))


FIGURE_6 = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]
"""ASTM E1049-85, figure 6: the history of its rainflow example."""

# rainflow 3.2.0 of PyPI, extract_cycles of figure 6: range, mean, count, indices; counts by range
# are the standard's.
PUBLISHED = [(3, -0.5, 0.5, 0, 1), (4, -1.0, 0.5, 1, 2), (4, 1.0, 1.0, 4, 5), (8, 1.0, 0.5, 2, 3),
             (9, 0.5, 0.5, 3, 6), (8, 0.0, 0.5, 6, 7), (6, 1.0, 0.5, 7, 8)]  # fmt: skip


def test_the_example_of_the_standard():
    assert [tuple(swing) for swing in strength.rainflow(FIGURE_6)] == PUBLISHED


@given(st.lists(st.integers(-9, 9), min_size=1, max_size=40), st.integers(0, 40))
def test_every_reversal_is_used_once_wherever_a_repeating_history_begins(history, shift):
    """The sizes of all swings add up to half of the way that the history goes up and down."""
    way, last = float(np.abs(np.diff(history)).sum()), abs(history[0] - history[-1])
    for repeating, told in ((False, way), (True, way + last)):
        swings = strength.rainflow(history, repeating=repeating)
        assert sum(s.size * s.times for s in swings) == pytest.approx(told / 2)
        for swing in swings:
            a, b = history[swing.first], history[swing.last]
            assert (swing.size, swing.mean) == (abs(a - b), (a + b) / 2)
    turned = strength.rainflow(np.roll(history, shift), repeating=True)
    assert sorted(s.size for s in turned) == sorted(s.size for s in swings)


def test_a_public_library_counts_the_same_and_a_life_is_miners_sum_of_it():
    library = pytest.importorskip("rainflow")
    draw, worn = np.random.default_rng(3), BAR.but(endless=False)
    for count in (200, 9, 17):
        history = draw.normal(size=count) * 120.0
        expected = [tuple(map(float, cycle)) for cycle in library.extract_cycles(history)]
        found = np.array([tuple(swing) for swing in strength.rainflow(history)])
        np.testing.assert_allclose(found, np.array(expected), rtol=0, atol=1e-11)
        # From its largest value and back to it, a history that repeats has no half cycle but two
        # of its largest swing.
        closed = np.roll(history, -int(np.argmax(history)))
        swings = library.extract_cycles([*closed, closed[0]])
        told = sum(
            times / strength.cycles(strength.reversed_amplitude(5e5 * size, 1e6 * mean, worn), worn)
            for size, mean, times, *_ in swings
        )
        at = np.linspace(0.0, 1.0, count + 1)
        solution = shaft(
            lambda t, at=at, row=[*closed, closed[0]]: table(t, at, row),
            material=worn,
            count=at.size,
        )
        assert solution.life("bar").damage == pytest.approx(told, rel=1e-6)


SHARE = 0.3
TURN = np.linspace(0.0, 2 * math.pi, 361)


def history(normal, *shears):
    """Stresses [MPa] as Pa, with a shear stress along y, or along both."""
    rows = np.zeros((3, TURN.size))
    for k, row in enumerate((normal, *shears)):
        rows[k] = row
    return 1e6 * rows


@given(st.floats(1.0, 300.0), st.floats(0.0, 300.0))
@settings(max_examples=20)
def test_a_bar_in_tension_with_a_mean(amplitude, mean):
    """On a plane at an angle it is a sin(2u)/2 + k (a + m) cos(u)^2, at most (k (a + m) + hypot(a,
    k (a + m)))/2; a fully reversed tension is worth the endurance limit.
    """
    found = strength.critical_plane(history(mean + amplitude * np.cos(TURN)))
    largest = SHARE * (amplitude + mean)
    told = (largest + math.hypot(amplitude, largest)) / 2
    assert found.value() == pytest.approx(1e6 * told, rel=1e-8)
    plane = strength.critical_plane(history(138.0 * np.cos(TURN)))
    assert strength.plane_factor(plane, BAR) == pytest.approx(2.0, rel=1e-9)
    assert math.tan(2 * plane.angle) == pytest.approx(1 / SHARE, rel=1e-3)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6])
def test_any_amplitudes_out_of_phase_against_all_planes_one_by_one(share):
    normal, shear = 120 * np.cos(TURN) + 30, 80 * np.sin(TURN + 0.4)
    best = 0.0
    for u in np.linspace(0.0, math.pi, 4001):
        c, s = math.cos(u), math.sin(u)
        across = normal * c * c + 2 * shear * c * s
        around = -normal * c * s + shear * (c * c - s * s)
        best = max(best, np.ptp(around) / 2 + share * max(across.max(), 0.0))
    rows = history(normal, shear)
    for along in ([0, 1, 2], [0, 2, 1]):  # shear along y, then along z
        found = strength.critical_plane(rows[along], share)
        assert found.value(share) == pytest.approx(1e6 * best, rel=1e-5)


def by_goodman(rows):
    found = strength.rainflow(rows[0], repeating=True)
    steel = strong.STEEL.but(endurance=200e6)
    return min(strength.factor(s.size / 2, s.mean, steel) for s in found)


def by_findley(rows):
    return strength.plane_factor(strength.critical_plane(rows), strong.STEEL.but(endurance=200e6))


@pytest.mark.parametrize(
    ("name", "criterion", "factor", "close"),
    [("slider", "findley", by_findley, 1e-3), ("sliding", "goodman", by_goodman, 1e-9)],
)
def test_no_place_of_a_link_is_worse_than_the_one_that_is_found(name, criterion, factor, close):
    """Looked at one by one; where a load travels along the link, the worst is where another one
    stands.
    """
    steel, shape = strong.STEEL.but(endurance=200e6), beams.rectangle(0.03, 0.012)
    scene = (
        strong.slider(200e6)
        if name == "slider"
        else strong.press(shape, material=steel, sliding=True)
    )
    solution = evaluate(scene, t=(0, 0.2094395, 25), wanted=["section:rod"], certificate=False)
    stress = solution.stress("rod")
    told = solution.safety("rod", criterion=criterion).against("fatigue")
    factors = [
        factor(rows)
        for place in [*np.linspace(0.0, 1.0, 41), 0.325]
        for side in ("base", "tip")
        for rows in np.moveaxis(stress.at(place, side), 1, 0)
    ]
    assert told * (1 - 1e-8) <= min(factors) <= told * (1 + close)


@pytest.mark.parametrize(
    ("ask", "error", "says"),
    [
        (
            lambda: strength.factor(1.0, 0.0, beams.material("EN AW-6082-T6")),
            DeclarationError,
            "'EN AW-6082-T6' has no endurance, which fatigue by goodman needs",
        ),
        (
            lambda: strength.factor(1.0, 0.0, beams.Material("x", 1.0, endurance=1.0), "soderberg"),
            DeclarationError,
            "'x' has no yield_strength, which fatigue by soderberg needs",
        ),
        (
            lambda: strength.plane_factor(
                strength.critical_plane(history(1.0)), BAR.but(endurance=None)
            ),
            DeclarationError,
            "has no endurance, which fatigue by findley needs",
        ),
        (
            lambda: shaft(wave(0, 1)).safety("bar", criterion="find"),
            UnknownNameError,
            "unknown fatigue criterion 'find'.*goodman, gerber, soderberg, morrow, findley",
        ),
        (
            lambda: shaft(wave(0, 1)).stress("bar").grid("von_mises", [2.0]),
            DeclarationError,
            "stress: expected a row of ratios xi/l from 0 to 1, got",
        ),
        (
            lambda: shaft(wave(0, 1)).stress("bar").peak("von_mises", notches=True),
            DeclarationError,
            "the beam of link 'bar' has no notches",
        ),
        (
            lambda: strength.critical_plane(np.zeros((2, 5))),
            DeclarationError,
            r"critical_plane: expected finite stresses \(3, t\), got",
        ),
        (
            lambda: strength.rainflow([1.0, math.nan]),
            DeclarationError,
            "expected a row of finite numbers",
        ),
    ],
)
def test_what_has_no_fatigue_is_refused(ask, error, says):
    with pytest.raises(error, match=says):
        ask()


MATERIALS = {
    "lasting": strong.STEEL.but(endurance=200e6),
    "worn": strong.STEEL.but(endurance=150e6, endless=False),
}

STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]

PROGRAM = """
#include "x_fatigue.h"
#include <stdio.h>

int main(void) {
  const x_fatigue_material materials[] = {X_FATIGUE_OF_LASTING, X_FATIGUE_OF_WORN};
  long many;
  while (scanf("%ld", &many) == 1) {
    int k;
    long i;
    x_fatigue counters[] = {{{0}, 0, 0.0, 0.0}, {{0}, 0, 0.0, 0.0}};
    for (i = 0; i < many; ++i) {
      double stress;
      if (scanf("%lf", &stress) != 1) return 1;
      for (k = 0; k < 2; ++k) x_fatigue_add(&counters[k], &materials[k], stress);
    }
    for (k = 0; k < 2; ++k) printf("%.17g ", x_fatigue_damage(&counters[k], &materials[k]));
    printf("%.17g\\n", counters[0].damage);
  }
  return 0;
}
"""


@pytest.fixture(scope="module")
def count(tmp_path_factory):
    """Damage of histories by both materials, and that of swings that have closed."""
    m, near, folder = Mechanism("x"), None, tmp_path_factory.mktemp("counting")
    for name, material in MATERIALS.items():
        link = m.link(name, length=0.3, beam=beams.Beam(beams.round_bar(0.02), material))
        m.revolute(f"to_{name}", m.ground if near is None else near.tip, link)
        near = link
    laws = {name: polynomial(0.1, 2.0) for name in m.joints}
    export(Scene(m, laws, t=(0.0, 1.0, 11)), folder, wanted=["safety"])
    (folder / "count.c").write_text(PROGRAM)
    compiler = codegen.find_compiler("c")

    def run(histories, depth=64):
        program = folder / f"count_{depth}"
        flags = [*STRICT, f"-DX_FATIGUE_DEPTH={depth}", folder / "count.c", "-o", program, "-lm"]
        subprocess.run([*compiler.command, *flags], check=True)
        rows = (f"{len(one)} " + " ".join(float(x).hex() for x in one) for one in histories)
        done = subprocess.run(
            [program], input="\n".join(rows), capture_output=True, text=True, check=True
        )
        return [list(map(float, line.split())) for line in done.stdout.splitlines()]

    return run


def damage(history, material):
    """Miner's sum over the swings of a whole history that has not ended."""
    swings = strength.rainflow(history) if len(history) else []
    sizes = strength.reversed_amplitude(
        [s.size / 2 for s in swings], [s.mean for s in swings], material
    )
    with np.errstate(divide="ignore"):
        return float(np.sum(np.array([s.times for s in swings]) / strength.cycles(sizes, material)))


def histories(rng):
    """Walks, noise, steps that repeat, sequences that grow and that die away, and short ones."""
    yield from ([], [1e8], [1e8, 1e8], [0.0, 5e8, 5e8, -3e8], [0.0, 6.5e8, 0.0, 6.5e8])
    for _ in range(30):
        size = int(rng.integers(2, 400))
        yield np.cumsum(rng.normal(size=size)) * 6e7
        yield rng.normal(size=size) * 1.5e8
        yield np.round(rng.normal(size=size)) * 1e8
    for ratio in (0.97, 1 / 0.97):
        yield 3e8 * ratio ** np.arange(25) * (-1.0) ** np.arange(25)


def test_c_counts_the_damage_of_the_whole_history(count):
    """What is no number is passed over."""
    every = list(histories(np.random.default_rng(21)))
    for history, found in zip(every, count(every), strict=True):
        told = [damage(history, material) for material in MATERIALS.values()]
        assert found[:2] == pytest.approx(told, rel=1e-10)
        assert found[2] <= found[0] * (1.0 + 1e-12)
    clean, dirty = count(
        [[0.0, 5e8, -3e8, 4e8], [0.0, math.nan, 5e8, math.inf, -3e8, -math.inf, 4e8]]
    )
    assert clean == dirty


def test_a_residue_that_is_too_deep_gives_up_its_oldest_swings(count):
    """One that dies away is counted as before, for each of its swings counts half at last; where
    swings grow again, half of what was given up is missing.
    """
    history = 4e8 * 0.99 ** np.arange(200) * (-1.0) ** np.arange(200)
    told = [damage(history, material) for material in MATERIALS.values()]
    for depth in (64, 8):
        assert count([history], depth)[0][:2] == pytest.approx(told, rel=1e-10)
    again = np.concatenate([history, history[::-1]])
    told = damage(again, MATERIALS["worn"])
    assert told / 2 <= count([again], 8)[0][1] < told * (1.0 + 1e-10)

"""Fatigue against a textbook's solved problems, closed forms, and
searches without any cleverness.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from internals import CRITERIA, _farthest, cycles, factor, loaded, reversed_amplitude

from lagrange_casadi.beams import Material, material
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.quick

# Budynas and Nisbett, Shigley's Mechanical Engineering Design, 8th edition, problems 6-12 to 6-15
# and their solutions: a bar with Se = 276, Sy = 413, Sut = 551 MPa; f = 0.9.
BAR = Material("bar", 7850.0, 207e9, yield_strength=413e6, ultimate=551e6, endurance=276e6)
PROBLEMS = [
    # normal: mean, amplitude; shear: mean, amplitude [MPa]; factors against yield, by Goodman, by
    # Gerber
    ((0, 172), (103, 0), 1.67, 1.06, 1.31),
    ((0, 69), (138, 0), 1.66, 1.46, 1.73),
    ((0, 83), (103, 69), 1.34, 1.18, 1.47),
]


def history(normal, shear):
    turn = np.cos(np.linspace(0.0, 2 * np.pi, 101))
    return 1e6 * np.stack([normal[0] + normal[1] * turn, shear[0] + shear[1] * turn, 0.0 * turn])


@pytest.mark.parametrize(("normal", "shear", "yields", "goodman", "gerber"), PROBLEMS)
def test_solved_problems_of_a_textbook(normal, shear, yields, goodman, gerber):
    swings = loaded(history(normal, shear))
    assert len(swings.times) == 1
    amplitude, mean = swings.amplitude[0], swings.mean[0]
    assert factor(amplitude, mean, BAR, "goodman") == pytest.approx(goodman, abs=0.006)
    assert factor(amplitude, mean, BAR, "gerber") == pytest.approx(gerber, abs=0.006)
    peak = math.hypot(sum(normal), math.sqrt(3) * sum(shear)) * 1e6
    assert BAR.yield_strength / peak == pytest.approx(yields, abs=0.006)


def test_the_life_of_a_solved_problem():
    """Problem 6-15: an amplitude of 358.5 MPa is borne 45 800 times."""
    swings = loaded(history((0, 0), (0, 207)))
    assert swings.amplitude[0] == pytest.approx(358.5e6, rel=1e-3)
    assert cycles(358.5e6, BAR) == pytest.approx(45_800, rel=2e-3)
    assert factor(swings.amplitude[0], swings.mean[0], BAR) == pytest.approx(0.77, abs=0.005)


@pytest.mark.parametrize("criterion", CRITERIA)
@given(st.floats(1e5, 5e8), st.floats(-5e8, 3e8))
def test_at_its_factor_a_load_is_worth_the_endurance_limit(criterion, amplitude, mean):
    n = float(factor(amplitude, mean, BAR, criterion))
    assert reversed_amplitude(n * amplitude, n * mean, BAR, criterion) == pytest.approx(
        BAR.endurance, rel=1e-9
    )


@pytest.mark.parametrize("criterion", CRITERIA)
def test_a_mean_in_compression_is_none(criterion):
    assert (
        factor(1e8, -2e8, BAR, criterion) == factor(1e8, 0.0, BAR, criterion) == pytest.approx(2.76)
    )


def test_a_mean_that_is_too_much_alone():
    assert reversed_amplitude(1e6, 600e6, BAR) == np.inf
    assert cycles(np.inf, BAR) == 0.0


def test_lives_are_on_the_line_and_endless_below_it():
    assert cycles(0.9 * 551e6, BAR) == pytest.approx(1e3)
    assert cycles(276e6 * (1 + 1e-9), BAR) == pytest.approx(1e6, rel=1e-6)
    assert cycles(276e6, BAR) == np.inf
    assert cycles(0.0, BAR.but(endless=False)) == np.inf
    assert cycles(138e6, BAR.but(endless=False)) == pytest.approx(
        1e6 * 2 ** (3 / math.log10(0.9 * 551 / 276))
    )


def test_morrow_takes_the_coefficient_or_the_ultimate_strength_and_345_mega():
    assert factor(1e8, 1e8, BAR, "morrow") == pytest.approx(1 / (1 / 2.76 + 100 / 896))
    assert factor(1e8, 1e8, BAR.but(fatigue_strength=1e9), "morrow") == pytest.approx(
        1 / (1 / 2.76 + 0.1)
    )


def test_what_lacks_is_named():
    with pytest.raises(
        DeclarationError, match=r"'EN AW-6082-T6' has no endurance, which fatigue by goodman needs"
    ):
        factor(1.0, 0.0, material("EN AW-6082-T6"))
    with pytest.raises(
        DeclarationError, match="'x' has no yield_strength, which fatigue by soderberg needs"
    ):
        factor(1.0, 0.0, Material("x", 1.0, endurance=1.0), "soderberg")
    with pytest.raises(
        UnknownNameError, match=r"unknown fatigue criterion 'good' .*valid: goodman, gerber"
    ):
        factor(1.0, 0.0, BAR, "good")


@given(
    arrays(
        float, st.tuples(st.just(3), st.integers(2, 30)), elements=st.integers(-20, 20).map(float)
    )
)
def test_the_largest_difference_is_found(points):
    first, last = _farthest(points)
    gaps = np.linalg.norm(points[:, :, None] - points[:, None], axis=0)
    # Between directions that are looked at, the farthest pair may be missed by little.
    assert np.linalg.norm(points[:, first] - points[:, last]) >= 0.985 * gaps.max()
    flat = points * np.array([1.0, 1.0, 0.0])[:, None]
    first, last = _farthest(flat)
    assert (
        np.linalg.norm(flat[:, first] - flat[:, last])
        >= 0.9985 * np.linalg.norm(flat[:, :, None] - flat[:, None], axis=0).max()
    )


def test_out_of_phase_is_not_in_phase():
    """A circle in the plane of s and sqrt(3) t: its amplitude is its radius, in phase it would be
    1.41 times that.
    """
    t = np.linspace(0.0, 2 * np.pi, 361)
    round_about = loaded(1e6 * np.stack([100 * np.cos(t), 100 / math.sqrt(3) * np.sin(t), 0 * t]))
    assert round_about.amplitude.max() == pytest.approx(100e6, rel=1e-4)
    together = loaded(1e6 * np.stack([100 * np.cos(t), 100 / math.sqrt(3) * np.cos(t), 0 * t]))
    assert together.amplitude.max() == pytest.approx(100e6 * math.sqrt(2), rel=1e-12)


def test_miners_sum_counts_small_swings_too():
    t = np.linspace(0.0, 2 * np.pi, 2001)
    swings = loaded(np.stack([1.5e8 * np.cos(t) + 3.2e8 * np.cos(7 * t), 0 * t, 0 * t]))
    assert swings.times.sum() == 7.0
    assert np.sum(swings.times / cycles(swings.amplitude, BAR)) > 1 / cycles(
        swings.amplitude.max(), BAR
    )

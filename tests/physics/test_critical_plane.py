"""Findley's criterion against closed forms: stresses in phase, with a mean, and a quarter turn out
of phase.
"""

import math

import numpy as np
import pytest
import strong
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import (
    DUCTILE,
    FINDLEY,
    Histories,
    LinkHistories,
    Member,
    critical_plane,
    plane_factor,
    plane_score,
)

from lagrange_casadi import beams, evaluate
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

BAR = beams.Material("bar", 7850.0, 207e9, yield_strength=413e6, ultimate=551e6, endurance=276e6)
TURN = np.linspace(0.0, 2 * math.pi, 361)
ROOT = math.hypot(1.0, DUCTILE)


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
    k (a + m)))/2.
    """
    found = critical_plane(history(mean + amplitude * np.cos(TURN)))
    largest = DUCTILE * (amplitude + mean)
    assert found.value() == pytest.approx(
        1e6 * (largest + math.hypot(amplitude, largest)) / 2, rel=1e-8
    )


def test_a_fully_reversed_tension_is_worth_the_endurance_limit():
    plane = critical_plane(history(138.0 * np.cos(TURN)))
    assert plane_factor(plane, BAR) == pytest.approx(2.0, rel=1e-9)
    # The plane of the largest shear stress, turned towards the one of the largest normal stress.
    assert math.tan(2 * plane.angle) == pytest.approx(1 / DUCTILE, rel=1e-3)


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.0, 1.0), (0.6, 0.8)])
def test_normal_and_shear_stress_in_phase(along):
    """Mohr's circle: its middle counts k times, its radius hypot(1, k) times; whichever way the
    shear stress points.
    """
    radius = math.hypot(50.0, 70.0)
    found = critical_plane(history(100 * np.cos(TURN), *(70 * c * np.cos(TURN) for c in along)))
    assert found.value() == pytest.approx(1e6 * (DUCTILE * 50.0 + radius * ROOT), rel=1e-6)
    twisted = critical_plane(history(0.0, *(70 * c * np.cos(TURN) for c in along)))
    assert twisted.value() == pytest.approx(1e6 * 70.0 * ROOT, rel=1e-6)


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.6, 0.8)])
def test_a_quarter_turn_out_of_phase(along):
    """Shear stress of half the normal one has the same amplitude on all planes that are turned
    about the third direction: the largest normal stress decides, and the plane is the
    cross-section.
    """
    shears = [50 * c * np.sin(TURN) for c in along]
    found = critical_plane(history(100 * np.cos(TURN), *shears))
    assert found.value() == pytest.approx(1e6 * (50.0 + DUCTILE * 100.0), rel=1e-6)
    assert found.angle == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6])
def test_any_amplitudes_out_of_phase_against_all_planes_one_by_one(share):
    normal, shear = 120 * np.cos(TURN) + 30, 80 * np.sin(TURN + 0.4)
    best = 0.0
    for u in np.linspace(0.0, math.pi, 4001):
        c, s = math.cos(u), math.sin(u)
        across = normal * c * c + 2 * shear * c * s
        around = -normal * c * s + shear * (c * c - s * s)
        best = max(best, np.ptp(around) / 2 + share * max(across.max(), 0.0))
    assert critical_plane(history(normal, shear), share).value(share) == pytest.approx(
        1e6 * best, rel=1e-5
    )


def test_no_plane_is_above_its_bound():
    draw = np.random.default_rng(8)
    for _ in range(20):
        values = draw.normal(size=(3, 2, 12)) * 10.0 ** draw.uniform(0, 2, size=(3, 1, 1))
        values[2, 1] = 0.0
        every = np.concatenate([values[0], values[1], values[2]])[None]
        bounds = plane_score().bound(Histories.of(every, np.arange(2), (0, 1)))[0, :, 0]
        assert all(
            critical_plane(values[:, k]).value() <= bounds[k] * (1 + 1e-12) for k in range(2)
        )


def test_a_link_is_judged_by_its_worst_plane():
    """No fibre at other places has less, and at the place that is told the fibre has the factor."""
    steel = strong.STEEL.but(endurance=200e6)
    solution = evaluate(
        strong.slider(200e6), t=(0, 0.2094395, 25), wanted=["section:rod"], certificate=False
    )
    stress = solution.stress("rod")
    histories = LinkHistories.of(Member.of(solution, "rod"))
    worst = histories.worst(plane_score())
    xi = histories.ratio(worst)
    factor = solution.safety("rod", criterion=FINDLEY).against("fatigue")
    there = stress.at(xi)[:, stress.fibres(xi).index(worst.name)]
    assert plane_factor(critical_plane(there), steel) == pytest.approx(factor, rel=1e-12)
    for place in (0.0, 0.2, 0.45, xi, 0.7):
        values = stress.at(place)
        assert all(
            plane_factor(critical_plane(values[:, k]), steel) >= factor * (1 - 1e-9)
            for k in range(values.shape[1])
        )


def test_what_is_no_criterion():
    solution = evaluate(
        strong.slider(200e6), t=(0, 0.2, 5), wanted=["section:rod"], certificate=False
    )
    with pytest.raises(
        UnknownNameError,
        match=r"unknown fatigue criterion 'find'.*goodman, gerber, soderberg, morrow, findley",
    ):
        solution.safety("rod", criterion="find")
    with pytest.raises(DeclarationError, match="has no endurance, which fatigue by findley needs"):
        plane_factor(critical_plane(history(1.0)), strong.STEEL.but(endurance=None))

"""Laws of motion inverted: to their last bits where they can be, refused by their reason where they
cannot.
"""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import Laws, Missed, MotionInverse, motion

pytestmark = pytest.mark.quick

W = ca.SX.sym("w")
TURN = math.tau


def reached(law, start, stop, speeds=(10.0,), around=0.0, count=181):
    """The way of a law with the parameter w, and the times of equal steps along it."""
    law = MotionInverse.of(Laws.of({"J": law}, ca.vertcat(W)), "J")
    p = np.array(speeds, float)[:, None]
    way = law.passage(
        *(np.full(len(p), float(x)) for x in (start, stop)),
        p,
        np.full(len(p), float(around)),
        samples=65,
    )
    coordinates = np.tile(np.linspace(start, stop, count), (len(p), 1))
    return law, way, coordinates, law.times(way, coordinates, p)


def test_a_steady_law_takes_one_subtraction_and_one_division():
    law, _, coordinates, t = reached(motion.polynomial(0.1, W), 0.0, 2 * TURN, (10.0, 3.7))
    assert law.steady
    np.testing.assert_array_equal(t, (coordinates - 0.1) / np.array([[10.0], [3.7]]))


@pytest.mark.parametrize(
    ("rate", "start", "stop"), [(10.0, 0.0, 5.0), (-10.0, TURN, 0.0), (-0.25, 3.0, -40.0)]
)
def test_a_drive_may_turn_backwards(rate, start, stop):
    _, way, _, t = reached(motion.polynomial(0.0, W), start, stop, (rate,))
    assert way.missed.tolist() == [Missed.REACHED]
    assert (np.diff(t) > 0.0).all()


RISING = {
    "run-up": motion.polynomial(0.0, 1.0, W / 2),
    "from rest": motion.polynomial(0.0, 0.0, W),
    "from rest without acceleration": motion.polynomial(0.0, 0.0, 0.0, W),
    "uneven": motion.expression(lambda t: W * t + 0.3 * ca.sin(W * t)),
    "nearly turning back": motion.expression(lambda t: W * t - 0.999 * ca.sin(W * t)),
    "steep": motion.expression(lambda t: 1.0 - ca.exp(-W * t) + 30.0 * t),
    "sampled": motion.samples(
        np.linspace(-0.1, 2.0, 40),
        4.0 * np.linspace(-0.1, 2.0, 40) + 0.1 * np.sin(np.linspace(0, 9, 40)),
    ),
}


@pytest.mark.parametrize("name", RISING)
def test_any_other_law_is_met_to_its_last_bits(name):
    """At every coordinate the law gives that coordinate back, in the order of time, for each design
    by itself.
    """
    speeds = (0.7, 3.0, 25.0)
    law, way, coordinates, t = reached(RISING[name], 0.05, TURN, speeds)
    assert not law.steady
    assert (way.missed == Missed.REACHED).all()
    assert (np.diff(t) > 0.0).all()
    d, rate, _ = law.at(t, np.array(speeds)[:, None])
    allowed = 4 * np.spacing(coordinates) + 2 * np.abs(rate) * np.spacing(np.abs(t))
    assert (np.abs(d - coordinates) <= allowed).all()
    for k, speed in enumerate(speeds):
        np.testing.assert_array_equal(t[k], reached(RISING[name], 0.05, TURN, (speed,))[3][0])


def test_a_run_up_from_rest_is_its_square_root():
    """To the bits that its start at rest leaves: the law is w t^2."""
    _, _, coordinates, t = reached(motion.polynomial(0.0, 0.0, W), 0.0, 2 * TURN, (10.0, 0.3))
    np.testing.assert_allclose(t, np.sqrt(coordinates / np.array([[10.0], [0.3]])), rtol=1e-15)


def test_a_swing_is_its_arc_sine_on_the_stretch_that_is_asked_for():
    swing = motion.harmonic(0.0, 1.0, W)
    up, down = reached(swing, -1.0, 1.0, (2.0,)), reached(swing, 0.9, -0.9, (2.0,), around=0.25)
    np.testing.assert_allclose(up[3], np.arcsin(up[2]) / (4 * math.pi), atol=1e-15)
    np.testing.assert_allclose(down[3], 0.25 - np.arcsin(down[2]) / (4 * math.pi), atol=1e-15)


def test_a_dwell_at_an_end_is_met_where_it_begins():
    rise = motion.expression(lambda t: ca.if_else(t < 1.0, t * t * (3.0 - 2.0 * t), 1.0))
    _, way, _, t = reached(rise, 0.0, 1.0)
    assert way.missed.tolist() == [Missed.REACHED]
    assert t[0, 0] == 0.0
    assert t[0, -1] == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize(
    ("law", "start", "stop", "why"),
    [
        (motion.polynomial(0.5), 0.0, 1.0, Missed.STANDS_STILL),
        (motion.polynomial(0.0, W), 1.0, 0.0, Missed.OTHER_WAY),
        (motion.polynomial(0.0, 1.0, W), 5.0, 0.0, Missed.OTHER_WAY),
        (motion.harmonic(0.0, 1.0, W), 0.0, 1.01, Missed.TURNS_BACK),
        (motion.expression(lambda t: W * t + 1.2 * ca.sin(W * t)), 0.0, 9.0, Missed.TURNS_BACK),
        (
            motion.expression(lambda t: W * t + 0.02 * ca.sin(100 * W * t)),
            0.0,
            9.0,
            Missed.TURNS_BACK,
        ),
        (motion.expression(lambda t: ca.tanh(W * t)), 0.0, 1.5, Missed.NEVER),
        (motion.samples([0, 1, 2, 3], [0, 1, 2, 3.5]), 0.0, 3.6, Missed.ENDS),
    ],
)
def test_what_a_law_does_not_do_is_told_by_its_reason(law, start, stop, why):
    _, way, _, t = reached(law, start, stop)
    assert way.missed.tolist() == [why]
    assert np.isnan(t).all()


def test_of_many_designs_each_has_its_own_reason():
    _, way, _, t = reached(motion.polynomial(0.0, W), 0.0, 1.0, (2.0, 0.0, -2.0, math.nan))
    assert way.missed.tolist() == [
        Missed.REACHED,
        Missed.STANDS_STILL,
        Missed.OTHER_WAY,
        Missed.NEVER,
    ]
    assert np.isfinite(t).all(axis=1).tolist() == [True, False, False, False]


@settings(max_examples=30, deadline=None)
@given(
    ripple=st.floats(-0.9, 0.9),
    waves=st.integers(1, 12),
    speed=st.floats(1e-3, 1e4),
    start=st.floats(-50.0, 50.0),
    way=st.floats(0.01, 100.0),
    back=st.booleans(),
)
def test_any_ripple_that_does_not_turn_back_is_inverted(ripple, waves, speed, start, way, back):
    sign = -1.0 if back else 1.0
    law = motion.expression(lambda t: sign * (W * t + ripple / waves * ca.sin(waves * W * t)))
    law, found, coordinates, t = reached(law, start, start + sign * way, (speed,), count=33)
    assert found.missed.tolist() == [Missed.REACHED]
    assert (np.diff(t) > 0.0).all()
    np.testing.assert_allclose(
        law.at(t, np.array([[speed]]))[0], coordinates, rtol=0, atol=1e-13 * (1 + abs(start) + way)
    )

"""Second derivatives of peaks by parameters: beside closed forms, and beside differences of first
ones.
"""

import itertools
import math

import casadi as ca
import mpmath
import numpy as np
import pytest
from conftest import CASES
from internals import PeakKind

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, prepare, sensitivities
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import UnknownNameError
from lagrange_casadi.motion import harmonic, polynomial, samples

pytestmark = pytest.mark.usefixtures("interpreted")


def test_a_smooth_peak_bends_as_its_closed_form():
    """The effort of an oscillating arm at its exact peak, which moves with every parameter, in 30
    digits.
    """
    m = Mechanism("arm")
    l, swing, beat = (
        m.parameter("l", 0.7, "m"),
        m.parameter("swing", 0.6, "rad"),
        m.parameter("beat", 1.3, "Hz"),
    )
    m.revolute("O", m.ground, m.link("arm", length=l, mass=2.0))
    f = prepare(Scene(m, {"O": harmonic(0.2, swing, beat)}, t=(0, 0.7, 40)), wanted=["effort"])
    start = float(f.peaks().t[0])

    def effort(t, l, swing, beat):
        w = 2 * mpmath.mp.pi * beat
        angle, acceleration = (
            mpmath.mpf(0.2) + swing * mpmath.sin(w * t),
            -swing * w * w * mpmath.sin(w * t),
        )
        return 2 * l**2 / 3 * acceleration + mpmath.mpf(9.81) * l * mpmath.cos(angle)

    def peak(*p):
        t = mpmath.findroot(lambda t: mpmath.diff(lambda x: effort(x, *p), t), mpmath.mpf(start))
        return effort(t, *p)

    with mpmath.workdps(30):
        at, exact = [mpmath.mpf(0.7), mpmath.mpf(0.6), mpmath.mpf(1.3)], np.empty((3, 3))
        for i, k in itertools.combinations_with_replacement(range(3), 2):
            orders = tuple((n == i) + (n == k) for n in range(3))
            exact[i, k] = exact[k, i] = float(mpmath.diff(peak, at, orders))
    found = f.curvature()
    np.testing.assert_allclose(found.bends[0], exact, rtol=1e-10, atol=1e-10 * np.abs(exact).max())
    assert found["effort:O"]["l"]["beat"] == found.bends[0, 0, 2]
    with pytest.raises(UnknownNameError, match="quantity with a peak"):
        found["effort:X"]


def rotor():
    """A link that turns; no gravity.

    Its axial force at the base is its first moment times the square of the rate.
    """
    m = Mechanism("rotor")
    m.set_gravity(0, 0)
    speed, l = m.parameter("speed", 20.0, "rad/s"), m.parameter("l", 0.4, "m")
    m.revolute("O", m.ground, m.link("arm", length=l, density=density(3.0, -1.0)))
    return m, speed


MOMENT = 3.0 / 2 - 1.0 / 3


def test_a_level_peak():
    m, speed = rotor()
    f = prepare(Scene(m, {"O": polynomial(0.0, speed)}, t=(0.0, 0.1, 11)), wanted=["section:arm"])
    bends = f.curvature(speed=30.0, l=0.5)["section:arm:axial"]
    exact = {
        "speed": {"speed": 2 * 0.25, "l": 4 * 30 * 0.5},
        "l": {"speed": 4 * 30 * 0.5, "l": 2 * 900.0},
    }
    for one, row in exact.items():
        for other, value in row.items():
            assert bends[one][other] == pytest.approx(MOMENT * value, rel=1e-13)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("asked", ["times", "over", "samples"])
def test_a_peak_at_an_end_that_moves(asked):
    """The rate is 20 T at the last instant T, which goes with the speed, or with its root."""
    m, speed = rotor()
    law = polynomial(0.0, 0.0, 10.0)
    if asked == "samples":
        times = np.linspace(0.0, 1.5, 16)
        law = samples(times, (10 * times**2).tolist())
    at = {"t": (0.0, speed / 20, 21)} if asked == "times" else {"over": ("O", 0.1, speed / 2, 21)}
    f = prepare(Scene(m, {"O": law}, t=(0.0, 1.0, 21)), wanted=["section:arm"], **at)
    gradient, found = f.gradient(), f.curvature()
    assert PeakKind(gradient.kinds[0]) is PeakKind.END
    bends = found["section:arm:axial"]
    share = MOMENT * 0.4**2
    # m l^2 (speed)^2, and m l^2 400 (speed/20).
    exact = (
        {"speed": 2 * share, "l": 2 * share * 40 / 0.4}
        if asked == "times"
        else {"speed": 0.0, "l": 2 * share * 20 / 0.4}
    )
    assert bends["speed"]["speed"] == pytest.approx(exact["speed"], rel=1e-11, abs=1e-9)
    assert bends["speed"]["l"] == pytest.approx(exact["l"], rel=1e-11)


def test_a_jump_whose_time_moves():
    """A brake sets in at an angle, at T = onset/speed, with 5 exp(-3 T)."""
    m, speed = rotor()
    onset = m.parameter("onset", 1.0, "rad")
    arm = m.bodies["arm"]
    m.torque("brake", arm, -5.0 * (m.direction(arm) > onset) * ca.exp(-3.0 * m.time))
    f = prepare(Scene(m, {"O": polynomial(0.0, speed)}, t=(0.0, 0.1, 41)), wanted=["effort"])
    assert PeakKind(f.gradient().kinds[0]) is PeakKind.SWITCH
    bends, at = f.curvature()["effort:O"], 1.0 / 20.0
    size = 5.0 * math.exp(-3.0 * at)
    assert bends["onset"]["onset"] == pytest.approx(9 * size / 400, rel=1e-8)
    assert bends["onset"]["speed"] == pytest.approx(size * (3 / 400 - 9 * at / 400), rel=1e-8)
    assert bends["speed"]["speed"] == pytest.approx(
        size * (9 * at**2 / 400 - 6 * at / 400), rel=1e-8
    )


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "four_bar",
        "quick_return",
        "cardan_shaft",
        "connecting_rod",
        "servo_press",
        "roller_cam",
        "scara",
    ],
)
def test_they_are_differences_of_first_ones(name):
    """Of all kinds of peaks, also along links, of loops that are iterated, and of instants that
    move.
    """
    scene = load_case(CASES / name).scene
    f = prepare(scene, wanted=["effort", "reaction", "section"])
    found, gradient = f.curvature(), f.gradient()
    p = f._answers.p[0].copy()
    sizes = (
        np.abs(gradient.value)
        + np.nanmax(np.abs(found.bends) * np.abs(p[:, None] * p), axis=(1, 2))
        + 1e-300
    )
    whole = np.abs(gradient.value) > 1e-9 * np.abs(gradient.value).max()
    for j, parameter in enumerate(f.parameters):
        step = 1e-4 * (abs(p[j]) or 1.0)
        four = {k: f.gradient(**{parameter: float(p[j] + k * step)}).slopes for k in (-2, -1, 1, 2)}
        exact = (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)
        gaps = (np.abs(found.bends[:, :, j] - exact) * np.abs(p * p[j])).max(axis=1) / sizes
        assert np.nanmax(gaps[whole]) <= 1e-6, (
            parameter,
            f.quantities[int(np.nanargmax(np.where(whole, gaps, 0.0)))],
        )
    assert np.isfinite(found.bends[whole]).all()


def test_of_series_too():
    m, speed = rotor()
    scene = Scene(m, {"O": polynomial(0.0, speed, 5.0)}, t=(0.0, 0.1, 5), xi=(0, 1, 3))
    changes = sensitivities(scene, evaluate(scene, certificate=False))
    # The axial force at the base is m l^2 rate^2.
    rate = 20.0 + 10.0 * changes.solution.t
    found = changes.curvature("section:arm:axial", "l", "speed")
    assert found.shape == (5, 3)
    np.testing.assert_allclose(found[:, 0], 4 * MOMENT * 0.4 * rate, rtol=1e-13)
    np.testing.assert_allclose(changes.curvature("motion:O_rate", "speed", "l"), 0.0, atol=0.0)
    with pytest.raises(UnknownNameError, match="parameter"):
        changes.curvature("effort:O", "l", "r")

"""Mechanisms in space against numbers from elsewhere, closed forms and statics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import CASES
from mechanisms import pins_of

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.motion import polynomial


def scene_of(name):
    return load_case(CASES / name).scene


def vm(scene, **keywords):
    return evaluate(scene, backend="vm", certificate=False, **keywords)


def test_the_benchmarks_slider_at_its_start():
    slide = vm(scene_of("spatial_slider_crank"), t=(0, 0, 1), wanted=["motion"]).motion("guide")
    assert (slide.value[0], slide.rate[0], slide.acceleration[0]) == pytest.approx(
        (0.2, 0.24, 1.44), abs=1e-14
    )


def test_a_shaft_out_of_phase_pulsates():
    """Hooke's joint twice: without inertia the torque follows the speed, between cos^2 and 1/cos^2
    of the tube's angle.
    """
    square = 1 - (0.15 / 0.5) ** 2
    parameters = {"phase": math.pi / 2}
    slow = vm(
        scene_of("cardan_shaft"), parameters=parameters | {"rpm": 1e-3}, wanted=["effort", "motion"]
    )
    ratio = slow.motion("far:turn").rate / slow.motion("bearing").rate
    assert (ratio.min(), ratio.max()) == pytest.approx((square, 1 / square), rel=1e-12)
    assert np.max(np.abs(slow.effort("bearing") - 80.0 * ratio)) < 1e-7
    assert (slow.effort("bearing").min(), slow.effort("bearing").max()) == pytest.approx(
        (72.8, 80 / 0.91), abs=1e-7
    )
    fast = vm(scene_of("cardan_shaft"), parameters=parameters, wanted=["effort"]).effort("bearing")
    assert np.mean(fast[:-1]) == pytest.approx(80.0, abs=1e-11)
    assert np.ptp(fast) > 4 * np.ptp(slow.effort("bearing"))


def test_a_slider_beside_its_guide_hangs_on_its_pin():
    """A cylindrical guide bears no moment about its line: the pin bears that of the weight."""
    m, side, mass = SpatialMechanism("beside"), 0.04, 3.0
    m.set_gravity(0.0, -9.81, 0.0)
    crank, rod = m.link("crank", length=0.1, mass=0.5), m.link("rod", length=0.4, mass=0.6)
    inertia = (0.01, 0.01, 0.01)
    slider = m.link("slider", length=0.05, mass=mass, centre=(0.0, 0.0, side), inertia=inertia)
    pins_of(m, axis=(0, 0, 1), O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, slider))
    m.cylindrical("G", m.ground, slider, axis=(1, 0, 0))
    law, posture = {"O": polynomial(0.3, 2.0)}, {"A": -0.4, "B": 0.1}
    solution = evaluate(Scene(m, law, t=(0, 1, 9), posture=posture))
    assert solution.certified
    assert solution.reaction("B").mx == pytest.approx(-mass * 9.81 * side, rel=1e-12)

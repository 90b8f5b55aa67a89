"""The cases in space against numbers from elsewhere, closed forms, statics and energies that are
worked out here.
"""

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


FORCES = ("axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z")


def test_an_arm_by_stored_numbers():
    """What Pinocchio 4.1.0 gave for the case at t = 0.7 s: efforts, then link 2 at half its
    length.
    """
    scene = load_case("arm6").scene
    solution = evaluate(scene, t=(0.7, 0.7, 1))
    law, half = solution.section("link2").law, np.array([[0.5]])
    found = [solution.effort(name)[0] for name in scene.motion]
    found += [law.at(force, half)[0, 0] for force in FORCES]
    assert found == pytest.approx(STORED, abs=1e-12 * np.abs(STORED).max())


STORED = (
    -13.366571991228078,
    -81.8860337066446,
    -35.95540567458077,
    0.5185214952163023,
    -5.1743306998229075,
    -0.0006327755976294354,
    -43.15448736579151,
    109.5231675289179,
    18.896270642899925,
    5.9552533950632105,
    -11.7118547489456,
    56.52568637869752,
)


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


def test_four_feet_bear_the_weight():
    """At rest the normal forces add up to the weight, alike on both sides."""
    case = load_case("quadruped").scene
    at_rest = dict.fromkeys(case.motion, polynomial(0.0))
    scene = Scene(case.mechanism, at_rest, t=(0, 0, 1), drives=list(case.drives))
    solution = evaluate(scene, wanted=["effort", "output"], backend="vm")
    normal = {
        leg: solution.series[f"output:{leg}_foot_normal"][0] for leg in ("FL", "FR", "RL", "RR")
    }
    assert sum(normal.values()) == pytest.approx((8.0 + 2.0 + 4 * 1.7) * 9.81, rel=1e-12)
    assert normal["FL"] == pytest.approx(normal["FR"], rel=1e-12)
    assert solution.effort("RL_knee")[0] == pytest.approx(solution.effort("RR_knee")[0], rel=1e-11)
    assert not any("foot" in note for note in solution.notes)

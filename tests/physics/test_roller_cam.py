"""The case of a roller cam: closed forms of its contact, its profile, and the smallest spring that
holds the contact.
"""

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case, refine

pytestmark = pytest.mark.usefixtures("interpreted")

MASS, OFFSET, ROLLER = 0.5, 0.006, 0.012


@pytest.mark.parametrize(
    "values", [{}, {"lift": 0.015, "base": 0.06, "stiffness": 20e3, "speed": 40.0}]
)
def test_the_contact_is_that_of_closed_forms(values):
    """Norton's pressure angle; the spring, the weight and inertia over its cosine; their moment on
    the shaft.
    """
    solution = evaluate(load_case(CASES / "roller_cam").scene, parameters=values)
    assert solution.certified
    given = {"base": 0.045, "stiffness": 12e3, "speed": 60.0, "lift": 0.02} | values
    motion = solution.motion("guide")
    least, place = np.sqrt((given["base"] + ROLLER) ** 2 - OFFSET**2), motion.value - 0.05
    assert np.ptp(motion.value) == pytest.approx(given["lift"], rel=1e-3)
    assert place.min() == pytest.approx(least, rel=1e-12)
    pushed = MASS * (motion.acceleration + 9.81) + 300.0 + given["stiffness"] * (place - least)
    tangent = (motion.rate / given["speed"] - OFFSET) / place
    force = solution.output("contact_force")
    assert force == pytest.approx(pushed * np.hypot(1.0, tangent), rel=1e-10)
    assert solution.output("contact_pressure_angle") == pytest.approx(
        np.arctan(np.abs(tangent)), abs=1e-11
    )
    assert solution.reaction("guide").fx == pytest.approx(
        pushed * tangent, rel=0, abs=1e-10 * pushed.max()
    )
    assert solution.effort("shaft") == pytest.approx(
        pushed * motion.rate / given["speed"], rel=0, abs=1e-11 * pushed.max()
    )
    assert force.min() > 0.0


def test_accelerations_are_those_of_the_laws():
    """2 pi h/beta^2 of cycloids, up and back, times the speed squared."""
    scene = load_case(CASES / "roller_cam").scene
    solution = evaluate(scene)
    up, back = (np.radians(angle) for angle in (100.0, 150.0))
    acceleration = solution.motion("guide").acceleration
    assert acceleration.max() == pytest.approx(2 * np.pi * 0.02 / up**2 * 60.0**2, rel=2e-3)
    turn = solution.motion("shaft").value % (2 * np.pi)
    falling = (turn > np.radians(120.0)) & (turn < np.radians(270.0))
    assert -acceleration[falling].min() == pytest.approx(
        2 * np.pi * 0.02 / back**2 * 60.0**2, rel=2e-3
    )
    (peak,) = refine(scene, solution, ["output:contact_hertz"])
    assert 3e8 < peak.value < 1.5e9  # what hardened steel bears

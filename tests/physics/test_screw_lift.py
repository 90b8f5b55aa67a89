"""The case of a screw lift: torques up and down, efficiency, and where the screw stops locking
itself.
"""

import math

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.parametrize("values", [{}, {"mu": 0.05, "payload": 300.0}, {"lead": 0.012, "mu": 0.2}])
def test_the_motor_lifts_the_weight_and_the_friction(values):
    """W r tan(angle +- phi) with the inertia of table and spindle; the efficiency of the way up;
    and work of the whole cycle.
    """
    solution = evaluate(load_case(CASES / "screw_lift").scene, parameters=values)
    assert solution.certified
    told = {"mu": 0.12, "payload": 800.0, "lead": 0.006} | values
    angle, phi = math.atan(told["lead"] / (2 * math.pi) / 0.0135), math.atan(told["mu"])
    motion, table = solution.motion("motor"), solution.motion("guide")
    weight = 9.81 * (told["payload"] + 60.0) + 60.0 * table.acceleration
    up = table.rate > 0.0
    thread = weight * 0.0135 * np.where(up, math.tan(angle + phi), math.tan(angle - phi))
    # The spindle turns backward on the way up.
    assert solution.effort("motor") == pytest.approx(6e-4 * motion.acceleration - thread, rel=1e-11)
    assert table.value == pytest.approx(-motion.value * told["lead"] / (2 * math.pi), abs=1e-13)
    lifted, given = weight * table.rate, -thread * motion.rate
    assert (lifted / given)[up] == pytest.approx(
        np.full(up.sum(), math.tan(angle) / math.tan(angle + phi)), rel=1e-11
    )
    assert solution.output("lifting_power") == pytest.approx(lifted, rel=1e-11)
    # Where it locks itself, it must be driven down.
    assert (given[~up] > 0.0).all() == (phi > angle)
    lost = solution.series["friction:flanks:loss"]
    assert given - lifted == pytest.approx(lost, rel=1e-10, abs=1e-10)
    assert (lost > 0.0).all()


def test_what_lies_along_the_spindle_is_determined():
    solution = evaluate(load_case(CASES / "screw_lift").scene)
    weight = 9.81 * 860.0 + 60.0 * solution.motion("guide").acceleration
    assert solution.reaction("motor").fz == pytest.approx(weight + 9.81 * 5.0, rel=1e-12)
    assert np.isnan(solution.reaction("motor").fx).all()
    assert {output.part for output in solution.indeterminate} == {"motor", "guide", "thread"}

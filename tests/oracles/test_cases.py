"""Every case: its certificate and its page; figures of some that are known."""

import math

import numpy as np
import pytest
from conftest import CASES, NAMES
from scipy.integrate import trapezoid

from lagrange_casadi import evaluate, load_case

pytestmark = pytest.mark.usefixtures("released")


@pytest.mark.sampled(15)
@pytest.mark.parametrize("name", NAMES)
def test_certificate_is_at_rounding_level(name):
    certificate = evaluate(load_case(CASES / name).scene).certificate
    expected = {"closure", "balance", "power"}
    assert expected <= set(certificate)
    # A lead of 6 mm makes of a rounding of lengths, 1 m times 1e-16, one of 1e-13 in the angle.
    level = {"closure": 1e-12} if name == "screw_lift" else {}
    for residual in expected:
        assert np.max(certificate[residual]) < level.get(residual, 1e-13), residual


@pytest.mark.parametrize("name", NAMES)
def test_a_page_says_what_it_is(name):
    page = (CASES / name / "README.md").read_text()
    assert page.startswith(f"# {name}\n")
    for word in ("Source:", "Expected values:", f"lagrange-casadi run cases/{name}"):
        assert word in page, word


# The set's equations at its beta, beta' and beta'' alone, everything else from the loops, in
# 60-digit arithmetic.
EXACT = {"P3": (199.17534806422029369, -29.755310058961486767), "P4": (23.066543603840927337,
    31.452725249522902698),
         "P6": (22.642494779373571809, 11.617392381073002921)}  # fmt: skip
EXACT_TORQUE = 0.033000002514822625774


def test_squeezer_against_the_sets_equations_in_60_digits():
    """The reactions of the pins that close the loops are the set's multipliers, in its order and
    with its signs.
    """
    solution = evaluate(load_case(CASES / "andrews_squeezer").scene, t=(0, 0, 1))
    for pin, expected in EXACT.items():
        found = (solution.reaction(pin).fx[0], solution.reaction(pin).fy[0])
        assert found == pytest.approx(expected, abs=1e-12 * 200)
    assert solution.effort("O")[0] == pytest.approx(EXACT_TORQUE, abs=1e-13)


def test_a_leg_takes_no_work_over_a_turn():
    """Weights, inertia at a constant speed, and a constant push give back what they took; and the
    foot goes its known way.
    """
    found = evaluate(load_case(CASES / "jansen_leg").scene, t=(0, 1.5, 7201))
    effort, angle = found.effort("O"), found.motion("O").value
    assert angle[-1] - angle[0] == pytest.approx(-2 * math.pi)
    assert abs(trapezoid(effort, angle)) < 1e-9 * np.abs(effort).max()
    assert np.ptp(found.output("foot_x")) == pytest.approx(0.679, abs=1e-3)
    assert np.ptp(found.output("foot_y")) == pytest.approx(0.225, abs=1e-3)

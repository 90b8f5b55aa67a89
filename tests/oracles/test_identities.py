"""What must hold whatever the numbers, beside what certificates check: an element's equilibrium,
scaling.
"""

import numpy as np
import pytest
from internals import certify
from mechanisms import slider_crank

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def cycle(values):
    return np.max(np.abs(values))


@pytest.mark.parametrize("link", ["crank", "rod"])
def test_an_element_is_in_equilibrium(slider_crank_fine, link):
    """d(bending)/d(xi) = -shear: exact for a cubic by Richardson's extrapolated differences."""
    section = slider_crank_fine.section(link)
    length = section.law.length
    h = section.xi[1] * length
    b = section.bending
    slope = (8 * (b[:, 3:-1] - b[:, 1:-3]) - (b[:, 4:] - b[:, :-4])) / (12 * h)
    assert cycle(slope + section.shear[:, 2:-2]) < 1e-11 * cycle(section.shear)


@pytest.fixture(scope="module")
def slider_crank_fine(slider_crank):
    return evaluate(slider_crank.scene, xi=(0, 1, 41), t=(0, 0.08, 101))


def test_no_moment_at_pins(solution):
    rod = solution.section("rod").bending
    assert np.all(rod[:, -1] == 0.0)
    assert cycle(rod[:, 0]) < 1e-13 * cycle(rod)
    crank = solution.section("crank").bending
    assert np.all(crank[:, -1] == 0.0)
    assert cycle(crank[:, 0] + solution.effort("O")) < 1e-13 * cycle(crank)


def test_forces_scale_with_masses(slider_crank):
    """All masses doubled: every force and moment doubled, to the bit, for doubling is exact."""
    one = evaluate(slider_crank.scene, t=(0, 0.08, 41))
    two = evaluate(
        slider_crank.scene, t=(0, 0.08, 41), parameters={"m1": 0.2, "m2": 0.2, "m3": 0.2}
    )
    for name in one.names():
        factor = 1.0 if name.startswith(("motion", "pose")) else 2.0
        np.testing.assert_array_equal(two.array(name), factor * one.array(name), err_msg=name)


def test_forces_scale_with_speed():
    """Less what gravity does, twice the speed at the same posture is four times every force."""
    program = derive(slider_crank())
    p = [0.1, 0.2, 0.1, 0.1, 0.1]
    for angle in np.linspace(0.0, 6.0, 13):
        still, slow, fast = (
            program.instant(0.0, angle, rate, 0.0, [], p).full().ravel()
            for rate in (0.0, 5.0, 10.0)
        )
        forces = [
            k
            for k, name in enumerate(program.names)
            if name.startswith(("effort", "reaction", "section"))
        ]
        gap = (fast - still - 4 * (slow - still))[forces]
        assert cycle(gap) < 1e-13 * cycle(fast[forces])


def test_a_link_that_bears_nothing_at_its_base_is_certified_by_what_acts_on_it():
    m = Mechanism("beam")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1).at(0.3))
    certificate = evaluate(Scene(m, {"J": polynomial(0, 1)}, t=(0, 1, 20))).certificate
    assert np.max(certificate["ends"]) < 1e-14


def test_blocks_change_no_certificate(solution, monkeypatch):
    whole = certify(solution)
    monkeypatch.setattr("lagrange_casadi.verification.certificate._BLOCK", 77)
    for name, values in certify(solution).items():
        assert np.array_equal(values, whole[name])

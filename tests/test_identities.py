"""What must hold whatever the numbers: power, equilibrium, the equilibrium of an element, ends,
scaling.
"""

import numpy as np
import pytest
from mechanisms import slider_crank

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.declare.motion import polynomial
from lagrange_casadi.verification.certificate import certify

pytestmark = pytest.mark.quick

G = 9.81


def cycle(values):
    return np.max(np.abs(values))


def test_power_balance(solution):
    """Effort times rate is the change of kinetic and potential energy, from the accelerations and
    velocities of the parts.
    """
    mass, r, l = 0.1, 0.1, 0.2
    crank, rod, slider = (solution.motion(j) for j in ("O", "A", "guide"))
    angle, rate, acc = crank.value, crank.rate, crank.acceleration
    spin, turn = crank.rate + rod.rate, crank.acceleration + rod.acceleration
    direction = angle + rod.value
    e1 = np.array([np.cos(angle), np.sin(angle)])
    n1 = np.array([-np.sin(angle), np.cos(angle)])
    e2 = np.array([np.cos(direction), np.sin(direction)])
    n2 = np.array([-np.sin(direction), np.cos(direction)])
    vc = r * rate * n1 + l / 2 * spin * n2
    ac = r * (acc * n1 - rate**2 * e1) + l / 2 * (turn * n2 - spin**2 * e2)
    gravity = np.array([0.0, -G])[:, None]
    power = mass * r**2 / 3 * acc * rate + mass * G * r / 2 * rate * np.cos(angle)
    power += mass * np.sum((ac - gravity) * vc, axis=0) + mass * l**2 / 12 * turn * spin
    power += mass * slider.acceleration * slider.rate
    assert cycle(solution.effort("O") * rate - power) < 1e-13 * cycle(power)


def test_whole_mechanism_is_in_equilibrium(solution):
    """Ground reactions and weight give the momentum's change of all parts together."""
    mass, r, l = 0.1, 0.1, 0.2
    angle, rate, acc = (getattr(solution.motion("O"), k) for k in ("value", "rate", "acceleration"))
    pose = solution.pose("rod")
    spin = rate + solution.motion("A").rate
    turn = acc + solution.motion("A").acceleration
    ax = r / 2 * (-acc * np.sin(angle) - rate**2 * np.cos(angle))
    ay = r / 2 * (acc * np.cos(angle) - rate**2 * np.sin(angle))
    bx = 2 * ax + l / 2 * (-turn * np.sin(pose.angle) - spin**2 * np.cos(pose.angle))
    by = 2 * ay + l / 2 * (turn * np.cos(pose.angle) - spin**2 * np.sin(pose.angle))
    o, guide = solution.reaction("O"), solution.reaction("guide")
    scale = cycle(o.fx)
    assert (
        cycle(o.fx + guide.fx - mass * (ax + bx + solution.motion("guide").acceleration))
        < 1e-13 * scale
    )
    assert cycle(o.fy + guide.fy - 3 * mass * G - mass * (ay + by)) < 1e-13 * scale


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


@pytest.mark.parametrize(("link", "base", "tip"), [("crank", "O", "A"), ("rod", "A", "B")])
def test_end_sections_are_the_joint_reactions(solution, link, base, tip):
    """At xi = 0 the outboard side is the whole link, which gives the reaction back; at xi = l the
    next link acts.
    """
    pose, section = solution.pose(link), solution.section(link)
    e = np.array([np.cos(pose.angle), np.sin(pose.angle)])
    n = np.array([-np.sin(pose.angle), np.cos(pose.angle)])
    for joint, column in ((base, 0), (tip, -1)):
        # A reaction acts on the joint's child: on this link at its base, on the next link at its
        # tip; in both the section feels the opposite, at the base because the outboard side is what
        # the reaction holds.
        force = -np.array([solution.reaction(joint).fx, solution.reaction(joint).fy])
        assert cycle(section.axial[:, column] - np.sum(e * force, axis=0)) < 1e-13 * cycle(
            section.axial
        )
        assert cycle(section.shear[:, column] - np.sum(n * force, axis=0)) < 1e-13 * cycle(
            section.axial
        )


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

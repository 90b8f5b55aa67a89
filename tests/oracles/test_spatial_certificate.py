"""The certificate of mechanisms in space: at the level of rounding whatever holds the bodies."""

import pytest
from mechanisms import links_of
from spatial_solutions import residuals

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion

pytestmark = pytest.mark.usefixtures("interpreted")

WHOLE = {"closure", "balance", "power", "ends"}


def hung_on_masses(m):
    """A bar between two point masses on lines, and a force on it: no joint gives its direction's
    rate, and its ends do.
    """
    a, b, bar = m.point_mass("a", 1.0), m.point_mass("b", 2.0), m.link("bar", length=0.5, mass=1.0)
    m.prismatic("P", m.ground, a, axis=(1, 0, 0))
    m.prismatic("Q", m.ground, b, axis=(0.1, 1, 0.2))
    m.spherical("S", a, bar)
    m.spherical("T", bar.tip, b)
    m.force("push", bar.at(0.2), x=3, z=-2)
    return {"P": motion.harmonic(0.2, 0.1, 1.0)}, {"Q": 0.4}


def on_a_mass(m):
    """A link whose base is at a point mass, turned by the link at its tip."""
    a = m.point_mass("a", 1.0)
    b, c = links_of(m, b=(0.5, 1.0), c=(0.5, 1.0))
    m.prismatic("P", m.ground, a, axis=(1, 0, 0))
    m.spherical("S", a, b)
    m.revolute("R", m.ground.at(0.3, 0.2, 0.1), c, axis=(0, 0, 1))
    m.universal("U", c.tip, b.tip, axis=(0, 0, 1), second=(0, 1, 0))
    return {"P": motion.harmonic(0, 0.1, 1.0)}, {"R": 0.1, "U:turn_1": 0.1, "U:turn_2": 0.1}


def light(m):
    """A link without mass that carries a point mass."""
    a, b = m.link("a", length=0.6, mass=0.0), m.point_mass("b", 2.0)
    m.universal("A", m.ground, a, axis=(0, 0, 1), second=(0, 1, 0))
    m.spherical("B", a.tip, b)
    return {"A": [motion.polynomial(0, 1.0), motion.polynomial(0.2, 0.3)]}, {}


def rolling_arm(m):
    """A link that turns about its own axis, on one that turns about z: of its axis one rate is
    nothing but rounding.
    """
    a, b = m.link("a", length=0.4, mass=1.0), m.link("b", length=0.3, mass=0.6)
    m.revolute("A", m.ground, a, axis=(0, 0, 1))
    m.revolute("B", a.tip, b, axis=(1, 0, 0))
    return {"A": motion.polynomial(0.1, 0.3), "B": motion.polynomial(0.0, 2.0)}, {}


@pytest.mark.parametrize("declare", [hung_on_masses, on_a_mass, light, rolling_arm])
def test_whatever_holds_the_bodies(declare):
    m = SpatialMechanism(declare.__name__)
    laws, posture = declare(m)
    solution = evaluate(Scene(m, laws, t=(0, 1, 11), posture=posture))
    assert set(residuals(solution.certificate)) == WHOLE
    assert max(residuals(solution.certificate).values()) < 1e-14


def test_many_turns_do_not_blur_what_is_judged():
    """A drive of ten million radians, far from the origin: angles have lost seven digits, and their
    phases are known.
    """
    m = SpatialMechanism("many")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.3, mass=1.0)
    m.revolute("A", m.ground.at(5, 6, 7), a, axis=(0, 1, 1))
    m.universal("B", a.tip, b, axis=(0, 0, 1), second=(0, 1, 0))
    laws = {
        "A": motion.polynomial(0, 1e4),
        "B": [motion.polynomial(0, 2e3), motion.polynomial(0, 1e3)],
    }
    solution = evaluate(Scene(m, laws, t=(0, 1000, 101)))
    assert max(residuals(solution.certificate).values()) < 1e-11
    assert solution.certified

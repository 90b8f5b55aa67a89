"""Which fibre a bending moment stretches, found without a moment: the section is a pin in one fibre
and a bar in another.
"""

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, evaluate

pytestmark = pytest.mark.usefixtures("interpreted")

LENGTH, AT, LOAD = 2.0, 0.25, 10.0


def cantilever(tip):
    """The forces in a beam from a wall along x, without gravity, whose tip bears the force ``tip``
    along y.
    """
    m = Mechanism("cantilever")
    m.set_gravity(0, 0)
    beam = m.link("beam", length=LENGTH, mass=1.0)
    m.weld("wall", m.ground, beam)
    m.force("load", beam.tip, y=tip)
    return evaluate(Scene(m, {}, t=(0, 1, 2), xi=(0, 1, 5))).section("beam")


def fibre(side, tip, height=0.1, reach=0.3):
    """The moment that a fibre at ``side`` (1: that of n) bears, by its tension: what the pin in the
    other fibre cannot.
    """
    m = Mechanism("fibres")
    m.set_gravity(0, 0)
    beam = m.link("beam", length=LENGTH * (1 - AT), mass=1.0)
    bar = m.link("bar", length=reach, mass=1.0)
    m.revolute("pin", m.ground.at(LENGTH * AT, -side * height / 2), beam.at(0, -side * height / 2))
    m.revolute("back", m.ground.at(LENGTH * AT - reach, side * height / 2), bar)
    m.revolute("front", bar.tip, beam.at(0, side * height / 2))
    m.force("load", beam.tip, y=tip)
    solution = evaluate(Scene(m, {}, t=(0, 1, 2), posture={"bar": 0.0, "beam": 0.0}))
    return height * solution.section("bar").axial[0, 0]


@pytest.mark.parametrize("tip", [-LOAD, LOAD])
def test_a_positive_moment_stretches_the_fibres_away_from_n(tip):
    section = cantilever(tip)
    bending = section.bending[0, np.searchsorted(section.xi, AT)]
    assert bending == pytest.approx(tip * LENGTH * (1 - AT), rel=1e-12)
    assert fibre(-1, tip) == pytest.approx(bending, rel=1e-12)
    assert fibre(1, tip) == pytest.approx(-bending, rel=1e-12)


def test_the_forces_of_a_loaded_tip():
    section = cantilever(-LOAD)
    np.testing.assert_allclose(section.axial, 0.0, atol=1e-12)
    np.testing.assert_allclose(section.shear, -LOAD, rtol=1e-12)
    np.testing.assert_allclose(
        section.bending[0], -LOAD * LENGTH * (1 - section.xi), rtol=1e-12, atol=1e-12
    )

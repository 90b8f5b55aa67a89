"""The law as numbers: exact at the ends, and exact peaks along the link."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi.base.quantities import FORCES
from lagrange_casadi.declare.density import NumericDensity
from lagrange_casadi.instants.section_law import PointLoad, SectionLaw

pytestmark = pytest.mark.quick

NAMES = ("n0", "n1", "n2", "f0", "f1", "f2", "m0")
numbers = st.floats(-100, 100)


def law(values, length=0.7, mass=1.3):
    return SectionLaw(
        length,
        NumericDensity((0.0, 1.0), ((mass,),)),
        {name: np.array([v]) for name, v in zip(NAMES, values, strict=True)},
    )


@given(st.tuples(*[numbers] * 7))
def test_the_tip_is_exact(values):
    found = law(values)
    one = np.array([1.0])
    assert [found.on_grid(force, one)[0, 0] for force in FORCES] == [
        values[0],
        values[3],
        values[6],
    ]


@given(st.tuples(*[numbers] * 7))
def test_extremes_bound_a_fine_grid(values):
    found, xi = law(values), np.linspace(0, 1, 2001)
    for force in FORCES:
        place, value = found.extreme(force)
        grid = np.abs(found.on_grid(force, xi)[0])
        assert abs(value[0]) >= grid.max() * (1 - 1e-12) - 1e-300
        assert abs(value[0]) <= grid.max() + 1e-3 * (np.ptp(grid) + grid.max() + 1e-12)
        assert 0.0 <= place[0] <= 1.0
        assert found.at(force, place[:, None])[0, 0] == pytest.approx(value[0])


CELLS = NumericDensity((0.0, 0.4, 1.0), ((1.0, 2.0), (3.0, -1.0, -0.5)))


def moving(t, order):
    """A law and a station that move with time, or their rates."""
    values = [np.polynomial.Polynomial([k + 1.0, 0.5 * k - 2.0, 0.3 - k]) for k in range(11)]
    values[7] = np.polynomial.Polynomial([0.35, 0.2, -0.04])
    found = [np.array([value.deriv(order)(t) if order else value(t)]) for value in values]
    return SectionLaw(
        0.7, CELLS, dict(zip(NAMES, found[:7], strict=True)), (PointLoad("pin", *found[7:]),)
    )


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.parametrize("side", ["tip", "base"])
def test_rates_are_those_of_differences(force, side):
    """At ratios that stand still, and at the station, which takes them along."""
    t, e = 0.3, 1e-4

    def forces(t):
        found = moving(t, 0)
        xi = np.array([[0.1, 0.37, float(found.loads[0].station[0]), 0.9]])
        return found.at(force, xi, side), xi

    near = [forces(t + k * e)[0] for k in (-2, -1, 1, 2)]
    difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e)
    rate = moving(t, 0).rate(force, moving(t, 1), forces(t)[1], side)
    np.testing.assert_allclose(rate, difference, rtol=1e-9, atol=1e-9)
    assert np.min(np.abs(rate)) > 1e-3


@pytest.mark.parametrize("force", FORCES)
def test_slopes_along_the_link_are_those_of_differences(force):
    found, e = moving(0.3, 0), 1e-4
    xi = np.array([[0.1, 0.37, 0.6, 0.9]])
    near = [found.at(force, xi + k * e) for k in (-2, -1, 1, 2)]
    difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e)
    np.testing.assert_allclose(found.along(force, xi), difference, rtol=1e-9, atol=1e-9)


def test_density_at_ratios():
    """What lies beyond a ratio grows as the density there."""
    u = np.array([[0.0, 0.2], [0.4, 0.8], [0.399999, 1.0]])
    np.testing.assert_allclose(CELLS.at(u), [[1.0, 1.4], [2.52, 1.88], [1.799998, 1.5]], rtol=1e-14)

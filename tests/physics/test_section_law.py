"""The law as numbers: exact peaks along the link, its slopes, and densities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import FORCES, NumericDensity, PointLoad, SectionLaw

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


def stationed():
    """A law of a link with a load at a station."""
    values = [np.array([1.0 - 0.3 * k + 0.1 * k * k]) for k in range(11)]
    values[7] = np.array([0.35])
    return SectionLaw(
        0.7, CELLS, dict(zip(NAMES, values[:7], strict=True)), (PointLoad("pin", *values[7:]),)
    )


@pytest.mark.parametrize("force", FORCES)
def test_slopes_along_the_link_are_those_of_differences(force):
    found, e = stationed(), 1e-4
    xi = np.array([[0.1, 0.37, 0.6, 0.9]])
    near = [found.at(force, xi + k * e) for k in (-2, -1, 1, 2)]
    difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e)
    np.testing.assert_allclose(found.along(force, xi), difference, rtol=1e-9, atol=1e-9)


def test_density_at_ratios():
    """What lies beyond a ratio grows as the density there."""
    u = np.array([[0.0, 0.2], [0.4, 0.8], [0.399999, 1.0]])
    np.testing.assert_allclose(CELLS.at(u), [[1.0, 1.4], [2.52, 1.88], [1.799998, 1.5]], rtol=1e-14)

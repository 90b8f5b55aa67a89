"""Designs to start from, spread by the sequence of Sobol: points that are known."""

import numpy as np
import pytest
from internals import sobol

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


def test_the_first_points_are_those_of_joe_and_kuo():
    """As their page has them for three dimensions."""
    told = [[4, 4, 4], [6, 2, 2], [2, 6, 6], [3, 3, 5], [7, 7, 1], [5, 1, 7], [1, 5, 3]]
    np.testing.assert_array_equal(8 * sobol(7, 3), told)


def test_they_are_those_of_scipy():
    qmc = pytest.importorskip("scipy.stats.qmc")
    others = qmc.Sobol(32, scramble=False, bits=32)
    others.fast_forward(1)
    np.testing.assert_array_equal(sobol(63, 32), others.random(63))


def test_too_many_dimensions_are_refused():
    with pytest.raises(
        DeclarationError,
        match="starts are spread over 32 parameters at most, got 33; name the designs",
    ):
        sobol(4, 33)

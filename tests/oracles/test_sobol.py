"""Designs to start from, spread by the sequence of Sobol: points that are known, and that every box
of a kind has one.
"""

import numpy as np
import pytest
from internals import MOST_DIMENSIONS, sobol

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


def test_the_first_points_are_those_of_joe_and_kuo():
    """As their page has them for three dimensions."""
    told = [[4, 4, 4], [6, 2, 2], [2, 6, 6], [3, 3, 5], [7, 7, 1], [5, 1, 7], [1, 5, 3]]
    np.testing.assert_array_equal(8 * sobol(7, 3), told)


def test_each_coordinate_takes_each_share_once():
    """With the origin 2^k points are a Latin hypercube; a direction number that is even would break
    it.
    """
    points = np.vstack([np.zeros((1, MOST_DIMENSIONS)), sobol(255, MOST_DIMENSIONS)])
    np.testing.assert_array_equal(
        np.sort(256 * points, axis=0), np.tile(np.arange(256.0)[:, None], MOST_DIMENSIONS)
    )
    assert len(np.unique(points, axis=1).T) == MOST_DIMENSIONS


def test_two_coordinates_are_a_net():
    """Of the first two dimensions each box of 2^-a by 2^-b, a + b = 8, has one of 256 points."""
    points = np.vstack([np.zeros((1, 2)), sobol(255, 2)])
    for a in range(9):
        boxes = np.floor(points * [2**a, 2 ** (8 - a)]) @ [1000, 1]
        assert len(np.unique(boxes)) == 256


def test_they_are_those_of_scipy():
    """Beyond what the properties above tell."""
    qmc = pytest.importorskip("scipy.stats.qmc")
    others = qmc.Sobol(MOST_DIMENSIONS, scramble=False, bits=32)
    others.fast_forward(1)
    np.testing.assert_array_equal(sobol(63, MOST_DIMENSIONS), others.random(63))


def test_too_many_dimensions_are_refused():
    with pytest.raises(
        DeclarationError,
        match="starts are spread over 32 parameters at most, got 33; name the designs",
    ):
        sobol(4, 33)

"""Which values are meant."""

import math

import numpy as np
import pytest
from internals import absent, matches, near

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

THERE = np.array([0.3, 0.1, 0.30000000000000004, 0.1, 0.2])


def test_near_is_but_for_rounding():
    assert near(THERE, 0.3).tolist() == [True, False, True, False, False]
    assert not near(THERE, 0.3000001).any()
    assert near(np.array([np.inf, 1.0]), np.inf).tolist() == [True, False]


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [(0.3, [0, 2]), ([0.1, 0.2], [1, 3, 4]), ((0.15, 0.3), [0, 2, 4]), ((-np.inf, 0.1), [1, 3])],
)
def test_what_is_wanted(wanted, expected):
    assert np.flatnonzero(matches("l", THERE, wanted, "m")).tolist() == expected


def test_the_nearest_values_are_different_ones():
    """Of a list each value may come many times."""
    assert (
        absent("l", np.array([0.1, 0.1, 0.1, 0.3, 0.5]), 0.12)
        == "no design has l = 0.12; nearest: 0.1, 0.3"
    )
    with pytest.raises(
        DeclarationError, match=r"no design has l up to 0\.19 and from 0\.15; nearest: 0\.1, 0\.2"
    ):
        matches("l", np.array([0.1, 0.1, 0.2]), (0.15, 0.19), "m")


@pytest.mark.parametrize(
    "wanted", [np.nan, "0.1", [], (0.1,), (0.1, 0.2, 0.3), (0.3, 0.1), [0.1, None]]
)
def test_what_cannot_be_wanted(wanted):
    with pytest.raises(DeclarationError, match="select: l: expected "):
        matches("l", THERE, wanted, "m")


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ("30 deg", [1]),
        (["0deg", 0.7], [0, 3]),
        (("10 deg", "40 deg"), [1, 3]),
        (("0.1 rad", math.pi), [1, 2, 3]),
        ("180 deg", [2]),
    ],
)
def test_angles_are_told_with_their_unit(wanted, expected):
    there = np.array([0.0, math.pi / 6, math.pi, 0.7 if "0.7" in str(wanted) else 0.6])
    assert np.flatnonzero(matches("phi", there, wanted, "rad")).tolist() == expected


def test_what_is_no_angle_takes_none():
    with pytest.raises(
        DeclarationError, match=r"select: l: expected numbers \[m\], not angles, got '30 deg'"
    ):
        matches("l", THERE, "30 deg", "m")
    with pytest.raises(
        DeclarationError, match="select: phi: expected a number, a list of numbers, or a tuple"
    ):
        matches("phi", THERE, "much deg", "rad")

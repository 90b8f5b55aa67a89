"""Angles as people type them."""

import math

import pytest

from lagrange_casadi.declare.angles import angle
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("720deg", 4 * math.pi),
        ("360 deg", 2 * math.pi),
        ("-90deg", -math.pi / 2),
        (" 1e2 deg ", math.radians(100)),
        ("1.5 rad", 1.5),
        ("2rad", 2.0),
        ("-0.25", -0.25),
        (0.3, 0.3),
        (7, 7.0),
    ],
)
def test_an_angle_is_in_rad_unless_it_says_deg(said, meant):
    assert angle(said) == pytest.approx(meant, rel=2e-16)


@pytest.mark.parametrize("turns", [-3, 1, 2, 50])
def test_whole_turns_are_whole(turns):
    assert angle(f"{360 * turns} deg") == turns * math.tau


@pytest.mark.parametrize(
    "said", ["", "deg", "rad", "90 degrees", "1_0 deg", "nan", "inf deg", "90 deg deg", math.nan, None, True, (1,)]
)
def test_what_is_no_angle_is_refused_in_a_line_that_shows_it(said):
    with pytest.raises(DeclarationError, match="expected an angle in rad, or with its unit as in '350 deg', got ") as caught:
        angle(said)
    assert repr(said) in str(caught.value)

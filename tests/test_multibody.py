"""What joints measure, where no drive is on them."""

import math

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi import Mechanism
from lagrange_casadi.multibody import joint_coordinate
from lagrange_casadi.planar import Frame, Rotation


def measured(parent, child, *, counted=False):
    """The angle of a pin between two bodies by their directions, (cosine, sine, angle)."""
    m = Mechanism("m")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    symbols = [ca.SX.sym(name, 3) for name in "ab"]
    frames = {name: Frame(rotation=Rotation(*ca.vertsplit(symbol))) for name, symbol in zip("ab", symbols, strict=True)}
    angle = joint_coordinate(m.revolute("J", a.tip, b), frames, (), counted=counted)
    return float(ca.Function("angle", symbols, [angle])(parent, child))


@given(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0))
def test_an_angle_lies_within_a_turn_or_counts(one, two):
    parent, child = ((math.cos(angle), math.sin(angle), angle) for angle in (one, two))
    assert measured(parent, child, counted=True) == two - one
    found = measured(parent, child)
    assert -math.pi <= found <= math.pi
    assert abs(math.remainder(found - (two - one), math.tau)) < 1e-14


@pytest.mark.parametrize("zero", [0.0, -0.0])
@pytest.mark.parametrize("cosine", [1.0, -1.0])
def test_opposite_directions_are_half_a_turn_apart_not_less_half_a_turn(cosine, zero):
    """Whatever the sign that the zero of the sine has come to."""
    for other in (0.0, -0.0):
        assert measured((cosine, zero, 0.0), (-cosine, other, 0.0)) == math.pi
        assert measured((cosine, zero, 0.0), (cosine, other, 0.0)) == 0.0

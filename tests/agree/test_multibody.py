"""What joints measure, where no drive is on them."""

import math

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import Frame, Rotation, Turned, motion_along

from lagrange_casadi import Mechanism

pytestmark = pytest.mark.quick

angles = st.floats(-30.0, 30.0)


@given(angles, angles)
def test_an_angle_counts_turns(parent, child):
    m = Mechanism("m")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    symbols = [ca.SX.sym(name, 3) for name in "ab"]
    frames = {
        name: Frame(rotation=Rotation.flat(*ca.vertsplit(symbol)))
        for name, symbol in zip("ab", symbols, strict=True)
    }
    joint = m.revolute("J", a.tip, b)
    function = ca.Function("angle", symbols, [motion_along(joint, joint.axes[0], frames, ())[0]])
    one, two = ((math.cos(angle), math.sin(angle), angle) for angle in (parent, child))
    assert float(function(one, two)) == child - parent


@given(angles)
def test_an_angle_that_is_seen_lies_within_a_turn_or_counts(angle):
    cosine, sine, counted = (ca.SX.sym(name) for name in ("cosine", "sine", "angle"))
    turned = Turned("J", ca.SX.sym("J_seen"), cosine, sine, counted)
    function = ca.Function("within", [cosine, sine, counted], [turned.within, turned.angle])
    within, counts = (float(x) for x in function(math.cos(angle), math.sin(angle), angle))
    assert counts == angle
    assert -math.pi <= within <= math.pi
    assert abs(math.remainder(within - angle, math.tau)) < 1e-14

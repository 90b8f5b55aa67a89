"""Users' constraints and non-holonomic rows, beside what random mechanisms draw of them."""

import math

import casadi as ca
import numpy as np
import oracle
import pytest
from balance import assert_balanced
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import expression, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def towed(drives):
    """A body on a skate whose nose is held by an arm of two links: the motion is the skate's, and
    the arm may make it.
    """
    m = Mechanism("towed")
    m.set_gravity(0.4, -0.3)
    cross, pivot = m.link("cross", length=0.1, mass=0.1), m.link("pivot", length=0.1, mass=0.2)
    body, upper, lower = (
        m.link(name, length=l, mass=w)
        for name, l, w in (("body", 0.4, 2.0), ("upper", 1.6, 0.7), ("lower", 1.5, 0.5))
    )
    m.prismatic("X", m.ground, cross, axis=(1, 0))
    across = m.prismatic("Y", cross, pivot, axis=(0, 1))
    turn, *_ = pins_of(
        m,
        turn=(pivot, body),
        shoulder=(m.ground.at(0.3, -1.2), upper),
        elbow=(upper.tip, lower),
        nose=(body.tip, lower.tip),
    )
    vx, vy = m.velocity(body)
    q = m.direction(body)
    m.nonholonomic("blade", -ca.sin(q) * vx + ca.cos(q) * vy, replaces=across)
    m.torque("drag", body, -0.3 * m.rate(turn))
    laws = {
        "X": expression(lambda t: 2.0 * ca.sin(0.5 * t)),
        "Y": expression(lambda t: 2.0 - 2.0 * ca.cos(0.5 * t)),
        "turn": polynomial(0.0, 0.5),
    }
    return Scene(m, laws, t=(0.2, 1.4, 15), posture={"upper": 0.2, "lower": 2.2}, drives=drives)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "drives",
    [("shoulder", "elbow"), ("X", "shoulder"), ("turn", "elbow"), ("Y", "turn"), ("nose", "Y")],
)
def test_a_non_holonomic_row_leaves_the_motion_to_drives_elsewhere(drives):
    """The blade holds sideways; two drives anywhere do the rest, that which the blade replaces too
    where it is named.
    """

    def effect(place):
        phi = place(("body", 0.0, 0.0))[2]
        return [(("body", 0.0, 0.0), -math.sin(phi.v), math.cos(phi.v), 0.0)]

    def drag(_):
        return [(("body", 0.0, 0.0), 0.0, 0.0, -0.15)]

    for t in (0.2, 0.9, 1.4):
        assert_balanced(
            towed(drives), t=t, extras=[oracle.Extra("blade", None, effect)], loads=[drag]
        )
    solution = evaluate(towed(drives))
    assert solution.certified
    assert {"balance", "power", "ends"} <= set(solution.certificate)
    assert {q.part for q in solution.outputs if q.group == "effort"} == set(drives)
    usual = evaluate(towed(None))
    power = [
        sum(s.effort(j) * s.motion(j).rate for j in joints)
        for s, joints in ((usual, ("X", "turn")), (solution, drives))
    ]
    assert np.abs(power[1] - power[0]).max() < 1e-12 * np.abs(power[0]).max()


def test_a_constraint_whose_slope_has_no_value_at_some_parameters():
    """The arc sine of a ratio has one only up to one: what stands beside it is in the equation all
    the same.
    """
    m = Mechanism("tied")
    ratio = m.parameter("ratio", 0.4, low=0.0, high=0.9)
    a, b = m.link("a", length=0.3, mass=1.0), m.link("b", length=0.2, mass=0.5)
    first, second = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1.0, 0.0), b)
    m.constraint("tie", ca.asin(ratio) * m.coordinate(second) - m.coordinate(first))
    solution = evaluate(Scene(m, {"A": polynomial(0.2, 0.5)}, t=(0, 1, 5), posture={"b": 0.5}))
    assert solution.certified
    assert solution.motion("B").value == pytest.approx(
        solution.motion("A").value / math.asin(0.4), rel=1e-13
    )

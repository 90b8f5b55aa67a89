"""Declarations: what is refused, and in which words."""

import math

import casadi as ca
import pytest
from mechanisms import slider_crank

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.errors import DeclarationError, ParameterError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


@pytest.fixture
def m():
    return Mechanism("m")


def test_a_link_stands_for_its_base_and_the_ground_for_its_origin(m):
    joint = m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    assert (joint.parent.x, joint.parent.y, joint.child.x, joint.child.end) == (
        0.0,
        0.0,
        0.0,
        "base",
    )
    assert m.links["a"].tip.x == 1.0


def test_lengths_may_be_expressions(m):
    r = m.parameter("r", 0.5, "m")
    link = m.link("a", length=2 * r + 0.1, mass=1)
    assert m.number(link.length, m.values()) == 1.1
    assert m.number(link.length, m.values({"r": 2.0})) == 4.1


@pytest.mark.parametrize(
    ("says", "declare"),
    {
        "link name 'a b' must be": lambda m: m.link("a b", length=1, mass=1),
        "link name '' must be": lambda m: m.link("", length=1, mass=1),
        "point mass 'a': the name is taken by a link": lambda m: [
            m.link("a", length=1, mass=1),
            m.point_mass("a", 1),
        ],
        "link 'ground': the name is taken by the ground": lambda m: m.link(
            "ground", length=1, mass=1
        ),
        "parameter 'r' is declared twice": lambda m: [m.parameter("r", 1), m.parameter("r", 2)],
        "link 'a': length: expected a finite number": lambda m: m.link("a", length="long", mass=1),
        "link 'a': length must be finite": lambda m: m.link("a", length=math.nan, mass=1),
        "link 'a': length depends on 'r', not a parameter of mechanism 'm'": lambda m: m.link(
            "a", length=ca.SX.sym("r"), mass=1
        ),
        "must be a scalar": lambda m: m.link("a", length=ca.SX.ones(2), mass=1),
        "joint 'J' joins 'ground' to itself": lambda m: m.revolute(
            "J", m.ground, m.ground.at(1, 2)
        ),
        "joint 'J': expected a link": lambda m: m.revolute("J", m.ground, "a"),
        "'a' belongs to another mechanism": lambda m: m.revolute(
            "J", m.ground, Mechanism("other").link("a", length=1, mass=1)
        ),
        r"axis must not be \(0, 0\)": lambda m: m.prismatic(
            "P", m.ground, m.point_mass("a", 1), axis=(0, 0)
        ),
        "'a' is a point mass, which has no direction": lambda m: m.prismatic(
            "P", m.point_mass("a", 1), m.ground, axis=(1, 0)
        ),
        "mechanism name '1st' must be": lambda m: Mechanism("1st"),
        "has no link and no point mass": lambda m: m.freeze(),
    }.items(),
)
def test_what_a_part_refuses(m, declare, says):
    with pytest.raises(DeclarationError, match=says):
        declare(m)


def test_a_link_that_hangs_on_nothing_is_named(m):
    a, b = (m.link(name, length=1, mass=1) for name in "ab")
    m.link("c", length=1, mass=1)
    m.revolute("J", m.ground, a)
    m.revolute("K", b.tip, m.links["c"])
    with pytest.raises(
        DeclarationError, match="'b', 'c' are not connected to the ground by any chain of joints"
    ):
        m.freeze()


def test_a_mechanism_freezes_in_a_scene(m):
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    Scene(m, {"J": polynomial(0, 1)})
    for change in (
        lambda: m.point_mass("b", 1),
        lambda: m.parameter("r", 1),
        lambda: m.set_gravity(0, 0),
    ):
        with pytest.raises(DeclarationError, match="mechanism 'm' is frozen"):
            change()


@pytest.mark.parametrize(
    ("values", "error", "says"),
    [
        ({"R": 1.0}, UnknownNameError, "unknown parameter 'R'; valid: r, l, m1, m2, m3"),
        (
            {"R": 1.0, "ll": 1.0},
            UnknownNameError,
            r"unknown parameters 'R', 'll' \(did you mean 'l'\?\); valid: r, l, m1, m2, m3",
        ),
        (
            {"l": math.nan, "m2": "big"},
            ParameterError,
            (
                r"parameter 'l' must be a finite number, got nan; parameter 'm2' must be a number"
                r" \[kg\], or a text such"
            ),
        ),
        ({"l": math.nan}, ParameterError, "parameter 'l' must be a finite number"),
        ({"l": math.inf}, ParameterError, "parameter 'l' must be a finite number"),
        ({"l": 0.0}, ParameterError, "link 'rod': length must be positive, got 0 m"),
        ({"m3": -1.0}, ParameterError, "point mass 'slider': mass must not be negative, got -1 kg"),
        (
            {"m1": 0.0, "m2": 0.0, "m3": 0.0},
            ParameterError,
            ("mechanism 'slider_crank' has neither mass"),
        ),
    ],
)
def test_what_the_values_of_parameters_refuse(values, error, says):
    with pytest.raises(error, match=says):
        slider_crank().mechanism.values(values)


def test_ranges(m):
    m.parameter("r", 0.5, "m", low=0.1, high=1.0)
    m.point_mass("p", 1)
    with pytest.raises(
        ParameterError, match=r"parameter 'r' = 2 m is out of its range \[0.1.*, 1\]"
    ):
        m.values({"r": 2.0})
    m.parameter("l", 1.0, low=0.0)
    with pytest.raises(
        ParameterError,
        match=r"parameter 'r' = 2 m is out of its range .*; parameter 'l' = -1 is out of",
    ):
        m.values({"r": 2.0, "l": -1.0})
    with pytest.raises(ParameterError, match="parameter 's' = 5"):
        m.parameter("s", 5, high=1)

"""Drives that do not match the freedoms, where counting by joints would be wrong."""

import math

import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.errors import LagrangeCasadiError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def slides(ways, drives):
    """Bodies that slide on one another, the last one on the ground: their directions are held once
    too often.
    """
    m = Mechanism("slides")
    bodies = [m.link(f"w{i}", length=0.2, mass=1.0) for i in range(len(ways) - 1)]
    chain = [m.ground, *bodies]
    for i, way in enumerate(ways[:-1]):
        m.prismatic(f"S{i}", chain[i], chain[i + 1], axis=(math.cos(way), math.sin(way)))
    last = (math.cos(ways[-1]), math.sin(ways[-1]))
    m.prismatic("last", m.ground.at(0.1, 0.05), bodies[-1], axis=last)
    return m, drives


def pinned():
    m = Mechanism("pin")
    a, b = m.link("a", length=0.3, mass=1.0), m.link("b", length=0.2, mass=1.0)
    m.prismatic("S", m.ground, a, axis=(1, 0))
    m.revolute("P", a.tip, b)
    m.prismatic("T", m.ground.at(0.3, 0.1), b, axis=(0, 1))
    return m, ["P"]


def twice():
    m = Mechanism("twice")
    a = m.link("a", length=1, mass=1)
    m.prismatic("X", m.ground, a, axis=(1, 0))
    m.prismatic("Y", m.ground, a.tip, axis=(1, 0))
    return m, ["X", "Y"]


def on_a_point():
    m = Mechanism("on_a_point")
    p, a = m.point_mass("p", 1), m.link("a", length=1, mass=1)
    m.revolute("O", m.ground, p)
    m.prismatic("P", a, p, axis=(1, 0))
    return m, ["P"]


def in_a_slot():
    m = Mechanism("slotted")
    a, b = links_of(m, a=(0.1, 1), b=(0.3, 1))
    pins_of(m, O=(m.ground, a), A=(a.tip, b))
    m.slot("G", m.ground, b.tip)
    return m, ["G"]


def on_rods():
    m = SpatialMechanism("on_rods")
    plate = m.link("plate", length=0.1, mass=1.0, centre=(0, 0, 0), inertia=(1, 1, 1))
    for k in range(6):
        rod = m.link(f"rod{k}", length=1.0, mass=1.0)
        m.spherical(f"S{k}", m.ground.at(k % 2, k // 2, 0), rod)
        m.spherical(f"T{k}", rod.tip, plate.at(0.1 * (k % 2), 0.1 * (k // 2), 0))
    return m, []


REFUSED = [
    (lambda: slides((0, 0.7, 1.9), []), r"has 1 degree.* \(by the rank .* and 0 drive"),
    (lambda: slides((0, 0.7, 1.9), ["S0", "S1"]), r"has 1 degree.* \(by the rank .* and 2 drive"),
    (lambda: slides((0, 0.7, 1.9, 2.5), ["S0"]), r"has 2 degree.* \(by the rank .* and 1 drive"),
    (pinned, r"has 0 degree\(s\) of freedom .* and 1 drive"),
    (twice, "the drive of joint 'Y' is redundant"),
    (on_a_point, "'a' is connected by sliding on a point only"),
    (in_a_slot, "joint 'G' is a slot and cannot be driven; drive another joint of its loop"),
    (on_rods, "'plate' is connected by two-force links only; declare a free"),
]


@pytest.mark.parametrize(("make", "says"), REFUSED)
def test_drives_that_do_not_match_are_refused(make, says):
    mechanism, drives = make()
    scene = Scene(mechanism, {drive: polynomial(0.1, 0.2) for drive in drives}, t=(0, 1, 5))
    with pytest.raises(LagrangeCasadiError, match=says):
        evaluate(scene)


@pytest.mark.parametrize("way", [-2.575, -1.6435, 0.3, 3.1045])
def test_two_guides_of_an_inclined_line_leave_a_freedom(way):
    """The second guide's slopes are rounding alone, and of no rank."""
    m = Mechanism("guided")
    bar, along = m.link("bar", length=0.8, mass=1.0), 1.8321
    m.prismatic("first", m.ground, bar, axis=(math.cos(along), math.sin(along)), angle=way)
    back = along - way
    m.prismatic("second", bar, m.ground, axis=(3 * math.cos(back), 3 * math.sin(back)), angle=-way)
    solution = evaluate(Scene(m, {"first": polynomial(0.1, 0.2)}, t=(0, 1, 3)), backend="vm")
    assert solution.motion("second").value == pytest.approx([-0.1, -0.2, -0.3])
    assert "effort:first" not in solution.undetermined

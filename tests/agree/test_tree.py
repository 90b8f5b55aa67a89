"""Spanning trees: which joints carry coordinates, which close loops."""

import pytest
from internals import span
from mechanisms import four_bar, slider_crank

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def names(tree):
    return [branch.joint.name for branch in tree.branches], [joint.name for joint in tree.closing]


def test_a_guided_point_is_left_open():
    """One equation is left, not two: the guide of a point mass closes the loop, as in the paper."""
    scene = slider_crank()
    assert names(span(scene.mechanism, scene.motion)) == (["O", "A", "B"], ["guide"])


def test_a_four_bar_opens_at_the_coupler():
    """Both grounded links hang on the ground, so no chain is longer than it must be."""
    scene = four_bar()
    assert names(span(scene.mechanism, scene.motion)) == (["O", "C", "A"], ["B"])


def test_a_driven_joint_is_always_a_branch():
    scene = four_bar()
    for joint in "OABC":
        assert joint in names(span(scene.mechanism, {joint}))[0]


def test_branches_run_against_joints_where_they_must():
    scene = four_bar(turned=(True, True))
    tree = span(scene.mechanism, scene.motion)
    assert {branch.joint.name: branch.sign for branch in tree.branches} == {
        "O": 1,
        "C": -1,
        "A": -1,
    }


def test_redundant_drives_are_refused():
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.prismatic("X", m.ground, a, axis=(1, 0))
    m.prismatic("Y", m.ground, a.tip, axis=(1, 0))
    scene = Scene(m, {"X": polynomial(0), "Y": polynomial(0)})
    with pytest.raises(DeclarationError, match="the drive of joint 'Y' is redundant"):
        span(m, scene.motion)


def test_a_link_that_only_slides_on_a_point_is_refused():
    m = Mechanism("m")
    p, a = m.point_mass("p", 1), m.link("a", length=1, mass=1)
    m.revolute("O", m.ground, p)
    m.prismatic("P", a, p, axis=(1, 0))
    scene = Scene(m, {"P": polynomial(0.5)})
    with pytest.raises(DeclarationError, match="'a' is connected by sliding on a point only"):
        span(m, scene.motion)


def test_a_driven_slide_carries_its_mass_whatever_else_is_pinned_to_it():
    """A point can be hung on its line, and no line on a point: a pin that is nearer the ground must
    wait.
    """
    m = Mechanism("driven_slot")
    a = m.link("a", length=0.3, mass=1.0)
    b = m.link("b", length=0.5, mass=1.0)
    c = m.link("c", length=0.6, mass=1.0)
    pin = m.point_mass("pin", 0.1)
    m.revolute("O", m.ground, a)
    m.revolute("P", a.tip, pin)
    m.revolute("Q", m.ground.at(0.6, 0), b)
    m.revolute("R", b.tip, c)
    m.slot("S", c, pin, axis=(1, 0))
    tree = span(m, ["S", "R"])
    assert [branch.joint.name for branch in tree.branches] == ["O", "Q", "R", "S"]
    assert [joint.name for joint in tree.closing] == ["P"]

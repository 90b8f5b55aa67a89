"""Closed forms of loops: each where its pattern is there, and none
where equations only look alike.
"""

import casadi as ca
import numpy as np
import pytest
from balance import assert_balanced
from mechanisms import ladder, links_of, pins_of

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.elements import cylinder
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def iterated(scene):
    return derive(scene).newton is not None


def test_a_ladder_against_a_wall():
    """Its middle goes round the corner on a circle with the crank, whose torque is the power of its
    weight: m g L/2 cos(angle).
    """
    scene = ladder()
    solution = evaluate(scene)
    angle = solution.motion("O").value
    np.testing.assert_allclose(solution.pose("bar").x, np.cos(angle), atol=1e-15)
    np.testing.assert_allclose(solution.effort("O"), 2.0 * 9.81 / 2 * np.cos(angle), rtol=1e-14)
    assert not iterated(scene)
    assert_balanced(scene)


def prescribed(equations, posture):
    """An arm of two links, two of whose places are prescribed; and a slide that is driven, since
    something must be.
    """
    m = Mechanism("prescribed")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.5, mass=1.2)
    pins_of(m, A=(m.ground, a), B=(a.tip, b))
    m.prismatic("S", m.ground.at(0, -1), m.point_mass("s", 1.0), axis=(1, 0))
    for name, gap in equations(m, b).items():
        m.constraint(name, gap)
    return Scene(m, {"S": polynomial(0.0, 0.1)}, t=(0, 1, 41), posture=posture)


def test_a_tip_that_is_prescribed_is_a_dyad():
    def equations(m, b):
        x, y = m.place(b.tip)
        return {"across": x - 0.7 - 0.1 * ca.sin(2 * m.time), "up": y - 0.3 * ca.cos(m.time)}

    scene = prescribed(equations, {"a": 1.1, "b": -0.5})
    solution = evaluate(scene)
    tip = solution.pose("b").x + 0.5 * np.cos(solution.pose("b").angle)
    np.testing.assert_allclose(tip, 0.7 + 0.1 * np.sin(2 * solution.t), atol=1e-15)
    assert not iterated(scene)


def test_the_height_of_a_tip_and_the_place_of_a_middle_are_not_two_circles():
    """Each equation holds both directions, as those of a pin do, and no two arms turn in them: they
    are iterated.
    """

    def equations(m, b):
        return {
            "height": m.place(b.tip)[1] - 0.471,
            "middle": m.place(b.at(0.25))[0] - 0.7 - 0.05 * ca.sin(3 * m.time),
        }

    scene = prescribed(equations, {"a": 0.9, "b": -0.1})
    solution = evaluate(scene)
    base, angle = solution.pose("b"), solution.pose("b").angle
    np.testing.assert_allclose(base.y + 0.5 * np.sin(angle), 0.471, atol=1e-14)
    np.testing.assert_allclose(
        base.x + 0.25 * np.cos(angle), 0.7 + 0.05 * np.sin(3 * solution.t), atol=1e-14
    )
    assert iterated(scene)


@pytest.mark.parametrize("size", [1e-6, 0.05, 1e3])
def test_two_circles_have_a_closed_form_whatever_their_size(size):
    """A lever that a ram moves, as short or long as may be.

    Places are drawn near a metre, and few links reach so far.
    """
    m = Mechanism("lever")
    crank, lever = links_of(m, crank=(0.05 * size, 1.0), lever=(0.2 * size, 1.0))
    pins_of(m, O=(m.ground, crank), P=(m.ground.at(0.25 * size, 0.0), lever))
    cylinder(
        m,
        "ram",
        crank.tip,
        lever.at(0.15 * size),
        closed=0.08 * size,
        bore=0.05 * size,
        rod=0.03 * size,
    )
    law = {"O": polynomial(0.1, 5.0), "ram": polynomial(0.12 * size, 0.02 * size)}
    assert derive(Scene(m, law, posture={"lever": 2.8}, t=(0, 0.4, 3))).newton is None

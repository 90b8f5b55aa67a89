"""Stations beyond a link's ends are refused, with the lines that make a link of what reaches there:
these lines are right.
"""

import re

import numpy as np
import pytest
from balance import assert_balanced

from lagrange_casadi import Mechanism, Scene, evaluate, read, save_model
from lagrange_casadi.errors import ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick

LENGTH, MASS, WEIGHT, G = 0.1, 0.6, 4.0, 9.81


def crank(station, place=None):
    """A crank with a counterweight at a station [m] that may lie beyond its ends; or where
    ``place(m)`` says.
    """
    m = Mechanism("balanced")
    arm, weight = m.link("arm", length=LENGTH, mass=MASS), m.point_mass("weight", WEIGHT)
    m.revolute("O", m.ground, arm)
    m.weld("bolt", place(m) if place else arm.at(station), weight)
    return Scene(m, {"O": polynomial(0.3, 2.0, 5.0)}, t=(0, 1, 21))


def told(station):
    """The place that the lines of the refusal make."""
    with pytest.raises(
        ParameterError,
        match=rf"joint 'bolt': its point at {station} m is outside link 'arm', 0 to 0\.1 m; for a",
    ) as error:
        crank(station)
    lines = re.search(
        r"declare another link: (tail = .*); and use tail\.tip as the point", str(error.value)
    )[1]

    def place(m):
        names = {"m": m}
        exec(lines.replace("; ", "\n"), names)
        return names["tail"].tip

    return place


@pytest.mark.parametrize("station", [-0.05, -0.3, 0.13])
def test_the_lines_make_what_was_meant(station):
    """The drive's torque against J alpha + g (sum of m x) cos(angle), for a rod about its end and a
    point mass.
    """
    scene = crank(None, told(station))
    solution = evaluate(scene)
    assert solution.certified
    angle, alpha = solution.motion("O").value, 10.0
    inertia = MASS * LENGTH**2 / 3 + WEIGHT * station**2
    moment = MASS * LENGTH / 2 + WEIGHT * station
    torque = inertia * alpha + G * moment * np.cos(angle)
    np.testing.assert_allclose(
        solution.effort("O"), torque, rtol=0, atol=1e-13 * np.abs(torque).max()
    )
    assert_balanced(scene, t=0.4)
    tail = solution.section("arm_tail")
    arm = station - max(0.0, min(station, LENGTH))
    weight = WEIGHT * (G * np.cos(angle) + station * alpha) * arm
    np.testing.assert_allclose(np.abs(tail.bending[:, 0]), np.abs(weight), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(tail.bending[:, -1], 0.0, atol=1e-13)


def test_a_station_on_its_link_is_none_of_it():
    assert evaluate(crank(0.05)).certified


def test_a_line_may_be_told_by_a_place_beyond_the_end(tmp_path):
    """A block that slides past the tip of its rail loads the same sections, wherever the line is
    told; and so does the model that a file holds, which tells it where the block is.
    """

    def slide(start):
        m = Mechanism("rail")
        rail, block = m.link("rail", length=0.4, mass=1.0), m.point_mass("block", 2.0)
        m.revolute("O", m.ground, rail)
        m.prismatic("P", rail.at(start), block, axis=(1, 0))
        laws = {"O": polynomial(0.3, 2.0), "P": polynomial(0.5 - start, 0.4)}
        return Scene(m, laws, t=(0.0, 0.2, 5))

    scene = slide(0.1)
    save_model(scene, tmp_path / "rail.json")
    within = evaluate(scene)
    for other in (slide(0.5), slide(-0.2)):
        beyond = evaluate(other)
        assert beyond.certified
        for name in ("axial", "shear", "bending"):
            forces, there = (getattr(one.section("rail"), name) for one in (beyond, within))
            np.testing.assert_allclose(forces, there, rtol=0.0, atol=1e-12 * np.abs(there).max())
    again = evaluate(read(tmp_path / "rail.json"), t=scene.t)
    np.testing.assert_allclose(again.effort("O"), within.effort("O"), rtol=1e-12)

"""Belts and chains: tensions and what pulleys bear against vectors of both strands, losses, and
what is refused.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import belt, wheel
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def drive(radii=(0.05, 0.12), crossed=False, turn=0.4, **more):
    m = Mechanism("drive")
    m.set_gravity(0, 0)
    load, preload = m.parameter("load", 60.0, "N m"), m.parameter("preload", 400.0, "N")
    first, second = (
        wheel(m, name, radius=r, mass=1.0)
        for name, r in zip(("first", "second"), radii, strict=True)
    )
    m.revolute("A", m.ground, first)
    m.revolute("B", m.ground.at(0.4 * math.cos(turn), 0.4 * math.sin(turn)), second)
    made = belt(m, "belt", first, second, radii=radii, preload=preload, crossed=crossed, **more)
    m.torque("load", second, load)
    return m, made


def strands(radii, crossed, turn=0.4):
    """Both tangents of two circles: the way from the first to the second, and where they leave the
    second, from its centre.
    """
    r1, r2 = radii
    e, other = np.exp(1j * turn), -r2 if crossed else r2
    for side in (1, -1):
        normal = e * np.exp(1j * side * math.acos((r1 - other) / 0.4))
        way = 0.4 * e + other * normal - r1 * normal
        assert abs((np.conj(way) * normal).real) < 1e-15
        yield way / abs(way), other * normal


@pytest.mark.parametrize("radii", [(0.05, 0.12), (0.12, 0.05), (0.08, 0.08)])
@pytest.mark.parametrize("crossed", [False, True])
@pytest.mark.parametrize(
    "values", [{}, {"load": -60.0}, {"preload": 100.0}, {"preload": 0.0, "load": -20.0}]
)
def test_pulleys_bear_both_strands(radii, crossed, values):
    """T1 - T2 = T/r and T1 + T2 = 2 F_i (Shigley, chapter 17), each along its strand; where one
    would push, it is slack.
    """
    m, made = drive(radii, crossed)
    solution = evaluate(Scene(m, {"A": polynomial(0.0)}, t=(0, 1, 2)), parameters=values)
    assert solution.certified
    told = {"load": 60.0, "preload": 400.0} | values
    force = told["load"] / radii[1]
    whole = max(2 * told["preload"], abs(force))
    (one, at_one), (two, at_two) = strands(radii, crossed)
    arms = [(np.conj(at) * -way).imag for way, at in ((one, at_one), (two, at_two))]
    tensions = np.linalg.solve([[1.0, 1.0], arms], [whole, -told["load"]])
    on_second = -tensions[0] * one - tensions[1] * two
    reaction, other = solution.reaction("B"), solution.reaction("A")
    assert reaction.fx[0] + 1j * reaction.fy[0] == pytest.approx(-on_second, abs=1e-12 * whole)
    assert other.fx[0] + 1j * other.fy[0] == pytest.approx(on_second, abs=1e-12 * whole)
    assert solution.output("belt_tight")[0] == pytest.approx(tensions.max(), rel=1e-12)
    assert solution.output("belt_slack")[0] == pytest.approx(tensions.min(), abs=1e-10)
    ratio = radii[0] / radii[1] * (-1 if crossed else 1)
    assert float(made.ratio) == pytest.approx(ratio)
    assert abs(solution.effort("A")[0]) == pytest.approx(abs(told["load"] * ratio), rel=1e-12)


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -1)])
def test_in_space_a_pulley_may_count_its_angle_the_other_way(axis):
    m = SpatialMechanism("drive")
    m.set_gravity(0, 0, 0)
    first, second = (
        wheel(m, name, radius=r, mass=1.0) for name, r in (("first", 0.05), ("second", 0.12))
    )
    m.revolute("A", m.ground, first, axis=(0, 0, 1), turned=[("y", "-90 deg")])
    m.revolute("B", m.ground.at(0.4, 0, 0), second, axis=axis, turned=[("y", "-90 deg")])
    belt(m, "belt", first, second, radii=(0.05, 0.12), preload=300.0, efficiency=0.9)
    m.torque("load", second, z=-24.0)
    solution = evaluate(Scene(m, {"A": polynomial(0.1, 7.0)}, t=(0, 1, 2)))
    assert solution.certified
    assert solution.effort("A")[0] == pytest.approx(24.0 * 5 / 12 / 0.9, rel=1e-12)
    loss = 0.1 * solution.effort("A")[0] * 7.0
    assert solution.output("belt_loss")[0] == pytest.approx(loss, rel=1e-12)
    about = 0.4 * solution.reaction("B").fy[0] + solution.effort("A")[0] - 24.0
    assert about == pytest.approx(0.0, abs=1e-12)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"radii": (0.05, 0.5)}, "centres are 0.4 m apart; expected more than the difference of"),
        ({"radii": (0.15, 0.3), "crossed": True}, "more than the sum of its radii, 0.45 m"),
        ({"preload": -1.0}, "preload must not be negative, got -1 N"),
        ({"efficiency": 1.2}, "efficiency must not be above 1, got 1.2"),
        ({"efficiency": 0.0}, "efficiency must be above 0, got 0"),
        ({"radii": 0.05}, "expected 2 radii"),
    ],
)
def test_bad_belts_are_refused_by_name(more, says):
    m, _ = drive()
    first, second = m.links["first"], m.links["second"]
    with pytest.raises(DeclarationError, match=f"belt 'other': .*{says}"):
        belt(m, "other", first, second, **{"radii": (0.05, 0.12), **more})
    scene = Scene(m, {"A": polynomial(0.0)}, t=(0, 1, 2))
    with pytest.raises(ParameterError, match="'belt': preload must not be negative, got -5 N"):
        evaluate(scene, parameters={"preload": -5.0})

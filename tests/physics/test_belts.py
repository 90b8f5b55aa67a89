"""Belts and chains: tensions and what pulleys bear against vectors of both strands, losses, and
what is refused.
"""

from __future__ import annotations

import math

import pytest
from mechanisms import pins_of

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
    pins_of(
        m, A=(m.ground, first), B=(m.ground.at(0.4 * math.cos(turn), 0.4 * math.sin(turn)), second)
    )
    made = belt(m, "belt", first, second, radii=radii, preload=preload, crossed=crossed, **more)
    m.torque("load", second, load)
    return m, made


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
        ({"preload": -1.0}, r"preload \[N\] must not be negative, got -1"),
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
    with pytest.raises(ParameterError, match=r"'belt': preload \[N\] must not be negative, got -5"):
        evaluate(scene, parameters={"preload": -5.0})

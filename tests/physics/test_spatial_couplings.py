"""What ties coordinates in space: gears between axes of joints that have several, and wheels that
roll on a plane.
"""

import casadi as ca
import numpy as np
import pytest
from spatial_bodies import Coupling, Joint, Mechanism, Rigid
from spatial_oracle import REACTION, solve

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("slides", [False, True])
def test_a_gear_between_axes_of_joints_with_several(slides):
    """A universal joint's first turn follows a cylindrical joint's turn, or its slide, as a rack:
    as Newton-Euler has it.
    """
    x, y, z = np.eye(3)
    inertia = (
        np.diag([0.02, 0.03, 0.04]),
        np.array([[0.05, 0.01, 0.0], [0.01, 0.04, 0.005], [0.0, 0.005, 0.03]]),
    )
    centres, at, ratio = ((0.1, 0.02, 0.0), (0.05, -0.03, 0.04)), (0.3, 0.1, 0.0), -1.5
    m = SpatialMechanism("geared")
    bodies = [
        m.link(
            f"b{k}",
            length=0.3,
            mass=2.0 + k,
            centre=centres[k],
            inertia=tuple(map(tuple, inertia[k].tolist())),
        )
        for k in (0, 1)
    ]
    first = m.cylindrical("C", m.ground, bodies[0], axis=(0.0, 0.0, 1.0))
    second = m.universal(
        "U", bodies[0].at(*at), bodies[1], axis=(1.0, 0.0, 0.0), second=(0.0, 1.0, 0.0)
    )
    m.constraint(
        "mesh",
        m.coordinate(second, "turn_1")
        - ratio * m.coordinate(first, "slide" if slides else "turn")
        - 0.2,
    )
    laws = {
        "C:turn": motion.polynomial(0.3, 2.0, 1.5),
        "C:slide": motion.polynomial(0.1, 0.5, -0.7),
    }
    laws["U:turn_2"] = motion.polynomial(0.4, -1.0, 0.6)
    found = evaluate(Scene(m, laws, t=(0.0, 0.5, 6), posture={"U:turn_1": 0.0}))
    assert found.certified
    joints = [
        Joint("C", "cylindrical", "ground", "b0", axis=z),
        Joint("U", "universal", "b0", "b1", at, axis=x, axis2=y),
    ]
    told = [Rigid(f"b{k}", 2.0 + k, centres[k], inertia[k]) for k in (0, 1)]
    coupled = Coupling("mesh", {("U", 0): 1, ("C", int(slides)): -ratio}, 0.2)
    one = Mechanism(told, joints, gravity=(0, 0, -9.81), couplings=[coupled])
    for i, t in enumerate(found.t):
        drives = {
            ("C", 0): (0.3 + 2 * t + 1.5 * t**2, 2 + 3 * t, 3.0),
            ("C", 1): (0.1 + 0.5 * t - 0.7 * t**2, 0.5 - 1.4 * t, -1.4),
            ("U", 1): (0.4 - t + 0.6 * t**2, -1 + 1.2 * t, 1.2),
        }
        true = solve(one, drives)
        assert found.motion("U:turn_1").value[i] == pytest.approx(
            true.coordinates["U", 0][0], abs=1e-12
        )
        own = {("C", 0): "C:turn", ("C", 1): "C:slide", ("U", 1): "U:turn_2"}
        for key, name in own.items():
            assert found.effort(name)[i] == pytest.approx(float(true.efforts[key]), abs=1e-11)
        assert abs(found.series["multiplier:mesh"][i]) == pytest.approx(
            abs(float(true.multipliers["mesh"])), abs=1e-11
        )
        for joint in ("C", "U"):
            reaction = [found.series[f"reaction:{joint}:{member}"][i] for member in REACTION]
            assert reaction == pytest.approx(
                true.reactions[joint].astype(float).tolist(), abs=1e-11
            )


def test_a_wheel_rolls_round_a_circle_on_a_plane():
    """It goes where it points and turns as it goes; what drives it along x has the rest of its
    weight's way to overcome.

    With e where it points and n to its left: M a = F x + mu e + lambda n, and what spins the wheel
    is -r mu.
    """
    m, radius, circle, mass, spin = SpatialMechanism("unicycle"), 0.2, 1.5, 7.0, 0.05
    stage, saddle = (
        m.link(name, length=0.1, mass=0.0, centre=(0, 0, 0), inertia=(0, 0, 0))
        for name in ("stage", "saddle")
    )
    fork = m.link("fork", length=0.1, mass=4.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    wheel = m.link("wheel", length=radius, mass=3.0, centre=(0, 0, 0), inertia=(0.03, spin, 0.03))
    x = m.prismatic("x", m.ground.at(0, 0, radius), stage, axis=(1, 0, 0))
    y = m.prismatic("y", stage, saddle, axis=(0, 1, 0))
    yaw = m.revolute("yaw", saddle, fork, axis=(0, 0, 1))
    shaft = m.revolute("shaft", fork, wheel, axis=(0, 1, 0))
    c, s = ca.cos(m.coordinate(yaw)), ca.sin(m.coordinate(yaw))
    m.nonholonomic(
        "rolling", c * m.rate(x) + s * m.rate(y) - radius * m.rate(shaft), replaces=shaft
    )
    m.nonholonomic("no_slip", c * m.rate(y) - s * m.rate(x), replaces=y)

    def angle(t):
        return 0.2 + 0.8 * t + 0.3 * t**2

    laws = {
        "x": motion.expression(lambda t: circle * ca.sin(angle(t))),
        "y": motion.expression(lambda t: -circle * ca.cos(angle(t))),
        "yaw": motion.expression(angle),
        "shaft": motion.expression(lambda t: circle / radius * angle(t)),
    }
    found = evaluate(Scene(m, laws, t=(0.0, 0.9, 10)))
    assert found.certified
    t, turn = found.t, 0.6
    going = 0.8 + 0.6 * t
    mu = -spin * (circle * turn / radius) / radius
    push = (mass * circle * turn - mu) / np.cos(angle(t))
    assert found.effort("x") == pytest.approx(push, abs=1e-11)
    assert found.effort("yaw") == pytest.approx(np.full(t.size, (0.1 + 0.03) * turn), abs=1e-11)
    assert found.series["multiplier:rolling"] == pytest.approx(np.full(t.size, mu), abs=1e-11)
    assert found.series["multiplier:no_slip"] == pytest.approx(
        mass * circle * going**2 + push * np.sin(angle(t)), abs=1e-11
    )
    assert {"effort:y", "effort:shaft"}.isdisjoint(found.series)

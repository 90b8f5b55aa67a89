"""Constraints in space, against closed forms: a point on a surface, at rest and turning."""

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.quick

MASS, GRAVITY = 2.0, 9.81


def bowl(place):
    """z less the height of a bowl that is not round."""
    x, y, z = place
    return z - 0.5 * x**2 - y**2 - 0.2 * x * y


def test_a_point_on_a_surface():
    """Its third coordinate follows from the surface; the multiplier times the surface's slopes is
    the force that holds it.
    """
    m = SpatialMechanism("bead")
    ball = m.point_mass("ball", MASS)
    m.free("at", m.ground, ball)
    m.constraint("bowl", bowl(m.place(ball)))
    laws = {"at:slide_1": harmonic(0.1, 0.3, 1.0), "at:slide_2": harmonic(0.0, 0.2, 1.5, 0.7)}
    solution = evaluate(Scene(m, laws, t=(0.0, 1.0, 41), posture={"at:slide_3": 0.0}))
    assert solution.certified

    t = ca.SX.sym("t")
    x, y = (law.graph(t) for law in laws.values())
    z = -bowl((x, y, 0.0))
    place = ca.vertcat(x, y, z)
    acceleration = ca.jacobian(ca.jacobian(place, t), t)
    px, py, pz = (ca.SX.sym(name) for name in "xyz")
    slopes = ca.substitute(
        ca.gradient(bowl((px, py, pz)), ca.vertcat(px, py, pz)), ca.vertcat(px, py, pz), place
    )
    needed = MASS * (acceleration + ca.vertcat(0, 0, GRAVITY))
    held = needed[2] / slopes[2]
    expected = ca.Function(
        "expected",
        [t],
        [ca.vertcat(z, held, needed[0] - held * slopes[0], needed[1] - held * slopes[1])],
    )
    height, multiplier, along, across = (
        row.full().ravel() for row in ca.vertsplit(expected(solution.t[None, :]))
    )
    np.testing.assert_allclose(solution.motion("at:slide_3").value, height, atol=1e-14)
    np.testing.assert_allclose(solution.multiplier("bowl"), multiplier, rtol=1e-12)
    for coordinate, effort in (("at:slide_1", along), ("at:slide_2", across)):
        np.testing.assert_allclose(
            solution.effort(coordinate), effort, atol=1e-12 * np.abs(effort).max()
        )


def test_a_point_of_a_link_on_a_cam_that_turns():
    """An arm rests by its tip on a slope that turns: the work of the drive and of the slope is the
    change of the arm's energy.
    """
    m = SpatialMechanism("follower")
    arm = m.link("arm", length=0.4, mass=1.0)
    m.universal("U", m.ground.at(0.0, 0.0, 0.5), arm, axis=(0.0, 0.0, 1.0), second=(0.0, 1.0, 0.0))
    m.path("tip", arm.tip)
    x, y, z = m.place(arm.tip)
    slope, speed = 0.3, 0.8
    m.constraint(
        "cam", z - 0.45 - slope * (x * ca.cos(speed * m.time) + y * ca.sin(speed * m.time))
    )
    scene = Scene(
        m, {"U:turn_1": polynomial(0.2, 0.5)}, t=(0.0, 2.0, 401), posture={"U:turn_2": 0.0}
    )
    solution = evaluate(scene)
    assert solution.certified
    x, y, z = (solution.output(f"tip_{name}") for name in "xyz")
    turned, held = speed * solution.t, solution.multiplier("cam")
    np.testing.assert_allclose(
        z - 0.45, slope * (x * np.cos(turned) + y * np.sin(turned)), atol=1e-14
    )
    # The force is the multiplier times the slopes of Phi; where Phi holds, its power is less the
    # part that time changes.
    power = solution.effort("U:turn_1") * 0.5 - held * slope * speed * (
        x * np.sin(turned) - y * np.cos(turned)
    )
    motion = solution.motion("U:turn_2")
    # A slender rod that turns about its end.
    energy = ((0.5 * np.cos(motion.value)) ** 2 + motion.rate**2) * 0.4**2 / 6 + GRAVITY * (
        z - 0.5
    ) / 2
    # Boole's rule, over four steps at a time.
    pieces = [
        weight * power[k : power.size - 4 + k : 4] for k, weight in enumerate((7, 32, 12, 32, 7))
    ]
    work = np.sum(pieces, axis=0) * (solution.t[1] - solution.t[0]) * 2 / 45
    np.testing.assert_allclose(work, np.diff(energy[::4]), atol=1e-12)

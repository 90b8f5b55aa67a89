"""The cases in space against numbers from elsewhere, closed forms, statics and energies that are
worked out here.
"""

from __future__ import annotations

import math
import runpy

import casadi as ca
import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.motion import harmonic

G = 9.81


UP = np.array([0.0, 0.0, 1.0])


def scene_of(name):
    return load_case(CASES / name).scene


def vm(scene, **keywords):
    return evaluate(scene, backend="vm", certificate=False, **keywords)


def vector(found, group, part, members="xyz"):
    return np.array([found.array(f"{group}:{part}:{member}") for member in members]).T


def along(found, link):
    """The direction of a link's axis, by instant."""
    return vector(found, "pose", link, ("xx", "xy", "xz"))


def test_the_benchmarks_slider_at_its_start():
    slide = vm(scene_of("spatial_slider_crank"), t=(0, 0, 1), wanted=["motion"]).motion("guide")
    assert (slide.value[0], slide.rate[0], slide.acceleration[0]) == pytest.approx(
        (0.2, 0.24, 1.44), abs=1e-14
    )


def test_a_shaft_out_of_phase_pulsates():
    """Hooke's joint twice: without inertia the torque follows the speed, between cos^2 and 1/cos^2
    of the tube's angle.
    """
    square = 1 - (0.15 / 0.5) ** 2
    parameters = {"phase": math.pi / 2}
    slow = vm(
        scene_of("cardan_shaft"), parameters=parameters | {"rpm": 1e-3}, wanted=["effort", "motion"]
    )
    ratio = slow.motion("far:turn").rate / slow.motion("bearing").rate
    assert (ratio.min(), ratio.max()) == pytest.approx((square, 1 / square), rel=1e-12)
    assert np.max(np.abs(slow.effort("bearing") - 80.0 * ratio)) < 1e-7
    assert (slow.effort("bearing").min(), slow.effort("bearing").max()) == pytest.approx(
        (72.8, 80 / 0.91), abs=1e-7
    )
    fast = vm(scene_of("cardan_shaft"), parameters=parameters, wanted=["effort"]).effort("bearing")
    assert np.mean(fast[:-1]) == pytest.approx(80.0, abs=1e-11)
    assert np.ptp(fast) > 4 * np.ptp(slow.effort("bearing"))


def test_a_suspension_at_rest():
    """Six equations of the hub, for the forces along five bars and the effort; half a bar's weight
    is across it at each end.
    """
    found = vm(
        scene_of("five_link_suspension"), parameters={"travel": 0.0}, t=(0, 0, 1), xi=(0, 1, 3)
    )
    told = runpy.run_path(str(CASES / "five_link_suspension" / "case.py"))
    wheel, weight = np.array(told["WHEEL"]), 0.9 * G
    top, low = np.array([0.0, 0.45, 0.75]), wheel - [0.0, 0.08, 0.02]
    distance = np.linalg.norm(top - low)
    bars, across, lengths = [], [], []
    given = [
        (wheel - [0.0, 0.03, 0.0], -18.0 * G * UP),
        (wheel * [1, 1, 0], np.array([0.0, -2500.0, 4000.0])),
    ]
    given.append((low, 30e3 * (distance - 0.62) * (top - low) / distance))
    for inner, outer in told["BARS"].values():
        start, end = np.array(inner), np.array(outer)
        lengths.append(np.linalg.norm(end - start))
        e = (end - start) / lengths[-1]
        across.append(-weight / 2 * (UP - (UP @ e) * e))
        given.append((end, across[-1]))
        bars.append((end, -e))
    matrix = np.array(
        [[*force, *np.cross(place, force)] for place, force in (*bars, (wheel, UP))]
    ).T
    right = -sum(np.array([*force, *np.cross(place, force)]) for place, force in given)
    *forces, effort = np.linalg.solve(matrix, right)
    size = np.max(np.abs(forces))
    assert found.effort("wheel:slide_3")[0] == pytest.approx(effort, abs=1e-12 * size)
    for k, (name, force) in enumerate(zip(told["BARS"], forces, strict=True)):
        section, back = found.section(name), bars[k][1]
        assert section.axial[0, [0, -1]] == pytest.approx(
            [force + weight * (back @ UP), force], abs=1e-12 * size
        ), name
        hub = vector(found, "reaction", f"{name}_hub", ("fx", "fy", "fz"))[0]
        assert np.max(np.abs(hub - (force * back + across[k]))) < 1e-12 * size, name
        level = math.hypot(*np.cross(back, UP))
        assert section.bending[0] == pytest.approx(
            [0, weight * level * lengths[k] / 8, 0], abs=1e-12
        ), name


MASS, GRAVITY = 2.0, 9.81


def bowl(place):
    """z less the height of a bowl that is not round."""
    x, y, z = place
    return z - 0.5 * x**2 - y**2 - 0.2 * x * y


@pytest.mark.quick
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

"""Numbers from outside: none of them made by this project."""

import math

import numpy as np
import pytest
from balance import instant_at, section_forces
from conftest import SIXTY_DIGITS

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def instants(slider_crank):
    """Every column at the reference's own instants."""
    program = derive(slider_crank.scene)
    p = list(slider_crank.scene.mechanism.values().values())
    rows = [instant_at(program, float(row["t"]), p).full().ravel() for row in SIXTY_DIGITS["rows"]]
    return dict(zip(program.names, np.array(rows).T, strict=True))


def reference(key, index=None):
    return np.array(
        [row[key] if index is None else row[key][index] for row in SIXTY_DIGITS["rows"]],
        dtype=float,
    )


def assert_within(found, expected, relative=1e-13):
    """Within ``relative`` of the largest value over the cycle."""
    assert np.max(np.abs(found - expected)) <= relative * np.max(np.abs(expected))


def test_the_case_is_the_references(slider_crank):
    parameters = slider_crank.scene.mechanism.values()
    assert parameters == {k: float(v) for k, v in SIXTY_DIGITS["parameters"].items() if k != "g"}
    assert slider_crank.scene.mechanism.gravity[:2] == (
        0.0,
        -float(SIXTY_DIGITS["parameters"]["g"]),
    )


def test_torque_and_reactions(instants):
    assert_within(instants["effort:O"], reference("torque_O"))
    assert_within(instants["reaction:guide:fy"], reference("guide_on_slider"))
    for axis in (0, 1):
        assert_within(instants[f"reaction:A:f{'xy'[axis]}"], reference("crank_on_rod_A", axis))
        assert_within(-instants[f"reaction:B:f{'xy'[axis]}"], reference("slider_on_rod_B", axis))


def test_sections(instants):
    law = {
        k: instants[f"section:rod:law:{k}"][:, None]
        for k in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")
    }
    forces = section_forces(law, 0.1, 0.2, np.array([float(x) for x in SIXTY_DIGITS["xi_over_l"]]))
    for force, key in zip(forces, ("R_axial", "R_shear", "R_bending"), strict=True):
        assert_within(-force, reference(key))


def test_sections_as_a_solution_gives_them(slider_crank):
    """The same by the whole path: compiled, on the grid, at t = 0.03 s and the ratios 0, 1/4, 1/2,
    3/4, 1.
    """
    row = next(row for row in SIXTY_DIGITS["rows"] if float(row["t"]) == 0.03)
    picked = [SIXTY_DIGITS["xi_over_l"].index(x) for x in ("0", "0.25", "0.5", "0.75", "1")]
    solution = evaluate(slider_crank.scene, t=(0.03, 0.03, 1), xi=(0, 1, 5), wanted=["section:rod"])
    for force in ("axial", "shear", "bending"):
        expected = np.array([float(row[f"R_{force}"][i]) for i in picked])
        largest = np.max(np.abs(reference(f"R_{force}")))
        assert (
            np.max(np.abs(solution.array(f"section:rod:{force}")[0] + expected)) <= 1e-13 * largest
        )


def test_marghitu_slider_crank():
    """D.

    B. Marghitu, Mechanisms and Robots Analysis with MATLAB (2009), R-RRT example, eq. 4.51-4.52,
    without the external force.

    The book's force on the slider enters linearly; its part is taken off by equilibrium: 100 N in
    +x on the slider.
    """
    root = math.sqrt(2.0)
    m = Mechanism("marghitu")
    m.set_gravity(0.0, -10.0)
    a, b = (m.link(name, length=1.0, mass=1.0) for name in ("one", "two"))
    c = m.point_mass("three", 1.0)
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    m.revolute("C", b.tip, c)
    m.prismatic("guide", m.ground, c, axis=(1, 0))
    solution = evaluate(
        Scene(
            m,
            {"A": polynomial(math.pi / 4, 1.0)},
            t=(0.0, 0.0, 1),
            posture={"two": -0.8},
            wanted=["effort", *REACTIONS],
        )
    )
    # The second link, at -45 deg, passes the 100 N on as (100, -100) N; the guide and the two pins
    # bear it.
    f12 = np.array([-(400 + 7 * root) / 4, 5 * (84 + root) / 4])
    f01 = np.array([-100 - 2 * root, 115 + root])
    external = np.array([-100.0, 100.0])
    assert solution.reaction("guide").fy[0] == pytest.approx(-(85 + 1.5 * root) + 100.0, rel=1e-13)
    np.testing.assert_allclose(
        np.hstack([solution.reaction("B").fx, solution.reaction("B").fy]),
        f12 - external,
        rtol=1e-13,
    )
    np.testing.assert_allclose(
        np.hstack([solution.reaction("A").fx, solution.reaction("A").fy]),
        f01 - external,
        rtol=1e-13,
    )
    lever = external[1] * math.cos(math.pi / 4) - external[0] * math.sin(math.pi / 4)
    assert solution.effort("A")[0] == pytest.approx(3 + 105 * root - lever, rel=1e-13)


REACTIONS = ("reaction:A", "reaction:B", "reaction:guide")


def test_one_rotating_rod():
    """Closed form: N = rho (l^2 - xi^2)/2 theta'^2 - rho (l - xi) g sin(theta); T = m l^2/3 theta''
    + m g l/2 cos(theta).
    """
    mass, l, g = 2.5, 0.8, 9.81
    m = Mechanism("rod")
    m.revolute("hinge", m.ground, m.link("arm", length=l, mass=mass))
    solution = evaluate(
        Scene(m, {"hinge": polynomial(0.3, 4.0, -6.0)}, t=(0, 1.3, 50), xi=(0, 1, 21))
    )
    t = solution.t
    angle, rate, acceleration = 0.3 + 4 * t - 6 * t**2, 4 - 12 * t, -12.0
    np.testing.assert_allclose(
        solution.effort("hinge"),
        mass * l**2 / 3 * acceleration + mass * g * l / 2 * np.cos(angle),
        atol=1e-13,
        rtol=1e-13,
    )
    rho, xi = mass / l, l * solution.xi
    tension = (
        rho * (l**2 - xi**2) / 2 * rate[:, None] ** 2 - rho * (l - xi) * g * np.sin(angle)[:, None]
    )
    assert_within(solution.section("arm").axial, tension)
    assert np.all(solution.section("arm").bending[:, -1] == 0.0)
    assert np.all(solution.section("arm").shear[:, -1] == 0.0)
    assert np.all(solution.section("arm").axial[:, -1] == 0.0)


def test_rod_whip_approaches_the_textbook():
    """Largest bending m w^2 r l/(9 sqrt 3) at l/sqrt 3 from the small end, for a rod long against
    its crank, without gravity.
    """
    mass, speed, r = 1.6, 52.36, 0.1375
    gaps = []
    for ratio in (4.0, 40.0, 400.0):
        m = Mechanism("whip")
        m.set_gravity(0.0, 0.0)
        crank, rod = m.link("crank", length=r, mass=0.0), m.link("rod", length=ratio * r, mass=mass)
        slider = m.point_mass("slider", 0.0)
        m.revolute("O", m.ground, crank)
        m.revolute("A", crank.tip, rod)
        m.revolute("B", rod.tip, slider)
        m.prismatic("guide", m.ground, slider, axis=(1, 0))
        turn = 2 * math.pi / speed
        peak = evaluate(
            Scene(
                m,
                {"O": polynomial(0.0, speed)},
                t=(0, turn, 2001),
                posture={"rod": 0.0},
                wanted=["section:rod"],
            )
        ).peak("section:rod:bending")
        textbook = mass * speed**2 * r * ratio * r / (9 * math.sqrt(3))
        gaps.append((abs(peak.value) / textbook - 1, peak.xi - (1 - 1 / math.sqrt(3))))
    assert [abs(gap[0]) for gap in gaps] == sorted((abs(gap[0]) for gap in gaps), reverse=True)
    assert abs(gaps[-1][0]) < 1e-5
    assert abs(gaps[-1][1]) < 1e-2

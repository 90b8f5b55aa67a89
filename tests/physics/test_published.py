"""Numbers from outside: sixty digits of a slider-crank, a textbook's example, and the torque that
Nguyen, Petre, Stroe print.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from balance import instant_at
from conftest import SIXTY_DIGITS
from mechanisms import pins_of, slider_crank

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


def test_torque_and_reactions(instants):
    assert_within(instants["effort:O"], reference("torque_O"))
    assert_within(instants["reaction:guide:fy"], reference("guide_on_slider"))
    for axis in (0, 1):
        assert_within(instants[f"reaction:A:f{'xy'[axis]}"], reference("crank_on_rod_A", axis))
        assert_within(-instants[f"reaction:B:f{'xy'[axis]}"], reference("slider_on_rod_B", axis))


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


def test_marghitus_slider_crank():
    """Mechanisms and Robots Analysis with MATLAB (2009), R-RRT example, eq. 4.51-4.52: 100 N in +x
    on the slider.
    """
    root, m = math.sqrt(2.0), Mechanism("marghitu")
    m.set_gravity(0.0, -10.0)
    a, b = (m.link(name, length=1.0, mass=1.0) for name in ("one", "two"))
    c = m.point_mass("three", 1.0)
    pins_of(m, A=(m.ground, a), B=(a.tip, b), C=(b.tip, c))
    m.prismatic("guide", m.ground, c, axis=(1, 0))
    m.force("push", c, x=100.0)
    law = {"A": polynomial(math.pi / 4, 1.0)}
    solution = evaluate(Scene(m, law, t=(0.0, 0.0, 1), posture={"two": -0.8}))
    printed = {
        "reaction:B:fx": -(400 + 7 * root) / 4,
        "reaction:B:fy": 5 * (84 + root) / 4,
        "reaction:A:fx": -100 - 2 * root,
        "reaction:A:fy": 115 + root,
        "reaction:guide:fy": -(85 + 1.5 * root),
        "effort:A": 3 + 105 * root,
    }
    found = {name: solution.series[name][0] for name in printed}
    assert found == pytest.approx(printed, rel=1e-13)


def test_eq_14_active_torque():
    """One term is missing from the bracket of theta'^2: + (m2/4 + m3) r^4 s^3 c^3/D^2."""
    r, l, m1, m2, m3 = 0.13, 0.35, 0.7, 0.4, 1.1
    angle, rate, acceleration = 2.4, -11.0, 53.0
    s, c = math.sin(angle), math.cos(angle)
    D = l**2 - r**2 * s**2
    q = math.sqrt(D)
    by_acceleration = (
        m1 / 3
        + (m2 * l**2 / 3 + m3 * r**2 * s**2) * c**2 / D
        + (m2 + m3) * s**2
        + (m2 + 2 * m3) * r * s**2 * c / q
    )
    by_rate = (
        (3 * m2 / 4 + m3) * s * c
        - (m2 / 2 + m3) * r * s**3 / q
        + (m2 + 2 * m3) * r * s * c**2 / q
        + m2 * r**2 * l**2 * s * c**3 / (12 * D**2)
        + (m2 / 4 + m3) * r**2 * s * c * (c**2 - s**2) / D
        + (m2 / 2 + m3) * r**3 * s**3 * c**2 / (D * q)
        - m2 * l**2 * s * c / (12 * D)
    )
    missing = (m2 / 4 + m3) * r**4 * s**3 * c**3 / D**2
    inertia = by_acceleration * acceleration + (by_rate + missing) * rate**2
    program = derive(slider_crank())
    out = program.instant(0.0, [angle], [rate], [acceleration], [], [r, l, m1, m2, m3])
    found = dict(zip(program.names, out.full().ravel(), strict=True))["effort:O"]
    torque = r**2 * inertia + (m1 + m2) * 9.81 * r * c / 2
    assert found == pytest.approx(torque, rel=1e-13)
    assert abs(r**2 * missing * rate**2) > 1e-3 * abs(torque)

"""Numbers from outside: sixty digits of a slider-crank, a textbook's example, closed forms of
rods, and the printed equations of Nguyen, Petre, Stroe, corrected and as printed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

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
    pins_of(m, A=(m.ground, a), B=(a.tip, b), C=(b.tip, c))
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


G = 9.81


@dataclass(frozen=True)
class State:
    """One posture of one slider-crank."""

    r: float
    l: float
    m1: float
    m2: float
    m3: float
    angle: float
    rate: float
    acceleration: float

    def __post_init__(self):
        s, c = np.sin(self.angle), np.cos(self.angle)
        D = self.l**2 - self.r**2 * s**2
        self.__dict__.update(s=s, c=c, D=D, q=np.sqrt(D))


STATES = [
    State(0.1, 0.2, 0.1, 0.1, 0.1, 0.5, 78.0, 0.03),
    State(0.13, 0.35, 0.7, 0.4, 1.1, 2.4, -11.0, 53.0),
    State(0.08, 0.11, 0.3, 0.9, 0.2, -1.2, 6.0, -210.0),
    State(0.2, 0.9, 0.5, 1.5, 0.6, 4.0, 0.0, 30.0),
    State(0.2, 0.9, 0.5, 1.5, 0.6, 5.5, 9.0, 0.0),
]


@pytest.fixture(scope="module")
def program():
    return derive(slider_crank())


def engine(program, x):
    out = program.instant(
        0.0, [x.angle], [x.rate], [x.acceleration], [], [x.r, x.l, x.m1, x.m2, x.m3]
    )
    return dict(zip(program.names, out.full().ravel(), strict=True))


def torque_14(x, corrected):
    """Eq. (14), solved for M."""
    m1, m2, m3, r, l, s, c, D, q = x.m1, x.m2, x.m3, x.r, x.l, x.s, x.c, x.D, x.q
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
    if corrected:
        by_rate += missing_in_14(x)
    return (
        r**2 * (by_acceleration * x.acceleration + by_rate * x.rate**2) + (m1 + m2) * G * r * c / 2
    )


def missing_in_14(x):
    return (x.m2 / 4 + x.m3) * x.r**4 * x.s**3 * x.c**3 / x.D**2


@pytest.mark.parametrize("x", STATES)
def test_eq_14_active_torque(program, x):
    """One term is missing from the bracket of theta'^2: + (m2/4 + m3) r^4 s^3 c^3/D^2."""
    found = engine(program, x)["effort:O"]
    scale = abs(found) + x.r**2 * x.m1 * (x.rate**2 + abs(x.acceleration))
    assert found == pytest.approx(torque_14(x, corrected=True), abs=1e-14 * scale)
    miss = x.r**2 * missing_in_14(x) * x.rate**2
    assert found - torque_14(x, corrected=False) == pytest.approx(miss, abs=1e-13 * scale)

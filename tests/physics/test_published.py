"""Numbers from outside: sixty digits of a slider-crank, a textbook's example, closed forms of
rods, and the printed equations of Nguyen, Petre, Stroe, corrected and as printed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from balance import instant_at, section_forces
from conftest import SIXTY_DIGITS
from mechanisms import slider_crank

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


def guide_19(x, corrected):
    """Eq. (19), N_B, term by term; the corrections are those listed in the test."""
    m2, m3, r, l, s, c, D, q = x.m2, x.m3, x.r, x.l, x.s, x.c, x.D, x.q
    # In short 3 (m2 + 2 m3) r^2 D^2 (s^2 theta'' + s c theta'^2), which only D^2 below turns into a
    # force.
    first = (
        3 * m2 * r**6 * s**6 + 6 * m3 * r**6 * s**6 + 3 * m2 * r**2 * l**4 * s**2
        + 6 * m3 * r**2 * l**4 * s**2 - 6 * m2 * r**4 * l**2 * s**4 - 12 * m3 * r**4 * l**2 * s**4
    ) * x.acceleration + (
        3 * m2 * r**6 * s**5 * c + 6 * m3 * r**6 * s**5 * c - 6 * m2 * r**4 * l**2 * s**3 * c
        - 12 * m3 * r**4 * l**2 * s**3 * c + 3 * m2 * r**2 * l**4 * s * c + 6 * m3 * r**2 * l**4 * s * c  # noqa: E501
    ) * x.rate**2  # fmt: skip
    factor = c if corrected else 1.0
    second = (
        (3 * m2 * r**5 * s**4 + 6 * m3 * r**5 * s**4) * factor + m2 * r * l**4 * c
        - 4 * m2 * r**3 * l**2 * s**2 * c - 6 * m3 * r**3 * l**2 * s**2 * c
    ) * x.acceleration  # fmt: skip
    a, b = (4, 6) if corrected else (2, 4)
    second += (
        -3 * m2 * r**5 * s**5 - 6 * m3 * r**5 * s**5 + a * m2 * r**3 * l**2 * s + 6 * m3 * r**3 * l**2 * s  # noqa: E501
        - m2 * r * l**4 * s - b * m2 * r**3 * l**2 * s * c**2 - 12 * m3 * r**3 * l**2 * s * c**2
    ) * x.rate**2  # fmt: skip
    weight = -m2 * G / 2 - m3 * G
    if corrected:
        return first / (6 * D**2 * q) - second / (6 * D**2) + weight
    return first / (6 * D * q) + second / (6 * D) + weight


@pytest.mark.parametrize("x", STATES)
def test_eq_19_guide_force(program, x):
    """Corrected: 6 D^2 q and - 6 D^2 below; a factor c with r^5 s^4; 4 and 6 for 2 and 4 with m2
    r^3 l^2. N_B = -(reaction, y).
    """
    found = -engine(program, x)["reaction:guide:fy"]
    scale = abs(found) + (x.m2 + x.m3) * x.r * (x.rate**2 + abs(x.acceleration))
    assert found == pytest.approx(guide_19(x, corrected=True), abs=1e-13 * scale)
    assert abs(found - guide_19(x, corrected=False)) > 1e-3 * scale


def axial_21(x, xi, corrected):
    """Eq. (21), N, as printed but for the last term of gravity."""
    m2, m3, r, l, s, c, D, q = x.m2, x.m3, x.r, x.l, x.s, x.c, x.D, x.q
    first = (
        6 * m2 * r**6 * xi * s**5 * c - 5 * m2 * r**2 * l**5 * s * c - 6 * m3 * r**2 * l**5 * s * c
        - 3 * m2 * r**6 * l * s**5 * c + 8 * m2 * r**4 * l**3 * s**3 * c + 6 * m3 * r**4 * l**3 * s**3 * c  # noqa: E501
        - 12 * m2 * r**4 * l**2 * xi * s**3 * c + 6 * m2 * r**2 * l**4 * xi * s * c
    ) * x.acceleration + (
        -6 * m2 * r**6 * xi * s**6 + 3 * m2 * r**6 * l * s**6 - 3 * m2 * r**2 * l**5 * c**2
        - 6 * m3 * r**2 * l**5 * c**2 + 2 * m2 * r**4 * l**3 * s**2 + 5 * m2 * r**2 * l**5 * s**2
        + 6 * m3 * r**4 * l**3 * s**2 + 6 * m3 * r**2 * l**5 * s**2 - 10 * m2 * r**4 * l**3 * s**4
        - 12 * m3 * r**4 * l**3 * s**4 + 3 * m2 * r**2 * l**3 * xi**2 * c**2 - m2 * r**4 * l**3 * s**2 * c**2  # noqa: E501
        - 6 * m3 * r**4 * l**3 * s**2 * c**2 - 6 * m2 * r**2 * l**4 * xi * s**2
        + 12 * m2 * r**4 * l**2 * xi * s**4 - 3 * m2 * r**4 * l * xi**2 * s**2 * c**2
    ) * x.rate**2  # fmt: skip
    last = 6 * m2 * G * r * l**4 * s * (xi if corrected else 1.0)
    first += (
        6 * m2 * G * r**3 * l**3 * s**3 - 3 * m2 * G * r * l**5 * s + 6 * m2 * G * r**5 * xi * s**5
        - 3 * m2 * G * r**5 * l * s**5 - 12 * m2 * G * r**3 * l**2 * xi * s**3 + last
    )  # fmt: skip
    second = (
        -12 * m2 * r**5 * l**3 * s**5 + 12 * m3 * r**3 * l**5 * s**3 + 15 * m2 * r**3 * l**5 * s**3
        - 6 * m3 * r**5 * l**3 * s**5 - 6 * m2 * r * l**7 * s - 6 * m3 * r * l**7 * s
        - 6 * m2 * r**7 * xi * s**7 + 3 * m2 * r**7 * l * s**7 - 18 * m2 * r**3 * l**4 * xi * s**3
        + 18 * m2 * r**5 * l**2 * xi * s**5 + 6 * m2 * r * l**6 * xi * s
    ) * x.acceleration + (
        -6 * m2 * r * l**7 * c - 6 * m3 * r * l**7 * c + 6 * m2 * r * l**6 * xi * c
        + 15 * m2 * r**3 * l**5 * s**2 * c + 12 * m3 * r**3 * l**5 * s**2 * c - 12 * m2 * r**5 * l**3 * s**4 * c  # noqa: E501
        - 6 * m3 * r**5 * l**3 * s**4 * c - 6 * m2 * r**7 * xi * s**6 * c + 3 * m2 * r**7 * l * s**6 * c  # noqa: E501
        - 18 * m2 * r**3 * l**4 * xi * s**2 * c + 18 * m2 * r**5 * l**2 * xi * s**4 * c
    ) * x.rate**2  # fmt: skip
    return first / (6 * l**2 * D**2) + second / (6 * l**2 * D**2 * q)


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.25, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("x", STATES)
def test_eq_21_axial_force(program, x, ratio):
    """The last term of gravity needs a factor xi, by its dimension; all else is right.

    N = -(axial): compression positive.
    """
    found = engine(program, x)
    law = {k: found[f"section:rod:law:{k}"] for k in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")}
    axial = -section_forces(law, x.m2, x.l, ratio)[0]
    scale = (x.m2 + x.m3) * x.r * (x.rate**2 + abs(x.acceleration)) * x.l / x.q + x.m2 * G
    xi = ratio * x.l
    assert axial == pytest.approx(axial_21(x, xi, corrected=True), abs=1e-13 * scale)
    miss = x.m2 * G * x.r * x.l**2 * x.s * (xi - 1.0) / x.D**2
    assert axial - axial_21(x, xi, corrected=False) == pytest.approx(
        miss, abs=1e-12 * (scale + abs(miss))
    )
    assert abs(miss) > 1e-3 * x.m2 * G * x.r

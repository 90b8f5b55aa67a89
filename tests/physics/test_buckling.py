"""Columns against closed forms, a beam-column worked out by its differential equation, and the
joints of small mechanisms.
"""

import math

import numpy as np
import pytest
import strong
from hypothesis import given
from hypothesis import strategies as st
from internals import BucklingColumn as Column
from internals import Member, critical_stress, describe, effective_lengths
from internals import buckling_used as used

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, evaluate
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

E, SY = 210e9, 490e6


def column(member, effective):
    return Column.of(member.cross, member.law.length, effective)


def load_factor(compression, moments, of):
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1.0 / used(of, compression, moments)


def test_eulers_curve_and_johnsons_parabola_touch_at_half_the_strength():
    border = math.sqrt(2 * math.pi**2 * E / SY)
    assert critical_stress(border, E, SY) == pytest.approx(SY / 2)
    step = 1e-6 * border
    slopes = [
        (critical_stress(border + s * step, E, SY) - critical_stress(border, E, SY)) / (s * step)
        for s in (1, -1)
    ]
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-5)
    assert critical_stress(0.0, E, SY) == SY
    assert critical_stress(3 * border, E, SY) == pytest.approx(SY / 18)


def rod_of(shape, columns=None):
    solution = evaluate(strong.press(shape, columns=columns), certificate=False)
    return solution, Member.of(solution, "rod")


def test_a_slender_rod_bears_eulers_load():
    solution, member = rod_of(beams.rectangle(0.008, 0.02))
    found = column(member, effective_lengths(solution.description, "rod"))
    assert found.effective == (1.0, 0.5)
    assert found.critical[0] == pytest.approx(math.pi**2 * E * (0.02 * 0.008**3 / 12) / 0.4**2)
    assert found.slenderness[0] == pytest.approx(0.4 / (0.008 / math.sqrt(12)))
    assert found.critical[1] == pytest.approx(
        0.008 * 0.02 * float(critical_stress(0.2 / (0.02 / math.sqrt(12)), E, SY))
    )


def test_of_what_leans_the_weakest_axis_counts():
    """A flat bar turned by 30 degrees in its cross-section: its own least second moment."""
    corners = np.array([(0.015, 0.003), (-0.015, 0.003), (-0.015, -0.003), (0.015, -0.003)])
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    turned = corners @ np.array([[c, s], [-s, c]])
    _, member = rod_of(
        beams.polygon([tuple(map(float, corner)) for corner in turned]), columns=(1.0, 1.0)
    )
    assert column(member, (1.0, 1.0)).euler[0] == pytest.approx(
        math.pi**2 * E * (0.03 * 0.006**3 / 12) / 0.16
    )


def test_of_a_taper_the_thinnest_counts():
    _, taper = rod_of(beams.tapered(beams.rectangle(0.02, 0.01), beams.rectangle(0.01, 0.01)))
    _, even = rod_of(beams.rectangle(0.01, 0.01))
    assert column(taper, (1.0, 0.5)).critical == pytest.approx(column(even, (1.0, 0.5)).critical)


EVEN = Column((1.0, 1.0), (60.0, 60.0), (2e5, 2e5), (1e5, 1e5), (1e3, 1e3))


@given(st.floats(1.0, 1e6), st.floats(0.0, 1e4))
def test_the_factor_is_the_root_of_the_interaction(compression, moment):
    """In one plane it is a root of a n e n^2 - (a + m + e) n + 1 = 0."""
    a, m, e = compression / 1e5, moment / 1e3, compression / 2e5
    found = load_factor(np.array([compression]), (np.array([moment]), np.zeros(1)), EVEN)[0]
    b = a + m + e
    assert found == pytest.approx(2.0 / (b + math.sqrt(b * b - 4 * a * e)), rel=1e-9)


def test_without_compression_nothing_buckles():
    assert load_factor(np.array([-5.0, 0.0]), (np.ones(2), np.ones(2)), EVEN).tolist() == [
        math.inf,
        math.inf,
    ]


def test_bending_about_both_axes_is_worse():
    both, one = (
        load_factor(np.array([1e4]), (np.array([300.0]), np.array([my])), EVEN)[0]
        for my in (300.0, 0.0)
    )
    assert both < one
    assert 1e4 * both / 1e5 + 2 * 300 * both / 1e3 / (1 - both * 1e4 / 2e5) == pytest.approx(1.0)


def test_a_beam_column_by_its_differential_equation():
    """E I v'' + N v = -M, pinned, even moment: the outermost fibre yields at M sec(pi/2
    sqrt(N/N_e)); the interaction with Euler's load and the yield load in its place is on the safe
    side of that, by little."""
    area, second, height, length = 4e-4, 2e-8, 0.02, 0.5
    euler = math.pi**2 * E * second / length**2
    yields = area * SY
    bends = SY * second / (height / 2)
    of = Column((1.0, 1.0), (0.0, 0.0), (euler, euler), (yields, yields), (bends, bends))
    n, m = 2e4, 40.0
    found = load_factor(np.array([n]), (np.array([m]), np.zeros(1)), of)[0]
    low, high = 0.0, euler / n
    for _ in range(80):
        middle = (low + high) / 2
        secant = 1 / math.cos(math.pi / 2 * math.sqrt(middle * n / euler))
        low, high = (
            (middle, high)
            if middle * n / yields + middle * m * secant / bends <= 1.0
            else (low, middle)
        )
    assert low == pytest.approx(found, rel=0.06)
    assert found >= low * 0.99


def described(build):
    m = Mechanism("m")
    arm = m.link("arm", length=0.4, mass=1.0)
    driven = build(m, arm)
    return describe(m, m.values(), driven)


def elbow(m, arm):
    other = m.link("other", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.revolute("A", arm.tip, other)
    return ["A"]


def driven(m, arm):
    elbow(m, arm)
    return ["O"]


def free(m, arm):
    m.revolute("O", m.ground, arm)
    m.weld("lump", arm.tip, m.point_mass("mass", 1.0))
    return ["O"]


def clamped(m, arm):
    m.prismatic("O", m.ground, arm, axis=(1, 0))
    m.weld("A", arm.tip, m.link("other", length=0.3, mass=1.0))
    return ["O"]


def to_a_piston(m, arm):
    piston = m.point_mass("piston", 1.0)
    m.prismatic("O", m.ground, arm, axis=(1, 0))
    m.revolute("pin", arm.tip, piston)
    m.prismatic("bore", m.ground, piston, axis=(0, 1))
    return ["bore"]


@pytest.mark.parametrize(
    ("build", "lengths"),
    [
        (driven, (2.0, 0.5)),
        (free, (2.0, 2.0)),
        (clamped, (1.0, 0.5)),
        (to_a_piston, (2.0, 0.5)),
        (elbow, (2.0, 0.5)),
    ],
)
def test_joints_tell_how_ends_are_held(build, lengths):
    assert effective_lengths(described(build), "arm") == lengths


def test_in_space_ends_are_joined_or_free():
    m = SpatialMechanism("m")
    arm, other = m.link("arm", length=0.4, mass=1.0), m.link("other", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.spherical("A", arm.tip, other)
    description = describe(m, m.values(), [])
    assert effective_lengths(description, "arm") == (1.0, 1.0)
    assert effective_lengths(description, "other") == (2.0, 2.0)


def test_what_buckling_needs():
    plain = beams.Material("plain", 7850.0, yield_strength=1e8)
    m = Mechanism("m")
    m.revolute(
        "O", m.ground, m.link("arm", length=0.4, beam=beams.Beam(beams.round_bar(0.02), plain))
    )
    solution = evaluate(
        Scene(m, {"O": polynomial(0.3, 2.0)}, t=(0, 1, 11), wanted=["section"]), certificate=False
    )
    with pytest.raises(
        DeclarationError, match="material 'plain' has no elasticity, which buckling needs"
    ):
        solution.safety("arm")
    with pytest.raises(
        DeclarationError,
        match="material 'plain' has no elasticity, which output 'safety:arm' needs",
    ):
        evaluate(Scene(m, {"O": polynomial(0.3, 2.0)}, t=(0, 1, 11)), wanted=["safety:arm"])
    with pytest.raises(
        DeclarationError,
        match="material 'plain' has no ultimate and no endurance, which output 'life:arm' needs",
    ):
        Scene(m, {"O": polynomial(0.3, 2.0)}, t=(0, 1, 11), wanted=["life:arm"])


def test_what_slides_along_a_link_holds_none_of_its_ends():
    """Its place on the link is told as the base, and is not there."""
    scene = strong.press(beams.rectangle(0.02, 0.01), sliding=True)
    told = describe(scene.mechanism, scene.mechanism.values(), ["O", "along"])
    assert effective_lengths(told, "rod") == (1.0, 0.5)

"""Friction of guides and sleeves in space: closed forms, the plane's, and reactions to which the
law is applied from outside.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

G, MASS = 9.81, 6.0


def table(across=0.0, along=0.0, **numbers):
    """A table on a level guide, whose weight is beside its line and beyond its middle."""
    m = SpatialMechanism("table")
    block = m.link(
        "block", length=0.3, mass=MASS, centre=(along, across, 0.0), inertia=(0.1, 0.1, 0.1)
    )
    guide = m.prismatic("X", m.ground, block, axis=(1, 0, 0))
    m.friction("rub", guide, **numbers)
    return Scene(m, {"X": polynomial(0.0, 0.4)}, t=(0, 1, 3))


@pytest.mark.parametrize("across", [0.0, 0.07])
@pytest.mark.parametrize("along", [0.0, 0.03, -0.2])
def test_a_weight_beside_a_guide_presses_on_its_blocks_and_on_what_keeps_it_from_turning(
    across, along
):
    """By statics the blocks bear W (1/2 + a/length) and W (1/2 - a/length), and what keeps it from
    turning W b/radius.
    """
    solution = evaluate(table(across, along, mu=0.1, length=0.12, radius=0.05))
    assert solution.certified
    pressed = MASS * G * (abs(0.5 + along / 0.12) + abs(0.5 - along / 0.12) + across / 0.05)
    assert solution.effort("X") == pytest.approx(0.1 * pressed, rel=1e-12)
    assert solution.series["friction:rub:loss"] == pytest.approx(0.1 * pressed * 0.4, rel=1e-12)


def test_a_bead_on_a_wire_bears_no_moment():
    m = SpatialMechanism("bead")
    wire = m.prismatic("X", m.ground, m.point_mass("ball", MASS), axis=(1, 0, 0))
    m.friction("rub", wire, mu=0.2, viscous=3.0)
    m.force("side", m.bodies["ball"], y=30.0)
    solution = evaluate(Scene(m, {"X": polynomial(0.0, -0.5)}, t=(0, 1, 3)))
    assert solution.certified
    assert solution.effort("X") == pytest.approx(
        -0.2 * math.hypot(MASS * G, 30.0) - 3.0 * 0.5, rel=1e-12
    )


def sleeve(turn, slide, **options):
    m = SpatialMechanism("sleeve")
    rod = m.link("rod", length=0.4, mass=MASS, centre=(0.0, 0.0, 0.0), inertia=(0.02, 0.1, 0.1))
    joint = m.cylindrical("C", m.ground, rod, axis=(1, 0, 0))
    numbers = {"mu": 0.2, "radius": 0.03, "length": 0.1} | options
    m.friction("sliding", joint, along="slide", **numbers)
    m.friction("turning", joint, along="turn", **numbers)
    return Scene(m, {"C:slide": slide, "C:turn": turn}, t=(0, 1, 9))


@pytest.mark.parametrize(("rate", "speed"), [(0.0, 0.3), (12.0, 0.3), (-12.0, -0.05), (5.0, 0.0)])
def test_a_sleeve_rubs_against_the_way_its_surface_slides(rate, speed):
    """A rod that turns slides easily: its friction has the direction of the speed, of which the
    turning is most.
    """
    solution = evaluate(sleeve(polynomial(0.1, rate), polynomial(0.0, speed)))
    assert solution.certified
    whole = math.hypot(speed, 0.03 * rate)
    weight = 0.2 * MASS * G
    assert solution.series["friction:sliding:along"] == pytest.approx(
        -weight * speed / whole, rel=1e-12, abs=1e-12
    )
    assert solution.series["friction:turning:along"] == pytest.approx(
        -weight * 0.03**2 * rate / whole, rel=1e-12, abs=1e-12
    )
    lost = solution.series["friction:sliding:loss"] + solution.series["friction:turning:loss"]
    assert lost == pytest.approx(weight * whole, rel=1e-12)


def test_a_sleeve_that_goes_to_and_fro_and_turns_has_no_jump():
    """Where the slide turns back while the rod turns, friction along it passes through zero
    smoothly; and viscous parts add up.
    """
    scene = sleeve(
        polynomial(0.0, 8.0), harmonic(0.0, 0.05, 1.0), static=0.3, stribeck=0.1, viscous=0.7
    )
    solution = evaluate(scene)
    assert solution.certified
    v, w = solution.motion("C:slide").rate, 0.03 * solution.motion("C:turn").rate
    whole = np.hypot(v, w)
    mu = 0.2 + 0.1 * np.exp(-((whole / 0.1) ** 2))
    assert solution.series["friction:sliding:along"] == pytest.approx(
        -mu * MASS * G * v / whole - 0.7 * v, rel=1e-11, abs=1e-11
    )
    expected = -mu * MASS * G * 0.03 * w / whole - 0.7 * w / 0.03
    assert solution.series["friction:turning:along"] == pytest.approx(expected, rel=1e-11)


def test_at_rest_both_are_open_and_where_both_turn_back_they_go_on():
    solution = evaluate(
        sleeve(harmonic(0.0, 1.0, 1.0, math.pi / 2), harmonic(0.0, 0.05, 1.0, math.pi / 2))
    )
    assert solution.certified
    assert not solution.resting.any()
    rates = solution.motion("C:slide").rate, solution.motion("C:turn").rate
    assert np.abs([rate[0] for rate in rates]).max() < 1e-12
    whole = math.hypot(0.05, 0.03)
    assert solution.series["friction:sliding:along"][0] == pytest.approx(
        0.2 * MASS * G * 0.05 / whole, rel=1e-9
    )
    still = evaluate(sleeve(polynomial(0.1), polynomial(0.2)))
    assert still.resting.all()
    assert np.isnan(still.series["friction:sliding:along"]).all()
    assert np.isnan(still.effort("C:turn")).all()


@pytest.mark.parametrize(
    ("joint", "numbers", "says"),
    [
        (
            "P",
            {"mu": 0.1, "radius": 0.1},
            "joint 'P' transmits a moment; expected length=, the guide length",
        ),
        (
            "P",
            {"mu": 0.1, "length": 0.1},
            "joint 'P' transmits a moment about its axis; expected radius=",
        ),
        (
            "P",
            {"mu": 0.1, "length": 0.1, "radius": 0.1, "along": "turn"},
            "joint 'P' has one coordinate and none called 'turn'",
        ),
        (
            "C",
            {"mu": 0.1, "length": 0.1, "radius": 0.1},
            "joint 'C' has two coordinates; expected along='slide' or 'turn'",
        ),
        ("C", {"mu": 0.1, "length": 0.1, "along": "slide"}, "joint 'C' turns; expected radius"),
        (
            "C",
            {"mu": 0.1, "radius": 0.1, "along": "turn"},
            "joint 'C' transmits a moment; expected length=, the distance of its",
        ),
        (
            "C",
            {"mu": 0.1, "radius": 0.1, "length": 0.1, "along": "turn", "smooth": 0.1},
            ("joint 'C' slides and turns at once, for which smooth= is not available"),
        ),
        (
            "U",
            {"mu": 0.1, "radius": 0.1},
            (
                "in space friction is possible in these joints: revolute, prismatic, cylindrical,"
                " screw, spherical"
            ),
        ),
    ],
)
def test_mistakes_are_told(joint, numbers, says):
    m = SpatialMechanism("m")
    a, b = m.link("a", length=0.1, mass=1.0), m.link("b", length=0.1, mass=1.0)
    m.prismatic("P", m.ground, a, axis=(1, 0, 0))
    m.cylindrical("C", a, b, axis=(1, 0, 0))
    m.universal("U", b.tip, m.link("c", length=0.1, mass=1.0), axis=(1, 0, 0), second=(0, 1, 0))
    with pytest.raises(DeclarationError, match=says):
        m.friction("rub", m.joints[joint], **numbers)

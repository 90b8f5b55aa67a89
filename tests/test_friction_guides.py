"""Friction of guides and sleeves in space: closed forms, the plane's, and reactions to which the
law is applied from outside.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
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


def slider_crank(space):
    """The same slider-crank in the plane x-z of space, and in the plane x-y; its guide rubs."""
    m = SpatialMechanism("rubbed") if space else Mechanism("rubbed")
    numbers = {"mu": m.parameter("mu", 0.3), "length": 0.05, "static": 0.4, "stribeck": 0.2}
    crank, rod = m.link("crank", length=0.05, mass=0.8), m.link("rod", length=0.16, mass=0.6)
    if not space:
        piston = m.link("piston", length=0.06, mass=0.5, centre=(0.01, 0.0), inertia=4e-4)
        m.revolute("main", m.ground, crank)
        m.revolute("pin", crank.tip, rod)
        m.revolute("wrist", rod.tip, piston)
        bore = m.prismatic("bore", m.ground, piston, axis=(1, 0))
        m.force("gas", piston, x=-2000.0)
        posture = {"rod": 0.0}
    else:
        m.set_gravity(0.0, 0.0, -G)
        piston = m.link(
            "piston", length=0.06, mass=0.5, centre=(0.01, 0.0, 0.0), inertia=(4e-4, 4e-4, 4e-4)
        )
        m.revolute("main", m.ground, crank, axis=(0, -1, 0))
        m.spherical("pin", crank.tip, rod)
        m.spherical("wrist", rod.tip, piston)
        bore = m.prismatic("bore", m.ground, piston, axis=(1, 0, 0))
        m.force("gas", piston, x=-2000.0)
        numbers |= {"radius": 0.02}
        posture = {"bore": 0.2}
    m.friction("rings", bore, **numbers)
    return Scene(m, {"main": polynomial(0.1, 60.0)}, t=(0, 0.1, 61), posture=posture)


@pytest.fixture(scope="module")
def spatial():
    return evaluate(slider_crank(True))


def test_a_guide_in_space_rubs_as_in_the_plane(spatial):
    flat = evaluate(slider_crank(False))
    assert spatial.certified
    assert flat.certified
    for name in ("friction:rings:along", "friction:rings:loss", "effort:main"):
        size = np.abs(flat.series[name]).max()
        assert spatial.series[name] == pytest.approx(flat.series[name], rel=0, abs=1e-11 * size)


def test_the_drive_gives_what_the_guide_takes(spatial):
    """The motion is the same with and without: at every instant the drive's power is more by the
    loss, and so over a turn.
    """
    smooth = evaluate(slider_crank(True), parameters={"mu": 0.0})
    # Without the part that static adds, none is dry.
    assert smooth.certified
    lost = [found.series["friction:rings:loss"] for found in (spatial, smooth)]
    power = [found.effort("main") * found.motion("main").rate for found in (spatial, smooth)]
    assert (lost[0] >= 0.0).all()
    assert power[0] - lost[0] == pytest.approx(
        power[1] - lost[1], rel=0, abs=1e-10 * np.abs(power[0]).max()
    )


def press(pushed=None):
    """A rod in space between a crank and an eccentric slider, whose tilted guide rubs; or which is
    ``pushed`` along its line.
    """
    m = SpatialMechanism("press")
    crank, rod = m.link("crank", length=0.1, mass=0.4), m.link("rod", length=0.4, mass=0.8)
    slider = m.link(
        "slider", length=0.05, mass=2.0, centre=(0.02, 0.03, -0.01), inertia=(1e-3, 2e-3, 3e-3)
    )
    m.revolute("O", m.ground, crank, axis=(0, 0, 1))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider.at(0.01, 0.02, 0.03))
    line = (0.96, 0.0, 0.28)
    guide = m.prismatic("guide", m.ground.at(0.0, 0.05, 0.1), slider, axis=line)
    m.force("work", slider.at(0.05, 0.0, 0.04), x=-300.0, y=40.0, z=60.0)
    if pushed is None:
        m.friction("rub", guide, mu=0.15, length=0.3, radius=0.2)
    else:
        m.force("push", slider, **{axis: pushed * x for axis, x in zip("xyz", line, strict=True)})
    return Scene(m, {"O": polynomial(0.4, 10.0)}, t=(0, 0.3, 7), posture={"guide": 0.4})


def test_beside_reactions_to_which_the_law_is_applied_from_outside():
    """The same slider pushed along its line by the force that the law makes of its reactions, again
    and again until it stays.
    """
    rubbed, pushed = evaluate(press()), []
    assert rubbed.certified
    reactions = []
    for force in (0.0, 1.0):  # reactions are linear in it
        found = evaluate(press(force), wanted=["reaction:guide", "motion"])
        reactions.append(
            np.stack([found.series[f"reaction:guide:{x}"] for x in ("fv", "fw", "mu", "mv", "mw")])
        )
    sign = np.sign(found.motion("guide").rate)
    force = np.zeros(7)
    for _ in range(200):
        v, w, about, tilt, lean = reactions[0] + (reactions[1] - reactions[0]) * force
        sides = sum(np.hypot(v / 2 + k * lean / 0.3, w / 2 - k * tilt / 0.3) for k in (1, -1))
        force = -sign * 0.15 * (sides + np.abs(about) / 0.2)
    pushed = rubbed.series["friction:rub:along"]
    assert pushed == pytest.approx(force, rel=1e-10)
    assert np.abs(force).min() > 1.0


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

"""Friction against closed forms: slopes, journals, screws, sleeves and bearings of shafts; and
what is refused.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


G, MASS = 9.81, 6.0


def sleeve(turn, slide, **options):
    m = SpatialMechanism("sleeve")
    rod = m.link("rod", length=0.4, mass=MASS, centre=(0.0, 0.0, 0.0), inertia=(0.02, 0.1, 0.1))
    joint = m.cylindrical("C", m.ground, rod, axis=(1, 0, 0))
    numbers = {"mu": 0.2, "radius": 0.03, "length": 0.1} | options
    m.friction("sliding", joint, along="slide", **numbers)
    m.friction("turning", joint, along="turn", **numbers)
    return Scene(m, {"C:slide": slide, "C:turn": turn}, t=(0, 1, 9))


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


LOADED, RADIUS = 50.0, 0.012


def jack(lead, mu, **more):
    """A spindle that turns upright, and a guided nut that it lifts;
    thread and thrust bearing rub.
    """
    m = SpatialMechanism("jack")
    p = {"lead": m.parameter("lead", lead, "m"), "mu": m.parameter("mu", mu)}
    spindle = m.link(
        "spindle", length=0.3, mass=1.0, centre=(0.15, 0, 0), inertia=(1e-3, 1e-2, 1e-2)
    )
    nut = m.link("nut", length=0.1, mass=LOADED, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    m.revolute("O", m.ground, spindle, axis=(0, 0, 1), turned=[("y", "-90 deg")])
    m.prismatic("guide", m.ground, nut, axis=(0, 0, 1))
    m.screw("thread", spindle, nut, axis=(1, 0, 0), lead=p["lead"], turned=[("y", "90 deg")])
    m.friction("flanks", m.joints["thread"], mu=p["mu"], radius=RADIUS, **more)
    return m


def test_where_equilibrium_leaves_bearings_open_so_is_their_friction():
    """The spindle and the guided nut hold each other across the thread: nothing tells how hard.

    The thread's own force is told, and one that rises over a rate is certified.
    """
    turned = {"motion": {"O": polynomial(0, 3.0)}, "t": (0, 1, 3), "posture": {"thread": 0.0}}
    assert evaluate(Scene(jack(0.004, 0.1, smooth=9.0), **turned)).certified
    m = jack(0.004, 0.1)
    m.friction("bearings", m.joints["O"], mu=0.2, radius=0.02, length=0.1)
    solution = evaluate(Scene(m, **turned))
    assert solution.certified
    assert {"friction:bearings:along", "load:bearings:mz", "effort:O"} <= set(solution.undetermined)
    angle, phi = math.atan(0.004 / math.tau / RADIUS), math.atan(0.1)
    assert np.abs(solution.series["friction:flanks:along"]) == pytest.approx(
        LOADED * G * RADIUS * abs(math.tan(phi - angle) + math.tan(angle)),
        rel=1e-11,
    )


def test_what_an_open_friction_presses_is_open_too():
    """How hard the guide is pressed is open: so is its friction, which loads the thread."""
    m = jack(0.004, 0.1)
    m.friction("way", m.joints["guide"], mu=0.2, radius=0.02, length=0.1)
    solution = evaluate(Scene(m, {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0}))
    assert {"friction:way:along", "friction:flanks:along"} <= set(solution.undetermined)


def joints_of(space):
    m = (SpatialMechanism if space else Mechanism)("bad")
    a, b, c = (m.link(name, length=0.1, mass=1.0) for name in "abc")
    if space:
        m.prismatic("P", m.ground, a, axis=(1, 0, 0))
        m.cylindrical("C", a, b, axis=(1, 0, 0))
        m.universal("U", b.tip, c, axis=(1, 0, 0), second=(0, 1, 0))
        m.screw("S", m.ground, m.link("d", length=0.1, mass=1.0), axis=(1, 0, 0), lead=0.01)
        return m
    m.revolute("pin", m.ground, a)
    m.prismatic("guide", a, b, axis=(1, 0))
    m.revolute("ball_pin", a.tip, m.point_mass("ball", 1.0))
    m.slot("slot", m.ground, b.tip)
    m.weld("weld", b, c)
    return m


RUBS = {"mu": 0.1, "radius": 0.01, "length": 0.1}


@pytest.mark.parametrize(
    ("joint", "told", "says"),
    [
        ("pin", {"mu": 0.1}, "joint 'pin' turns; expected radius"),
        ("pin", RUBS, "turns and has no guide length; expected radius="),
        ("pin", {"mu": -0.1, "radius": 0.01}, "mu must be at least 0, got -0.1"),
        ("pin", {"mu": 0.1, "radius": 0.0}, "radius must be positive, got 0"),
        ("pin", {}, "expected mu=, a friction coefficient, coulomb= or viscous="),
        ("pin", {"viscous": 0.1, "radius": 0.1}, "radius needs mu="),
        ("pin", {"mu": 0.1, "radius": 0.01, "static": 0.2}, "static needs stribeck"),
        ("pin", {"mu": 0.1, "radius": 0.01, "stribeck": 0.2}, "stribeck needs static="),
        ("guide", {"mu": 0.1}, "transmits a moment; expected length="),
        ("guide", RUBS, "slides and has no radius; expected length="),
        ("slot", {"mu": 0.1, "length": 0.1}, "transmits no moment; leave length= out"),
        ("ball_pin", {"mu": 0.1, "radius": 0.01}, "has no angle: 'ball' is a point mass"),
        ("weld", {"mu": 0.1}, "in a plane friction is possible in these joints: revolute, pris"),
        ("P", {"mu": 0.1, "radius": 0.1}, "transmits a moment; expected length=, the guide length"),
        ("P", {"mu": 0.1, "length": 0.1}, "a moment about its axis; expected radius="),
        ("P", RUBS | {"along": "turn"}, "has one coordinate and none called 'turn'"),
        ("C", RUBS, "has two coordinates; expected along='slide' or 'turn'"),
        ("C", {"mu": 0.1, "length": 0.1, "along": "slide"}, "joint 'C' turns; expected radius"),
        ("C", {"mu": 0.1, "radius": 0.1, "along": "turn"}, "a moment; expected length=, the dist"),
        ("C", RUBS | {"along": "turn", "smooth": 0.1}, "for which smooth= is not available"),
        ("U", {"mu": 0.1, "radius": 0.1}, "in space friction is possible in these joints: rev"),
        ("S", {"mu": 0.1, "radius": 0.1, "static": 0.2, "stribeck": 0.1}, "is a screw, whose thr"),
    ],
)
def test_mistakes_are_told(joint, told, says):
    m = joints_of(space=joint in {"P", "C", "U", "S"})
    with pytest.raises(DeclarationError, match=f"friction 'rub': .*{says}|friction 'rub': {says}"):
        m.friction("rub", m.joints[joint], **told)


def test_a_screw_that_no_couple_drives_or_that_would_close_a_loop_is_named():
    scene = Scene(jack(0.02, 0.1), {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0})
    words = "'flanks': mu times the lead per radian must be less than the radius"
    with pytest.raises(ParameterError, match=words):
        evaluate(scene, parameters={"mu": 4.0})
    drives = {"O": polynomial(0, 3.0), "guide": polynomial(0, 1.0)}
    words = "joint 'thread' is a screw between bodies whose positions already follow from drives"
    with pytest.raises(DeclarationError, match=words):
        evaluate(Scene(jack(0.02, 0.1), drives, t=(0, 1, 3)))


@pytest.mark.parametrize("turns", [0.6, 3.2, -40.0])
def test_a_screw_counts_the_turns_of_what_turns_it(turns):
    """A loop tells its direction alone; many turns lift the nut by as many leads, at whatever
    instant one begins.
    """
    scene = Scene(
        jack(0.01, 0.0),
        {"O": polynomial(0.4, math.tau * turns)},
        t=(0, 1, 5),
        posture={"thread": 0.0},
    )
    solution = evaluate(scene)
    assert solution.certified
    assert solution.motion("guide").value == pytest.approx(
        -0.01 * (0.4 / math.tau + turns * solution.t), abs=1e-14
    )
    assert solution.motion("thread").value == pytest.approx(
        -0.4 - math.tau * turns * solution.t, abs=1e-12
    )
    late = evaluate(scene, t=(0.75, 1.0, 2))
    assert late.motion("guide").value[0] == pytest.approx(
        solution.motion("guide").value[3], abs=1e-14
    )

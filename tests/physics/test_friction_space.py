"""Friction of threads and of shafts in space, against textbooks' closed forms; self-locking."""

import math

import numpy as np
import pytest
from internals import Joint

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load, save
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

MASS, G, RADIUS = 50.0, 9.81, 0.012


def jack(lead, mu, **more):
    """A spindle that turns upright, and a guided nut that it lifts;
    thread and thrust bearing rub.
    """
    m = SpatialMechanism("jack")
    p = {"lead": m.parameter("lead", lead, "m"), "mu": m.parameter("mu", mu)}
    spindle = m.link(
        "spindle", length=0.3, mass=1.0, centre=(0.15, 0, 0), inertia=(1e-3, 1e-2, 1e-2)
    )
    nut = m.link("nut", length=0.1, mass=MASS, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    m.revolute("O", m.ground, spindle, axis=(0, 0, 1), turned=[("y", "-90 deg")])
    m.prismatic("guide", m.ground, nut, axis=(0, 0, 1))
    m.screw("thread", spindle, nut, axis=(1, 0, 0), lead=p["lead"], turned=[("y", "90 deg")])
    m.friction("flanks", m.joints["thread"], mu=p["mu"], radius=RADIUS, **more)
    return m


@pytest.mark.sampled(7)
@pytest.mark.parametrize("lead", [0.004, 0.02, -0.004, -0.02])
@pytest.mark.parametrize("mu", [0.0, 0.08, 0.3])
def test_the_torque_of_a_lifting_screw(lead, mu):
    """W r tan(angle + phi) to lift, W r tan(phi - angle) to lower (Shigley): where phi > angle the
    screw locks itself.
    """
    scene = Scene(jack(lead, mu), {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0})
    angle, phi, weight = math.atan(abs(lead) / math.tau / RADIUS), math.atan(mu), MASS * G
    for speed in (3.0, -3.0):
        m = jack(lead, mu)
        scene = Scene(m, {"O": polynomial(0, speed)}, t=(0, 1, 3), posture={"thread": 0.0})
        solution = evaluate(scene)
        assert solution.certified
        lifts = solution.motion("guide").rate[0] > 0.0
        driven = solution.effort("O") * math.copysign(1.0, speed)  # along its motion
        expected = math.tan(angle + phi) if lifts else math.tan(phi - angle)
        assert driven == pytest.approx(weight * RADIUS * expected, rel=1e-11, abs=1e-12)
        efficiency = math.tan(angle) / math.tan(angle + phi)
        if lifts:
            given, gained = solution.effort("O") * speed, weight * solution.motion("guide").rate
            assert gained / given == pytest.approx(efficiency, rel=1e-11)
            assert solution.series["friction:flanks:loss"] == pytest.approx(
                given - gained, rel=1e-9, abs=1e-9
            )
        else:
            assert (driven[0] > 0.0) == (phi > angle)


def test_a_collar_bears_the_thrust():
    m = SpatialMechanism("upright")
    disc = m.link("disc", length=0.1, mass=7.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    m.friction(
        "collar", m.revolute("O", m.ground, disc, axis=(0, 0, 1)), mu=0.2, radius=0.02, length=0.1
    )
    solution = evaluate(Scene(m, {"O": polynomial(0, 3.0)}, t=(0, 1, 3)))
    assert solution.certified
    assert solution.effort("O") == pytest.approx(0.2 * 0.02 * 7.0 * G, rel=1e-12)


def test_where_equilibrium_leaves_bearings_open_so_is_their_friction():
    """The spindle and the guided nut hold each other across the thread: nothing tells how hard.

    The thread's own force is told.
    """
    m = jack(0.004, 0.1)
    m.friction("bearings", m.joints["O"], mu=0.2, radius=0.02, length=0.1)
    solution = evaluate(Scene(m, {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0}))
    assert solution.certified
    assert {"friction:bearings:along", "load:bearings:mz", "effort:O"} <= set(solution.undetermined)
    angle, phi = math.atan(0.004 / math.tau / RADIUS), math.atan(0.1)
    assert np.abs(solution.series["friction:flanks:along"]) == pytest.approx(
        MASS * G * RADIUS * abs(math.tan(phi - angle) + math.tan(angle)), rel=1e-11
    )


@pytest.mark.parametrize("arm", [0.0, 0.02, 0.3])
def test_two_bearings_of_a_shaft_that_carries_a_wheel_beside_them(arm):
    """By statics the bearings bear W (1/2 + arm/length) and W (1/2 - arm/length)."""
    m = SpatialMechanism("overhung")
    shaft = m.link("shaft", length=0.4, mass=0.0)
    O = m.revolute("O", m.ground, shaft, axis=(1, 0, 0))
    m.weld("hub", shaft.at(arm), m.point_mass("wheel", 12.0))
    m.friction("bearings", O, mu=0.05, radius=0.015, length=0.1)
    solution = evaluate(Scene(m, {"O": polynomial(0, 20.0)}, t=(0, 0.1, 5)))
    assert solution.certified
    share = abs(0.5 + arm / 0.1) + abs(0.5 - arm / 0.1)
    assert solution.effort("O") == pytest.approx(0.05 * 0.015 * 12.0 * G * share, rel=1e-11)


def test_a_file_holds_it(tmp_path):
    scene = Scene(jack(0.02, 0.1), {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0})
    solution = evaluate(scene, backend="vm")
    save(solution, tmp_path / "jack.h5")
    again = load(tmp_path / "jack.h5")
    assert again.certified
    assert (
        again.series["friction:flanks:along"].tolist()
        == solution.series["friction:flanks:along"].tolist()
    )
    assert again.description == solution.description


def test_what_no_couple_drives_is_refused():
    scene = Scene(jack(0.02, 0.1), {"O": polynomial(0, 3.0)}, t=(0, 1, 3), posture={"thread": 0.0})
    with pytest.raises(
        ParameterError,
        match="friction 'flanks': mu times the lead per radian must be less than the radius",
    ):
        evaluate(scene, parameters={"mu": 4.0})


def test_mistakes_in_space_are_told():
    with pytest.raises(
        DeclarationError, match="is a screw, whose thread has one friction coefficient"
    ):
        jack(0.01, 0.1, static=0.2, stribeck=0.1)
    m = jack(0.01, 0.1)
    for joint, words in (
        ("O", "transmits a moment; expected length=, the distance of its two bearing"),
        (
            "guide",
            "friction 'more': joint 'guide' transmits a moment; expected length=, the guide length",
        ),
    ):
        found: Joint = m.joints[joint]
        with pytest.raises(DeclarationError, match=words):
            m.friction("more", found, mu=0.1, radius=0.1)

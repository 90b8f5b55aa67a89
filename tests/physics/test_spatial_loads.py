"""Loads and rows of mechanisms in space, against closed forms."""

import math

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.errors import DeclarationError, ParameterError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize("joint", ["relative", "hard"])
def test_a_torsion_spring_turns_back_about_its_joints_axis(joint):
    """A rod on a tilted shaft, whose own turning is another drive's: the spring adds to the one
    effort, and to nothing else.
    """
    efforts, reactions = [], []
    for stiffness in (0.0, 7.0):
        m = SpatialMechanism("door")
        if joint == "relative":
            frame = m.link("frame", length=0.3, mass=1.0)
            door = m.link("door", length=0.5, mass=2.0)
            m.revolute("mast", m.ground, frame, axis=(0.0, 0.6, 0.8))
            hinge = m.revolute(
                "hinge",
                frame.tip,
                door,
                axis=(1.0, 2.0, 2.0),
                turned=[("z", "35 deg"), ("x", "20 deg")],
            )
        else:
            frame = m.link("frame", between=((0, 0, 0), (0.3, 0, 0)), mass=1.0)
            door = m.link("door", between=((0.3, 0, 0), (0.3, 0.3, 0.4)), mass=2.0)
            m.revolute("mast", m.ground, frame, at=(0, 0, 0), axis=(0.0, 0.6, 0.8))
            hinge = m.revolute("hinge", frame, door, at=(0.3, 0, 0), axis=(1.0, 2.0, 2.0))
        m.torsion_spring(
            "coil", hinge, stiffness=stiffness, angle="20 deg", damping=0.3 if stiffness else 0.0
        )
        laws = {"mast": motion.harmonic(0.2, 0.5, 1.0), "hinge": motion.harmonic(0.4, 0.7, 1.5)}
        found = evaluate(Scene(m, laws, t=(0, 1, 41)))
        assert found.certified
        efforts.append([found.effort(name) for name in laws])
        reactions.append(
            [
                found.series[f"reaction:hinge:{member}"]
                for member in ("fx", "fy", "fz", "mx", "my", "mz")
            ]
        )
    turned = found.motion("hinge")
    added = 7.0 * (turned.value - math.radians(20)) + 0.3 * turned.rate
    assert np.max(np.abs(efforts[1][1] - efforts[0][1] - added)) < 1e-13
    assert np.max(np.abs(efforts[1][0] - efforts[0][0])) < 1e-13
    assert np.max(np.abs(np.array(reactions[1]) - reactions[0])) < 1e-13
    size = np.sqrt(sum(found.series[f"load:coil:m{axis}"] ** 2 for axis in "xyz"))
    assert np.max(np.abs(size - np.abs(added))) < 1e-13


def test_a_wheel_that_rolls_takes_no_effort_and_is_pushed_at_its_rim():
    m, radius = SpatialMechanism("barrow"), 0.2
    carrier = m.link(
        "carrier", length=0.3, mass=5.0, centre=(0.0, 0.0, 0.0), inertia=(0.1, 0.1, 0.1)
    )
    pull = m.prismatic("pull", m.ground.at(0, 0, radius), carrier, axis=(1.0, 0.0, 0.0))
    wheel = m.link(
        "wheel", length=radius, mass=3.0, centre=(0.0, 0.0, 0.0), inertia=(0.01, 0.02, 0.01)
    )
    shaft = m.revolute("shaft", carrier, wheel, axis=(0.0, 1.0, 0.0))
    m.nonholonomic("rolling", m.rate(pull) - radius * m.rate(shaft), replaces=shaft)
    laws = {
        "pull": motion.polynomial(0.0, 1.0, 2.0),
        "shaft": motion.polynomial(0.0, 1.0 / radius, 2.0 / radius),
    }
    found = evaluate(Scene(m, laws, t=(0, 1, 11)))
    assert found.certified
    assert "effort:shaft" not in found.series
    assert np.max(np.abs(found.effort("pull") - (8.0 + 0.02 / radius**2) * 4.0)) < 1e-12


@pytest.mark.parametrize("station", [-0.2, 0.7])
def test_a_station_beyond_an_end_is_refused_with_lines_that_weld_on_what_reaches_there(station):
    def flag(point=None):
        m = SpatialMechanism("flag")
        m.set_gravity(0.0, 0.0, 0.0)
        pole = m.link("pole", length=0.5, mass=1.0)
        m.revolute("hinge", m.ground, pole, axis=(1.0, 0.0, 0.0))
        m.force("wind", pole.at(station) if point is None else point(m), y=2.0)
        return evaluate(Scene(m, {"hinge": motion.polynomial(0.0, 1.0)}, t=(0, 1, 3)))

    with pytest.raises(
        ParameterError, match=r"is outside link 'pole', 0 to 0\.5 m; for a point beyond"
    ) as refused:
        flag()
    tail, weld = str(refused.value).partition("declare another link: ")[2].split("; ")[:2]

    def point(m):
        names = {"m": m}
        exec(f"{tail}\n{weld.removeprefix('and ')}", names)
        return names["tail"].tip

    found = flag(point)
    assert found.certified
    assert found.reaction("hinge").mz[0] == pytest.approx(-2.0 * station, abs=1e-14)


def test_a_row_replaces_one_drive():
    m = SpatialMechanism("disc")
    disc = m.link(
        "disc", length=0.1, mass=1.0, centre=(0.0, 0.0, 0.0), inertia=(0.002, 0.001, 0.001)
    )
    pose = m.free("pose", m.ground, disc)
    with pytest.raises(
        DeclarationError,
        match=r"those of joint 'pose' are pose:slide_1, .*; use a chain of joints of one",
    ):
        m.nonholonomic("rolling", m.velocity(disc)[0] - 0.1 * m.rate(pose, "turn_2"), replaces=pose)


def test_a_point_mass_at_the_end_is_a_body_without_inertia():
    """It has no axes of its own; random mechanisms in space have none."""

    def swung(end):
        m = SpatialMechanism("chain")
        a, b = m.link("a", length=0.4, mass=1.0), m.link("b", length=0.5, mass=0.6)
        m.universal("A", m.ground, a, axis=(0.2, 0.3, 1.0), second=(0.3, -0.2, 0.0))
        m.revolute("B", a.tip, b, axis=(1, 2, 0.5))
        still = {"length": 0.1, "mass": 2.0, "centre": (0, 0, 0), "inertia": (0, 0, 0)}
        held = m.link("end", **still) if end == "body" else m.point_mass("end", 2.0)
        m.weld("held", b.at(0.3, 0.05, 0.0), held)
        laws = {"A:turn_1": motion.harmonic(0.2, 0.7, 1.2, 0.3), "B": motion.harmonic(0.4, 0.9, 1)}
        laws["A:turn_2"] = motion.harmonic(-0.3, 0.4, 0.8)
        return evaluate(Scene(m, laws, t=(0, 1, 5)))

    body, point = swung("body"), swung("point")
    assert point.certified
    assert {"reaction:held:fx", "section:b:held:fy"} <= set(point.series) & set(body.series)
    size = max(np.abs(values).max() for values in body.series.values())
    for name in set(point.series) & set(body.series):
        np.testing.assert_allclose(
            point.series[name], body.series[name], rtol=0, atol=1e-13 * size, err_msg=name
        )

"""Inertias that drives feel, duties of motors, and how warm they get, by closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import CASES
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.actuators import Duty, Motor, assess, duty_of, inertia_at
from lagrange_casadi.elements import cylinder
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import dwell, move, moves, polynomial, trapezoid

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def press(law, **options):
    """A slider-crank that presses and weighs, in all of which the inertia has no part."""
    m = Mechanism("press")
    l = m.parameter("l", 0.4, "m")
    crank = m.link("crank", length=0.1, mass=1.2)
    rod = m.link("rod", length=l, mass=2.0)
    ram = m.point_mass("ram", 15.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, ram)
    way = m.prismatic("way", m.ground, ram, axis=(0, 1))
    m.spring("buffer", ram, m.ground.at(0.0, 1.0), stiffness=4e3, length=0.5)
    m.force("work", ram, y=-200.0 - 30.0 * m.rate(way))
    return Scene(m, {"O": law}, posture={"rod": 1.5}, **options)


def test_a_slider_cranks_inertia_is_that_of_its_velocities():
    """By velocities of the rod's ends, of which its energy is that of a uniform bar."""
    scene = press(polynomial(0.1, 7.0), t=(0, 0.9, 37))
    angle, l, r = 0.1 + 7.0 * np.linspace(0, 0.9, 37), 0.35, 0.1
    lean = np.arccos(r * np.cos(angle) / l)  # of the rod, from the horizontal
    turning = r * np.sin(angle) / (l * np.sin(lean))
    ends = [
        np.stack([-r * np.sin(angle), r * np.cos(angle)]),
        np.stack([0 * angle, r * np.cos(angle) - l * np.cos(lean) * -turning]),
    ]
    rod = (
        2.0
        / 3.0
        * sum(
            (a * b).sum(axis=0)
            for a, b in ((ends[0], ends[0]), (ends[0], ends[1]), (ends[1], ends[1]))
        )
    )
    expected = 1.2 * r**2 / 3 + rod + 15.0 * ends[1][1] ** 2
    assert inertia_at(scene, "O", parameters={"l": l}) == pytest.approx(expected, rel=1e-12)
    assert np.ptp(expected) > 0.5 * expected.mean()


def added(scene, joint, at):
    """By how much the effort grows for a unit more of acceleration, at a time."""
    more = dict(scene.motion)
    law = more[joint]
    more[joint] = type(law)(lambda t: law.graph(t) + (t - at) ** 2 / 2)
    found = [
        evaluate(
            Scene(scene.mechanism, motion, posture=scene.posture, t=(*scene.t[:2], 3)),
            wanted=["effort"],
            t=(at, at, 1),
        )
        for motion in (scene.motion, more)
    ]
    return float((found[1].effort(joint) - found[0].effort(joint))[0])


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("name", "joint"),
    [
        ("four_bar", "O"),
        ("rssr", "O"),
        ("spatial_slider_crank", "A"),
        ("arm", "elbow"),
        ("scara", "shoulder"),
    ],
)
def test_it_is_what_a_unit_of_acceleration_takes_more(name, joint):
    """Inverse dynamics knows nothing of the energy's second derivative: two efforts whose drives
    differ in acceleration alone.
    """
    scene = load_case(CASES / name).scene
    at = scene.span[0] + 0.3 * (scene.span[1] - scene.span[0])
    seen = inertia_at(scene, joint, t=(at, at, 1))
    assert seen[0] == pytest.approx(added(scene, joint, at), rel=1e-7)


def test_at_rest_a_mechanism_has_inertia_too():
    law = moves([move("90 deg", time=0.3), dwell(0.2)], start="20 deg")
    seen = inertia_at(press(law, t=(0, 0.5, 51)), "O")
    assert seen[30:] == pytest.approx(seen[30], rel=1e-12)
    assert inertia_at(press(polynomial(math.radians(90), 1.0), t=(0, 0, 1)), "O")[
        0
    ] == pytest.approx(seen[40], rel=1e-12)


def hoist(law, **options):
    """A boom that a weightless cylinder lifts; nothing but the boom moves."""
    m = Mechanism("hoist")
    boom = m.link("boom", length=3.0, mass=150.0)
    m.revolute("foot", m.ground, boom)
    cylinder(m, "ram", m.ground.at(1.0, -0.2), boom.at(1.5), closed=0.5, bore=0.1)
    return Scene(m, {"foot": law}, posture={"ram": 0.2}, drives=["ram"], **options)


def test_a_drive_elsewhere_feels_it_through_its_lever():
    seen = inertia_at(hoist(polynomial(0.2, 0.3), t=(0, 3, 13)), "ram")
    angle = 0.2 + 0.3 * np.linspace(0, 3, 13)
    x, y = 1.5 * np.cos(angle) - 1.0, 1.5 * np.sin(angle) + 0.2
    lever = (-x * np.sin(angle) + y * np.cos(angle)) * 1.5 / np.hypot(x, y)
    assert seen == pytest.approx(150.0 * 9.0 / 3 / lever**2, rel=1e-12)


@pytest.mark.parametrize("alone", ["boom_cylinder", "bucket_cylinder"])
def test_of_several_drives_the_others_are_at_rest(alone):
    """The excavator's pose is given; beside it the same machine of which the cylinders' motion is
    given, and one accelerates.
    """
    scene = load_case(CASES / "excavator").scene
    at = (scene.span[1], scene.span[1], 1)
    solution = evaluate(scene, t=at, wanted=["motion"])
    laws = {
        name: polynomial(solution.motion(name).value[0], float(name == alone))
        for name in scene.weights
    }
    rough = {link: solution.pose(link).angle[0] for link in scene.mechanism.links}
    other = Scene(scene.mechanism, laws, t=(0, 1, 3), posture=rough)
    assert inertia_at(scene, alone, t=at)[0] == pytest.approx(added(other, alone, 0.0), rel=1e-7)


def test_what_no_drive_feels_alone_is_told():
    with pytest.raises(UnknownNameError, match="unknown drive 'P'; valid: O"):
        inertia_at(press(polynomial(0.1, 7.0)), "P")
    with pytest.raises(
        DeclarationError,
        match="inertia at 'X': with non-holonomic constraints no drive can move alone",
    ):
        inertia_at(load_case(CASES / "sleigh").scene, "X")


def warmest(t, torque, tau):
    """The share of the limit of heat of a motor whose continuous torque is 1 N m."""
    motor = Motor("m", 1.0, 1.0, 9.0, 99.0, 9.0, 0.0, time_constant=tau)
    duty = Duty("O", 1.0, 1.0, 0.0, np.array(t), np.zeros(len(t)), np.array(torque))
    return assess(motor, duty).heat


def test_a_winding_warms_and_cools_as_its_law_says():
    """On for 2 s, off for 6 s, over and over: the exponentials of any textbook, at the end of the
    pull.
    """
    cycle = [0.0, 2.0, 2.0 + 1e-9, 8.0], [3.0, 3.0, 0.0, 0.0]
    assert warmest(*cycle, math.inf) == pytest.approx(3.0 * math.sqrt(2.0 / 8.0), rel=1e-8)
    for tau in (0.1, 1.0, 5.0, 100.0):
        peak = math.expm1(-2.0 / tau) / math.expm1(-8.0 / tau)
        assert warmest(*cycle, tau) == pytest.approx(3.0 * math.sqrt(peak), rel=1e-8)


@given(
    st.lists(st.floats(0.0, 9.0), min_size=2, max_size=30),
    st.floats(1e-3, 1e3),
    st.floats(1.0, 100.0),
)
def test_the_warmest_instant_is_between_the_mean_and_the_peak(pulls, tau, more):
    t = np.cumsum(np.linspace(0.1, 0.5, len(pulls)))
    least, slow, quick = (warmest(t, pulls, one) for one in (math.inf, tau * more, tau))
    assert least * (1 - 1e-9) <= slow <= quick * (1 + 1e-9)
    assert quick <= max(pulls) * (1 + 1e-9)
    assert warmest(t, pulls, 1e9) == pytest.approx(least, rel=1e-6, abs=1e-12)


def test_a_motor_that_its_voltage_limits_gives_less_at_speed():
    plain = Motor("plain", 2.0, 1.5, 300.0, 6.0, 500.0, 0.0)
    weak = Motor(
        "weak",
        2.0,
        1.5,
        300.0,
        6.0,
        500.0,
        0.0,
        knee_speed=200.0,
        end_torque=1.0,
        time_constant=0.05,
    )
    assert weak.short_time_torque(np.array([0.0, -200.0, 350.0, 500.0])).tolist() == [
        6.0,
        6.0,
        3.5,
        1.0,
    ]
    m = Mechanism("table")
    m.set_gravity(0, 0)
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0, centre=(0, 0), inertia=0.1))
    law = moves([move(2.0, time=0.5, law=trapezoid(1 / 2)), dwell(0.1)])
    solution = evaluate(Scene(m, {"J": law}, t=(0, 0.6, 601)), wanted=["effort", "motion"])
    duty = duty_of(solution, "J", ratio=50.0)
    first, second = assess(plain, duty), assess(weak, duty)
    pull, speed = 0.1 / 50.0 * 2.0 / 0.25**2, 50.0 * 2.0 / 0.25  # steady, and the largest speed
    assert first.torque == pytest.approx(pull / 6.0, rel=1e-9)
    assert second.torque == pytest.approx(pull / (6.0 - 5.0 * (speed - 200.0) / 300.0), rel=1e-2)
    assert (first.speed, second.speed) == pytest.approx((speed / 500.0, speed / 500.0), rel=1e-2)
    assert second.heat > 1.02 * first.heat
    assert second.serves


def test_friction_at_rest_leaves_a_duty_open_but_for_its_range(here):
    m = Mechanism("drawer")
    runner = m.prismatic("X", m.ground, m.point_mass("table", 10.0), axis=(1, 0))
    m.friction("rub", runner, mu=0.1)
    scene = Scene(m, {"X": moves([move(0.2, time=0.4), dwell(0.2)])}, t=(0, 0.6, 61))
    solution = evaluate(scene)
    with pytest.raises(
        DeclarationError,
        match=r"the effort of drive 'X' is indeterminate at 2\d of 61 instants; joints with"
        r" friction are at rest",
    ):
        duty_of(replace(solution, holding={}), "X")
    assert np.abs(duty_of(solution, "X").torque[-1]) == pytest.approx(0.1 * 10.0 * 9.81)

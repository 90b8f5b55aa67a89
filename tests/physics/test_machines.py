"""Machines from practice, against what is known of them without any equation of motion, and against
Newton-Euler.
"""

import math
from dataclasses import replace

import numpy as np
import oracle
import pytest
from balance import assert_balanced
from conftest import CASES
from internals import derive_derive as derive
from machines import ROLLING, rolling, shown
from splines import by_hand

from lagrange_casadi import evaluate, load_case


def force(name, x, fx, fy, mz=0.0):
    """What acts on a body on its axis."""
    return lambda place: [((name, x, 0), fx, fy, mz)]


def gas(top, lean, name):
    """The pressure by a spline made another way."""
    bars = shown("V-twin")["bars"]
    pressure = by_hand(
        np.linspace(0.0, 4 * math.pi, 19), np.array([1e5 * bar for bar in bars]), True
    )

    def push(place):
        size = -math.pi / 4 * 0.08**2 * pressure(place(("crank", 0, 0))[2].v - top)[0]
        return [((f"{name}_piston", 0, 0), size * math.cos(lean), size * math.sin(lean), 0)]

    return push


def cam_contact():
    names = shown("Cam")
    lift = by_hand(names["angles"], names["lift"](names["angles"]), True)
    ends = ("follower", 0, 0), ("disc", 0, 0)

    def gap(place):
        angle = place(ends[1])[2]
        return place(ends[0])[1] - 0.04 - angle.through(*lift(angle.v))

    return oracle.Extra(
        "contact",
        gap,
        lambda place: [(ends[0], 0, 1, 0), (ends[1], 0, 0, -lift(place(ends[1])[2].v)[1])],
    )


def mesh(name, side):
    """The tooth's force: along the way of the planet's centre, at its rim; of the sun's mesh with
    its opposite on the sun.
    """

    def effect(place):
        angle, planet = place(("carrier", 0, 0))[2].v, ("planet", 0, 0)
        on_planet = (planet, -math.sin(angle), math.cos(angle), side * 0.02)
        return [on_planet] if side > 0 else [on_planet, (("sun", 0, 0), 0, 0, -0.03)]

    return oracle.Extra(name, None, effect)


QUARTER, TAU = math.pi / 4, 2 * math.pi
SPRING = [
    lambda place: [
        (("follower", 0.12, 0), 0, -300.0 - 12e3 * (place(("follower", 0, 0))[1].v - 0.04), 0)
    ]
]
BELT = oracle.Extra(
    "belt",
    lambda place: place(("pulley", 0, 0))[2] - place(("outer", 0, 0))[2],
    lambda place: [(("pulley", 0, 0), 0, 0, 1), (("outer", 0, 0), 0, 0, -1)],
)
BESIDE = {
    "V-twin": lambda: {
        "loads": [gas(11 * QUARTER, 3 * QUARTER, "left"), gas(QUARTER, QUARTER, "right")]
    },
    "Scissor lift": lambda: {"loads": [force("b2", 1.2, 0, -2500.0), force("a2", 1.2, 0, -2500.0)]},
    "Toggle press": lambda: {"loads": [force("ram", 0, 0, 80e3)]},
    "Cam": lambda: {"extras": [cam_contact()], "loads": SPRING},
    "SCARA": lambda: {"extras": [BELT]},
    "Rolling gear": lambda: {
        "extras": [mesh("inside", -1), mesh("outside", 1)],
        "loads": [force("carrier", 0, 0, 0, -90.0)],
        "unaided": ["output", "pin"],
    },
    "Geneva drive": dict,
}


def along(values, at):
    """The integral of values over what they are along, by trapezia."""
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(at)))


@pytest.mark.sampled(5)
@pytest.mark.parametrize("title", BESIDE)
def test_against_newton_euler(title):
    """The machines that are no cases; at instants of the page's own."""
    scene = rolling() if title == "Rolling gear" else shown(title)["scene"]
    start, stop = scene.span
    for part in (0.07, 0.4, 0.83):
        assert_balanced(scene, t=start + part * (stop - start), nudge=1e-4, **BESIDE[title]())


def test_gas_gives_its_work_to_the_crank():
    """Indicated work is mean torque times angle: by the closed form of a piston's place, at every
    instant and over two turns.
    """
    scene = shown("V-twin")["scene"]
    fired, idle = (
        evaluate(scene, parameters={"throttle": x}, over=("main", "45 deg", "765 deg", 7201))
        for x in (1.0, 0.0)
    )
    angle = fired.motion("main").value
    pressure = by_hand(
        np.linspace(0.0, 2 * TAU, 19),
        np.array([1e5 * bar for bar in shown("V-twin")["bars"]]),
        True,
    )
    torque = 0.0
    for lean, top in ((3 * QUARTER, 11 * QUARTER), (QUARTER, QUARTER)):
        turned = angle - lean
        slope = (
            -0.05
            * np.sin(turned)
            * (1 + 0.05 * np.cos(turned) / np.sqrt(0.16**2 - (0.05 * np.sin(turned)) ** 2))
        )
        torque += math.pi / 4 * 0.08**2 * np.array([pressure(x)[0] for x in angle - top]) * slope
    assert (
        np.abs(fired.effort("main") - idle.effort("main") - torque).max()
        < 1e-12 * np.abs(fired.effort("main")).max()
    )
    indicated = along(torque, angle)
    assert 2 * TAU * fired.statistics("effort:main").mean == pytest.approx(indicated, rel=1e-9)
    assert indicated < -100.0


def test_a_lift_at_rest_is_held_by_the_slope_of_its_potential():
    """The ram's force is dV/dq: of the load, the links and the ram itself, by the angle of the
    links alone.
    """
    scene = shown("Scissor lift")["scene"]
    found = evaluate(scene, parameters={"speed": 0.0}, t=(0, 0, 1))
    turn, s, c, g = math.acos(1.1 / 1.2), 0.9, 0.3, 9.81
    q = math.sqrt(s**2 + c**2 - 2 * s * c * math.cos(turn))
    dq = s * c * math.sin(turn) / q
    leaning = s * math.cos(turn) / q - s * math.sin(turn) * dq / q**2
    lifted = (3 * 5000.0 + 12.0 * g * 2 * (0.5 + 1.5 + 2.5)) * 1.2 * math.cos(turn)
    own = g * ((4.0 - 3.0) * 0.15 * leaning + 3.0 * s * math.cos(turn))
    assert found.effort("ram")[0] == pytest.approx((lifted + own) / dq, rel=1e-13)


def test_a_press_gives_the_power_of_its_work():
    scene = shown("Toggle press")["scene"]
    pressed, idle = evaluate(scene), evaluate(scene, parameters={"work": 0.0})
    power = (pressed.effort("main") - idle.effort("main")) * pressed.motion("main").rate
    done = 80e3 * pressed.motion("way").rate
    assert np.abs(power - done).max() < 1e-12 * np.abs(done).max()


def test_a_cam_turns_against_its_follower():
    """The torque is the contact's force times the slope of the lift, and the weight of the disc."""
    found = evaluate(shown("Cam")["scene"])
    slope = found.motion("guide").rate / 60.0
    torque = found.output("contact_force") * slope + 1.5 * 9.81 * 0.02 * np.cos(
        found.motion("main").value
    )
    assert np.abs(found.effort("main") - torque).max() < 1e-12 * np.abs(found.effort("main")).max()


def test_the_first_motor_of_a_scara_is_a_textbooks():
    found = evaluate(shown("SCARA")["scene"])
    first = found.motion("shoulder")
    bent = found.motion("elbow").value
    second = found.motion("motor")
    lever = 0.35 * (4.0 * 0.15 + 3.0 * 0.3)
    own = 6.0 * 0.35**2 / 3 + (4.0 + 3.0) * 0.35**2
    torque = own * first.acceleration + lever * (
        np.cos(bent) * second.acceleration - np.sin(bent) * second.rate**2
    )
    assert np.abs(found.effort("shoulder") - torque).max() < 1e-12 * np.abs(torque).max()


@pytest.mark.parametrize("drive", ["main", "output", "pin"])
def test_rows_hold_where_another_joint_drives(drive):
    """Whoever drives a planetary gear gives the power that its carrier takes; the meshes bear what
    is then left for them.
    """
    scene = replace(rolling(), drives=[drive])
    found = evaluate(scene)
    assert found.certified
    power = ROLLING["torque"] * ROLLING["slow"]
    assert np.abs(found.effort(drive) * found.motion(drive).rate / power - 1).max() < 1e-12
    mesh = {"main": 90.0 / (0.03 + 0.07), "output": 0.0, "pin": 0.0}[drive]
    assert np.abs(np.abs(found.multiplier("inside")) - mesh).max() < 1e-12 * 90.0 / 0.1
    assert_balanced(scene, t=0.2, nudge=1e-4, **BESIDE["Rolling gear"]() | {"unaided": []})


def test_a_wheel_of_four_slots_moves_by_its_closed_form():
    """Place, rate and acceleration of every textbook; the crank gives what the wheel's inertia
    takes.
    """
    found = evaluate(shown("Geneva drive")["scene"], parameters={"omega": 20.0})
    k, angle, wheel = math.sin(QUARTER), found.motion("main").value, found.motion("axle")
    under = 1 + k**2 - 2 * k * np.cos(angle)
    np.testing.assert_allclose(
        wheel.value, -np.arctan2(k * np.sin(angle), 1 - k * np.cos(angle)), rtol=0, atol=1e-14
    )
    np.testing.assert_allclose(
        wheel.rate, -20.0 * k * (np.cos(angle) - k) / under, rtol=0, atol=1e-12 * 20.0 * 2.5
    )
    bend = k * (1 - k**2) * np.sin(angle) / under**2
    np.testing.assert_allclose(
        wheel.acceleration, 20.0**2 * bend, rtol=0, atol=1e-12 * 20.0**2 * 5.41
    )
    taken = 1.5e-3 * wheel.acceleration * wheel.rate / 20.0
    assert np.abs(found.effort("main") - taken).max() < 1e-12 * np.abs(taken).max()


def test_a_shaper_cuts_once_a_turn():
    """The work of a turn is the cutting force times the stroke, and the time of its two strokes is
    that of two angles.
    """
    scene = load_case(CASES / "quick_return").scene
    found = evaluate(scene, over=("O", 0, "-360 deg", 14401))
    stroke = np.ptp(found.motion("way").value)
    assert along(found.effort("O"), found.motion("O").value) == pytest.approx(
        400.0 * stroke, rel=1e-6
    )
    slow = np.count_nonzero(found.motion("way").rate > 0) / found.t.size
    assert slow == pytest.approx(0.5 + math.asin(0.1 / 0.3) / math.pi, abs=1e-3)


def test_cylinders_lift_what_goes_up():
    """Over a stroke from rest to rest: their work is the change of potential energy, less the work
    of the ground.
    """
    scene = load_case(CASES / "excavator").scene
    assert derive(scene).newton is None
    found = evaluate(scene, t=(0, 4, 4001))
    assert found.certified
    assert np.abs([found.motion(joint).rate[[0, -1]] for joint in scene.drives]).max() < 1e-12
    work = sum(along(found.effort(joint), found.motion(joint).value) for joint in scene.drives)
    lifted = 0.0
    for name, body in found.description["bodies"].items():
        pose = found.pose(name)
        centre = body.get("centre", {"x": (body["length"] or 0.0) / 2, "y": 0.0})
        turned = (
            0.0
            if pose.angle is None
            else centre["x"] * np.sin(pose.angle) + centre["y"] * np.cos(pose.angle)
        )
        height = pose.y + turned
        lifted += body["mass"] * 9.81 * (height[-1] - height[0])
    ground = 20e3 * (found.output("teeth_x")[-1] - found.output("teeth_x")[0])
    assert ground == pytest.approx(-2.5 * 20e3)
    assert work == pytest.approx(lifted - ground, rel=1e-6)


def test_a_slow_pump_has_the_torque_of_its_torque_factor():
    """API Specification 11E: the rods' load times A R sin(alpha) / (C sin(beta)), by the pump's
    geometry alone; A is the arc's.
    """
    scene = load_case(CASES / "beam_pump").scene
    slow, loads = {"spm": 1e-5}, (0.0, 14e3)
    empty, full = (
        evaluate(scene, parameters=slow | {"fluid": x}, over=("shaft", 0, "360 deg", 181))
        for x in loads
    )
    assert empty.certified
    assert full.certified
    a, r, c, p, (x, y) = 3.3, 1.0, 2.8, 3.6, (2.8, 3.5)
    angle = full.motion("shaft").value
    pin = r * np.cos(angle), r * np.sin(angle)
    along, up = x - pin[0], y - pin[1]
    far = np.hypot(along, up)
    beta = np.arccos((c**2 + p**2 - far**2) / (2 * c * p))
    lean = np.arctan2(up, along) + np.arccos((p**2 + far**2 - c**2) / (2 * p * far))
    factor = -a * r / c * np.sin(lean - angle) / np.sin(beta)
    load = full.output("rod_load") - empty.output("rod_load")
    assert set(np.round(load)) == {0.0, 14e3}
    torque = full.effort("shaft") - empty.effort("shaft")
    assert np.abs(torque - factor * load).max() < 1e-12 * np.abs(full.effort("shaft")).max()


def test_a_turn_of_a_pump_lifts_the_fluid_once():
    """What the fluid adds is its force times the rods' speed: over a turn, times the stroke.

    Weights add nothing.
    """
    scene = load_case(CASES / "beam_pump").scene
    empty, full = (evaluate(scene, parameters={"fluid": x}, t=(0, 6, 6001)) for x in (0.0, 14e3))
    rate = full.motion("well").rate
    power = 14e3 * np.where(rate > 0, rate, 0.0)
    turned = 2 * np.pi / 6
    gap = (full.effort("shaft") - empty.effort("shaft")) * turned - power
    assert np.abs(gap).max() < 1e-12 * np.abs(full.output("power")).max()
    assert (
        abs(along(empty.effort("shaft"), empty.motion("shaft").value))
        < 1e-9 * np.abs(empty.effort("shaft")).max()
    )
    stroke = np.ptp(full.motion("well").value)
    assert along(full.effort("shaft"), full.motion("shaft").value) == pytest.approx(
        14e3 * stroke, rel=1e-6
    )

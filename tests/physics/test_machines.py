"""Machines from practice, against what is known of them without any equation of motion, and
against Newton-Euler.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import CASES
from machines import shown

from lagrange_casadi import Scene, evaluate, load_case
from lagrange_casadi.motion import dwell, move, moves

QUARTER, TAU = math.pi / 4, 2 * math.pi


def along(values, at):
    """The integral of values over what they are along, by trapezia."""
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(at)))


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


def of_scara(solution):
    """The efforts of both motors by the closed form of textbooks on robots, in absolute angles of
    the two arms.
    """
    first, second = solution.motion("shoulder"), solution.motion("motor")
    lever = 0.35 * (4.0 * 0.15 + 3.0 * 0.3)
    inner = 6.0 * 0.35**2 / 3 + (4.0 + 3.0) * 0.35**2
    outer = 4.0 * 0.3**2 / 3 + 3.0 * 0.3**2
    bent = second.value - first.value
    yield inner * first.acceleration + lever * (
        np.cos(bent) * second.acceleration - np.sin(bent) * second.rate**2
    )
    yield (outer + 1e-3) * second.acceleration + lever * (
        np.cos(bent) * first.acceleration + np.sin(bent) * first.rate**2
    )


@pytest.mark.parametrize("pace", [1.0, 1.7])
def test_efforts_are_those_of_the_closed_form(pace):
    solution = evaluate(load_case(CASES / "scara").scene, parameters={"pace": pace})
    assert solution.certified
    for joint, expected in zip(("shoulder", "motor"), of_scara(solution), strict=True):
        assert solution.effort(joint) == pytest.approx(
            expected, rel=0, abs=1e-12 * np.abs(expected).max()
        )


G = 9.81


THROWS = {"1": 0.0, "2": 2 * math.pi / 3, "3": 4 * math.pi / 3}


R, L, ROD, PISTON = 0.04, 0.14, 0.55, 0.4


WANTED = ["effort", "motion", "reaction", "load"]


@pytest.fixture(scope="module")
def module():
    return load_case(CASES / "v6")


def pistons(theta, bank):
    """Of each cylinder its direction, and the places of crank pin and piston on the plane y, z."""
    for bank_name, side in (("left", 1), ("right", -1)):
        for number, throw in THROWS.items():
            u = np.array([math.cos(side * bank / 2), math.sin(side * bank / 2)])
            pin = R * np.array([np.cos(theta + throw), np.sin(theta + throw)])
            along, across = u @ pin, u[0] * pin[1] - u[1] * pin[0]
            yield f"{bank_name}_{number}", u, pin, u[:, None] * (along + np.sqrt(L**2 - across**2))


def matter(theta, bank):
    """Masses of rods and pistons as points (a rod is three: Simpson's rule), and places (2, n)."""
    for _, _, pin, piston in pistons(theta, bank):
        yield from ((ROD / 6, pin), (ROD * 2 / 3, (pin + piston) / 2))
        yield PISTON + ROD / 6, piston


def slope(values):
    """The derivative by the angle of what is periodic over the two turns, by Fourier series."""
    n = values.shape[-1]
    wave = 1j * np.fft.fftfreq(n, 1.0 / n) / 2.0
    return np.fft.ifft(np.fft.fft(values) * wave).real


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"bank": math.pi / 2, "load": 0.0},
        {"bank": math.pi / 3, "rpm": 5000.0, "right_3_turn": 0.0, "left_1_turn": 1.0},
    ],
)
def test_power_and_momentum(module, values):
    found = evaluate(module.scene, parameters=values, wanted=WANTED)
    assert found.certified
    assert not [name for name in found.undetermined if name.startswith("effort")]
    theta, bank = found.motion("main_fixed:turn_1").value[:-1], values.get("bank", 2 * math.pi / 3)
    w = values.get("rpm", 3000.0) * math.pi / 30
    kinetic, potential, momentum = 0.0, 0.0, np.zeros((2, theta.size))
    for mass, place in matter(theta, bank):
        speed = w * slope(place)
        kinetic = kinetic + mass * np.sum(speed**2, axis=0) / 2
        potential = potential + mass * G * place[1]
        momentum += mass * speed
    # The bent bar: 12 kg/m on three throws, whose centres are at half of the radius in the cheeks.
    for throw in THROWS.values():
        reach = 12.0 * (0.06 * R + 2 * R * R / 2)
        turned = theta + throw
        potential = potential + reach * G * np.sin(turned)
        momentum += reach * w * np.array([-np.sin(turned), np.cos(turned)])
    gas, pushed = 0.0, np.zeros((2, theta.size))
    for name, u, _, piston in pistons(theta, bank):
        push = np.array([found.array(f"load:{name}_gas:f{axis}")[:-1] for axis in "yz"])
        gas = gas + np.sum(push * slope(piston), axis=0)
        pushed += push
        assert np.abs(u[0] * push[1] - u[1] * push[0]).max() < 1e-9
        # It burns near its upper dead centre, once in two turns.
        if values.get("load", 1.0):
            k = int(np.argmax(np.hypot(*push)))
            reach = (u @ piston)[k] / (R + L)
            assert reach > 0.985
    told = slope(kinetic + potential) - gas
    effort = found.effort("main_fixed:turn_1")[:-1]
    assert np.abs(effort - told).max() < 1e-10 * np.abs(told).max()
    whole = 6 * (ROD + PISTON) + 12.0 * (4 * 0.05 + 3 * 0.06 + 6 * R) + 8.0
    told = w * slope(momentum) - pushed - np.array([[0.0], [-whole * G]])
    walls = [f"{name}_wall" for name, *_ in pistons(theta, bank)]
    every = [
        np.array([found.array(f"reaction:{name}:f{axis}")[:-1] for axis in "yz"])
        for name in ("main_fixed", "main_floating", *walls)
    ]
    assert np.abs(sum(every) - told).max() < 1e-10 * np.abs(every).max()


@pytest.mark.parametrize(
    "values", [{}, {"lift": 0.015, "base": 0.06, "stiffness": 20e3, "speed": 40.0}]
)
def test_the_contact_of_a_roller_cam_is_that_of_closed_forms(values):
    """Norton's pressure angle; the spring, the weight and inertia over its cosine; their moment on
    the shaft.
    """
    solution = evaluate(load_case(CASES / "roller_cam").scene, parameters=values)
    assert solution.certified
    given = {"base": 0.045, "stiffness": 12e3, "speed": 60.0, "lift": 0.02} | values
    motion = solution.motion("guide")
    least, place = np.sqrt((given["base"] + 0.012) ** 2 - 0.006**2), motion.value - 0.05
    assert np.ptp(motion.value) == pytest.approx(given["lift"], rel=1e-3)
    assert place.min() == pytest.approx(least, rel=1e-12)
    pushed = 0.5 * (motion.acceleration + 9.81) + 300.0 + given["stiffness"] * (place - least)
    tangent = (motion.rate / given["speed"] - 0.006) / place
    force = solution.output("contact_force")
    assert force == pytest.approx(pushed * np.hypot(1.0, tangent), rel=1e-10)
    assert solution.output("contact_pressure_angle") == pytest.approx(
        np.arctan(np.abs(tangent)), abs=1e-11
    )
    assert solution.reaction("guide").fx == pytest.approx(
        pushed * tangent, rel=0, abs=1e-10 * pushed.max()
    )
    assert solution.effort("shaft") == pytest.approx(
        pushed * motion.rate / given["speed"], rel=0, abs=1e-11 * pushed.max()
    )
    assert force.min() > 0.0


@pytest.mark.parametrize("values", [{}, {"mu": 0.05, "payload": 300.0}, {"lead": 0.012, "mu": 0.2}])
def test_the_motor_of_a_screw_lift_lifts_the_weight_and_the_friction(values):
    """W r tan(angle +- phi) with the inertia of table and spindle; the efficiency of the way up;
    and work of the whole cycle.
    """
    solution = evaluate(load_case(CASES / "screw_lift").scene, parameters=values)
    assert solution.certified
    told = {"mu": 0.12, "payload": 800.0, "lead": 0.006} | values
    angle, phi = math.atan(told["lead"] / (2 * math.pi) / 0.0135), math.atan(told["mu"])
    motion, table = solution.motion("motor"), solution.motion("guide")
    weight = 9.81 * (told["payload"] + 60.0) + 60.0 * table.acceleration
    up = table.rate > 0.0
    thread = weight * 0.0135 * np.where(up, math.tan(angle + phi), math.tan(angle - phi))
    # The spindle turns backward on the way up.
    assert solution.effort("motor") == pytest.approx(6e-4 * motion.acceleration - thread, rel=1e-11)
    assert table.value == pytest.approx(-motion.value * told["lead"] / (2 * math.pi), abs=1e-13)
    lifted, given = weight * table.rate, -thread * motion.rate
    assert (lifted / given)[up] == pytest.approx(
        np.full(up.sum(), math.tan(angle) / math.tan(angle + phi)), rel=1e-11
    )
    assert solution.output("lifting_power") == pytest.approx(lifted, rel=1e-11)
    # Where it locks itself, it must be driven down.
    assert (given[~up] > 0.0).all() == (phi > angle)
    lost = solution.series["friction:flanks:loss"]
    assert given - lifted == pytest.approx(lost, rel=1e-10, abs=1e-10)
    assert (lost > 0.0).all()


def test_the_file_of_a_scara_is_as_good_as_the_moves_that_it_was_made_from():
    scene = load_case(CASES / "scara").scene

    def played(start, end):
        out = move(f"{end} deg", time=0.47, law="s_curve")
        back = move(f"{start} deg", time=0.43, law="s_curve")
        return moves(
            [dwell(0.08), out, dwell(0.12), back, dwell(0.1)], start=f"{start} deg", cyclic=True
        )

    exact = Scene(
        scene.mechanism,
        {"shoulder": played(10, 95), "motor": played(70, 160)},
        t=scene.t,
        posture=scene.posture,
    )
    found, expected = evaluate(scene, parameters={"pace": 1.0}), evaluate(exact)
    for joint in ("shoulder", "motor"):
        assert (
            np.degrees(np.abs(found.motion(joint).value - expected.motion(joint).value)).max()
            < 0.002
        )
        gap = found.effort(joint) - expected.effort(joint)
        size = np.abs(expected.effort(joint)).max()
        assert np.abs(gap).max() < 0.03 * size
        assert np.sqrt(np.mean(gap**2)) < 0.006 * size

"""The case of a servo press: its crank's work and effort by virtual work, and the choice of its
motor by closed forms.
"""

import math

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case
from lagrange_casadi.actuators import duty_of, inertia_at, read_motors, select
from lagrange_casadi.cli import main

pytestmark = pytest.mark.usefixtures("interpreted")

HEIGHTS, SHARES = np.array([0, 5, 15, 30, 39, 40]) / 1000, (0.55, 0.7, 0.95, 1.0, 0.6, 0.0)
R, L = 0.08, 0.6


@pytest.fixture(scope="module")
def scene():
    return load_case(CASES / "servo_press").scene


def stroke(t, strokes=30.0, slowing=0.5, drawing=250e3):
    """The crank's angle from the top, its rate and acceleration; the effort that it takes; and its
    inertia.
    """
    turn = strokes * math.pi / 30
    x = math.pi / 2 + turn * t + slowing * np.sin(turn * t)
    rate, change = turn * (1 + slowing * np.cos(turn * t)), -slowing * turn**2 * np.sin(turn * t)
    s, c = np.sin(x), np.cos(x)
    root = np.sqrt(L**2 - (R * c) ** 2)
    height = R + L + R * s - root
    slope = R * c - R**2 * c * s / root
    # Of the rod, both ends' velocities for a unit rate of the crank: (-r s, r c) and (0, slope).
    rod = 80.0 / 3 * (R**2 + R * c * slope + slope**2)

    def inertia(angle):
        c, s = np.cos(angle), np.sin(angle)
        down = R * c - R**2 * c * s / np.sqrt(L**2 - (R * c) ** 2)
        return 6.0 + 90.0 * 0.02**2 + 80.0 / 3 * (R**2 + R * c * down + down**2) + 400.0 * down**2

    whole, step = inertia(x), 1e-5
    assert whole == pytest.approx(6.036 + rod + 400.0 * slope**2)
    bend = (
        inertia(x - 2 * step)
        - 8 * inertia(x - step)
        + 8 * inertia(x + step)
        - inertia(x + 2 * step)
    ) / (12 * step)
    force = drawing * np.interp(height, HEIGHTS, SHARES) * (slope < 0)
    weights = 9.81 * (90.0 * 0.02 * c + 80.0 * (R * c + slope) / 2)  # the ram's is carried
    return x, rate, height, whole * change + bend * rate**2 / 2 - force * slope + weights, whole


@pytest.mark.parametrize("values", [{}, {"strokes": 18.0, "slowing": 0.7, "drawing": 400e3}])
def test_the_cranks_effort_is_that_of_virtual_work(scene, values):
    solution = evaluate(scene, parameters=values)
    assert solution.certified
    angle, rate, height, effort, inertia = stroke(solution.t, **values)
    assert solution.motion("main").value == pytest.approx(angle, rel=1e-13)
    assert solution.output("height") == pytest.approx(height, abs=1e-13)
    assert solution.effort("main") == pytest.approx(effort, rel=0, abs=1e-9 * effort.max())
    assert solution.output("power") == pytest.approx(
        effort * rate, rel=0, abs=1e-9 * (effort * rate).max()
    )
    assert inertia_at(scene, "main", parameters=values) == pytest.approx(inertia, rel=1e-12)


@pytest.mark.parametrize("values", [{}, {"strokes": 45.0, "slowing": 0.0}])
def test_a_stroke_takes_the_work_of_the_part(scene, values):
    """The area under the table, whatever the motion: all else is weights and inertia, which give
    back what they took.
    """
    solution = evaluate(
        scene,
        parameters=values,
        t=(0, 60 / values.get("strokes", 30.0), 20000),
        wanted=["effort", "motion"],
    )
    power = solution.effort("main") * solution.motion("main").rate
    assert np.trapezoid(power, solution.t) == pytest.approx(
        250e3 * np.trapezoid(SHARES, HEIGHTS), rel=2e-6
    )
    assert 250e3 * np.trapezoid(SHARES, HEIGHTS) == pytest.approx(8375.0)


def test_the_motor_is_the_one_that_closed_forms_name(scene, capsys):
    """Every motor with every ratio, from the virtual work of the crank."""
    case, ratios = str(CASES / "servo_press"), (20, 30, 40, 50)
    solution = evaluate(scene, wanted=["effort", "motion"])
    t = solution.t
    _, rate, _, effort, _ = stroke(t)
    change = -0.5 * math.pi**2 * np.sin(math.pi * t)
    serving = {}
    motors = read_motors(CASES / "servo_press" / "motors.csv")
    for motor in motors:
        for ratio in ratios:
            torque = (
                effort / ratio * np.where(effort > 0, 1 / 0.95, 0.95)
                + motor.inertia * ratio * change
            )
            speed = ratio * rate
            lasting = np.interp(
                np.trapezoid(speed, t) / 2,
                [0, motor.rated_speed],
                [motor.stall_torque, motor.rated_torque],
            )
            limit = np.interp(
                speed, [motor.knee_speed, motor.max_speed], [motor.peak_torque, motor.end_torque]
            )
            # Half an hour of winding against 2 s of cycle: the mean of the losses is what warms.
            heat = math.sqrt(np.trapezoid(torque**2, t) / 2) / lasting
            shares = (heat, (abs(torque) / limit).max(), speed.max() / motor.max_speed)
            if max(shares) <= 1.0:
                serving[motor.rated_power, heat] = (motor.name, ratio, shares)
    name, ratio, shares = serving[min(serving)]
    choice = select(
        motors,
        lambda n, inertia: duty_of(solution, "main", ratio=n, inertia=inertia, efficiency=0.95),
        ratios=ratios,
    )
    assert (choice.motor.name, choice.ratio) == (name, ratio) == ("S 180", 50)
    assert (choice.torque, choice.speed) == pytest.approx(shares[1:], rel=1e-6)
    assert choice.heat == pytest.approx(shares[0], rel=2e-3)
    assert [why.partition(":")[0] for why in choice.refused] == ["S 40", "S 70", "S 110"]
    page = (CASES / "servo_press" / "README.md").read_text()
    assert (
        f"{choice.duty.rms_torque:.3g} N m, its peak {choice.duty.peak_torque:.0f} N m"
        in " ".join(page.split())
    )
    energies = choice.duty.energy / 1000, choice.duty.regenerated / 1000
    assert "{:.3g} kJ a stroke, of which {:.2f} kJ".format(*energies) in " ".join(page.split())
    assert main(["drive", case, "--ratio", "20,30,40,50", "--efficiency", "0.95"]) == 0
    assert (
        "smallest suitable of 6 motors: 'S 180', 31416 W, with a ratio of 50"
        in capsys.readouterr().out
    )

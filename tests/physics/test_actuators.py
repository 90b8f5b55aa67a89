"""Motors: inertias that drives feel, means and energies of closed forms, heat, what a catalogue
names, the case of a servo press, and what is refused.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, optimise, sweep
from lagrange_casadi.actuators import (
    Duty,
    Motor,
    assess,
    duty_of,
    inertia_at,
    plot_duty,
    read_motors,
    select,
)
from lagrange_casadi.errors import DeclarationError, NoDesignError, PathError, UnknownNameError
from lagrange_casadi.motion import dwell, expression, harmonic, move, moves, polynomial, trapezoid

pytestmark = pytest.mark.usefixtures("interpreted")

INERTIA = 2.0 * 0.6**2 / 3


def turned(law, t):
    m = Mechanism("table")
    m.set_gravity(0, 0)
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0))
    return evaluate(Scene(m, {"J": law}, t=t), wanted=["effort", "motion"])


@pytest.mark.quick
def test_a_harmonic_swing_has_the_means_of_its_closed_form():
    """Torque and speed are sines: what is given in a swing comes back, A^2 w^2 J/2 each quarter."""
    size, hertz, ratio, rotor = 0.4, 1.5, 8.0, 2e-4
    omega = 2 * math.pi * hertz
    solution = turned(harmonic(0.0, size, hertz), (0, 1 / hertz, 2001))
    duty = duty_of(solution, "J", ratio=ratio, inertia=rotor)
    torque = (INERTIA / ratio + rotor * ratio) * size * omega**2
    backward = duty_of(solution, "J", ratio=-ratio, inertia=rotor)
    assert (backward.torque + duty.torque).tolist() == [0.0] * 2001
    assert duty.rms_torque == pytest.approx(torque / math.sqrt(2), rel=1e-6)
    assert duty.peak_torque == pytest.approx(torque, rel=1e-6)
    assert duty.peak_speed == pytest.approx(ratio * size * omega, rel=1e-6)
    assert duty.mean_speed == pytest.approx(ratio * size * omega * 2 / math.pi, rel=1e-6)
    energy = (INERTIA + rotor * ratio**2) * (size * omega) ** 2 / 2
    assert duty.energy == pytest.approx(2 * energy, rel=1e-5)
    assert duty.regenerated == pytest.approx(2 * energy, rel=1e-5)
    assert duty.peak_power == pytest.approx(torque * ratio * size * omega / 2, rel=1e-6)


HEADS = "name,stall_torque,rated_torque,rated_speed,peak_torque,max_speed,inertia"


ROWS = [
    "small,0.6,0.5,3000,1.8,5000,1e-5",
    "middle,1.6,1.3,3000,4.8,5000,4e-5",
    "large,5,4.2,3000,15,4500,3e-4",
]


def catalogue(folder, rows=ROWS, heads=HEADS):
    (folder / "motors.csv").write_text("\n".join([heads, *rows]))
    return read_motors(folder / "motors.csv")


@pytest.mark.quick
def test_where_no_motor_serves_the_nearest_is_named(here):
    solution = turned(harmonic(0.0, 0.8, 6.0), (0, 1 / 6.0, 401))
    with pytest.raises(
        NoDesignError,
        match=(
            r"no motor of 3 is suitable; nearest is large: (speed|heat|peak torque) \d+ % of its"
        ),
    ):
        select(
            catalogue(here),
            lambda ratio, inertia: duty_of(solution, "J", ratio=ratio, inertia=inertia),
            ratios=(5, 10),
        )


@pytest.mark.quick
@pytest.mark.parametrize(
    ("rows", "heads", "says"),
    [
        (
            [*ROWS, "bad,1,x,3000,2,4000,1e-5"],
            HEADS,
            r"motors\.csv, line 5: rated_torque: expected a positive number, got 'x'",
        ),
        (
            [*ROWS, "bad,1,-1,3000,2,4000,1e-5"],
            HEADS,
            "line 5: rated_torque: expected a positive number, got '-1'",
        ),
        (
            [*ROWS, "bad,1,2,3000,2,4000,1e-5"],
            HEADS,
            "line 5: expected rated_torque <= stall_torque <= peak_torque",
        ),
        ([*ROWS, "bad,1,2"], HEADS, "line 5: 3 cells, expected 7"),
        ([*ROWS, ",1,1,3000,2,4000,1e-5"], HEADS, "line 5: it has no name"),
        (
            ROWS,
            HEADS.replace("inertia", "J"),
            r"motors\.csv, line 1: expected one column 'inertia' of name, stall_torque",
        ),
        ([*ROWS, ROWS[0]], HEADS, r"motors\.csv, line 5: motor 'small' is listed twice"),
        (
            ROWS,
            HEADS.replace("inertia", "inertia [lb in^2]"),
            r"column 'inertia' is in 'lb in\^2'; expected a moment of inertia \[kg m\^2\]",
        ),
        (
            [f"{row},2" for row in ROWS],
            f"{HEADS},knee_speed",
            "expected both columns knee_speed and end_torque, or none",
        ),
        (
            [f"{row},5000," for row in ROWS],
            f"{HEADS},knee_speed,end_torque",
            "line 2: expected both knee_speed and end_torque",
        ),
        (
            [f"{row},2000,20" for row in ROWS],
            f"{HEADS},knee_speed,end_torque",
            "line 2: expected knee_speed <= max_speed, and end_t",
        ),
        (
            [f"{row},2" for row in ROWS],
            f"{HEADS},inertia",
            "line 1: expected one column 'inertia' of name",
        ),
        ([], HEADS, "expected a line for every motor below this head"),
    ],
)
def test_a_bad_line_of_a_catalogue_is_told(here, rows, heads, says):
    with pytest.raises(DeclarationError, match=says):
        catalogue(here, rows, heads)


@pytest.mark.parametrize(
    ("ask", "error", "says"),
    [
        (lambda s: duty_of(s, "J", ratio=0.0), DeclarationError, "ratio must be a finite number o"),
        (lambda s: duty_of(s, "J", efficiency=1.2), DeclarationError, "above 0 and at most 1"),
        (
            lambda s: duty_of(s, "J", inertia=-1.0),
            DeclarationError,
            "inertia must not be negative",
        ),
        (
            lambda s: duty_of(s, "J").inertia_ratio,
            DeclarationError,
            "inertia ratio of 'J': expected the inertia reflected to the drive",
        ),
        (
            lambda s: duty_of(s, "J", carried=np.ones(3)).inertia_ratio,
            DeclarationError,
            "inertia ratio of 'J': expected the motor's inertia",
        ),
        (lambda s: duty_of(s, "J", carried=[1.0]), DeclarationError, "at each of the 3 instants"),
        (lambda s: duty_of(s, "J", linear=True), DeclarationError, "a linear motor slides"),
        (
            lambda s: Motor("m", 1.0, 1.0, 1.0, 1.0, 1.0, -1.0),
            DeclarationError,
            "motor 'm': inertia: expected a number of at least 0, got -1.0",
        ),
        (
            lambda s: select(
                [Motor("m", 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, linear=True)], lambda *_: duty_of(s, "J")
            ),
            DeclarationError,
            "motor 'm' is a linear one, and the duty of 'J' is that of a rotary one",
        ),
        (lambda s: duty_of(s, "K"), UnknownNameError, "unknown drive 'K'; valid: J"),
        (lambda s: duty_of(s.during(slice(1)), "J"), DeclarationError, "two instants or more"),
        (lambda s: read_motors("none.csv"), PathError, "no such file"),
        (lambda s: plot_duty(duty_of(s, "J"), "duty.txt"), DeclarationError, r"ends in \.png"),
        (lambda s: select([], duty_of), DeclarationError, "expected motors, and ratios"),
        (lambda s: feels("four_bar", "P"), UnknownNameError, "unknown drive 'P'; valid: O"),
        (
            lambda s: feels("sleigh", "X"),
            DeclarationError,
            "with non-holonomic constraints no drive can move",
        ),
        (
            lambda s: feels("excavator", "boom_cylinder", "foot"),
            DeclarationError,
            "with 4 drives for 3 motions no drive can move",
        ),
        (
            lambda s: evened(minimise="fluctuation:reaction:O:fx"),
            (DeclarationError, UnknownNameError),
            "a fluctuation of energy is that of an effort",
        ),
        (
            lambda s: evened(minimise="fluctuation:effort:P"),
            (DeclarationError, UnknownNameError),
            "effort of a joint whose motion is given",
        ),
        (
            lambda s: evened(minimise="third", subject_to=[f"{TERM} >= 1"]),
            DeclarationError,
            "can be limited from above only",
        ),
        (
            lambda s: sweep(
                uneven_rotor(harmonic(0.0, 0.3, 1.0), t=(0.0, 1.0, 41)),
                {"third": [1.0]},
                fluctuation=True,
            ),
            DeclarationError,
            "joint 'O' ends where it began",
        ),
    ],
)
def test_misuse_is_named(ask, error, says):
    with pytest.raises(error, match=says):
        ask(turned(polynomial(0.0, 1.0), (0, 1, 3)))


def feels(case, joint, *more):
    """What a joint of a case feels, with more drives."""
    scene = load_case(case).scene
    return inertia_at(replace(scene, drives=[*scene.weights, *more]) if more else scene, joint)


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
    scene = load_case("four_bar").scene
    law = moves([move("90 deg", time=0.3), dwell(0.2)], start="20 deg")
    still, turning = (
        inertia_at(replace(scene, motion={"O": one}, t=t), "O")
        for one, t in ((law, (0, 0.5, 51)), (polynomial(math.radians(90), 1.0), (0, 0, 1)))
    )
    assert still[30:] == pytest.approx(turning[0], rel=1e-12)


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


def test_the_motor_is_the_one_that_the_sums_of_all_name():
    """Every motor with every ratio, one by one."""
    solution = evaluate(load_case(CASES / "servo_press").scene, wanted=["effort", "motion"])
    t, ratios, serving = solution.t, (20, 30, 40, 50), {}
    effort, crank = solution.effort("main"), solution.motion("main")
    motors = read_motors(CASES / "servo_press" / "motors.csv")
    for motor, ratio in itertools.product(motors, ratios):
        torque = effort / ratio * np.where(effort > 0, 1 / 0.95, 0.95)
        torque, speed = torque + motor.inertia * ratio * crank.acceleration, ratio * crank.rate
        mean, at = np.trapezoid(speed, t) / 2, [0, motor.rated_speed]
        lasting = np.interp(mean, at, [motor.stall_torque, motor.rated_torque])
        ends = [motor.knee_speed, motor.max_speed], [motor.peak_torque, motor.end_torque]
        # Half an hour of winding against 2 s of cycle: the mean of the losses is what warms.
        heat = math.sqrt(np.trapezoid(torque**2, t) / 2) / lasting
        most = (abs(torque) / np.interp(speed, *ends)).max(), speed.max() / motor.max_speed
        if max(heat, *most) <= 1.0:
            serving[motor.rated_power, heat] = (motor.name, ratio, most)
    name, ratio, most = serving[min(serving)]
    choice = select(
        motors,
        lambda n, inertia: duty_of(solution, "main", ratio=n, inertia=inertia, efficiency=0.95),
        ratios=ratios,
    )
    assert (choice.motor.name, choice.ratio) == (name, ratio) == ("S 180", 50)
    assert (choice.torque, choice.speed) == pytest.approx(most, rel=1e-6)
    assert choice.heat == pytest.approx(min(serving)[1], rel=2e-3)
    assert [why.partition(":")[0] for why in choice.refused] == ["S 40", "S 70", "S 110"]


TERM = "fluctuation:effort:O"


def uneven_rotor(motion=None, t=None, turned=math.tau):
    """A disc against a torque with a third harmonic."""
    m = Mechanism("rotor")
    m.set_gravity(0.0, 0.0)
    third = m.parameter("third", 0.5, "N*m")
    speed = m.parameter("speed", 10.0, "rad/s")
    disc = m.link("disc", length=0.2, mass=3.0, centre=(0.0, 0.0), inertia=0.5)
    angle = m.coordinate(m.revolute("O", m.ground, disc))
    m.torque("load", disc, -(2.0 + 6.0 * ca.sin(angle) + third * ca.sin(3.0 * angle)))
    ripple = m.parameter("ripple", 0.0, "rad")
    turn = motion or expression(lambda t: 0.3 + speed * t + ripple * ca.sin(speed * t))
    return Scene(m, {"O": turn}, t=t or (0.0, turned / speed, 41), wanted=["effort"])


def test_a_sweep_keeps_the_fluctuation_of_energy():
    """The energy is 6 cos(x) + third/3 cos(3 x), which at third = -3 turns at 30 deg."""
    found = sweep(
        uneven_rotor(), {"third": [0.0, 0.5, -3.0], "speed": [5.0, -8.0]}, fluctuation=True
    )
    exact = np.array([12.0, 12.0 + 1.0 / 3.0, 6.0 * math.sqrt(3.0)])
    assert np.abs(found[TERM][:, 0] / exact - 1.0).max() < 1e-9
    assert np.isnan(found[TERM][:, 1]).all()  # a turn backwards ends before it begins
    assert found.columns[TERM].unit == "J"


def evened(**asked):
    """The best third harmonic."""
    return optimise(uneven_rotor(), over={"third": (-6.0, 4.0)}, starts=1, screen=4, **asked)


def test_a_third_harmonic_is_chosen_that_evens_the_energy():
    """The least of max |cos(x) + q cos(3 x)| is sqrt(3)/2, at q = -1/6."""
    found = evened(minimise=TERM)
    assert found.converged
    assert found.objective == pytest.approx(6.0 * math.sqrt(3.0), rel=1e-9)
    assert found.values["third"] == pytest.approx(-3.0, abs=1e-6)
    # For a smaller third the energy turns at its ends alone: it is 12 + 2/3 third.
    other = evened(minimise="peak:effort:O", subject_to=[f"{TERM} <= 11"])
    assert other.converged
    assert other.values["third"] == pytest.approx(-1.5, abs=1e-6)
    assert other.limits[0].multiplier == pytest.approx(1.5, rel=1e-6)


@pytest.mark.parametrize(("name", "t"), [("ripple", (0.0, 0.5, 41)), ("speed", None)])
def test_the_least_uneven_turn_is_chosen_that_evens_the_energy(name, t):
    """A disc that is faster where its load takes more: of a torque that goes with the angle. The
    time that a part of a turn takes is each speed's own.
    """
    turn, near = np.linspace(0.0, 5.0, 100_001), []
    best = {"ripple": 0.06, "speed": 10.0}
    for share in (1.0, 1.001, 0.999):
        ripple, rate = (best | {name: share * best[name]}).values()
        x, speed = turn + ripple * np.sin(turn), rate * (1.0 + ripple * np.cos(turn))
        energy = 0.25 * speed**2 - 6.0 * np.cos(0.3 + x) - np.cos(0.9 + 3.0 * x) / 6.0
        near.append(np.ptp(energy - (energy[-1] - energy[0]) * x / x[-1]))
    over = {name: (0.8 * best[name], 1.5 * best[name])}
    limit = f"{TERM} <= {near[0]:.17g}"
    found = optimise(
        uneven_rotor(t=t, turned=5.0),
        minimise=name,
        subject_to=[limit],
        over=over,
        parameters={one: value for one, value in best.items() if one != name},
        starts=1,
        screen=4,
    )
    assert found.values[name] == pytest.approx(best[name], rel=1e-7)
    slope = 2e-3 * best[name] / (near[2] - near[1])
    assert found.limits[0].multiplier == pytest.approx(slope, rel=1e-5)

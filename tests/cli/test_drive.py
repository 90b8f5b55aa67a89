"""The command ``drive``, the inertia that a drive feels, and how warm a motor gets."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import CASES
from hypothesis import given
from hypothesis import strategies as st
from internals import RigidMass, warmest

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.actuators import Motor, assess, duty_of, inertia_at, plot_duty, read_motors
from lagrange_casadi.cli import main
from lagrange_casadi.density import Density
from lagrange_casadi.elements import cylinder
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import dwell, harmonic, move, moves, polynomial, trapezoid

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


@pytest.mark.parametrize(
    "alone",
    [pytest.param("boom_cylinder"), pytest.param("bucket_cylinder", marks=pytest.mark.long)],
)
def test_of_several_drives_the_others_are_at_rest(alone):
    """The excavator's pose is given; beside it the same machine of which the cylinders' motion is
    given, and one moves.
    """
    scene = load_case(CASES / "excavator").scene
    at = (scene.span[1], scene.span[1], 1)
    solution = evaluate(scene, t=at, wanted=["motion"])
    laws = {
        name: polynomial(solution.motion(name).value[0], float(name == alone))
        for name in scene.weights
    }
    rough = {link: solution.pose(link).angle[0] for link in scene.mechanism.links}
    other = Scene(scene.mechanism, laws, t=(0, 0, 1), posture=rough)
    expected = 2.0 * sum(map(float, energies(other)))
    assert inertia_at(scene, alone, t=at)[0] == pytest.approx(expected, rel=1e-9)
    assert inertia_at(other, alone)[0] == pytest.approx(expected, rel=1e-9)


def energies(scene):
    """The kinetic energy of each body at the first instant, by differences of its poses."""
    h = 1e-4
    solution = evaluate(replace(scene, t=(-2 * h, 2 * h, 5)), wanted=["motion"])
    values = scene.mechanism.values()
    for name, body in scene.mechanism.bodies.items():
        if name == "ground":
            continue
        pose = solution.pose(name)
        angle = np.zeros(5) if pose.angle is None else pose.angle
        mass, (x, y), inertia = matter(scene.mechanism, body, values)
        place = np.stack(
            [
                pose.x + x * np.cos(angle) - y * np.sin(angle),
                pose.y + x * np.sin(angle) + y * np.cos(angle),
            ]
        )
        speed, turning = (
            (f[..., 0] - 8 * f[..., 1] + 8 * f[..., 3] - f[..., 4]) / (12 * h)
            for f in (place, angle)
        )
        yield mass * speed @ speed / 2 + inertia * turning**2 / 2


def matter(mechanism, body, values):
    """Mass, centre and inertia: of a uniform link, a rigid one, or a point mass."""

    def number(value):
        return float(mechanism.number(value, values))

    mass = body.mass
    if isinstance(mass, Density):
        length = number(body.length)
        base, tip, rest = (number(part) for part in mass.ends(body.length))
        whole = base + tip
        middle = tip * length / whole
        return whole, (middle, 0.0), rest + tip * length**2 - whole * middle**2
    if isinstance(mass, RigidMass):
        return number(mass.mass), tuple(number(x) for x in mass.centre[:2]), number(mass.inertia)
    return number(mass), (0.0, 0.0), 0.0


def test_what_no_drive_feels_alone_is_told():
    with pytest.raises(UnknownNameError, match="unknown drive 'P'; valid: O"):
        inertia_at(press(polynomial(0.1, 7.0)), "P")
    with pytest.raises(
        DeclarationError,
        match="inertia at 'X': with non-holonomic constraints no drive can move alone",
    ):
        inertia_at(load_case(CASES / "sleigh").scene, "X")


def test_the_ratio_of_inertias():
    solution = evaluate(press(polynomial(0.1, 7.0), t=(0, 0.9, 37)), wanted=["effort", "motion"])
    seen = inertia_at(press(polynomial(0.1, 7.0), t=(0, 0.9, 37)), "O")
    duty = duty_of(solution, "O", ratio=-4.0, inertia=1e-3, carried=seen)
    least, mean, largest = duty.inertia_ratio
    assert (least, largest) == pytest.approx((seen.min() / 0.016, seen.max() / 0.016))
    assert least < mean < largest
    assert mean == pytest.approx(np.trapezoid(seen, solution.t) / 0.9 / 0.016)
    for missing in ({"inertia": 1e-3}, {"carried": seen}):
        with pytest.raises(DeclarationError, match="inertia ratio of 'O': expected"):
            _ = duty_of(solution, "O", **missing).inertia_ratio
    with pytest.raises(
        DeclarationError, match="carried: expected an inertia at each of the 37 instants"
    ):
        duty_of(solution, "O", carried=seen[1:])


def test_a_winding_warms_and_cools_as_its_law_says():
    """On for 2 s, off for 6 s, over and over: the exponentials of any textbook, at the end of the
    pull.
    """
    t = np.array([0.0, 2.0, 2.0 + 1e-9, 8.0])
    torque = np.array([3.0, 3.0, 0.0, 0.0])
    assert warmest(t, torque, math.inf) == pytest.approx(3.0 * math.sqrt(2.0 / 8.0), rel=1e-8)
    for tau in (0.1, 1.0, 5.0, 100.0):
        peak = math.expm1(-2.0 / tau) / math.expm1(-8.0 / tau)
        assert warmest(t, torque, tau) == pytest.approx(3.0 * math.sqrt(peak), rel=1e-8)


@given(
    st.lists(st.floats(0.0, 9.0), min_size=2, max_size=30),
    st.floats(1e-3, 1e3),
    st.floats(1.0, 100.0),
)
def test_the_warmest_instant_is_between_the_mean_and_the_peak(pulls, tau, more):
    torque, t = np.array(pulls), np.cumsum(np.linspace(0.1, 0.5, len(pulls)))
    least, slow, quick = (warmest(t, torque, tau) for tau in (math.inf, tau * more, tau))
    assert least * (1 - 1e-9) <= slow <= quick * (1 + 1e-9)
    assert quick <= torque.max() * (1 + 1e-9)
    assert warmest(t, torque, 1e9) == pytest.approx(least, rel=1e-6, abs=1e-12)


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


ROTARY = "name,stall_torque,rated_torque,rated_speed,peak_torque,max_speed,inertia [kg cm^2]"
LINEAR = "name;stall_force;rated_force;rated_speed;peak_force;max_speed;mass"


def test_linear_motors_have_forces_and_masses(here):
    (here / "linear.csv").write_text(f"{LINEAR}\nL1;100;80;2;300;4;1,5\n")
    (motor,) = read_motors("linear.csv")
    assert (motor.linear, motor.inertia, motor.max_speed) == (True, 1.5, 4.0)
    m = Mechanism("stage")
    m.prismatic("X", m.ground, m.point_mass("table", 10.0), axis=(1, 0))
    solution = evaluate(
        Scene(m, {"X": harmonic(0.0, 0.1, 1.0)}, t=(0, 1, 401)), wanted=["effort", "motion"]
    )
    choice = assess(motor, duty_of(solution, "X", inertia=motor.inertia, linear=True))
    assert choice.torque == pytest.approx(11.5 * 0.1 * (2 * math.pi) ** 2 / 300.0, rel=1e-6)
    assert choice.governs in choice.shares
    with pytest.raises(
        DeclarationError,
        match="motor 'L1' is a linear one, and the duty of 'X' is that of a rotary one",
    ):
        assess(motor, duty_of(solution, "X", ratio=600.0))
    solution = evaluate(press(polynomial(0.1, 7.0), t=(0, 0.9, 37)), wanted=["effort", "motion"])
    with pytest.raises(
        DeclarationError, match="drive 'O' turns, and a linear motor slides; expected a rotary one"
    ):
        duty_of(solution, "O", linear=True)


CASE = """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import dwell, move, moves


def scene():
    m = Mechanism("gantry")
    m.set_gravity(0, 0)
    load = m.parameter("load", 8.0, "kg")
    beam = m.link("beam", length=1.0, mass=12.0)
    m.prismatic("X", m.ground, beam, axis=(1, 0))
    m.prismatic("Y", beam, m.point_mass("table", load), axis=(0, 1))
    law = moves([move(0.4, time=0.4), dwell(0.2), move(0.0, time=0.4), dwell(0.1)], cyclic=True)
    other = moves([move(0.2, time=0.3), dwell(0.3), move(0.0, time=0.3), dwell(0.2)], cyclic=True)
    return Scene(m, {"X": law, "Y": other}, t=(0, 1.1, 441))
"""


@pytest.fixture
def gantry(here):
    (here / "case.py").write_text(CASE)
    (here / "rotary.csv").write_text(
        f"{ROTARY}\nsmall,0.3,0.25,3000,0.9,6000,0.1\nmiddle,2,1.6,3000,6,6000,0.8\nlarge,9,7,3000,27,5000,9\n"
    )
    (here / "linear.csv").write_text(f"{LINEAR}\nL1;100;80;2;300;4;1,5\nL2;400;320;2;1200;4;4\n")
    return here


def test_one_command_chooses_a_motor_for_every_drive(gantry, capsys):
    assert (
        main(
            ["drive", "case.py", "--motors", "rotary.csv", "--lead", "0.02", "--efficiency", "0.9"]
        )
        == 0
    )
    out = capsys.readouterr().out
    solution = evaluate(load_case("case.py").scene, wanted=["effort", "motion"])
    for name, mass in (("X", 20.0), ("Y", 8.0)):
        turns = math.tau / 0.02
        choices = [
            assess(
                motor,
                duty_of(
                    solution,
                    name,
                    ratio=turns,
                    efficiency=0.9,
                    inertia=motor.inertia,
                    carried=np.full(441, mass),
                ),
            )
            for motor in read_motors("rotary.csv")
        ]
        first = next(choice for choice in choices if choice.serves)
        told = out.partition(f"\n{name}: ")[2].partition("\nY: ")[0]
        assert f"smallest suitable of 3 motors: '{first.motor.name}'" in told
        assert f"inertia of what it drives: {mass:.5g} kg\n" in told
        ratio = mass / (turns**2 * first.motor.inertia)
        assert (
            f"inertia of the load over that of the motor: {ratio:.5g}, mean {ratio:.5g}\n" in told
        )
        for limit, share in first.shares.items():
            assert f"    {limit:<12} {share:>8.4g} |" in told
        assert f"rms {first.duty.rms_torque:.5g} N m, peak {first.duty.peak_torque:.5g} N m" in told
        energy, back = first.duty.energy, first.duty.regenerated
        assert f"energy of a cycle {energy:.5g} J; regenerated {back:.5g} J" in told
    assert out.splitlines()[-1].startswith("certificate: relative residuals closure")


def test_it_draws_and_takes_linear_motors_and_other_parameters(gantry, capsys):
    arguments = ["drive", "case.py", "--motors", "linear.csv", "--drive", "Y", "--set", "load=20"]
    assert main([*arguments, "--plot", "y.svg"]) == 0
    out = capsys.readouterr().out
    assert "smallest suitable of 2 motors: 'L2', 640 W, with a ratio of 1\n" in out
    assert "peak force" in out
    assert "    smaller: L1: " in out
    assert "\nX: " not in out
    assert "force [N]" not in out
    assert (gantry / "y.svg").read_text().startswith("<?xml")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("ending", [".png", ".pdf", ".svg"])
def test_a_picture_has_the_same_bytes_every_time(here, ending):
    duty = duty_of(
        evaluate(press(polynomial(0.1, 7.0), t=(0, 0.9, 37)), wanted=["effort", "motion"]), "O"
    )
    first, second = here / f"a{ending}", here / f"b{ending}"
    for path in (first, second):
        plot_duty(duty, path, Motor("m", 60.0, 40.0, 30.0, 200.0, 50.0, 0.0, 20.0, 90.0))
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 5000


def test_without_a_catalogue_it_tells_the_load(gantry, capsys):
    assert main(["drive", "case.py", "--drive", "X", "--t", "0:1.1:12"]) == 0
    out = capsys.readouterr().out
    assert "gantry: 12 instants from 0 to 1.1 s\nX: rms " in out
    assert "take more instants" in out
    assert "smallest" not in out
    (gantry / "motors.csv").write_text((gantry / "linear.csv").read_text())
    assert main(["drive", "case.py", "--drive", "X"]) == 0
    assert "smallest suitable of 2 motors: 'L2'" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "status", "says"),
    [
        (
            ["--motors", "rotary.csv"],
            2,
            "drive 'X' slides: expected --lead, the travel per turn of the motor, or linear motors",
        ),
        (["--motors", "linear.csv", "--lead", "0.1"], 2, "--lead: linear motors have no lead"),
        (["--lead", "-1"], 2, "--lead: expected a positive length"),
        (["--inertia", "nan"], 2, "--inertia: expected a number that is not negative"),
        (["--ratio", "5,x"], 2, "expected numbers other than 0, as in 5 or 5,10,20, got 'x'"),
        (["--ratio", "0"], 2, "got '0'"),
        (["--drive", "Z"], 2, "unknown drive 'Z'; valid: X, Y"),
        (["--plot", "x.png"], 2, "--plot: expected one drive, by --drive; there are X, Y"),
        (
            ["--drive", "X", "--plot", "x.txt"],
            2,
            "x.txt: expected a name that ends in .png, .pdf, .svg",
        ),
        (["--motors", "none.csv"], 2, "none.csv: no such file"),
        (
            ["--motors", "rotary.csv", "--lead", "0.02", "--efficiency", "2"],
            2,
            "efficiency must be above 0 and at most 1, got 2.0",
        ),
        (["--motors", "rotary.csv", "--ratio", "5000"], 1, "no motor of 3 is suitable; nearest is"),
    ],
)
def test_misuse_is_one_line(gantry, capsys, arguments, status, says):
    assert main(["drive", "case.py", *arguments]) == status
    told = capsys.readouterr()
    assert says in told.err
    assert told.err.startswith("error: ")
    assert status == 1 or not told.out
    assert told.err.count("\n") == 1
    assert not list(gantry.glob("*.png"))


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

"""Motors and cylinders: means and energies of closed forms, what a catalogue names, and what is
refused.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.actuators import Motor, assess, duty_of, plot_duty, read_motors, select
from lagrange_casadi.elements import cylinder
from lagrange_casadi.errors import DeclarationError, NoDesignError, PathError, UnknownNameError
from lagrange_casadi.motion import harmonic, move, moves, polynomial, trapezoid

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

INERTIA = 2.0 * 0.6**2 / 3


def turned(law, t):
    m = Mechanism("table")
    m.set_gravity(0, 0)
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0))
    return evaluate(Scene(m, {"J": law}, t=t), wanted=["effort", "motion"])


def test_a_harmonic_swing_has_the_means_of_its_closed_form():
    """Torque and speed are sines: what is given in a swing comes back, A^2 w^2 J/2 each quarter."""
    size, hertz, ratio, rotor = 0.4, 1.5, 8.0, 2e-4
    omega = 2 * math.pi * hertz
    duty = duty_of(
        turned(harmonic(0.0, size, hertz), (0, 1 / hertz, 2001)), "J", ratio=ratio, inertia=rotor
    )
    torque = (INERTIA / ratio + rotor * ratio) * size * omega**2
    assert duty.rms_torque == pytest.approx(torque / math.sqrt(2), rel=1e-6)
    assert duty.peak_torque == pytest.approx(torque, rel=1e-6)
    assert duty.peak_speed == pytest.approx(ratio * size * omega, rel=1e-6)
    assert duty.mean_speed == pytest.approx(ratio * size * omega * 2 / math.pi, rel=1e-6)
    energy = (INERTIA + rotor * ratio**2) * (size * omega) ** 2 / 2
    assert duty.energy == pytest.approx(2 * energy, rel=1e-5)
    assert duty.regenerated == pytest.approx(2 * energy, rel=1e-5)
    assert duty.peak_power == pytest.approx(torque * ratio * size * omega / 2, rel=1e-6)


def test_a_gearbox_loses_either_way():
    """Speeding up by a trapezoid the motor gives more than the load takes; slowing down it gets
    back less.
    """
    law = moves([move(2.0, time=0.6, law=trapezoid(1 / 3))])
    solution = turned(law, (0, 0.6, 6001))
    duty = duty_of(solution, "J", ratio=5.0, efficiency=0.8)
    steady = INERTIA * 4.5 * 2.0 / 0.6**2 / 5.0
    assert duty.torque[1000] == pytest.approx(steady / 0.8, rel=1e-9)
    assert duty.torque[3000] == pytest.approx(0.0, abs=1e-12)
    assert duty.torque[5000] == pytest.approx(-steady * 0.8, rel=1e-9)
    kinetic = INERTIA * (1.5 * 2.0 / 0.6) ** 2 / 2
    assert duty.energy == pytest.approx(kinetic / 0.8, rel=1e-3)
    assert duty.regenerated == pytest.approx(kinetic * 0.8, rel=1e-3)
    assert duty_of(solution, "J", ratio=-5.0).torque[1000] == pytest.approx(-steady, rel=1e-9)


HEADS = "name,stall_torque,rated_torque,rated_speed,peak_torque,max_speed,inertia"
ROWS = [
    "small,0.6,0.5,3000,1.8,5000,1e-5",
    "middle,1.6,1.3,3000,4.8,5000,4e-5",
    "large,5,4.2,3000,15,4500,3e-4",
]


def catalogue(folder, rows=ROWS, heads=HEADS):
    (folder / "motors.csv").write_text("\n".join([heads, *rows]))
    return read_motors(folder / "motors.csv")


def test_the_smallest_motor_that_serves_is_named(here):
    solution = turned(harmonic(0.0, 0.8, 2.0), (0, 0.5, 401))
    motors = catalogue(here, ROWS[::-1])

    def asked(ratio, inertia):
        return duty_of(solution, "J", ratio=ratio, inertia=inertia, efficiency=0.9)

    choice = select(motors, asked, ratios=(5, 10, 20))
    # Every motor with every ratio, by hand.
    serving = []
    for motor in motors:
        for ratio in (5, 10, 20):
            duty = asked(ratio, motor.inertia)
            lasting = motor.stall_torque - (
                motor.stall_torque - motor.rated_torque
            ) * duty.mean_speed / (3000 * math.pi / 30)
            limits = (
                duty.rms_torque / lasting,
                duty.peak_torque / motor.peak_torque,
                duty.peak_speed / motor.max_speed,
            )
            if max(limits) <= 1.0:
                serving.append((motor.rated_power, limits[0], motor.name, ratio, limits))
    _, _, name, ratio, limits = min(serving)
    assert (choice.motor.name, choice.ratio) == (name, ratio)
    assert (choice.heat, choice.torque, choice.speed) == pytest.approx(limits, rel=1e-12)
    assert name == "middle"
    assert len(choice.refused) == 1
    assert choice.refused[0].startswith("small: ")
    plot_duty(choice.duty, here / "duty.png", choice.motor)
    assert (here / "duty.png").stat().st_size > 5000


def test_a_rotor_may_be_without_inertia(here):
    """As that of a catalogue that does not tell it: it counts as none, and there is no ratio of
    inertias.
    """
    (motor,) = catalogue(here, ["light,1,0.5,3000,2,4000,0"])
    assert motor.inertia == 0.0
    duty = duty_of(
        turned(harmonic(0.0, 0.8, 0.1), (0, 10, 101)), "J", ratio=40, inertia=motor.inertia
    )
    with pytest.raises(DeclarationError, match="expected the inertia reflected to the drive"):
        assert duty.inertia_ratio
    assert assess(motor, duty).heat > 0.0


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


@pytest.mark.parametrize(
    ("rows", "heads", "says"),
    [
        (
            [*ROWS, "bad,1,x,3000,2,4000,1e-5"],
            HEADS,
            r"motors\.csv, line 5: rated_torque must be a positive number, got 'x'",
        ),
        (
            [*ROWS, "bad,1,-1,3000,2,4000,1e-5"],
            HEADS,
            "line 5: rated_torque must be a positive number, got '-1'",
        ),
        (
            [*ROWS, "bad,1,2,3000,2,4000,1e-5"],
            HEADS,
            "line 5: expected rated_torque <= stall_torque <= peak_torque",
        ),
        ([*ROWS, "bad,1,2"], HEADS, "line 5: 3 cells, expected 7"),
        ([*ROWS, ",1,1,3000,2,4000,1e-5"], HEADS, "line 5: a motor without a name"),
        (
            ROWS,
            HEADS.replace("inertia", "J"),
            r"motors\.csv, line 1: it lacks the column 'inertia'; expected name, stall_torque",
        ),
        ([*ROWS, ROWS[0]], HEADS, r"motors\.csv, line 5: motor 'small' is listed twice"),
        (
            ROWS,
            HEADS.replace("inertia", "inertia [lb in^2]"),
            r"column 'inertia' cannot be in 'lb in\^2'; valid: kg m\^2, kg cm\^2",
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
            "line 1: the column 'inertia' is listed twice",
        ),
        ([], HEADS, "expected at least one motor below the heads"),
    ],
)
def test_a_bad_line_of_a_catalogue_is_told(here, rows, heads, says):
    with pytest.raises(DeclarationError, match=says):
        catalogue(here, rows, heads)


def test_misuse_is_named(here):
    solution = turned(polynomial(0.0, 1.0), (0, 1, 3))
    for options, says in (
        ({"ratio": 0.0}, "ratio must be a finite number other than 0"),
        ({"efficiency": 1.2}, "efficiency must be above 0 and at most 1"),
        ({"inertia": -1.0}, "inertia must be a finite number that is not negative"),
    ):
        with pytest.raises(DeclarationError, match=says):
            duty_of(solution, "J", **options)
    with pytest.raises(UnknownNameError, match="unknown drive 'K'; valid: J"):
        duty_of(solution, "K")
    with pytest.raises(DeclarationError, match="two instants or more"):
        duty_of(turned(polynomial(0.0, 1.0), (0, 0, 1)), "J")
    with pytest.raises(PathError, match="no such file"):
        read_motors(here / "none.csv")
    with pytest.raises(DeclarationError, match=r"expected a name that ends in \.png"):
        plot_duty(duty_of(solution, "J"), here / "duty.txt")
    with pytest.raises(DeclarationError, match="expected motors, and ratios"):
        select([], lambda ratio, inertia: duty_of(solution, "J"))
    motor = Motor("m", 2.0, 1.0, 300.0, 5.0, 500.0, 0.0)
    assert motor.continuous_torque(np.array([0.0, 300.0, -300.0, 600.0, 900.0])).tolist() == [
        2.0,
        1.0,
        1.0,
        0.0,
        0.0,
    ]


def hoist(**options):
    """A boom that a cylinder lifts."""
    m = Mechanism("hoist")
    load = m.parameter("load", 800.0, "kg")
    boom = m.link("boom", length=3.0, mass=150.0)
    m.revolute("foot", m.ground, boom)
    m.weld("grip", boom.tip, m.point_mass("weight", load))
    made = cylinder(
        m,
        "ram",
        m.ground.at(1.0, -0.2),
        boom.at(1.5, 0.1),
        closed=0.5,
        bore=0.1,
        rod=0.06,
        **options,
    )
    lifting = moves([move("60 deg", time=3.0)], start="10 deg")
    return made, Scene(m, {"foot": lifting}, t=(0, 3, 301), posture={"ram": 0.2}, drives=["ram"])


def test_a_cylinder_bears_what_virtual_work_says():
    """The force times the speed of the pins' distance is the load's power; pressures balance the
    force on both areas.
    """
    back = 4e5
    made, scene = hoist(back_pressure=back, barrel_mass=0.0, rod_mass=0.0)
    solution = evaluate(scene)
    assert solution.certified
    angle = solution.motion("foot")
    c, s = np.cos(angle.value), np.sin(angle.value)
    front = np.stack([1.5 * c - 0.1 * s - 1.0, 1.5 * s + 0.1 * c + 0.2])
    reach = np.hypot(*front)
    assert solution.motion("ram").value == pytest.approx(reach - 0.5, rel=1e-12)
    inertia = 150.0 * 9.0 / 3 + 800.0 * 9.0
    moment = inertia * angle.acceleration + 9.81 * c * (150.0 * 1.5 + 800.0 * 3.0)
    arm = (-front[0] * (1.5 * s + 0.1 * c) + front[1] * (1.5 * c - 0.1 * s)) / reach
    force = solution.effort("ram")
    assert force == pytest.approx(moment / arm, rel=1e-10)
    cap, ring = math.pi / 4 * 0.1**2, math.pi / 4 * (0.1**2 - 0.06**2)
    pressures = solution.output("ram_cap_pressure"), solution.output("ram_rod_pressure")
    assert pressures[0] * cap - pressures[1] * ring == pytest.approx(force, rel=1e-12)
    assert np.minimum(*pressures) == pytest.approx(back, rel=1e-12)
    assert (made.cap_area, made.rod_area) == pytest.approx((cap, ring))
    assert solution.output("ram_flow") == pytest.approx(
        cap * solution.motion("ram").rate, rel=1e-12
    )
    assert solution.output("ram_power") == pytest.approx(
        force * solution.motion("ram").rate, rel=1e-12
    )


def test_a_cylinder_that_does_not_drive_bears_no_force():
    """Another joint lifts the boom; the oil goes to and fro, under the back pressure alone."""
    back = 4e5
    made, driven = hoist(back_pressure=back)
    solution = evaluate(
        Scene(driven.mechanism, driven.motion, t=driven.t, posture=driven.posture, drives=["foot"])
    )
    assert solution.certified
    pressures = solution.output("ram_cap_pressure"), solution.output("ram_rod_pressure")
    assert np.all(pressures[0] == back)
    assert pressures[1] == pytest.approx(back * made.cap_area / made.rod_area, rel=1e-12)
    assert solution.output("ram_flow") == pytest.approx(
        made.cap_area * solution.motion("ram").rate, rel=1e-12
    )
    assert np.all(solution.output("ram_power") == 0.0)


def test_a_cylinder_that_pulls_works_on_its_rod_side():
    """The boom is lifted from above, so the rod pulls."""
    m = Mechanism("hung")
    boom = m.link("boom", length=3.0, mass=150.0)
    m.revolute("foot", m.ground, boom)
    cylinder(
        m,
        "ram",
        m.ground.at(0.3, 2.5),
        boom.at(2.0),
        closed=0.8,
        bore=0.1,
        rod=0.06,
        back_pressure=1e5,
    )
    scene = Scene(
        m, {"foot": harmonic(0.0, 0.2, 0.2)}, t=(0, 5, 51), posture={"ram": 1.0}, drives=["ram"]
    )
    solution = evaluate(scene)
    assert (solution.effort("ram") < 0.0).all()
    cap, ring = math.pi / 4 * 0.1**2, math.pi / 4 * (0.1**2 - 0.06**2)
    assert solution.output("ram_rod_pressure") == pytest.approx(
        (1e5 * cap - solution.effort("ram")) / ring, rel=1e-12
    )
    assert solution.output("ram_cap_pressure") == pytest.approx(1e5, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            {"bore": 0.05, "rod": 0.06},
            "cylinder 'ram': its rod must be thinner than its bore, got 0.06 m in 0.05 m",
        )
    ],
)
def test_cylinders_that_cannot_be(options, says):
    m = Mechanism("m")
    link = m.link("link", length=1.0, mass=1.0)
    with pytest.raises(DeclarationError, match=says):
        cylinder(m, "ram", m.ground, link.tip, closed=0.5, **options)

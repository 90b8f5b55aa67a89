"""A machine left to itself: against closed forms, textbooks, and Dymola's results of a model of the
Modelica library.
"""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from mechanisms import crank_slider, four_bar, pins_of

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    evaluate,
    flywheel,
    forward,
    free,
    load_case,
)
from lagrange_casadi.errors import DeclarationError, LagrangeCasadiError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def elliptic(k):
    """The complete elliptic integral of the first kind, by the arithmetic-geometric mean."""
    a, b = 1.0, math.sqrt(1.0 - k * k)
    for _ in range(40):
        a, b = (a + b) / 2.0, math.sqrt(a * b)
    return math.pi / (2.0 * a)


def rotor(inertia=0.5, stop=2.0, rolls=False):
    m = Mechanism("rotor")
    m.set_gravity(0.0, 0.0)
    disc = m.link("disc", length=0.2, mass=3.0, centre=(0.0, 0.0), inertia=inertia)
    pin = m.revolute("O", m.ground, disc)
    if rolls:
        m.nonholonomic("roll", m.rate(pin), replaces=pin)
    return Scene(m, {"O": polynomial(0.0, 10.0)}, t=(0.0, stop, 41))


def slider_crank(motion, friction=0.0, **posture):
    m = crank_slider(lengths=(0.1, 0.3))
    if friction:
        m.friction("rub", m.joints["guide"], mu=friction)
    return Scene(m, motion, t=(0.0, 1.0, 101), posture=posture or {"rod": 0.0})


def plane(angle, mu, rate):
    """A block on a plane that falls by an angle."""
    m = Mechanism("plane")
    block = m.point_mass("block", 2.0)
    guide = m.prismatic("guide", m.ground, block, axis=(math.cos(angle), -math.sin(angle)))
    m.friction("rub", guide, mu=mu)
    return Scene(m, {"guide": polynomial(0.0, rate)}, t=(0.0, 2.0, 201))


def test_a_pendulum_swings_with_the_period_of_the_elliptic_integral():
    m = Mechanism("pendulum")
    rod = m.link("rod", length=1.0, mass=2.0)
    m.revolute("O", m.ground, rod)
    amplitude = 2.0
    found = free(
        Scene(m, {"O": polynomial(0.0)}, t=(1.0, 7.0, 301)), start=(amplitude - math.pi / 2, 0.0)
    )
    half = 2.0 * elliptic(math.sin(amplitude / 2.0)) / math.sqrt(1.5 * 9.81)
    assert [event.t for event in found.events] == pytest.approx(
        [1.0 + half * k for k in range(1, 6)], rel=1e-11
    )
    assert {event.kind for event in found.events} == {"rest"}
    assert found.ended is None
    assert found.energy.max() < 1e-11
    solution, motion = found.solution, found.solution.motion("O")
    assert solution.certified
    assert np.abs(motion.value - found.angle).max() < 1e-13
    assert np.abs(motion.rate - found.speed).max() < 1e-13
    assert np.abs(motion.acceleration - found.acceleration).max() < 1e-13
    # The hinge carries the weight and turns the centre: m (a + w^2 r) along the rod.
    along = found.angle
    pull = 2.0 * (9.81 * np.sin(along) - found.speed**2 * 0.5)
    radial = solution.reaction("O").fx * np.cos(along) + solution.reaction("O").fy * np.sin(along)
    assert np.abs(radial - pull).max() < 1e-9


def test_a_motor_runs_up_along_an_exponential():
    """And its torque is the one on the joint, less what turns the flywheel."""
    motor = forward.dc_motor(6.0, 40.0)
    found = free(rotor(), drive=motor, load=1.5, inertia=0.25, start=(0.0, 0.0))
    end, tau = 30.0, 0.75 * 40.0 / 6.0
    exact = end * (1.0 - np.exp(-found.t / tau))
    assert np.abs(found.speed - exact).max() < 1e-10
    assert np.abs(found.angle - (end * found.t - tau * exact)).max() < 1e-10
    effort = found.solution.effort("O")
    assert np.abs(effort - 0.5 * (end - exact) / tau).max() < 1e-10
    assert found.solution.certificate["drive"].max() < 1e-13
    geared = free(rotor(), drive=forward.dc_motor(2.0, 120.0).geared(3.0), load=1.5, inertia=0.25)
    same = free(rotor(), drive=motor, load=1.5, inertia=0.25)
    assert np.abs(geared.speed - same.speed).max() < 1e-10


def test_laws_have_the_torques_of_their_formulas():
    laws = {
        forward.torque(3.0): (3.0, 3.0),
        forward.power(60.0): (6.0, 3.0),
        forward.torque_curve([0.0, 10.0, 30.0], [4.0, 5.0, 1.0]): (5.0, 3.0),
        # Kloss: at the breakdown slip the breakdown torque, at twice the slip 4/5 of it.
        forward.induction_motor(7.0, 0.25, 40.0 / 3.0): (7.0, -2.0 * 7.0 / (0.5 + 2.0)),
        forward.expression(lambda t, angle, speed: 0.1 * speed + angle - t): (1.0, 2.0),
    }
    for law, torques in laws.items():
        for speed, expected in zip((10.0, 20.0), torques, strict=True):
            value = law.graph(ca.SX(0.0), ca.SX(0.0), ca.SX(speed))
            assert float(value) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("fluctuation", "speed"), [(0.02, 10.0), (0.3, -10.0)])
def test_a_flywheel_holds_a_fluctuation_by_elliptic_integrals(fluctuation, speed):
    """Under a torque that goes with the sine w^2 = A + B cos(phi), B = 2 T/I."""
    torque = 8.0
    found = flywheel(
        rotor(),
        fluctuation=fluctuation,
        load=forward.expression(lambda t, angle, speed: 5.0 + torque * ca.sin(angle)),
        start=(0.0, speed),
        count=41,
    )
    cycle, whole = found.motion.cycle, found.inertia + 0.5
    swing = 2.0 * torque / whole
    base = cycle.largest**2 - swing
    assert cycle.least**2 == pytest.approx(base - swing, rel=1e-9)
    period = 4.0 * elliptic(math.sqrt(2.0 * swing / (base + swing))) / math.sqrt(base + swing)
    assert cycle.period == pytest.approx(period, rel=1e-9)
    assert cycle.period == pytest.approx(math.tau / abs(speed), rel=1e-9)
    assert cycle.fluctuation == pytest.approx(fluctuation, rel=1e-8)
    assert cycle.torque == pytest.approx(5.0, rel=1e-9)
    assert found.energy == pytest.approx(2.0 * torque, rel=1e-9)
    assert found.textbook == pytest.approx(2.0 * torque / (fluctuation * speed**2), rel=1e-9)
    assert found.textbook == pytest.approx(whole, rel=fluctuation)


def test_a_punch_slows_a_motor_as_a_textbook_prints():
    """Budynas and Nisbett's solutions to Shigley's Mechanical Engineering Design, chapter 16, page
    417: a motor of T = 2690.4 - 21.41 w turns 110.72 lbf in s^2; a punch takes 1560 lbf in, which
    slows it from 124.41 to 117.81 rad/s, a fluctuation of 0.0545. That the punch lasts 0.5 s of
    each 10 s was inferred from these numbers.
    """
    motor = forward.expression(lambda t, angle, speed: 2690.4 - 21.41 * speed)
    punch = forward.expression(lambda t, angle, speed: 1560.0 * (t < 0.5))
    found = free(rotor(110.72), drive=motor, load=punch, start=(0.0, 124.41), t=(0.0, 10.0, 201))
    assert found.speed[10] == pytest.approx(117.81, abs=0.01)
    assert found.speed[-1] == pytest.approx(124.41, abs=0.01)
    assert np.ptp(found.speed) / found.speed[[0, 10]].mean() == pytest.approx(0.0545, abs=1e-4)


def test_friction_stops_a_block_where_it_must_and_holds_it():
    """Also at an instant, which has then no friction of its own."""
    slope = math.atan(0.3)
    for mu, rate in ((0.3, 3.0), (0.75, 0.75 * 9.81)):
        found, stop = free(plane(0.0, mu, rate)), rate / (mu * 9.81)
        assert found.ended.kind == "held"
        assert found.ended.t == pytest.approx(stop, rel=1e-10)
        assert found.ended.angle == pytest.approx(rate * stop / 2.0, rel=1e-10)
        assert found.t[-1] < stop
        assert found.solution.certified
    with pytest.raises(LagrangeCasadiError, match="held at t = 0 s"):
        free(plane(0.99 * slope, 0.3, 0.0))
    falling = free(plane(1.5 * slope, 0.3, 0.0))
    rate = 9.81 * (math.sin(1.5 * slope) - 0.3 * math.cos(1.5 * slope))
    assert np.abs(falling.speed - rate * falling.t).max() < 1e-10
    assert free(plane(0.9 * slope, 0.3, 0.0), drive=-15.0).speed[-1] < 0.0


def test_a_dead_centre_ends_a_run():
    found = free(slider_crank({"guide": polynomial(0.35, 1.0)}, crank=0.9))
    assert found.ended.kind == "dead centre"
    assert found.ended.angle == pytest.approx(0.4, abs=1e-6)
    assert found.t[-1] <= found.ended.t
    assert found.energy.max() < 1e-9


def test_a_run_begins_in_the_assembly_that_its_scene_has_there():
    """Half a turn on, where the other assembly is nearer to the posture of the scene."""
    scene = four_bar((0.3, 0.25, 0.35), frame=(0.1, 0.0), rocker=1.0)
    scene = replace(scene, motion={"O": polynomial(0.0, math.pi)}, t=(0.0, 1.0, 101))
    found = free(scene, start=(math.pi, 1.0))
    expected = evaluate(scene).motion("C").value[-1]
    assert abs(math.remainder(found.solution.motion("C").value[0] - expected, math.tau)) < 1e-9


def test_a_jam_ends_a_run():
    """Where the rod leans by the angle of friction."""
    found = free(slider_crank({"O": polynomial(0.3)}, 4.0), drive=2.0, start=(0.3, 20.0))
    assert (found.ended.kind, found.ended.joints) == ("jam", "'guide'")
    leans = math.asin(3.0 * math.sin(math.atan(1.0 / 4.0)))
    assert found.ended.angle == pytest.approx(leans, rel=1e-9)


def steel(length, diameter, along):
    """Mass, inertia about the centre of a cylinder of steel, its axis along a unit vector."""
    mass = 7700.0 * math.pi * length * diameter**2 / 4.0
    across = mass * (length**2 + 0.75 * diameter**2) / 12.0
    outer = np.outer(along, along)
    return mass, mass * diameter**2 / 8.0 * outer + across * (np.eye(3) - outer)


FOURBAR = {
    "b1": ((0.0, 0.0, 0.0), (0.0, 0.5, 0.1)),
    "b2": ((1.0, 0.0, 0.0), (1.0, 0.2, 0.0)),
    "b3": ((1.0, 0.2, 0.0), (0.0, 0.5, 0.1)),
}


def fourbar():
    """Modelica.Mechanics.MultiBody.Examples.Loops.Fourbar1, of the Modelica Standard Library."""
    m = SpatialMechanism("fourbar")
    m.set_gravity(0.0, -9.80665, 0.0)
    links = {}
    for name, (base, tip) in FOURBAR.items():
        r = np.subtract(tip, base)
        length = float(np.linalg.norm(r))
        mass, inertia = steel(length, 0.05, r / length)
        centre = tuple(np.add(base, tip) / 2.0)
        inertia = tuple(map(tuple, inertia))
        links[name] = m.link(name, between=(base, tip), mass=mass, centre=centre, inertia=inertia)
    b1, b2, b3 = links.values()
    m.revolute("j1", m.ground, b1, axis=(1.0, 0.0, 0.0), at=(0.0, 0.0, 0.0))
    m.prismatic("j2", m.ground, b2, axis=(1.0, 0.0, 0.0), at=(1.0, 0.0, 0.0))
    m.universal("rev", b2, b3, axis=(0.0, 1.0, 0.0), second=(0.0, 0.0, 1.0), at=(1.0, 0.2, 0.0))
    m.spherical("ball", b1, b3, at=(0.0, 0.5, 0.1))
    return Scene(m, {"j1": polynomial(0.0, 5.235987755982989)}, t=(0.0, 5.0, 51), wanted=["effort"])


def test_a_spatial_four_bar_moves_as_dymola_says():
    """Dymola's run of the Modelica Standard Library's Fourbar1, interval 1 ms, whose integration
    loses energy all the way; here none is lost.
    """
    found = free(fourbar())
    dymola = {
        1.0: (7.802133830694239, 9.361588417590532),
        2.5: (19.867257902157814, 7.829235325209652),
        5.0: (40.3282362223391, 11.739421903908035),
    }
    for time, state in dymola.items():
        k = int(np.argmin(np.abs(found.t - time)))
        assert (found.angle[k], found.speed[k]) == pytest.approx(state, rel=1e-4)
    assert found.energy.max() < 1e-10


def press():
    return load_case(CASES / "punch_press").scene


TWO = {"O": polynomial(0.0, 1.0), "A": polynomial(0.0, 1.0)}


def arm():
    m = Mechanism("arm")
    upper, lower = m.link("upper", length=0.3, mass=1.0), m.link("lower", length=0.3, mass=1.0)
    pins_of(m, O=(m.ground, upper), A=(upper.tip, lower))
    return Scene(m, TWO, t=(0.0, 1.0, 11))


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: free(arm()), "one degree of freedom, but in 'arm' 2 motions are given: O, A"),
        (lambda: free(rotor(), drive="fast"), "drive: expected a law of forward, or a number"),
        (
            lambda: free(rotor(), drive=forward.Law(lambda t, a: t)),
            "cannot be made as an expression",
        ),
        (lambda: free(rotor(0.0), drive=1.0), "nothing that 'O' moves has inertia; expected"),
        (
            lambda: free(slider_crank({"guide": polynomial(0.35)}, crank=0.9), start=(0.5, 0.0)),
            "the loops of 'slider_crank' do not close at 0.5, or are at a dead centre there",
        ),
        (
            lambda: free(
                press(),
                drive=forward.induction_motor(8.0, 0.2, 157.08).geared(25.0),
                inertia=60.0,
                start=(math.pi / 2, -6.0),
                steady=True,
                accuracy=1e-6,
            ),
            "'punch_press' stalls, because it loses speed each turn: from -",
        ),
        (lambda: free(rotor(), start=(0.0,)), r"start: expected \(coordinate, rate\)"),
        (
            lambda: free(rotor(), drive=forward.power(9.0), start=(0.0, 0.0)),
            "the law of its drive is not finite at the start",
        ),
        (
            lambda: free(
                rotor(), drive=forward.expression(lambda t, a, w: -50.0 * ca.sign(w - 9.0))
            ),
            "reached t = 0.01.* s, rate 9; the law of the drive or of a load is stiff",
        ),
        (lambda: forward.dc_motor(5.0, -30.0), "torque and speed must have one sign"),
        (lambda: forward.induction_motor(5.0, 0.0, 30.0), "breakdown_slip must be positive"),
        (lambda: free(rotor(), drive=5.0, steady=True), "nothing in it depends on the speed"),
        (lambda: free(rotor(), steady=True, t=(0, 1, 5)), "t and steady exclude each other"),
        (
            lambda: free(
                rotor(), drive=forward.dc_motor(5.0, 30.0), load=5.5, steady=True, accuracy=1e-6
            ),
            "'rotor' stalls, because it loses speed each turn: from",
        ),
        (
            lambda: free(
                rotor(), load=forward.expression(lambda t, a, w: ca.cos(a / 2.0)), steady=True
            ),
            "does not repeat after 6.28319 rad: its effort",
        ),
        (
            lambda: free(rotor(), load=forward.expression(lambda t, a, w: t), steady=True),
            "depends on the time",
        ),
        (lambda: free(plane(0.1, 0.3, 1.0), steady=True), "'guide' slides"),
        (lambda: free(rotor(), t=(0, 0, 1)), "t: a free machine needs two instants or more"),
        (lambda: free(rotor(), inertia=-1.0), "inertia: expected a number of at least 0, got -1"),
        (
            lambda: free(rotor(), drive=forward.expression(lambda t, a, w: ca.sqrt(0.5 - t))),
            "its motion cannot be followed beyond t = 0.[45]",
        ),
        (
            lambda: free(
                rotor(),
                drive=forward.expression(lambda t, a, w: 1 + w**2),
                steady=True,
                accuracy=1e-6,
            ),
            "no steady cycle was found near .*; the machine gains speed each turn",
        ),
        (lambda: free(rotor(), steady=True, start=(0.0, 0.0)), "the speed at the start is 0"),
        (lambda: flywheel(rotor(), load=1.0), "needs no flywheel"),
        (
            lambda: free(four_bar(drives=["C"])),
            "is driven at the joint whose motion is given, 'O', but drives= names C",
        ),
        (
            lambda: free(rotor(rolls=True)),
            "non-holonomic constraints of 'rotor' are out of scope: roll",
        ),
    ],
)
def test_what_is_none_is_refused_by_name(ask, message):
    with pytest.raises((DeclarationError, LagrangeCasadiError), match=message):
        ask()

"""Gears, users' constraints and non-holonomic rows: their multipliers, and what
these do to links.
"""

import math

import casadi as ca
import numpy as np
import oracle
import pytest
from balance import assert_balanced
from internals import DesignEngine
from mechanisms import INSTANT, MOTION

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import expression, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize("turns", [0.0, 40.0])
def test_gears_count_turns(turns):
    """Two wheels and a crank-rocker on the second; the ratio is no whole number, so whole turns
    matter.
    """
    m = Mechanism("geared")
    wheel, a, b, c = (
        m.link(n, length=l, mass=w)
        for n, l, w in (("wheel", 0.05, 0.2), ("a", 0.1, 0.3), ("b", 0.35, 0.5), ("c", 0.25, 0.4))
    )
    first = m.revolute("G1", m.ground.at(-0.2, 0), wheel)
    second = m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    m.gear("mesh", first, second, ratio=-0.7, offset=0.3)
    scene = Scene(
        m,
        {"G1": polynomial(2 * math.pi * turns + 0.2, 3.0, 4.0)},
        posture={"c": 1.5},
        t=(INSTANT, 1, 2),
    )
    assert derive(scene).newton is None

    def gap(place):
        return place(("a", 0, 0))[2] - (-0.7) * place(("wheel", 0, 0))[2] - 0.3

    def effect(_):
        return [(("a", 0.0, 0.0), 0.0, 0.0, 1.0), (("wheel", 0.0, 0.0), 0.0, 0.0, 0.7)]

    wheel_at = 2 * math.pi * turns + 0.2 + 3.0 * INSTANT + 4.0 * INSTANT**2
    rough = {"wheel": wheel_at, "a": 0.3 - 0.7 * wheel_at}
    assert_balanced(scene, extras=[oracle.Extra("mesh", gap, effect)], nudge=1e-3, rough=rough)


def test_any_constraint_of_the_users():
    """Phi(q, t) that no table of joints has: the heights of two sliders multiply to a function of
    time.
    """
    m = Mechanism("product")
    p, q = m.point_mass("p", 0.5), m.point_mass("q", 0.8)
    x = m.coordinate(m.prismatic("X", m.ground, p, axis=(1, 0)))
    y = m.coordinate(m.prismatic("Y", m.ground, q, axis=(0, 1)))
    m.constraint("product", x * y - 1.0 - 0.1 * ca.sin(m.time))
    scene = Scene(m, {"X": polynomial(1.0, 0.5, 0.2)}, posture={"Y": 1.0}, t=(0, 1, 11))
    solution = evaluate(scene)
    t, place, rate, acc = (
        solution.t,
        *(getattr(solution.motion("X"), k) for k in ("value", "rate", "acceleration")),
    )
    s, sd, sdd = 1 + 0.1 * np.sin(t), 0.1 * np.cos(t), -0.1 * np.sin(t)
    height = s / place
    height_rate = (sd - height * rate) / place
    height_acc = (sdd - 2 * height_rate * rate - height * acc) / place
    np.testing.assert_allclose(solution.motion("Y").value, height, rtol=1e-13)
    np.testing.assert_allclose(solution.motion("Y").rate, height_rate, rtol=1e-12)
    np.testing.assert_allclose(solution.motion("Y").acceleration, height_acc, rtol=1e-11)
    # 0.8 (y'' + g) = lambda x, and the drive gives 0.5 x'' - lambda y.
    multiplier = 0.8 * (height_acc + 9.81) / place
    np.testing.assert_allclose(solution.multiplier("product"), multiplier, rtol=1e-12)
    np.testing.assert_allclose(solution.effort("X"), 0.5 * acc - multiplier * height, rtol=1e-11)


def sleigh(lead=0.0):
    """A body on a skate: x, y and its heading are prescribed; the blade takes the place of the
    drive of y. It carries a boom.
    """
    m = Mechanism("sleigh")
    m.set_gravity(0.0, 0.0)
    cross, pivot = m.link("cross", length=0.1, mass=0.0), m.link("pivot", length=0.1, mass=0.0)
    body, boom = m.link("body", length=0.4, mass=2.0), m.link("boom", length=0.8, mass=0.5)
    m.prismatic("X", m.ground, cross, axis=(1, 0))
    across = m.prismatic("Y", cross, pivot, axis=(0, 1))
    m.revolute("turn", pivot, body)
    m.weld("stem", body.tip, boom, angle=1.0)
    vx, vy = m.velocity(body)
    q = m.direction(body)
    m.nonholonomic("blade", -ca.sin(q) * vx + ca.cos(q) * vy, replaces=across)
    laws = {
        "X": expression(lambda t: 2.0 * ca.sin(0.5 * t)),
        "Y": expression(lambda t: 2.0 - 2.0 * ca.cos(0.5 * t)),
        "turn": polynomial(lead, 0.5),
    }
    return Scene(m, laws, t=(0.2, 3.0, 15))


def test_non_holonomic_row():
    def effect(place):
        phi = place(("body", 0.0, 0.0))[2]
        return [(("body", 0.0, 0.0), -math.sin(phi.v), math.cos(phi.v), 0.0)]

    for t in (0.2, 1.3, 2.9):
        assert_balanced(sleigh(), t=t, extras=[oracle.Extra("blade", None, effect)], unaided=["Y"])
    solution = evaluate(sleigh())
    with pytest.raises(DeclarationError, match="unknown drive 'Y'; valid: X, turn"):
        solution.effort("Y")
    assert np.max(np.abs(solution.section("boom").bending)) > 0.05


def prop(x, y=0.0, level=False):
    """A driven link on a spring-less prop: a point of another link, hinged to the first, is held at
    a height.
    """
    m = Mechanism("prop")
    a, b = m.link("a", length=0.5, mass=1.0), m.link("b", length=0.8, mass=2.0)
    m.revolute("O", m.ground, a)
    m.revolute("A", b.at(0.2), a.tip)
    if level:
        m.constraint("hold", m.direction(b) - 0.3)
    else:
        m.constraint("hold", m.place(b.at(x, y))[1] - 0.45 - 0.1 * ca.sin(m.time))
    return Scene(m, {"O": MOTION}, posture={"b": 0.2}, t=(INSTANT, 1, 2))


@pytest.mark.parametrize(("x", "y"), [(0.6, 0.0), (0.55, 0.1), (0.05, -0.1), (0.8, 0.0)])
def test_a_constraint_on_a_place_loads_the_link_there(x, y):
    def gap(place):
        return (
            place(("b", x, y))[1]
            - 0.45
            - 0.1 * oracle.Jet(math.sin(INSTANT), math.cos(INSTANT), -math.sin(INSTANT))
        )

    assert_balanced(
        prop(x, y), extras=[oracle.Extra("hold", gap, lambda _: [(("b", x, y), 0.0, 1.0, 0.0)])]
    )
    certificate = evaluate(prop(x, y)).certificate
    assert max(np.max(certificate[k]) for k in ("balance", "power", "ends", "closure")) < 1e-13


def test_a_constraint_on_a_direction_turns_the_link_at_its_base():
    def gap(place):
        return place(("b", 0.0, 0.0))[2] - 0.3

    assert_balanced(
        prop(0, level=True),
        extras=[oracle.Extra("hold", gap, lambda _: [(("b", 0.0, 0.0), 0.0, 0.0, 1.0)])],
    )


def test_a_gear_between_a_link_and_what_it_carries_bends_it():
    """A planet at the arm's tip is geared to the arm's own hinge: the arm carries the gear's
    torque.
    """
    m = Mechanism("planetary")
    m.set_gravity(0.0, 0.0)
    arm, planet = (
        m.link("arm", length=0.5, mass=1.0),
        m.link("planet", length=0.1, mass=0.5, centre=(0.0, 0.0), inertia=0.03),
    )
    first = m.revolute("O", m.ground, arm)
    second = m.revolute("P", arm.tip, planet)
    m.gear("mesh", first, second, ratio=3.0)
    m.torque("brake", planet, 7.0)
    scene = Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2))

    def gap(place):
        return (place(("planet", 0, 0))[2] - place(("arm", 0, 0))[2]) - 3.0 * place(("arm", 0, 0))[
            2
        ]

    def effect(_):
        return [
            (("planet", 0.0, 0.0), 0.0, 0.0, 1.0),
            (("arm", 0.5, 0.0), 0.0, 0.0, -1.0),
            (("arm", 0.0, 0.0), 0.0, 0.0, -3.0),
        ]

    extras = [oracle.Extra("mesh", gap, effect)]
    assert_balanced(
        scene,
        extras=extras,
        loads=[lambda _: [(("planet", 0.0, 0.0), 0.0, 0.0, 7.0)]],
        rough={"planet": 1.46 * 4},
    )
    solution = evaluate(scene)
    assert abs(solution.section("arm").bending[0, -1]) > 1.0
    assert np.max(solution.certificate["balance"]) < 1e-14


def test_a_row_at_a_station_loads_the_link_there():
    m = Mechanism("skid")
    m.set_gravity(0.0, 0.0)
    cross, pivot, body = (
        m.link("cross", length=0.1, mass=0.0),
        m.link("pivot", length=0.1, mass=0.0),
        m.link("body", length=1.0, mass=2.0),
    )
    m.prismatic("X", m.ground, cross, axis=(1, 0))
    across = m.prismatic("Y", cross, pivot, axis=(0, 1))
    m.revolute("turn", pivot, body)
    vy = m.velocity(body.at(0.4))[1]
    m.nonholonomic("skid", vy, replaces=across)
    laws = {"X": polynomial(0, 1.0, 0.3), "turn": polynomial(0.2, 0.7)}
    laws["Y"] = expression(lambda t: -0.4 * ca.sin(0.2 + 0.7 * t))
    scene = Scene(m, laws, t=(INSTANT, 1, 5))
    extras = [oracle.Extra("skid", None, lambda _: [(("body", 0.4, 0.0), 0.0, 1.0, 0.0)])]
    assert_balanced(scene, extras=extras, unaided=["Y"])


def test_motion_that_violates_a_row_is_refused():
    with pytest.raises(
        AssemblyError,
        match=r"non-holonomic constraint 'blade' by -0\.0\d+ at t = 0\.2 s, where X = 0\.19",
    ):
        evaluate(sleigh(lead=0.1))


def test_a_row_must_replace_a_drive():
    base = sleigh()
    with pytest.raises(
        DeclarationError,
        match="constraint 'blade' replaces the drive of joint 'Y', which has no motion",
    ):
        Scene(base.mechanism, {"X": polynomial(0), "turn": polynomial(0)})


def test_a_row_along_which_nothing_goes_is_not_violated():
    """A skate that starts along an inclined axis: what is added up in its row is rounding, term by
    term, and its speed is not.
    """
    m = Mechanism("sleigh")
    cross, pivot, body = (m.link(n, length=0.1, mass=1.0) for n in ("cross", "pivot", "body"))
    m.prismatic("X", m.ground, cross, axis=(0.0, -1.0), angle=-2.513896326794897)
    across = m.prismatic(
        "Y", cross, pivot, axis=(-0.8093825600407514, 0.58728176500031), angle=1.5437
    )
    m.revolute("Z", pivot, body)
    vx, vy = m.velocity(body)
    q = m.direction(body)
    m.nonholonomic("blade", -ca.sin(q) * vx + ca.cos(q) * vy, replaces=across)
    laws = {
        "X": expression(lambda t: 0.55 * ca.sin(0.35 * t)),
        "Y": expression(lambda t: 0.55 - 0.55 * ca.cos(0.35 * t)),
        "Z": expression(lambda t: -0.6006 + 0.35 * t),
    }
    scene = Scene(m, laws, t=(0, 0.05, 2))
    assert evaluate(scene).certified
    assert DesignEngine.of(scene, ["effort"]).evaluate(np.zeros((1, 0))).status == 0


def towed(drives):
    """A body on a skate whose nose is held by an arm of two links: the motion is the skate's, and
    the arm may make it.
    """
    m = Mechanism("towed")
    m.set_gravity(0.4, -0.3)
    cross, pivot = m.link("cross", length=0.1, mass=0.1), m.link("pivot", length=0.1, mass=0.2)
    body, upper, lower = (
        m.link(name, length=l, mass=w)
        for name, l, w in (("body", 0.4, 2.0), ("upper", 1.6, 0.7), ("lower", 1.5, 0.5))
    )
    m.prismatic("X", m.ground, cross, axis=(1, 0))
    across = m.prismatic("Y", cross, pivot, axis=(0, 1))
    turn = m.revolute("turn", pivot, body)
    m.revolute("shoulder", m.ground.at(0.3, -1.2), upper)
    m.revolute("elbow", upper.tip, lower)
    m.revolute("nose", body.tip, lower.tip)
    vx, vy = m.velocity(body)
    q = m.direction(body)
    m.nonholonomic("blade", -ca.sin(q) * vx + ca.cos(q) * vy, replaces=across)
    m.torque("drag", body, -0.3 * m.rate(turn))
    laws = {
        "X": expression(lambda t: 2.0 * ca.sin(0.5 * t)),
        "Y": expression(lambda t: 2.0 - 2.0 * ca.cos(0.5 * t)),
        "turn": polynomial(0.0, 0.5),
    }
    return Scene(m, laws, t=(0.2, 1.4, 15), posture={"upper": 0.2, "lower": 2.2}, drives=drives)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "drives",
    [("shoulder", "elbow"), ("X", "shoulder"), ("turn", "elbow"), ("Y", "turn"), ("nose", "Y")],
)
def test_a_non_holonomic_row_leaves_the_motion_to_drives_elsewhere(drives):
    """The blade holds sideways; two drives anywhere do the rest, that which the blade replaces too
    where it is named.
    """

    def effect(place):
        phi = place(("body", 0.0, 0.0))[2]
        return [(("body", 0.0, 0.0), -math.sin(phi.v), math.cos(phi.v), 0.0)]

    def drag(_):
        return [(("body", 0.0, 0.0), 0.0, 0.0, -0.15)]

    for t in (0.2, 0.9, 1.4):
        assert_balanced(
            towed(drives), t=t, extras=[oracle.Extra("blade", None, effect)], loads=[drag]
        )
    solution = evaluate(towed(drives))
    assert solution.certified
    assert {"balance", "power", "ends"} <= set(solution.certificate)
    assert {q.part for q in solution.outputs if q.group == "effort"} == set(drives)
    usual = evaluate(towed(None))
    power = [
        sum(s.effort(j) * s.motion(j).rate for j in joints)
        for s, joints in ((usual, ("X", "turn")), (solution, drives))
    ]
    assert np.abs(power[1] - power[0]).max() < 1e-12 * np.abs(power[0]).max()


def test_a_constraint_whose_slope_has_no_value_at_some_parameters():
    """The arc sine of a ratio has one only up to one: what stands beside it is in the equation all
    the same.
    """
    m = Mechanism("tied")
    ratio = m.parameter("ratio", 0.4, low=0.0, high=0.9)
    a, b = m.link("a", length=0.3, mass=1.0), m.link("b", length=0.2, mass=0.5)
    first, second = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1.0, 0.0), b)
    m.constraint("tie", ca.asin(ratio) * m.coordinate(second) - m.coordinate(first))
    solution = evaluate(Scene(m, {"A": polynomial(0.2, 0.5)}, t=(0, 1, 5), posture={"b": 0.5}))
    assert solution.certified
    assert solution.motion("B").value == pytest.approx(
        solution.motion("A").value / math.asin(0.4), rel=1e-13
    )

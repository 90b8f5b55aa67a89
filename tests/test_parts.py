"""Links as they are, joints of every kind, loads, constraints and rows: each against vector Newton-Euler."""

import math

import casadi as ca
import numpy as np
import oracle
import pytest
from builders import INSTANT, MOTION, compare, instant_at

from lagrange_casadi import Mechanism, Scene, density, derive, evaluate, table
from lagrange_casadi.errors import AssemblyError, DeclarationError, MobilityError, ParameterError
from lagrange_casadi.motion import expression, polynomial

TOLERANCE = 1e-12


def assert_balanced(scene, **keywords):
    worst, gap = compare(scene, **keywords)
    assert gap < TOLERANCE, worst


def crank_and_rod(rod, crank=None, loads=lambda m, parts: None, **link):
    """A crank drives a rod whose tip slides on the x axis; the rod is declared by its keywords."""
    m = Mechanism("test")
    a = m.link("a", length=0.1, **(crank or {"mass": 0.3}))
    b = m.link("b", length=0.35, **rod)
    s = m.point_mass("s", 0.6)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, s)
    m.prismatic("P", m.ground.at(0, 0.02), s, axis=(1, 0))
    loads(m, {"a": a, "b": b, "s": s})
    return Scene(m, {"O": MOTION}, posture={"b": 0.0}, t=(INSTANT, 1, 2))


@pytest.mark.parametrize(
    "rod",
    [
        {"density": density.polynomial(2.0, -1.5)},
        {"density": density.polynomial(1.0, 3.0, -2.0, 0.5)},
        {"density": density.tabulated([0, 0.2, 0.25, 0.9, 1], [1.0, 3.0, 0.5, 0.5, 4.0])},
        {"mass": 0.7, "centre": (0.12, -0.03), "inertia": 0.011},
    ],
    ids=["tapered", "cubic", "table", "rigid"],
)
def test_links_of_every_density(rod):
    assert_balanced(crank_and_rod(rod))


def test_density_may_depend_on_parameters():
    m = Mechanism("taper")
    tip = m.parameter("tip", 1.0, "kg/m")
    m.revolute("O", m.ground, m.link("a", length=m.parameter("l", 0.5, "m"), density=density.polynomial(2.0, tip - 2.0)))
    scene = Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2))
    for parameters in ({}, {"tip": 0.2}, {"tip": 3.0, "l": 0.8}):
        assert_balanced(scene, parameters=parameters)


def test_lumps_and_branches_at_stations():
    """Point masses welded on and beside the axis, a lever welded at an angle, and a pinned pendulum, on one link."""
    m = Mechanism("branched")
    a = m.link("a", length=0.6, mass=0.8)
    b = m.link("b", length=0.2, mass=0.2)
    c = m.link("c", length=0.3, mass=0.3)
    m.revolute("O", m.ground, a.at(0.15, 0.02))
    m.weld("on", a.at(0.3), m.point_mass("on_axis", 0.5))
    m.weld("beside", a.at(0.45, -0.1), m.point_mass("beside_axis", 0.4))
    m.weld("lever", a.at(0.5, 0.05), b, angle=0.7)
    m.revolute("pin", b.tip, c)
    m.weld("end", a.tip, m.point_mass("end_mass", 0.2))
    m.weld("base", a.base, m.point_mass("base_mass", 0.3))
    assert_balanced(Scene(m, {"O": MOTION, "pin": polynomial(0.3, -4.0, 2.0)}, t=(INSTANT, 1, 2)))


def test_one_sided_values_at_a_station():
    """A lump's weight is the jump of shear; both sides are there, and the grid takes the tip's side."""
    m = Mechanism("shelf")
    a = m.link("a", length=1.0, mass=0.0)
    m.weld("wall", m.ground, a)
    m.weld("lump", a.at(0.25), m.point_mass("mass", 2.0))
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 5)))
    law = solution.section("a").law
    at = np.array([[0.25]])
    assert law.at("shear", at, side="base")[0, 0] == pytest.approx(-2.0 * 9.81)
    assert law.at("shear", at, side="tip")[0, 0] == 0.0
    assert solution.section("a").shear[0].tolist() == pytest.approx([-19.62, 0, 0, 0, 0])
    assert law.at("bending", np.array([[0.0]]))[0, 0] == pytest.approx(-2.0 * 9.81 * 0.25)
    peak = solution.peak("section:a:shear")
    assert (peak.value, peak.xi) == pytest.approx((-19.62, 0.0))


def test_welded_assemblies_carry_their_moments():
    m = Mechanism("frame")
    a, b, c = (m.link(n, length=l, mass=w) for n, l, w in (("a", 0.3, 0.5), ("b", 0.2, 0.4), ("c", 0.25, 0.3)))
    m.revolute("O", m.ground, a)
    m.weld("W1", a.tip, b, angle=math.pi / 2)
    m.weld("W2", c, b.tip, angle=-0.4)
    m.weld("tool", c.tip, m.point_mass("tool_mass", 1.0))
    assert_balanced(Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2)))


@pytest.mark.parametrize("axis", [(1, 0), (0.9, 0.2)])
def test_pin_in_slot(axis):
    """A crank's pin slides in a rocker's slot; it loads the rocker where it is at the moment."""
    m = Mechanism("slotted")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.6, mass=0.5)
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(0.05, -0.3), b)
    m.slot("S", b, a.tip, axis=axis)
    scene = Scene(m, {"O": MOTION}, posture={"b": 1.5}, t=(INSTANT, 1, 2))
    assert derive(scene).newton is None
    assert_balanced(scene)
    solution = evaluate(scene)
    station = solution.section("b").law.loads[0].station
    np.testing.assert_allclose(station, solution.motion("S").value * axis[0] / math.hypot(*axis) / 0.6, rtol=1e-12)


def test_scotch_yoke_and_trammel():
    m = Mechanism("yoke")
    a, y = m.link("a", length=0.1, mass=0.3), m.link("y", length=0.3, mass=0.5)
    m.revolute("O", m.ground, a)
    m.prismatic("guide", m.ground, y, axis=(1, 0), angle=math.pi / 2)
    m.slot("S", y.at(0.1), a.tip, axis=(1, 0))
    scene = Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2))
    assert_balanced(scene)


def loads_on(m, parts):
    a, b, s = parts["a"], parts["b"], parts["s"]
    x, v = m.coordinate(m.joints["P"]), m.rate(m.joints["P"])
    m.force("gas", s, x=-50.0 * table(x, [0.2, 0.3, 0.4, 0.5], [5.0, 2.0, 1.0, 0.5]) - 3.0 * v)
    m.force("wind", b.at(0.2, 0.01), x=4.0 * ca.sin(7 * m.time), y=-2.0)
    m.force("follower", b.at(0.1), y=5.0, turning=True)
    m.torque("brake", b.at(0.25), 0.7, against=a.at(0.05))
    m.spring("spring", m.ground.at(0.2, 0.3), b.at(0.3, -0.02), stiffness=200.0, length=0.1, damping=4.0)
    m.spring("strut", a.tip, s, stiffness=90.0, length=0.2)
    m.damper("dashpot", m.ground.at(0.5, 0.1), b.tip, damping=2.5)
    m.torsion_spring("coil", m.joints["A"], stiffness=1.5, angle=0.2, damping=0.05)


def loads_beside(place):
    """The same loads, written again for the oracle."""
    t = INSTANT
    sx = place(("s", 0.0, 0.0))[0]
    x, v = sx.v, sx.d
    gas = -50.0 * float(np.interp(x, [0.2, 0.3, 0.4, 0.5], [5.0, 2.0, 1.0, 0.5])) - 3.0 * v
    phi = place(("b", 0.0, 0.0))[2]
    parts = [(("s", 0.0, 0.0), gas, 0.0, 0.0), (("b", 0.2, 0.01), 4.0 * math.sin(7 * t), -2.0, 0.0)]
    parts.append((("b", 0.1, 0.0), -5.0 * math.sin(phi.v), 5.0 * math.cos(phi.v), 0.0))
    parts += [(("b", 0.25, 0.0), 0.0, 0.0, 0.7), (("a", 0.05, 0.0), 0.0, 0.0, -0.7)]
    for p, q, k, rest, c in (
        (("ground", 0.2, 0.3), ("b", 0.3, -0.02), 200.0, 0.1, 4.0),
        (("a", 0.1, 0.0), ("s", 0.0, 0.0), 90.0, 0.2, 0.0),
        (("ground", 0.5, 0.1), ("b", 0.35, 0.0), 0.0, 0.0, 2.5),
    ):
        (px, py, _), (qx, qy, _) = place(p), place(q)
        d, e = (qx - px), (qy - py)
        length = math.hypot(d.v, e.v)
        tension = k * (length - rest) + c * (d.v * d.d + e.v * e.d) / length
        fx, fy = tension * d.v / length, tension * e.v / length
        parts += [(p, fx, fy, 0.0), (q, -fx, -fy, 0.0)]
    bend = phi - place(("a", 0.0, 0.0))[2]
    couple = -1.5 * (math.remainder(bend.v, 2 * math.pi) - 0.2) - 0.05 * bend.d
    parts += [(("b", 0.0, 0.0), 0.0, 0.0, couple), (("a", 0.1, 0.0), 0.0, 0.0, -couple)]
    return parts


def test_loads_of_every_kind():
    assert_balanced(crank_and_rod({"mass": 0.5}, loads=loads_on), loads=[loads_beside])


def test_loads_are_reported():
    solution = evaluate(crank_and_rod({"mass": 0.5}, loads=loads_on), wanted=["load:wind", "load:brake", "load:strut"])
    assert solution.array("load:wind:fx")[0] == pytest.approx(4.0 * math.sin(7 * INSTANT))
    assert solution.array("load:brake:mz").tolist() == [0.7, 0.7]
    assert set(solution.series) == {f"load:{n}:{k}" for n in ("wind", "brake", "strut") for k in ("fx", "fy", "mz")}


def test_drive_between_two_moving_links():
    """The coupler's own motor drives a four-bar: its torque acts on both links, with opposite signs."""
    m = Mechanism("inner_drive")
    a, b, c = (m.link(n, length=l, mass=w) for n, l, w in (("a", 0.2, 0.3), ("b", 0.35, 0.5), ("c", 0.25, 0.4)))
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    assert_balanced(Scene(m, {"A": polynomial(-1.2, 0.8, -0.5)}, posture={"a": 1.5, "c": 1.2}, t=(INSTANT, 1, 2)))


@pytest.mark.parametrize("turns", [0.0, 40.0])
def test_gears_count_turns(turns):
    """Two wheels and a crank-rocker on the second; the ratio is no whole number, so whole turns matter."""
    m = Mechanism("geared")
    wheel, a, b, c = (
        m.link(n, length=l, mass=w) for n, l, w in (("wheel", 0.05, 0.2), ("a", 0.1, 0.3), ("b", 0.35, 0.5), ("c", 0.25, 0.4))
    )
    first = m.revolute("G1", m.ground.at(-0.2, 0), wheel)
    second = m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    m.gear("mesh", first, second, ratio=-0.7, offset=0.3)
    scene = Scene(m, {"G1": polynomial(2 * math.pi * turns + 0.2, 3.0, 4.0)}, posture={"c": 1.5}, t=(INSTANT, 1, 2))
    assert derive(scene).newton is None

    def gap(place):
        return place(("a", 0, 0))[2] - (-0.7) * place(("wheel", 0, 0))[2] - 0.3

    def effect(_):
        return [(("a", 0.0, 0.0), 0.0, 0.0, 1.0), (("wheel", 0.0, 0.0), 0.0, 0.0, 0.7)]

    wheel_at = 2 * math.pi * turns + 0.2 + 3.0 * INSTANT + 4.0 * INSTANT**2
    rough = {"wheel": wheel_at, "a": 0.3 - 0.7 * wheel_at}
    assert_balanced(scene, extras=[oracle.Extra("mesh", gap, effect)], nudge=1e-3, rough=rough)


def test_any_constraint_of_the_users():
    """Phi(q, t) that no table of joints has: the heights of two sliders multiply to a function of time."""
    m = Mechanism("product")
    p, q = m.point_mass("p", 0.5), m.point_mass("q", 0.8)
    x = m.coordinate(m.prismatic("X", m.ground, p, axis=(1, 0)))
    y = m.coordinate(m.prismatic("Y", m.ground, q, axis=(0, 1)))
    m.constraint("product", x * y - 1.0 - 0.1 * ca.sin(m.time))
    scene = Scene(m, {"X": polynomial(1.0, 0.5, 0.2)}, posture={"Y": 1.0}, t=(0, 1, 11))
    solution = evaluate(scene)
    t, place, rate, acc = solution.t, *(getattr(solution.motion("X"), k) for k in ("value", "rate", "acceleration"))
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
    """A body on a skate: x, y and its heading are prescribed; the blade takes the place of the drive of y. It carries a boom."""
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
    """A driven link on a spring-less prop: a point of another link, hinged to the first, is held at a height."""
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
        return place(("b", x, y))[1] - 0.45 - 0.1 * oracle.Jet(math.sin(INSTANT), math.cos(INSTANT), -math.sin(INSTANT))

    assert_balanced(prop(x, y), extras=[oracle.Extra("hold", gap, lambda _: [(("b", x, y), 0.0, 1.0, 0.0)])])
    certificate = evaluate(prop(x, y)).certificate
    assert max(np.max(certificate[k]) for k in ("balance", "power", "ends", "closure")) < 1e-13


def test_a_constraint_on_a_direction_turns_the_link_at_its_base():
    def gap(place):
        return place(("b", 0.0, 0.0))[2] - 0.3

    assert_balanced(prop(0, level=True), extras=[oracle.Extra("hold", gap, lambda _: [(("b", 0.0, 0.0), 0.0, 0.0, 1.0)])])


def test_a_gear_between_a_link_and_what_it_carries_bends_it():
    """A planet at the arm's tip is geared to the arm's own hinge: the arm carries the gear's torque."""
    m = Mechanism("planetary")
    m.set_gravity(0.0, 0.0)
    arm, planet = m.link("arm", length=0.5, mass=1.0), m.link("planet", length=0.1, mass=0.5, centre=(0.0, 0.0), inertia=0.03)
    first = m.revolute("O", m.ground, arm)
    second = m.revolute("P", arm.tip, planet)
    m.gear("mesh", first, second, ratio=3.0)
    m.torque("brake", planet, 7.0)
    scene = Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2))

    def gap(place):
        return (place(("planet", 0, 0))[2] - place(("arm", 0, 0))[2]) - 3.0 * place(("arm", 0, 0))[2]

    def effect(_):
        return [(("planet", 0.0, 0.0), 0.0, 0.0, 1.0), (("arm", 0.5, 0.0), 0.0, 0.0, -1.0), (("arm", 0.0, 0.0), 0.0, 0.0, -3.0)]

    extras = [oracle.Extra("mesh", gap, effect)]
    assert_balanced(scene, extras=extras, loads=[lambda _: [(("planet", 0.0, 0.0), 0.0, 0.0, 7.0)]], rough={"planet": 1.46 * 4})
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
    with pytest.raises(AssemblyError, match=r"violates the non-holonomic row 'blade' by -0\.0\d+ at t = 0\.2 s, where X = 0\.19"):
        evaluate(sleigh(lead=0.1))


def parallelogram(third=1.0, pendulum=False):
    """Three equal cranks on one coupler: one of them is too many. The third is off the line of the others, so none is dead."""
    m = Mechanism("three_cranks")
    a, b, c = (m.link(n, length=0.2, mass=0.3) for n in "abc")
    bar = m.link("bar", length=1.0, mass=1.0)
    m.revolute("O", m.ground, a)
    m.revolute("P", m.ground.at(0.4, 0), b)
    m.revolute("Q", m.ground.at(third, 0.3), c)
    m.revolute("A", a.tip, bar)
    m.revolute("B", b.tip, bar.at(0.4))
    m.revolute("C", c.tip, bar.at(1.0, 0.3))
    motion = {"O": polynomial(0.7, 2.0)}
    if pendulum:
        m.revolute("hang", bar.at(0.7), m.link("bob", length=0.3, mass=0.4))
        motion["hang"] = polynomial(-1.5, 1.0)
    return Scene(m, motion, posture={"a": 0.7, "b": 0.7, "c": 0.7, "bar": 0.0}, t=(0, 3.0, 31))


def test_reactions_that_are_not_unique_are_named():
    solution = evaluate(parallelogram())
    open_ = {name.rpartition(":")[0] for name in solution.undetermined if name.startswith("reaction")}
    assert open_ == {f"reaction:{joint}" for joint in "OPQABC"}
    assert np.isnan(solution.reaction("A").fx).all()
    # The cranks turn together, the bar moves without turning: the torque is what all of them need.
    rate = 2.0
    torque = 3 * (0.3 * 0.1 * 9.81 * np.cos(0.7 + rate * solution.t)) + 1.0 * 0.2 * 9.81 * np.cos(0.7 + rate * solution.t)
    np.testing.assert_allclose(solution.effort("O"), torque, atol=1e-12)


def test_a_unique_reaction_stays_where_others_are_not():
    """A pendulum hung on the parallelogram's bar has a reaction of its own."""
    solution = evaluate(parallelogram(pendulum=True))
    assert np.isfinite(solution.reaction("hang").fx).all()
    assert np.isfinite(solution.section("bob").bending).all()
    assert np.isfinite(solution.effort("hang")).all()
    assert np.isnan(solution.reaction("C").fy).all()
    assert "section:bar:C:n" in solution.undetermined


def test_an_over_constrained_mechanism_that_does_not_fit_is_refused():
    with pytest.raises((MobilityError, AssemblyError), match=r"0 degree\(s\) of freedom|do not fit"):
        evaluate(parallelogram(third=1.02))


def test_two_guides_share_a_load():
    """A bar held by two coaxial guides: each one's force is open, the drive's is not."""
    m = Mechanism("guides")
    bar = m.link("bar", length=1.0, mass=2.0)
    m.prismatic("G1", m.ground, bar, axis=(1, 0))
    m.prismatic("G2", m.ground.at(1, 0), bar.tip, axis=(1, 0))
    solution = evaluate(Scene(m, {"G1": polynomial(0.0, 0.0, 0.5)}, t=(0, 1, 3)))
    np.testing.assert_allclose(solution.effort("G1"), 2.0, rtol=1e-14)
    assert {name for name in solution.undetermined if "reaction" in name} == {
        f"reaction:{g}:{k}" for g in ("G1", "G2") for k in ("fy", "mz")
    }
    assert np.all(solution.reaction("G2").fx == 0.0)


def test_a_static_structure_needs_no_drive():
    """A cantilever: closed form of a textbook."""
    m = Mechanism("cantilever")
    beam = m.link("beam", length=2.0, mass=3.0)
    m.weld("wall", m.ground, beam)
    m.force("tip", beam.tip, y=-10.0)
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 5)))
    xi = 2.0 * solution.xi
    np.testing.assert_allclose(solution.section("beam").bending[0], -10 * (2 - xi) - 3 / 2 * 9.81 * (2 - xi) ** 2 / 2, rtol=1e-14)
    assert solution.reaction("wall").mz[0] == pytest.approx(10 * 2 + 3 * 9.81 * 1)
    assert solution.reaction("wall").fy[0] == pytest.approx(10 + 3 * 9.81)


@pytest.mark.parametrize(
    ("declare", "error", "says"),
    [
        (lambda m, a: m.link("b", length=1), DeclarationError, "link 'b': give its mass, or a density"),
        (lambda m, a: m.link("b", length=1, mass=1, density=density.uniform(1)), DeclarationError, "give its mass, or a density"),
        (lambda m, a: m.link("b", length=1, mass=1, centre=(0, 0)), DeclarationError, "centre and inertia go together"),
        (lambda m, a: m.link("b", length=1, density=3.0), DeclarationError, "expected a density of lagrange_casadi.density"),
        (lambda m, a: density.tabulated([0, 0.5, 0.5, 1], [1, 1, 1, 1]), DeclarationError, "places must increase, but entry 2"),
        (lambda m, a: density.tabulated([0, 0.5], [1, 1]), DeclarationError, "must reach from 0 to 1, got 0 to 0.5"),
        (lambda m, a: density.polynomial(), DeclarationError, "at least one coefficient"),
        (lambda m, a: table(m.time, [0, 1, 1], [1, 2, 3]), DeclarationError, "table: places must increase"),
        (lambda m, a: m.force("F", "nothing", x=1), DeclarationError, "load 'F': expected a link"),
        (lambda m, a: m.force("F", Mechanism("n").link("z", length=1, mass=1), x=1), DeclarationError, "of another mechanism"),
        (lambda m, a: [m.force("F", a, x=1), m.force("F", a, x=1)], DeclarationError, "load 'F' is declared twice"),
        (lambda m, a: m.force("J", a, x=1), DeclarationError, "load 'J': the name is taken"),
        (lambda m, a: m.torque("T", m.point_mass("p", 1), 1.0), DeclarationError, "point mass 'p' bears no torque"),
        (lambda m, a: m.constraint("c", 3.0), DeclarationError, "constraint 'c' depends on no coordinate"),
        (lambda m, a: m.constraint("c", m.time * 2), DeclarationError, "depends on no coordinate"),
        (lambda m, a: m.constraint("c", m.coordinate(m.joints["J"]) * m.rate(m.joints["J"])), DeclarationError, "depends on rates"),
        (lambda m, a: m.nonholonomic("r", m.rate(m.joints["J"]) ** 2, replaces=m.joints["J"]), DeclarationError, "must be linear"),
        (lambda m, a: m.nonholonomic("r", m.time, replaces=m.joints["J"]), DeclarationError, "depends on no rate"),
        (lambda m, a: m.coordinate("J"), DeclarationError, "expected a joint of mechanism 'm', got 'J'; joints: J"),
        (lambda m, a: m.coordinate(m.weld("W", a.tip, m.point_mass("p", 1))), DeclarationError, "joint 'W' has no coordinate"),
        (lambda m, a: m.weld("W", m.point_mass("p", 1), a), DeclarationError, "no direction to carry the weld"),
        (lambda m, a: m.force("F", m.ground, x=1), DeclarationError, "a force on the ground moves nothing"),
        (lambda m, a: m.prismatic("P", m.ground, m.point_mass("p", 1), axis=1), DeclarationError, "axis must be two components"),
        (lambda m, a: m.revolute("a", m.ground, a.tip), DeclarationError, "joint 'a': the name is taken"),
        (lambda m, a: m.constraint("J", m.coordinate(m.joints["J"])), DeclarationError, "constraint 'J': the name is taken"),
        (lambda m, a: m.link("law", length=1, mass=1), DeclarationError, "link 'law': the name is taken"),
        (
            lambda m, a: [m.nonholonomic(n, m.rate(m.joints["J"]), replaces=m.joints["J"]) for n in "rs"],
            DeclarationError,
            "already",
        ),
    ],
)
def test_misuse_is_named(declare, error, says):
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.revolute("J", m.ground, a)
    with pytest.raises(error, match=says):
        declare(m, a)


@pytest.mark.parametrize(
    ("matter", "says"),
    [
        ({"density": density.polynomial(1.0, -3.0)}, r"density must not be negative, got -2 kg/m at xi/l = 1"),
        ({"density": density.polynomial(1.0, -5.0, 5.0)}, r"density must not be negative, got -0\.25 kg/m at xi/l = 0\.5"),
        ({"density": density.tabulated([0, 0.5, 1], [1, -1, 1])}, r"got -1 kg/m at xi/l = 0\.5"),
        ({"mass": 1.0, "centre": (0, 0), "inertia": -1.0}, "inertia must not be negative"),
    ],
)
def test_impossible_links_are_named(matter, says):
    m = Mechanism("m")
    m.revolute("J", m.ground, m.link("a", length=1, **matter))
    with pytest.raises(ParameterError, match=says):
        Scene(m, {"J": polynomial(0)})


def test_a_station_outside_its_link_is_named():
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.revolute("J", m.ground, a)
    m.weld("W", a.at(m.parameter("x", 0.5, "m")), m.point_mass("p", 1))
    scene = Scene(m, {"J": polynomial(0)})
    with pytest.raises(ParameterError, match=r"joint 'W': station 1\.5 m is outside link 'a', 0 to 1 m"):
        evaluate(scene, parameters={"x": 1.5})


def test_a_load_outside_its_link_is_named():
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.revolute("J", m.ground, a)
    m.spring("S", m.ground.at(0, 1), a.at(-0.9), stiffness=1.0, length=0.0)
    with pytest.raises(ParameterError, match=r"load 'S': station -0\.9\d* m is outside link 'a'"):
        Scene(m, {"J": polynomial(0)})


def test_a_slider_may_leave_its_link():
    """What is beyond the base acts on the base's side of every section: the rest hangs on it as on a bracket."""
    m = Mechanism("boom")
    a, p = m.link("a", length=0.5, mass=1.0), m.point_mass("p", 2.0)
    m.revolute("J", m.ground.at(0, 0), a)
    m.prismatic("S", a, p, axis=(1, 0))
    scene = Scene(m, {"J": MOTION, "S": polynomial(-0.3, 1.0)}, t=(0, 1, 11))
    for t in (0.0, 0.5, 1.0):
        assert_balanced(scene, t=t)
    assert np.max(evaluate(scene).certificate["ends"]) < 1e-14


def test_links_between_point_masses_have_a_certificate():
    """A trammel: a rod whose ends are pinned to two sliders."""
    m = Mechanism("trammel")
    rod, p, q = m.link("rod", length=1.0, mass=2.0), m.point_mass("p", 0.3), m.point_mass("q", 0.4)
    m.prismatic("X", m.ground, p, axis=(1, 0))
    m.prismatic("Y", m.ground, q, axis=(0, 1))
    m.revolute("P", p, rod)
    m.revolute("Q", q, rod.tip)
    scene = Scene(m, {"X": polynomial(0.5, 0.3, -0.2)}, posture={"rod": 2.0}, t=(0, 1, 11))
    assert_balanced(scene, t=0.4)
    certificate = evaluate(scene).certificate
    assert max(np.max(certificate[k]) for k in ("balance", "power", "ends", "closure")) < 1e-13


def test_a_slot_between_links_cannot_be_driven():
    m = Mechanism("m")
    a, b = m.link("a", length=0.1, mass=1), m.link("b", length=1, mass=1)
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(0, -0.5), b)
    m.slot("S", b, a.tip)
    with pytest.raises(DeclarationError, match="joint 'S' cannot be driven: it is a slot"):
        derive(Scene(m, {"S": polynomial(0.5)}))


def test_a_row_must_replace_a_drive():
    base = sleigh()
    with pytest.raises(DeclarationError, match="row 'blade' replaces the drive of joint 'Y', which has no motion"):
        Scene(base.mechanism, {"X": polynomial(0), "turn": polynomial(0)})


def test_instants_are_functions_of_time_where_loads_are():
    scene = crank_and_rod({"mass": 0.5}, loads=loads_on)
    graph = derive(scene, ["load:wind"])
    k = graph.columns.index("load:wind:fx")
    assert float(instant_at(graph, 0.5)[k]) == pytest.approx(4.0 * math.sin(3.5))

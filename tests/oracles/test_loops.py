"""Closed forms of loops: each where its pattern is there, and none
where equations only look alike.
"""

import math

import casadi as ca
import numpy as np
import pytest
from balance import assert_balanced
from mechanisms import ladder

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.elements import cylinder
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def iterated(scene):
    return derive(scene).newton is not None


def test_a_ladder_against_a_wall():
    """Its middle goes round the corner on a circle with the crank, whose torque is the power of its
    weight: m g L/2 cos(angle).
    """
    scene = ladder()
    solution = evaluate(scene)
    angle = solution.motion("O").value
    np.testing.assert_allclose(solution.pose("bar").x, np.cos(angle), atol=1e-15)
    np.testing.assert_allclose(solution.effort("O"), 2.0 * 9.81 / 2 * np.cos(angle), rtol=1e-14)
    assert not iterated(scene)
    assert_balanced(scene)


def guided(first, second):
    """A bar whose two pins slide on two lines, pushed by a crank and a rod."""
    m = Mechanism("guided")
    bar, crank = m.link("bar", length=0.6, mass=1.0), m.link("crank", length=0.15, mass=0.3)
    # Assembled in a posture of its own: every place follows from it.
    x, y, turn, at, way = 0.4, 0.1, 0.9, (-0.5, -0.2), 0.3
    for name, place, angle in (
        ("P", (x, y), first),
        ("Q", (x + 0.6 * math.cos(turn), y + 0.6 * math.sin(turn)), second),
    ):
        foot = m.point_mass(name.lower(), 0.1)
        m.prismatic(name, m.ground.at(*place), foot, axis=(math.cos(angle), math.sin(angle)))
        m.revolute(f"at_{name}", bar.base if name == "P" else bar.tip, foot)
    px, py = x + 0.2 * math.cos(turn), y + 0.2 * math.sin(turn)
    cx, cy = at[0] + 0.15 * math.cos(way), at[1] + 0.15 * math.sin(way)
    length = math.hypot(px - cx, py - cy)
    rod = m.link("push", length=length, mass=0.2)
    m.revolute("O", m.ground.at(*at), crank)
    m.revolute("C", crank.tip, rod)
    m.revolute("D", rod.tip, bar.at(0.2))
    posture = {"bar": turn + 0.05, "P": 0.0, "Q": 0.0, "push": math.atan2(py - cy, px - cx)}
    return Scene(m, {"O": polynomial(way, 1.0)}, t=(0, 0.3, 41), posture=posture)


@pytest.mark.parametrize("lines", [(0.0, 1.3), (0.7, 2.4), (2.0, -0.4), (0.3, 0.3 + math.pi / 2)])
def test_a_bar_guided_by_two_pins_on_two_lines(lines):
    scene = guided(*lines)
    assert evaluate(scene).certificate["closure"].max() < 1e-14
    assert_balanced(scene)


@pytest.mark.parametrize("line", [0.9, 0.9 + math.pi])
def test_a_bar_guided_by_two_pins_on_one_line(line):
    """An ordinary slide: its direction is that of the line, though rounding puts its place into the
    equation of the other pin.
    """
    scene = guided(line, line)
    solution = evaluate(scene)
    np.testing.assert_allclose(solution.pose("bar").angle, 0.9, atol=1e-14)
    assert_balanced(scene)


def prescribed(equations, posture):
    """An arm of two links, two of whose places are prescribed; and a slide that is driven, since
    something must be.
    """
    m = Mechanism("prescribed")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.5, mass=1.2)
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    m.prismatic("S", m.ground.at(0, -1), m.point_mass("s", 1.0), axis=(1, 0))
    for name, gap in equations(m, b).items():
        m.constraint(name, gap)
    return Scene(m, {"S": polynomial(0.0, 0.1)}, t=(0, 1, 41), posture=posture)


def test_a_tip_that_is_prescribed_is_a_dyad():
    def equations(m, b):
        x, y = m.place(b.tip)
        return {"across": x - 0.7 - 0.1 * ca.sin(2 * m.time), "up": y - 0.3 * ca.cos(m.time)}

    scene = prescribed(equations, {"a": 1.1, "b": -0.5})
    solution = evaluate(scene)
    tip = solution.pose("b").x + 0.5 * np.cos(solution.pose("b").angle)
    np.testing.assert_allclose(tip, 0.7 + 0.1 * np.sin(2 * solution.t), atol=1e-15)
    assert not iterated(scene)


def test_the_height_of_a_tip_and_the_place_of_a_middle_are_not_two_circles():
    """Each equation holds both directions, as those of a pin do, and no two arms turn in them: they
    are iterated.
    """

    def equations(m, b):
        return {
            "height": m.place(b.tip)[1] - 0.471,
            "middle": m.place(b.at(0.25))[0] - 0.7 - 0.05 * ca.sin(3 * m.time),
        }

    scene = prescribed(equations, {"a": 0.9, "b": -0.1})
    solution = evaluate(scene)
    base, angle = solution.pose("b"), solution.pose("b").angle
    np.testing.assert_allclose(base.y + 0.5 * np.sin(angle), 0.471, atol=1e-14)
    np.testing.assert_allclose(
        base.x + 0.25 * np.cos(angle), 0.7 + 0.05 * np.sin(3 * solution.t), atol=1e-14
    )
    assert iterated(scene)


def test_slides_of_any_number_are_one_linear_system():
    """A wedge on a wedge on a wedge, and the last on the ground: closed form, whatever is declared
    first.
    """
    m = Mechanism("wedges")
    bodies = [m.link(f"w{i}", length=0.2, mass=1.0 + i) for i in range(3)]
    chain = [m.ground, *bodies]
    for i, way in enumerate((0.0, 0.7, 1.9)):
        m.prismatic(f"S{i}", chain[i], chain[i + 1], axis=(math.cos(way), math.sin(way)))
    m.prismatic("last", m.ground.at(0.1, 0.05), bodies[2], axis=(math.cos(2.5), math.sin(2.5)))
    solution = evaluate(
        Scene(m, {"S0": polynomial(0.1, 0.2), "S2": polynomial(0.0, -0.1)}, t=(0, 1, 5))
    )
    assert solution.certificate["closure"].max() < 1e-15
    # Their directions are held four times for three bodies: moments are open, and the efforts are
    # not.
    weight = 9.81 * np.array([1.0, 2.0, 3.0])
    rate = (
        np.array([solution.pose(f"w{i}").y[1] - solution.pose(f"w{i}").y[0] for i in range(3)])
        / 0.25
    )
    power = 0.2 * solution.effort("S0") - 0.1 * solution.effort("S2")
    np.testing.assert_allclose(power, weight @ rate, rtol=1e-12)


def test_lines_that_come_to_be_parallel_are_a_dead_centre():
    """A pin on a fixed line and in the slot of a crank: where the crank lies along the line, its
    place is open.
    """
    m = Mechanism("crossing")
    crank, pin = m.link("crank", length=1.0, mass=0.2), m.point_mass("pin", 0.5)
    m.revolute("O", m.ground.at(0, -0.3), crank)
    m.slot("slot", crank, pin)
    m.prismatic("line", m.ground, pin, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(1.0, 1.0)}, t=(0, 0.5, 6))
    np.testing.assert_allclose(
        evaluate(scene).pose("pin").x, 0.3 / np.tan(1.0 + np.linspace(0, 0.5, 6)), rtol=1e-13
    )


def two_slots():
    """A rod hinged to a driven slide, and another rod that slides on it: both are led by slots of
    the ground.
    """
    m = Mechanism("two_slots")
    s = m.link("s", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.6, mass=1.0)
    sleeve = m.link("sleeve", length=0.3, mass=1.0)
    m.prismatic("X", m.ground, s, axis=(1, 0))
    m.revolute("A", s, rod)
    m.prismatic("P", rod, sleeve, axis=(1, 0))
    m.slot("first", m.ground.at(0, 0.3), sleeve, axis=(1, 0))
    m.slot("second", m.ground.at(0.1, 0), sleeve.tip, axis=(0.2, 1))
    posture = {"rod": 0.9, "sleeve": 0.9, "P": 0.35, "first": 0.1, "second": 0.5}
    return Scene(m, {"X": polynomial(-0.1, 0.1)}, t=(0, 1, 11), posture=posture)


def led():
    """A crank and two links whose tip is led by a slot and by a prescribed height."""
    m = Mechanism("led")
    a, b, c = (m.link(n, length=l, mass=1.0) for n, l in (("a", 0.3), ("b", 0.5), ("c", 0.4)))
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c)
    m.constraint("height", m.place(c.tip)[1] - 0.1 - 0.2 * m.time)
    m.slot("slot", m.ground.at(0.9, 0), c.tip, axis=(0.1, 1))
    return Scene(m, {"O": polynomial(1.0, 0.3)}, t=(0, 0.5, 11), posture={"b": 0.3, "c": -0.6})


def heights():
    """Two heights of one link: its direction follows from their difference, and another link's from
    either.
    """
    m = Mechanism("heights")
    a, b = m.link("a", length=0.465, mass=1.0), m.link("b", length=0.4325, mass=1.0)
    m.revolute("O", m.ground, a.tip)
    m.revolute("A", a, b)
    m.constraint("c0", m.place(b.at(0.1633, -0.05515))[1] + 0.42)
    m.constraint("c1", m.place(b.tip)[1] + 0.32 - 0.02 * ca.sin(m.time))
    return Scene(m, {}, t=(0, 1, 11), posture={"a": 1.0, "b": 0.3})


def geared_arm():
    """The driven pin between two links turns the first by a gear, and that the second: some torques
    cancel in the equations.
    """
    m = Mechanism("geared_arm")
    a, b, c = (m.link(name, length=0.3, mass=1.0) for name in "abc")
    first, second = m.revolute("A", m.ground, a), m.revolute("B", a.tip, b)
    driven = m.revolute("C", b.tip, c)
    m.gear("one", first, driven, ratio=-1.5)
    m.gear("two", second, first, ratio=2.0)
    return Scene(m, {"C": polynomial(0.3, 1.0)}, posture={"a": -0.2, "b": -0.3}, t=(0, 1, 11))


def guided_twice():
    """Two bearings of one line, and a slot that holds what they leave free."""
    m = Mechanism("twice")
    a, b = m.link("a", length=0.2, mass=1.0), m.link("b", length=0.3, mass=1.0)
    m.prismatic("G", m.ground, a, axis=(1, 0.3), angle=0.4)
    m.prismatic("H", m.ground, a, axis=(1, 0.3), angle=0.4)
    m.slot("S", m.ground.at(0.1, 0.0), a.tip, axis=(0, 1))
    m.revolute("P", a.tip, b)
    return Scene(
        m,
        {"P": polynomial(0.1, 1.0)},
        t=(0, 1, 5),
        posture={"a": 0.4, "G": -0.05, "H": -0.05, "S": 0.1},
    )


def rates():
    """A height leads a crank, an equation a slide on it, and a four-bar hangs on the slide, whose
    rate has factors of zero.
    """
    m = Mechanism("rates")
    b0, b1, b2, b3 = (
        m.link(n, length=l, mass=1.0)
        for n, l in (("b0", 0.26), ("b1", 0.13), ("b2", 0.41), ("b3", 0.15))
    )
    m.revolute("j1", m.ground.at(0.35, -0.41), b1.at(0.05))
    m.constraint("c0", m.place(b1.tip)[1] + 0.444 + 0.038 * ca.sin(3.0 * m.time))
    j2 = m.prismatic("j2", b2, b1, axis=(1.0, 0.0), angle=-0.5)
    m.constraint("c1", m.coordinate(j2) + 0.23)
    m.revolute("j0", m.ground.at(0.31, 0.05), b0.at(0.07))
    m.revolute("j3", b0.tip, b3)
    m.slot("j4", b2.at(0.34, 0.5), b3.tip, axis=(1.0, 0.0))
    posture = {"b0": 2.4, "b1": -0.5, "b2": 0.0, "b3": 0.0, "j2": -0.23, "j4": -0.4}
    return Scene(m, {"j3": polynomial(-2.4, 0.2)}, t=(0.0, 0.35, 5), posture=posture)


@pytest.mark.parametrize("made", [two_slots, led, heights, geared_arm, guided_twice, rates])
def test_equations_of_several_joints_and_constraints(made):
    """Found by drawing mechanisms at random.

    Newton and Euler, from the reported motions, and the equations are the judges.
    """
    solution = evaluate(made(), backend="vm")
    residuals = {
        name: values.max() for name, values in solution.certificate.items() if name != "condition"
    }
    assert {"closure", "balance", "power"} <= set(residuals)
    assert max(residuals.values()) < 1e-12


def test_a_posture_on_a_dead_centre_assembles_nothing():
    """Two links in one line lie between the two ways in which they can be assembled."""
    scene = led()
    with pytest.raises(AssemblyError, match="cannot be assembled from the given posture"):
        evaluate(Scene(scene.mechanism, scene.motion, t=scene.t, posture={"b": -0.3, "c": -0.3}))


@pytest.mark.parametrize("size", [1e-6, 0.05, 1e3])
def test_two_circles_have_a_closed_form_whatever_their_size(size):
    """A lever that a ram moves, as short or long as may be.

    Places are drawn near a metre, and few links reach so far.
    """
    m = Mechanism("lever")
    crank = m.link("crank", length=0.05 * size, mass=1.0)
    lever = m.link("lever", length=0.2 * size, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("P", m.ground.at(0.25 * size, 0.0), lever)
    cylinder(
        m,
        "ram",
        crank.tip,
        lever.at(0.15 * size),
        closed=0.08 * size,
        bore=0.05 * size,
        rod=0.03 * size,
    )
    law = {"O": polynomial(0.1, 5.0), "ram": polynomial(0.12 * size, 0.02 * size)}
    assert derive(Scene(m, law, posture={"lever": 2.8}, t=(0, 0.4, 3))).newton is None

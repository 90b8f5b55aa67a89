"""Bodies where loops close or not, beside what a hand computes."""

import math

import numpy as np
import pytest
from conftest import CASES, NAMES
from internals import placement

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    evaluate,
    load_case,
)
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.motion import expression

TURN = {"A": expression(lambda t: t)}
UNIT = 2.0**40


def chain(lengths, end=None, unit=1.0, space=False):
    """Links without a mass from the origin, to a place of the ground where there is one."""
    m = SpatialMechanism("chain") if space else Mechanism("chain")
    pin = m.spherical if space else m.revolute
    links = [m.link(name, length=x * unit) for name, x in zip("abc", lengths, strict=False)]
    m.revolute("A", m.ground, links[0], **({"axis": (0, 0, 1)} if space else {}))
    for name, one, other in zip("BC", links, links[1:], strict=False):
        pin(name, one.tip, other)
    if end:
        pin("end", m.ground.at(*(x * unit for x in end)), links[-1].tip)
    return m


def slider(unit=1.0):
    """A rod of 0.3 m from a crank of 0.1 m to a line that is 0.5 m above."""
    m = chain((0.1, 0.3), unit=unit)
    block = m.point_mass("block", 1.0)
    m.revolute("pin", m.links["b"].tip, block)
    m.prismatic("guide", m.ground.at(0, 0.5 * unit), block, axis=(1, 0))
    return m


def third(unit=1.0):
    """A parallelogram, and a third crank that is too short."""
    m = chain((1.0, 2.0), unit=unit)
    for name, x, length in (("c", 2.0, 1.0), ("d", 1.0, 0.8)):
        crank = m.link(name, length=length * unit)
        m.revolute(f"{name}0", m.ground.at(x * unit, 0), crank)
        m.revolute(f"{name}1", m.links["b"].at(x * unit), crank.tip)
    return m


def named(unit=1.0):
    """A dyad one length of which is a parameter."""
    m = Mechanism("named")
    a = m.link("a", length=m.parameter("reach", unit, "m", high=2.0 * unit))
    b = m.link("b", length=0.5 * unit)
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    m.revolute("end", m.ground.at(1.75 * unit, 0), b.tip)
    return m


def welded(unit=1.0):
    """A bar between two welds, the second of which is turned by 10 degrees."""
    m = Mechanism("welded")
    a = m.link("a", length=unit)
    m.weld("A", m.ground, a)
    m.weld("end", m.ground.at(unit, 0), a.tip, angle="10 deg")
    return m


def geared(unit=1.0):
    """Two driven arms that a gear couples otherwise."""
    m = Mechanism("geared")
    arms = [m.link(name, length=unit) for name in "ab"]
    joints = [m.revolute(k, m.ground, arm) for k, arm in zip("AB", arms, strict=True)]
    m.gear("mesh", *joints, ratio=-2.0)
    return m


def rod(unit=1.0):
    """A two-force link of 3 m between a crank and a rocker, whose circles are sqrt(20) m apart."""
    m = SpatialMechanism("rod")
    a, b = m.link("a", length=unit), m.link("b", length=2.0 * unit)
    m.revolute("A", m.ground, a, axis=(0, 0, 1))
    m.revolute("D", m.ground.at(5.0 * unit, 0, 0), b, axis=(1, 0, 0), turned=((0, 1, 0), (0, 0, 1)))
    between = m.link("rod", length=3.0 * unit, mass=1.0)
    m.spherical("S", a.tip, between)
    m.spherical("end", b.tip, between.tip)
    return m


DYAD = "the ends of b and c are {} m apart; with these lengths they reach {} m; it closes with "
OPEN = {
    "far": (
        lambda unit: chain((0.3, 0.8, 0.6), (2.0, 0.0), unit),
        TURN,
        0.3,
        DYAD.format(1.7, "0.2 to 1.4")
        + "length of a 0.6 m (+0.3 m) or length of b 1.1 m (+0.3 m) or length of c 0.9 m (+0.3 m)",
    ),
    "near": (
        lambda unit: chain((0.1, 2.0, 1.0), (0.5, 0.0), unit),
        TURN,
        0.6,
        DYAD.format(0.4, "1 to 3") + "length of b 1.4 m (-0.6 m) or length of c 1.6 m (+0.6 m)",
    ),
    "undriven": (
        lambda unit: chain((0.3, 0.8, 0.6), (2.0, 0.0), unit),
        {},
        0.3,
        (
            "the ends of a, b and c are 2 m apart; with these lengths they reach 0 to 1.7 m; it"
            " closes with length of a 0.6 m (+0.3 m) or length of b 1.1 m (+0.3 m) or length of c"
            " 0.9 m (+0.3 m)"
        ),
    ),
    "line": (
        slider,
        TURN,
        0.2,
        (
            "the ends of b are 0.5 m apart at least, as joint 'guide' leads them; with this length"
            " they reach 0.3 m; it closes with length of b 0.5 m (+0.2 m)"
        ),
    ),
    "structure": (
        lambda unit: chain((1.0, 1.0), (2.5, 0.0), unit),
        TURN,
        0.5,
        (
            "the ends of b are 1.5 m apart; with this length they reach 1 m; it closes with length"
            " of a 1.5 m (+0.5 m) or length of b 1.5 m (+0.5 m)"
        ),
    ),
    "third crank": (
        third,
        {"A": expression(lambda t: t + math.pi / 2)},
        0.2,
        (
            "the ends of d are 1 m apart; with this length they reach 0.8 m; it closes with length"
            " of d 1 m (+0.2 m)"
        ),
    ),
    "parameter": (
        named,
        TURN,
        0.25,
        (
            "the ends of b are 0.75 m apart; with this length they reach 0.5 m; it closes with"
            " reach 1.25 m (+0.25 m) or length of b 0.75 m (+0.25 m)"
        ),
    ),
    "weld": (welded, {}, math.radians(10), "ground and a are turned by 10 deg against each other"),
    "gear": (
        geared,
        {"A": expression(lambda t: t + 1.0), "B": expression(lambda t: t)},
        2.0,
        "constraint 'mesh' is 2 in place of 0",
    ),
    "space": (
        lambda unit: chain((1.0, 2.0), (5.0, 0.0, 0.0), unit, space=True),
        TURN,
        2.0,
        (
            "the ends of b are 4 m apart; with this length they reach 2 m; it closes with length of"
            " a 3 m (+2 m) or length of b 4 m (+2 m)"
        ),
    ),
    "space, undriven": (
        lambda unit: chain((1.0, 2.0), (5.0, 0.0, 0.0), unit, space=True),
        {},
        2.0,
        "length of a 3 m (+2 m) or length of b 4 m (+2 m)",
    ),
    "two-force link": (
        rod,
        TURN,
        math.sqrt(20) - 3.0,
        "it closes with length of rod 4.47 m (+1.47 m) or length of a 2.76 m (+1.76 m)",
    ),
}


@pytest.mark.parametrize("name", OPEN)
def test_what_is_apart_and_what_closes_it(name):
    make, motion, size, says = OPEN[name]
    (gap,) = placement.place(make(1.0), motion=motion).gaps
    assert gap.size == pytest.approx(size, rel=1e-9)
    assert says in gap.sentence
    if gap.unit == "m":
        assert np.linalg.norm(gap.ends[1] - gap.ends[0]) == pytest.approx(size, rel=1e-9)
    (far,) = placement.place(make(UNIT), motion=motion).gaps
    assert far.size == pytest.approx(size * (UNIT if gap.unit == "m" else 1.0), rel=1e-9)


@pytest.mark.sampled(11)
@pytest.mark.parametrize("name", NAMES)
def test_a_case_stands_as_it_is_evaluated(name):
    scene = load_case(CASES / name).scene
    begins, _ = scene.span
    solution = evaluate(scene, t=(begins, begins, 1), wanted=["motion"], backend="vm")
    found = placement.place_scene(scene)
    assert not found.gaps
    for body in found.bases:
        pose = solution.pose(body)
        place = [float(x[0]) for x in (pose.x, pose.y) if x is not None]
        assert found.bases[body][:2] == pytest.approx(place, abs=1e-9 * found.description.extent)
        if pose.angle is not None:
            there = math.cos(pose.angle[0]), math.sin(pose.angle[0]), 0.0
            assert found.axes[body][0] == pytest.approx(there, abs=1e-9)


def test_it_is_declared_further_after_it_was_placed():
    m = Mechanism("growing")
    a = m.link("a", length=1.0)
    assert placement.place(m).bases["a"][0] > 0.0  # beside the ground
    m.revolute("A", m.ground, a)
    b = m.link("b", length=0.5)
    found = placement.place(m, posture={"a": "90 deg"})
    assert found.bases["a"] == pytest.approx([0, 0, 0])
    assert found.axes["a"][0] == pytest.approx([0, 1, 0])
    assert found.bases["b"][0] > 0.0
    m.revolute("B", a.tip, b)
    assert placement.place(m, posture={"a": "90 deg"}).bases["b"] == pytest.approx([0, 1, 0])
    with pytest.raises(Exception, match="link 'a': expected either mass= or density="):
        Scene(m, TURN)


def test_a_motion_that_jams_is_known_until_it_does():
    m = Mechanism("jams")
    a, b, c = (m.link(k, length=x, mass=1.0) for k, x in zip("abc", (0.3, 0.8, 0.6), strict=True))
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    m.revolute("C", b.tip, c.tip)
    m.revolute("D", m.ground.at(1.3, 0), c)
    scene = Scene(m, TURN, posture={"c": "90 deg"}, t=(0.0, 3.0, 31))
    last = math.acos((0.3**2 + 1.3**2 - 1.4**2) / (2 * 0.3 * 1.3))
    with pytest.raises(AssemblyError, match=f"all loops close until t = {last:.6g} s") as caught:
        evaluate(scene, backend="vm")
    shown = caught.value.placement
    assert shown.t == pytest.approx(last)
    assert shown.axes["a"][0][:2] == pytest.approx([math.cos(last), math.sin(last)])
    assert shown.axes["b"][0] == pytest.approx(-shown.axes["c"][0], abs=1e-4)

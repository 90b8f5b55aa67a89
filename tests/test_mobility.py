"""Internal forces of many mechanisms against vector Newton-Euler on free bodies, which shares nothing with the package."""

import math

import numpy as np
import pytest
from builders import INSTANT, MOTION, compare, four_bar, instant_at, slider_crank
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.declare.motion import polynomial
from lagrange_casadi.declare.parts import Link
from lagrange_casadi.errors import AssemblyError

TOLERANCE = 1e-12


def chain(*parts):
    """Links end to end from the ground; each part is (kind, reverse)."""
    m = Mechanism("chain")
    near, motion = m.ground, {}
    for i, (kind, reverse) in enumerate(parts):
        link = m.link(f"l{i}", length=0.1 + 0.07 * i, mass=0.3 + 0.2 * i)
        ends = (link, near) if reverse else (near, link)
        if kind == "revolute":
            m.revolute(f"J{i}", *ends)
        else:
            m.prismatic(f"J{i}", *ends, axis=(1.0, 0.3), angle=0.5)
        motion[f"J{i}"] = polynomial(0.1 + 0.2 * i, -2.0 + i, 1.0 + 0.5 * i)
        near = link.tip
    m.revolute("P", near, m.point_mass("payload", 0.7))
    return Scene(m, motion, t=(INSTANT, 1, 2))


def block(guide_of="ground"):
    """An offset slider-crank whose slider is a link, guided at an angle."""
    m = Mechanism("block")
    a, b, s = (m.link(n, length=l, mass=w) for n, l, w in (("a", 0.1, 0.3), ("b", 0.35, 0.5), ("s", 0.05, 0.6)))
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, s)
    m.prismatic("P", m.ground.at(0, 0.03), s, axis=(1, 0.2), angle=0.4)
    return Scene(m, {"O": MOTION}, posture={"b": 0.0}, t=(INSTANT, 1, 2))


def driven_slider():
    """The slider drives the crank."""
    m = Mechanism("driven_slider")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.35, mass=0.5)
    s = m.point_mass("s", 0.6)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, s)
    m.prismatic("P", m.ground.at(0, 0.03), s, axis=(1, 0.2))
    return Scene(m, {"P": polynomial(0.3, 0.2, 0.1)}, posture={"a": 1.0}, t=(INSTANT, 1, 2))


def inverted(block_carries):
    """A block on the crank's pin slides along a rocker (RPR); either of the two carries the axis."""
    m = Mechanism("inverted")
    a, b, s = (m.link(n, length=l, mass=w) for n, l, w in (("a", 0.1, 0.3), ("rocker", 0.5, 0.5), ("s", 0.05, 0.2)))
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(0, -0.3), b)
    m.revolute("A", a.tip, s)
    if block_carries:
        m.prismatic("P", s, b, axis=(1, 0), angle=0.3)
    else:
        m.prismatic("P", b, s, axis=(1, 0))
    return Scene(m, {"O": MOTION}, posture={"rocker": 1.6}, t=(INSTANT, 1, 2))


def cross_slide():
    """A pin on a crank moves two slides at right angles (PRP): no branch, two equations for two slides."""
    m = Mechanism("cross_slide")
    a, x, y = (m.link(n, length=l, mass=w) for n, l, w in (("a", 0.1, 0.3), ("x", 0.2, 0.5), ("y", 0.05, 0.2)))
    m.revolute("O", m.ground, a)
    m.prismatic("X", m.ground, x, axis=(1, 0))
    m.prismatic("Y", x, y, axis=(0, 1), angle=0.2)
    m.revolute("A", a.tip, y)
    return Scene(m, {"O": MOTION}, t=(INSTANT, 1, 2))


def six_bar():
    """A four-bar whose rocker's pin drives a slider: two loops, one after the other."""
    m = Mechanism("six_bar")
    a, b, c, d = (m.link(n, length=l, mass=w) for n, l, w in zip("abcd", (0.1, 0.35, 0.25, 0.4), (0.3, 0.5, 0.4, 0.2), strict=True))
    s = m.point_mass("s", 0.6)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    m.revolute("B", b.tip, c.tip)
    m.revolute("D", c.tip, d)
    m.revolute("E", d.tip, s)
    m.prismatic("guide", m.ground.at(0.3, 0.1), s, axis=(1, 0))
    return Scene(m, {"O": MOTION}, posture={"c": 1.5, "d": 0.0}, t=(INSTANT, 1, 2))


def truss_platform(loads=lambda m: None):
    """A triangle of three bars on three legs, one leg's foot driven: no dyad anywhere, six unknown directions at once."""
    m = Mechanism("truss_platform")
    feet = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.7)]
    corners = [(0.2, 0.2), (0.4, 0.2), (0.3, 0.4)]
    bars, posture = [], {}
    for i in range(3):
        (x0, y0), (x1, y1) = corners[i], corners[(i + 1) % 3]
        bars.append(m.link(f"bar{i}", length=math.hypot(x1 - x0, y1 - y0), mass=0.2 + 0.1 * i))
        posture[f"bar{i}"] = math.atan2(y1 - y0, x1 - x0) + 0.1
    shaft = m.link("shaft", length=m.parameter("shaft", 0.05, "m"), mass=0.1)
    m.revolute("O", m.ground.at(-0.05, 0.0), shaft)
    for i in range(3):
        (x0, y0), (x1, y1) = feet[i], corners[i]
        leg = m.link(f"leg{i}", length=math.hypot(x1 - x0, y1 - y0), mass=0.3)
        posture[f"leg{i}"] = math.atan2(y1 - y0, x1 - x0) - 0.1
        m.revolute(f"foot{i}", shaft.tip if i == 0 else m.ground.at(x0, y0), leg)
        m.revolute(f"corner{i}", leg.tip, bars[i])
        m.revolute(f"mate{i}", bars[i - 1].tip, bars[i])
    loads(m)
    return Scene(m, {"O": polynomial(0.0, 0.4, 0.5)}, posture=posture, t=(0.0, 1.0, 21))


CASES = {
    "slider_crank": lambda: slider_crank(t=(INSTANT, 1, 2)),
    "four_bar": four_bar,
    "four_bar_ends_swapped": lambda: four_bar(turned=(True, False)),
    "four_bar_rocker_swapped": lambda: four_bar(turned=(False, True)),
    "four_bar_all_swapped": lambda: four_bar(turned=(True, True)),
    "block": block,
    "driven_slider": driven_slider,
    "inverted_rocker_carries": lambda: inverted(block_carries=False),
    "inverted_block_carries": lambda: inverted(block_carries=True),
    "cross_slide": cross_slide,
    "six_bar": six_bar,
    "chain_rrr": lambda: chain(("revolute", False), ("revolute", False), ("revolute", False)),
    "chain_reversed": lambda: chain(("revolute", True), ("revolute", True), ("revolute", False)),
    "chain_prismatic": lambda: chain(("revolute", False), ("prismatic", False), ("revolute", False)),
    "chain_prismatic_reversed": lambda: chain(("revolute", False), ("prismatic", True), ("revolute", True)),
}


@pytest.mark.parametrize("name", CASES)
def test_every_force_against_newton_euler(name):
    worst, gap = compare(CASES[name]())
    assert gap < TOLERANCE, worst


def test_loops_without_closed_form_against_newton_euler():
    scene = truss_platform()
    graph = derive(scene)
    assert graph.newton is not None
    worst, gap = compare(scene, t=0.0, nudge=0.003)
    assert gap < TOLERANCE, worst


def test_parent_and_child_exchanged_are_the_same_mechanism():
    """The reaction changes its sign with the roles, nothing else changes."""
    plain, turned = (evaluate(four_bar(turned=t)) for t in ((False, False), (True, True)))
    for joint, sign in (("O", 1), ("A", -1), ("C", -1)):
        np.testing.assert_allclose(plain.reaction(joint).fx, sign * turned.reaction(joint).fx, rtol=1e-12)
        np.testing.assert_allclose(plain.reaction(joint).fy, sign * turned.reaction(joint).fy, rtol=1e-12)
    np.testing.assert_allclose(plain.effort("O"), turned.effort("O"), rtol=1e-12)
    # The coupler runs from the other end: its tip is where its base was.
    for force, sign in (("axial", 1), ("shear", 1), ("bending", -1)):
        one, two = plain.array(f"section:b:{force}"), turned.array(f"section:b:{force}")
        np.testing.assert_allclose(one, sign * two[:, ::-1], atol=1e-12 * np.max(np.abs(one)))


def test_declaration_order_does_not_matter():
    def declare(order):
        m = Mechanism("order")
        parts = {"b": (0.35, 0.5), "c": (0.25, 0.4), "a": (0.1, 0.3)}
        links = {n: m.link(n, length=parts[n][0], mass=parts[n][1]) for n in order}
        joints = {
            "O": lambda: m.revolute("O", m.ground, links["a"]),
            "A": lambda: m.revolute("A", links["a"].tip, links["b"]),
            "B": lambda: m.revolute("B", links["b"].tip, links["c"].tip),
            "C": lambda: m.revolute("C", m.ground.at(0.3, 0.05), links["c"]),
        }
        for name in sorted(joints, reverse=order == "cba"):
            joints[name]()
        return evaluate(Scene(m, {"O": MOTION}, posture={"c": 1.5, "b": 0.5}, t=(INSTANT, 1, 3)))

    one, two = declare("abc"), declare("cba")
    for name in one.names():
        scale = np.max(np.abs(one.array(name)), initial=1e-3)
        np.testing.assert_allclose(one.array(name), two.array(name), atol=1e-12 * scale, err_msg=name)


place = st.tuples(st.sampled_from(["base", "tip", "station", "beside"]), st.floats(0.1, 0.9), st.floats(-0.2, 0.2))
branch = st.tuples(
    st.sampled_from(["revolute", "prismatic", "weld", "mass"]),
    st.booleans(),
    st.integers(0, 5),
    place,
    place,
    st.floats(-3.0, 3.0),
    st.floats(0.05, 2.0),
)


def point_of(body, choice):
    kind, along, beside = choice
    if not isinstance(body, Link):
        return body
    if kind in ("base", "tip"):
        return getattr(body, kind)
    return body.at(along * body.length, beside if kind == "beside" else 0.0)


@settings(max_examples=40, deadline=None)
@given(st.lists(branch, min_size=1, max_size=5))
def test_random_trees(branches):
    """Links hung on each other anywhere by any joint, either end of which may be the parent, at stations on and off their axes."""
    m = Mechanism("tree")
    bodies, motion = [m.ground], {}
    for i, (kind, reverse, on, near, far, angle, mass) in enumerate(branches):
        base = bodies[on % len(bodies)]
        if kind == "mass":
            m.weld(f"J{i}", point_of(base, near), m.point_mass(f"p{i}", mass))
            continue
        link = m.link(f"l{i}", length=0.3 + 0.1 * i, mass=mass)
        ends = (point_of(base, near), point_of(link, far))
        ends = ends[::-1] if reverse else ends
        if kind == "revolute":
            m.revolute(f"J{i}", *ends)
            motion[f"J{i}"] = polynomial(angle, 1.0 + 0.3 * i, -2.0)
        elif kind == "prismatic":
            m.prismatic(f"J{i}", *ends, axis=(math.cos(angle), math.sin(angle)), angle=0.4 * i)
            motion[f"J{i}"] = polynomial(0.2, -0.5, 1.0 + 0.2 * i)
        else:
            m.weld(f"J{i}", *ends, angle=angle)
        bodies.append(link)
    worst, gap = compare(Scene(m, motion, t=(INSTANT, 1, 2)), nudge=1e-4)
    assert gap < TOLERANCE, worst


lengths = st.floats(0.05, 2.0)
masses = st.floats(0.0, 5.0)


@settings(max_examples=25, deadline=None)
@given(st.tuples(lengths, lengths, lengths), st.tuples(masses, masses, st.floats(0.1, 5.0)), st.floats(0.1, 3.0), st.booleans())
def test_random_four_bars(length, mass, frame, turned):
    try:
        worst, gap = compare(four_bar(length, mass, (frame, 0.1), 0.9, (turned, not turned)), nudge=1e-3)
    except AssemblyError:
        return
    if _transmission(four_bar(length, mass, (frame, 0.1), 0.9)) > 1e-2:
        assert gap < 1e-10, worst


def _transmission(scene):
    """How far a scene's loop is from a dead centre: the closure of loops.py, at its first instant."""
    graph = derive(scene)
    return float(instant_at(graph, scene.t[0])[graph.names.index("_closure:B")])


@settings(max_examples=15, deadline=None)
@given(st.floats(0.05, 0.3), st.floats(-0.15, 0.15), st.tuples(masses, masses, masses, masses), st.floats(0.2, 0.4), st.booleans())
def test_random_six_bars(x, y, mass, arm, turned):
    """A crank-rocker with a pin anywhere on its coupler that swings a second rocker; parents, children and order exchanged."""
    m = Mechanism("six_bar")
    swing = m.link("swing", length=0.28, mass=0.5)
    crank, coupler, rocker, last = (
        m.link(n, length=l, mass=w)
        for n, l, w in zip(("crank", "coupler", "rocker", "arm"), (0.1, 0.35, 0.25, arm), mass, strict=True)
    )
    ends = {
        "O": (m.ground, crank),
        "A": (crank.tip, coupler),
        "B": (coupler.tip, rocker.tip),
        "C": (m.ground.at(0.3, 0.05), rocker),
        "D": (coupler.at(x, y), last),
        "E": (last.tip, swing.tip),
        "F": (m.ground.at(0.45, 0.35), swing),
    }
    for name in sorted(ends, reverse=turned):
        m.revolute(name, *(ends[name][::-1] if turned and name != "O" else ends[name]))
    scene = Scene(m, {"O": MOTION}, posture={"rocker": 1.5, "arm": 0.3, "swing": 1.8}, t=(INSTANT, 1, 2))
    try:
        graph = derive(scene)
    except AssemblyError:
        return
    closures = [float(instant_at(graph, INSTANT)[k]) for k, name in enumerate(graph.names) if name.startswith("_closure")]
    worst, gap = compare(scene, nudge=1e-3)
    if min(closures) > 1e-2:
        assert gap < 1e-10, worst


@settings(max_examples=25, deadline=None)
@given(st.floats(0.01, 1.0), st.floats(1.05, 8.0), masses, masses, st.floats(0.1, 5.0))
def test_random_slider_cranks(r, ratio, m1, m2, m3):
    parameters = {"r": r, "l": ratio * r, "m1": m1, "m2": m2, "m3": m3}
    worst, gap = compare(slider_crank(), parameters=parameters, nudge=1e-3)
    assert gap < 1e-11, worst


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(["revolute", "prismatic"]), st.booleans()), min_size=1, max_size=4))
def test_random_open_chains(parts):
    worst, gap = compare(chain(*parts), nudge=1e-3)
    assert gap < TOLERANCE, worst

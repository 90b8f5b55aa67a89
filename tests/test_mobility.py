"""Internal forces of many mechanisms against vector Newton-Euler on free bodies, which shares
nothing with the package.
"""

import math

import numpy as np
import pytest
from balance import compare, instant_at
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import INSTANT, MOTION, PATTERNS, chain, four_bar, slider_crank, truss_platform

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.declare.motion import polynomial
from lagrange_casadi.declare.parts import Link
from lagrange_casadi.errors import AssemblyError

TOLERANCE = 1e-12


@pytest.mark.parametrize("name", PATTERNS)
def test_every_force_against_newton_euler(name):
    worst, gap = compare(PATTERNS[name]())
    assert gap < TOLERANCE, worst


def test_loops_without_closed_form_against_newton_euler():
    scene = truss_platform()
    program = derive(scene)
    assert program.newton is not None
    worst, gap = compare(scene, t=0.0, nudge=0.003)
    assert gap < TOLERANCE, worst


def test_parent_and_child_exchanged_are_the_same_mechanism():
    """The reaction changes its sign with the roles, nothing else changes."""
    plain, turned = (
        evaluate(four_bar(turned=t), backend="vm") for t in ((False, False), (True, True))
    )
    for joint, sign in (("O", 1), ("A", -1), ("C", -1)):
        np.testing.assert_allclose(
            plain.reaction(joint).fx, sign * turned.reaction(joint).fx, rtol=1e-12
        )
        np.testing.assert_allclose(
            plain.reaction(joint).fy, sign * turned.reaction(joint).fy, rtol=1e-12
        )
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
        return evaluate(
            Scene(m, {"O": MOTION}, posture={"c": 1.5, "b": 0.5}, t=(INSTANT, 1, 3)), backend="vm"
        )

    one, two = declare("abc"), declare("cba")
    for name in one.names():
        scale = np.max(np.abs(one.array(name)), initial=1e-3)
        np.testing.assert_allclose(
            one.array(name), two.array(name), atol=1e-12 * scale, err_msg=name
        )


place = st.tuples(
    st.sampled_from(["base", "tip", "station", "beside"]), st.floats(0.1, 0.9), st.floats(-0.2, 0.2)
)
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


@settings(max_examples=10, deadline=None)
@given(st.lists(branch, min_size=1, max_size=5))
def test_random_trees(branches):
    """Links hung on each other anywhere by any joint, either end of which may be the parent, at
    stations on and off their axes.
    """
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


@settings(max_examples=6, deadline=None)
@given(
    st.tuples(lengths, lengths, lengths),
    st.tuples(masses, masses, st.floats(0.1, 5.0)),
    st.floats(0.1, 3.0),
    st.booleans(),
)
def test_random_four_bars(length, mass, frame, turned):
    try:
        worst, gap = compare(
            four_bar(length, mass, (frame, 0.1), 0.9, (turned, not turned)), nudge=1e-3
        )
    except AssemblyError:
        return
    if _transmission(four_bar(length, mass, (frame, 0.1), 0.9)) > 1e-2:
        assert gap < 1e-10, worst


def _transmission(scene):
    """How far a scene's loop is from a dead centre: the closure of
    loops.py, at its first instant.
    """
    program = derive(scene)
    return float(instant_at(program, scene.t[0])[program.names.index("_closure:B")])


@settings(max_examples=8, deadline=None)
@given(
    st.floats(0.05, 0.3),
    st.floats(-0.15, 0.15),
    st.tuples(masses, masses, masses, masses),
    st.floats(0.2, 0.4),
    st.booleans(),
)
def test_random_six_bars(x, y, mass, arm, turned):
    """A crank-rocker with a pin anywhere on its coupler that swings a second rocker; parents,
    children and order exchanged.
    """
    m = Mechanism("six_bar")
    swing = m.link("swing", length=0.28, mass=0.5)
    crank, coupler, rocker, last = (
        m.link(n, length=l, mass=w)
        for n, l, w in zip(
            ("crank", "coupler", "rocker", "arm"), (0.1, 0.35, 0.25, arm), mass, strict=True
        )
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
    scene = Scene(
        m, {"O": MOTION}, posture={"rocker": 1.5, "arm": 0.3, "swing": 1.8}, t=(INSTANT, 1, 2)
    )
    try:
        program = derive(scene)
    except AssemblyError:
        return
    closures = [
        float(instant_at(program, INSTANT)[k])
        for k, name in enumerate(program.names)
        if name.startswith("_closure")
    ]
    worst, gap = compare(scene, nudge=1e-3)
    if min(closures) > 1e-2:
        assert gap < 1e-10, worst


@settings(max_examples=6, deadline=None)
@given(st.floats(0.01, 1.0), st.floats(1.05, 8.0), masses, masses, st.floats(0.1, 5.0))
def test_random_slider_cranks(r, ratio, m1, m2, m3):
    parameters = {"r": r, "l": ratio * r, "m1": m1, "m2": m2, "m3": m3}
    worst, gap = compare(slider_crank(), parameters=parameters, nudge=1e-3)
    assert gap < 1e-11, worst


@settings(max_examples=8, deadline=None)
@given(
    st.lists(
        st.tuples(st.sampled_from(["revolute", "prismatic"]), st.booleans()), min_size=1, max_size=4
    )
)
def test_random_open_chains(parts):
    worst, gap = compare(chain(*parts), nudge=1e-3)
    assert gap < TOLERANCE, worst

"""The mechanisms that several tests share."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from conftest import NAMES
from operations import EACH, X, Y

from lagrange_casadi import Mechanism, Scene, curve
from lagrange_casadi.motion import expression, harmonic, polynomial, samples

MOTION = polynomial(0.2, 3.0, 4.0)

INSTANT = 0.3

PIN = Mechanism.revolute

PLAIN = [
    pytest.param(
        name,
        marks=[pytest.mark.long]
        * (name in ("delta", "parallel_leg", "quadruped", "stewart_gough", "v6")),
    )
    for name in NAMES
]
"""All cases as parameters, the large ones, whose joints are in others too, only with ``--long``."""


def links_of(m, **rows):
    """Declare links by rows: name to length and mass."""
    return [m.link(name, length=length, mass=mass) for name, (length, mass) in rows.items()]


def pins_of(m, axis=None, **rows):
    """Declare revolute joints by rows: name to parent and child; in space about an axis."""
    told = {} if axis is None else {"axis": axis}
    return [m.revolute(name, *ends, **told) for name, ends in rows.items()]


def slider_crank(wanted=("all",), mechanism=None, **keywords):
    """The paper's mechanism, with parameters; or another one with its motion."""
    keywords = {"posture": {"rod": 0.0}, "t": (0, 0.08, 81), "xi": (0, 1, 11)} | keywords
    return Scene(
        mechanism or crank_slider(),
        {"O": polynomial(0, 25 * math.pi, math.pi / 200)},
        wanted,
        **keywords,
    )


def crank_slider(pin=PIN, lengths=(0.1, 0.2)):
    m = Mechanism("slider_crank")
    r, l = (m.parameter(name, length, "m") for name, length in zip("rl", lengths, strict=True))
    crank, rod = links_of(
        m, crank=(r, m.parameter("m1", 0.1, "kg")), rod=(l, m.parameter("m2", 0.1, "kg"))
    )
    slider = m.point_mass("slider", m.parameter("m3", 0.1, "kg"))
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod))
    pin(m, "B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    return m


def four_bar(
    lengths=(0.1, 0.35, 0.25),
    masses=(0.3, 0.5, 0.4),
    frame=(0.3, 0.05),
    rocker=1.5,
    pin=PIN,
    **keywords,
):
    """A crank-rocker."""
    m = Mechanism("four_bar")
    a, b, c = (m.link(n, length=l, mass=w) for n, l, w in zip("abc", lengths, masses, strict=True))
    pins_of(m, O=(m.ground, a), A=(a.tip, b))
    pin(m, "B", b.tip, c.tip)
    m.revolute("C", m.ground.at(*frame), c)
    return Scene(m, {"O": MOTION}, posture={"c": rocker}, t=(INSTANT, 1.0, 2), **keywords)


def crank_and_rod(rod, crank=None, loads=lambda m, parts: None, **link):
    """A crank drives a rod whose tip slides on the x axis; the rod is declared by its keywords."""
    m = Mechanism("test")
    a = m.link("a", length=0.1, **(crank or {"mass": 0.3}))
    b = m.link("b", length=0.35, **rod)
    s = m.point_mass("s", 0.6)
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, s))
    m.prismatic("P", m.ground.at(0, 0.02), s, axis=(1, 0))
    loads(m, {"a": a, "b": b, "s": s})
    return Scene(m, {"O": MOTION}, posture={"b": 0.0}, t=(INSTANT, 1, 2))


def driven_slider():
    """The slider drives the crank."""
    m = Mechanism("driven_slider")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.35, mass=0.5)
    s = m.point_mass("s", 0.6)
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, s))
    m.prismatic("P", m.ground.at(0, 0.03), s, axis=(1, 0.2))
    return Scene(m, {"P": polynomial(0.3, 0.2, 0.1)}, posture={"a": 1.0}, t=(INSTANT, 1, 2))


def truss_platform(loads=lambda m: None):
    """A triangle of three bars on three legs, one leg's foot driven: no dyad anywhere, six unknown
    directions at once.
    """
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


def ladder(length=1.0, mass=2.0):
    """Its foot on the floor, its tip on the wall, its middle in the slot of a driven crank without
    mass.
    """
    m = Mechanism("ladder")
    crank, bar = m.link("crank", length=0.8, mass=0.0), m.link("bar", length=length, mass=mass)
    foot, tip, middle = (m.point_mass(name, 0.0) for name in ("foot", "tip", "middle"))
    m.revolute("O", m.ground, crank)
    m.prismatic("floor", m.ground, foot, axis=(1, 0))
    pins_of(m, F=(bar, foot), T=(bar.tip, tip))
    m.prismatic("wall", m.ground, tip, axis=(0, 1))
    m.revolute("M", bar.at(length / 2), middle)
    m.slot("slot", crank, middle)
    return Scene(
        m, {"O": polynomial(0.5, 0.2)}, t=(0, 3, 31), posture={"bar": math.pi - 0.5, "floor": 0.8}
    )


def parallelogram(third=1.0, pendulum=False):
    """Three equal cranks on one coupler: one of them is too many.

    The third is off the line of the others, so none is dead.
    """
    m = Mechanism("three_cranks")
    a, b, c = (m.link(n, length=0.2, mass=0.3) for n in "abc")
    bar = m.link("bar", length=1.0, mass=1.0)
    pins_of(
        m,
        O=(m.ground, a),
        P=(m.ground.at(0.4, 0), b),
        Q=(m.ground.at(third, 0.3), c),
        A=(a.tip, bar),
        B=(b.tip, bar.at(0.4)),
        C=(c.tip, bar.at(1.0, 0.3)),
    )
    motion = {"O": polynomial(0.7, 2.0)}
    if pendulum:
        m.revolute("hang", bar.at(0.7), m.link("bob", length=0.3, mass=0.4))
        motion["hang"] = polynomial(-1.5, 1.0)
    return Scene(m, motion, posture={"a": 0.7, "b": 0.7, "c": 0.7, "bar": 0.0}, t=(0, 3.0, 31))


def flat_parallelogram():
    m = Mechanism("parallelogram")
    a, b, c = links_of(m, a=(0.2, 1.0), b=(0.5, 1.0), c=(0.2, 1.0))
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, c.tip), C=(m.ground.at(0.5, 0), c))
    return Scene(m, {"O": polynomial(0.7, 4.0)}, posture={"b": 0.0, "c": 0.7}, t=(0, 1, 101))


def double_crank(step):
    """A drag link whose second crank a gear counts, so that it is iterated; instants ``step``
    radians of the drive apart.
    """
    m = Mechanism("double_crank")
    a, b, c = (m.link(n, length=l, mass=1.0) for n, l in (("a", 0.3), ("b", 0.25), ("c", 0.35)))
    wheel = m.link("wheel", length=0.1, mass=0.1)
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, c.tip))
    joints = m.revolute("C", m.ground.at(0.1, 0.0), c), m.revolute("G", m.ground.at(0.5, 0), wheel)
    m.gear("mesh", *joints, ratio=-2.0)
    return Scene(m, {"O": polynomial(0.2, 1.0)}, posture={"c": 0.6, "b": 1.5}, t=(0, 12 * step, 13))


def spline_arm():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    return Scene(m, {"J": samples([0, 1, 2, 3], [0, 1, 4, 2])}, t=(0, 3, 4))


def every_function():
    """An arm under a torque that takes every function there is."""
    m = Mechanism("functions")
    arm = m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    x, y = m.coordinate(joint) * m.rate(joint) / 2, m.rate(joint)
    each = EACH | {"acosh": ca.acosh(1 + X)}
    m.torque("t", arm, ca.substitute(sum(each.values()), ca.vertcat(X, Y), ca.vertcat(x, y)))
    return Scene(m, {"J": polynomial(0.3, 0.4)}, t=(0, 1, 9))


def cam_lift(angle):
    """A closed form for :func:`cam`: the lift [m] at an angle of the cam, of CasADi's or NumPy's
    numbers.
    """
    return 0.004 * (1 - np.cos(angle)) + 0.0007 * np.sin(3 * angle)


def cam(lift, motion=None, **keywords):
    """A cam lifts a rod that is guided upright, against a spring that stiffens by a curve and a
    side force.
    """
    m = Mechanism("cam")
    base = m.parameter("base", 0.03, "m", low=0.0)
    disc, rod = m.link("disc", length=0.03, mass=0.6), m.link("rod", length=0.1, mass=0.2)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, rod, axis=(0, 1), angle=math.pi / 2)
    rise = m.coordinate(guide) - base
    m.constraint("contact", rise - lift(m.coordinate(main)))
    spring = curve([-0.002, 0.0, 0.004, 0.008, 0.012], [-150.0, -200.0, -320.0, -470.0, -700.0])
    m.force("spring", rod.tip, x=15.0, y=spring(rise))
    keywords = {"posture": {"rod": 1.5}, "t": (0.0, 0.4, 161)} | keywords
    return Scene(m, {"main": motion or polynomial(0.3, 40.0, 5.0)}, **keywords)


def sampled_cam(count=73, **keywords):
    """The same, its lift by a curve through samples over the turn."""
    angles = np.linspace(0.0, 2 * math.pi, count)
    return cam(curve(angles, cam_lift(angles), periodic=True), **keywords)


def bracket(reach=0.9):
    """A mass slides along a swinging arm, beyond its tip and before its base."""
    m = Mechanism("bracket")
    arm = m.link("arm", length=m.parameter("l", 0.5, "m", low=0.0), mass=1.0)
    p = m.point_mass("p", 2.0)
    m.revolute("J", m.ground.at(0, 0), arm.at(0.1))
    m.prismatic("S", arm, p, axis=(1, 0))
    return Scene(
        m, {"J": polynomial(0.2, 3.0, 4.0), "S": harmonic(0.25, reach, 1.0)}, t=(0.0, 1.0, 101)
    )


DRAG_LINK = {"lengths": (0.3, 0.35, 0.32), "frame": (0.1, 0.0)}

STIFFNESS, FREE, DAMPING = 1.5, 0.2, 0.05


def coil(m, joint):
    m.torsion_spring(
        f"coil_{joint}", m.joints[joint], stiffness=STIFFNESS, angle=FREE, damping=DAMPING
    )


def sprung(
    joints,
    lengths=(0.1, 0.35, 0.25),
    frame=(0.3, 0.05),
    rocker=1.5,
    law=None,
    span=2.0,
    count=101,
    parametric=False,
    pin=PIN,
):
    """A four-bar with springs on some of its undriven joints."""
    m = Mechanism("sprung")
    sides = (
        [m.parameter(n, l, "m") for n, l in zip("pqr", lengths, strict=True)]
        if parametric
        else lengths
    )
    a, b, c = (
        m.link(n, length=l, mass=w) for n, l, w in zip("abc", sides, (0.3, 0.5, 0.4), strict=True)
    )
    pins_of(m, O=(m.ground, a), A=(a.tip, b))
    pin(m, "B", b.tip, c.tip)
    m.revolute("C", m.ground.at(*frame), c)
    for joint in joints:
        coil(m, joint)
    law = law or polynomial(0.2, 2 * math.pi)
    return Scene(m, {"O": law}, posture={"b": 0.9, "c": rocker}, t=(0.0, span, count))


MASS, LENGTH, G = 1.2, 0.5, 9.81


def pendulum(law, gravity=G, load=None, **keywords):
    m = Mechanism("pendulum")
    m.set_gravity(0, -gravity)
    arm = m.link("arm", length=LENGTH, mass=MASS)
    pin = m.revolute("pin", m.ground, arm)
    if load:
        m.force("push", arm.tip, x=load(m.coordinate(pin)))
    return Scene(m, {"pin": law}, **keywords)


def counting(motion, load, **parameters):
    """A driven crank with a load on its rod; ``load(m, angle)`` is a force on the slider along its
    guide.
    """
    m = Mechanism("counting")
    symbols = {name: m.parameter(name, value) for name, value in parameters.items()}
    crank, rod = m.link("crank", length=0.1, mass=0.3), m.link("rod", length=0.35, mass=0.5)
    slider = m.point_mass("slider", 0.6)
    joint, *_ = pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, slider))
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    m.force("load", slider, x=load(m, m.coordinate(joint), **symbols))
    return Scene(m, {"O": motion}, posture={"rod": 0.0}, t=(0.0, 0.1, 11))


def harmonics(m, angle):
    """A load on :func:`counting`'s slider."""
    return 5.0 * ca.sin(3 * angle) + ca.cos(angle / 2 - 0.1) ** 2


def sampled(scale):
    """A crank driven through samples of a steady rate beside a swing."""
    t = np.linspace(0.0, 100.0, 401)
    return counting(samples(t, scale * (5.0 * t + 0.2 * np.sin(t))), harmonics)


def far(distance, load=0.0):
    """A four-bar so far from the origin that places lose what is behind the point; under a load, or
    none.
    """
    m = Mechanism("far")
    a, b, c = (
        m.link(name, length=length, mass=1.0)
        for name, length in zip("abc", (0.1, 0.35, 0.25), strict=True)
    )
    pins_of(
        m,
        O=(m.ground.at(distance, 0), a),
        A=(a.tip, b),
        B=(b.tip, c.tip),
        C=(m.ground.at(distance + 0.3, 0.05), c),
    )
    if load:
        m.force("load", c.at(0.1), x=load)
    return Scene(m, {"O": polynomial(0, 10.0)}, t=(0, 0.6, 61), posture={"c": 1.5})


def press(law=polynomial, wanted=("all",), pin=PIN, **keywords):
    """A press whose speed is a parameter: ``law(0, w)`` gives the crank's motion, ``t`` and
    ``over`` may be functions of it.
    """
    m = Mechanism("press")
    rpm, length = m.parameter("rpm", 600.0, "1/min"), m.parameter("l", 0.5, "m", low=0.0)
    crank, rod = links_of(m, crank=(0.1, 1.2), rod=(length, 2.0))
    ram = m.point_mass("ram", 15.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod))
    pin(m, "B", rod.tip, ram)
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    asked = {
        name: keywords.pop(name)(rpm) for name in ("t", "over") if callable(keywords.get(name))
    }
    return Scene(
        m,
        {"O": law(0, rpm * math.tau / 60)},
        wanted,
        posture={"rod": 1.5, "guide": 0.6},
        **asked,
        **keywords,
    )


def uneven(_, w):
    """A crank's motion at the mean speed w that is uneven by a fifth."""
    return expression(lambda t: w * t + 0.2 * ca.sin(w * t))


def standing_rod():
    """A rod of 1 m and 2 kg that stands on the ground, where its turn is driven, and is pulled up
    at its middle.
    """
    m = Mechanism("rod")
    mu, pull = m.parameter("mu", 0.5), m.parameter("pull", 0.0, "N")
    rod = m.link("rod", length=1.0, mass=2.0)
    m.contact("foot", rod, friction=mu, at=(0.0, 0.0))
    m.force("up", rod.at(0.5), y=pull)
    return Scene(m, {"foot": polynomial("60 deg", 0.0, -1.0)}, t=(0, 0.3, 4))

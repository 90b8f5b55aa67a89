"""Mechanisms whose loops are iterated, for want of a closed form; one that is pushed one way."""

from __future__ import annotations

import math

import casadi as ca
from mechanisms import MOTION, crank_slider, slider_crank

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import expression


def pinned(m, name, one, other):
    """A pin by two equations that no closed form solves: what it closes is iterated."""
    (x, y), (u, v) = m.place(one), m.place(other)
    for axis, gap in (("x", x - u), ("y", y - v)):
        m.constraint(f"{name}_{axis}", gap * ca.exp(x - u))


def iterated(wanted=("all",), **keywords):
    """The slider-crank of the other tests, iterated."""
    return slider_crank(
        wanted, crank_slider(pinned), posture={"rod": 0.0, "guide": 0.3}, **keywords
    )


def two_rods(motion=MOTION, **keywords):
    """A crank with two rods across each other: one rod's loop has a closed form, the other one's is
    iterated.
    """
    m, posture = Mechanism("two_rods"), {}
    r, l = m.parameter("r", 0.1, "m"), m.parameter("l", 0.3, "m")
    crank = m.link("crank", length=r, mass=0.1)
    m.revolute("O", m.ground, crank)
    for name, length, pin, way in (
        ("closed", l, Mechanism.revolute, (1, 0)),
        ("stepped", 0.5, pinned, (0, 1)),
    ):
        rod = m.link(f"{name}_rod", length=length, mass=0.1)
        slider = m.point_mass(f"{name}_slider", 0.1)
        m.revolute(f"{name}_A", crank.tip, rod)
        pin(m, f"{name}_B", rod.tip, slider)
        m.prismatic(f"{name}_guide", m.ground, slider, axis=way)
        posture |= {f"{name}_rod": math.atan2(*reversed(way)), f"{name}_guide": 0.4}
    return Scene(m, {"O": motion}, posture=posture, **{"t": (0, 1, 61), **keywords})


def one_way(comparison):
    """A slide on the 3-4-5 law of 1 m in 1 s, whose work resists by what a rate is compared to."""
    m = Mechanism("feeder")
    slide = m.point_mass("slide", m.parameter("mass", 20.0, "kg", low=1.0))
    way = m.prismatic("way", m.ground, slide, axis=(1, 0))
    m.force("work", slide, x=-100.0 * comparison(m.rate(way)))
    law = expression(lambda t: t**3 * (10 + t * (6 * t - 15)))
    return Scene(m, {"way": law}, t=(0, 1, 101))

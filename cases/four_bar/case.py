"""A crank-rocker four-bar at constant speed."""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = Mechanism("four_bar")
    a, b, c = (
        m.parameter(name, value, "m", low=0.0)
        for name, value in (("a", 0.1), ("b", 0.35), ("c", 0.25))
    )
    crank = m.link("crank", length=a, mass=0.3)
    coupler = m.link("coupler", length=b, mass=0.5)
    rocker = m.link("rocker", length=c, mass=0.4)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("B", coupler.tip, rocker.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), rocker)
    return Scene(m, motion={"O": polynomial(0, 20 * pi)}, t=(0, 0.1, 401), posture={"rocker": 1.5})

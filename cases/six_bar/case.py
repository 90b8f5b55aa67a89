"""A Stephenson III six-bar: a four-bar whose coupler carries, beside its axis, the pin that drives
a second rocker.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = Mechanism("six_bar")
    crank = m.link("crank", length=0.1, mass=0.3)
    coupler = m.link("coupler", length=0.35, mass=0.6)
    rocker = m.link("rocker", length=0.25, mass=0.4)
    arm = m.link("arm", length=0.3, mass=0.3)
    swing = m.link("swing", length=0.28, mass=0.5)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("B", coupler.tip, rocker.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), rocker)
    m.revolute("D", coupler.at(0.2, 0.12), arm)
    m.revolute("E", arm.tip, swing.tip)
    m.revolute("F", m.ground.at(0.45, 0.35), swing)
    return Scene(
        m,
        motion={"O": polynomial(0, 10 * pi)},
        t=(0, 0.2, 401),
        posture={"rocker": 1.5, "arm": 0.3, "swing": 1.8},
    )

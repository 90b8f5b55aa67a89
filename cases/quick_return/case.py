"""A shaper's quick return: a crank's pin in the slot of a rocker, and a ram that the rocker's end
drives.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = Mechanism("quick_return")
    r = m.parameter("r", 0.1, "m", low=0.0)
    cutting = m.parameter("cutting", 400.0, "N")
    crank = m.link("crank", length=r, mass=1.0)
    rocker = m.link("rocker", length=0.6, mass=4.0)
    connecting = m.link("connecting", length=0.25, mass=1.0)
    ram = m.point_mass("ram", 10.0)
    m.revolute("O", m.ground, crank)
    m.revolute("C", m.ground.at(0, -0.3), rocker)
    m.slot("slot", rocker, crank.tip)
    m.revolute("D", rocker.tip, connecting)
    m.revolute("E", connecting.tip, ram)
    way = m.prismatic("way", m.ground.at(0, 0.3), ram, axis=(1, 0))
    # The tool cuts on the slow stroke and meets nothing on the quick one: the force follows the
    # sign of the ram's rate.
    rate = m.rate(way)
    m.force("cut", ram, x=-cutting * (rate > 0))
    return Scene(
        m,
        motion={"O": polynomial(0, -4 * pi)},
        t=(0, 0.5, 401),
        posture={"rocker": 1.5, "connecting": 0.0},
    )

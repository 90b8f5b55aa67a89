"""A Geneva drive with six slots that turns an indexing table by 60 deg, and locks it for two thirds
of a turn of its crank.
"""

from math import pi, sin, tan

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import geneva
from lagrange_casadi.motion import polynomial

SLOTS = 6
START = -3.0
"""Angle of the crank at the first instant [rad]: the table is locked."""


def scene() -> Scene:
    m = Mechanism("geneva")
    rpm = m.parameter("rpm", 60.0, "1/min", low=0.0)
    r = m.parameter("r", 0.08, "m", low=0.0)
    table = m.parameter("table", 0.9, "kg m^2", low=0.0)
    drag = m.parameter("drag", 4.0, "N m s/rad", low=0.0)
    tool = m.parameter("tool", 15.0, "N m")
    m.set_gravity(0.0, 0.0)  # both axes are upright
    crank = m.link("crank", length=r, mass=2.5, centre=(0.0, 0.0), inertia=6e-3)
    wheel = m.link("wheel", length=r / tan(pi / SLOTS), mass=18.0, centre=(0.0, 0.0), inertia=table)
    main = m.revolute("main", m.ground, crank)
    axle = m.revolute("axle", m.ground.at(r / sin(pi / SLOTS), 0.0), wheel)
    geneva(m, "index", main, axle, slots=SLOTS, lock=0.75 * r)
    m.torque("friction", wheel, -drag * m.rate(axle))
    m.torque("tool", wheel, tool)
    return Scene(m, {"main": polynomial(START, 2 * pi / 60 * rpm)}, t=(0, 2, 721))

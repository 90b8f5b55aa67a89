"""A four-bar with skew axes: a crank drives a rocker by a coupler between two spherical joints."""

from math import pi

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = SpatialMechanism("rssr")
    speed = m.parameter("speed", 10.0, "rad/s")
    brake = m.parameter("brake", 1.5, "N m")
    m.set_gravity(0.0, -9.81, 0.0)
    crank = m.link("crank", length=m.parameter("r", 0.1, "m", low=0.01, high=0.15), mass=0.4)
    coupler = m.link("coupler", length=m.parameter("l", 0.4, "m", low=0.2, high=1.0), mass=0.8)
    rocker = m.link("rocker", length=0.25, mass=0.6)
    # The rocker turns about (0.48, 0.8, 0.36), and lies along (0.6, 0, -0.8) where its angle is
    # zero.
    axis, along = (0.48, 0.8, 0.36), (0.6, 0.0, -0.8)
    across = (-0.64, 0.6, -0.48)
    m.revolute("O", m.ground, crank)
    m.spherical("A", crank.tip, coupler)
    m.spherical("B", coupler.tip, rocker.tip)
    m.revolute("Q", m.ground.at(0.3, -0.1, 0.2), rocker, axis=axis, turned=(along, across))
    x, y, z = axis
    m.torque("brake", rocker, x=-brake * x, y=-brake * y, z=-brake * z)
    return Scene(m, {"O": polynomial(0.4, speed)}, t=(0, pi / 5, 361), posture={"Q": 2.9})

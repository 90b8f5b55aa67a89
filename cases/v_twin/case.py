"""A compressor of two cylinders at a right angle on one pin of the crank, all of whose bearings and
rings have friction.
"""

from math import pi, sqrt

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial

CYLINDERS = {"left": (pi / 2, (0, 1)), "right": (0.0, (1, 0))}
"""The directions in which the cylinders lie, as an angle and as a vector: along x and y, and
gravity falls between them.
"""


def scene() -> Scene:
    m = Mechanism("v_twin")
    m.set_gravity(-9.81 / sqrt(2), -9.81 / sqrt(2))
    stroke, bore = (
        m.parameter("stroke", 0.07, "m", low=0.0),
        m.parameter("bore", 0.085, "m", low=0.0),
    )
    mu_rings, mu_pins = (
        m.parameter("mu_rings", 0.08, low=0.0),
        m.parameter("mu_pins", 0.02, low=0.0),
    )
    crank = m.link("crank", length=stroke / 2, mass=3.0, centre=(-0.008, 0.0), inertia=4e-3)
    main = m.revolute("main", m.ground, crank)
    m.friction("main_bearing", main, mu=mu_pins, radius=0.022)
    for side, (way, (x, y)) in CYLINDERS.items():
        rod = m.link(f"{side}_rod", length=0.13, mass=0.42)
        piston = m.link(
            f"{side}_piston", length=0.06, mass=0.38, centre=(0.01 * x, 0.01 * y), inertia=5e-4
        )
        big_end = m.revolute(f"{side}_big_end", crank.tip, rod)
        wrist = m.revolute(f"{side}_wrist", rod.tip, piston)
        wall = m.prismatic(f"{side}_wall", m.ground, piston, axis=(x, y))
        m.friction(f"{side}_bearing", big_end, mu=mu_pins, radius=0.02)
        m.friction(f"{side}_pin", wrist, mu=mu_pins, radius=0.01)
        m.friction(f"{side}_rings", wall, mu=mu_rings, length=0.05)
        # A smooth diagram: gauge pressure rises towards the top of the stroke, on the way up more
        # than on the way down.
        turned = m.coordinate(main) - way
        pressure = 1e5 * (
            3.0 + 2.5 * ca.cos(turned) - 1.75 * ca.sin(turned) + 0.5 * ca.cos(2 * turned)
        )
        push = -pressure * pi / 4 * bore**2
        m.force(f"{side}_gas", piston, x=push * x, y=push * y)
    posture = {f"{side}_rod": way for side, (way, _) in CYLINDERS.items()}
    return Scene(
        m, {"main": polynomial(pi / 36, 1450 * 2 * pi / 60)}, t=(0, 60 / 1450, 361), posture=posture
    )

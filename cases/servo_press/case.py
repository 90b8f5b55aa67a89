"""A servo press: a crank that runs slowly while its ram draws a part, and quickly for the rest of
the stroke.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Mechanism, Scene, table
from lagrange_casadi.motion import expression

# The force of the part over the largest one, over the ram's height above its lowest place [mm].
HEIGHTS = (0, 5, 15, 30, 39, 40)
SHARES = (0.55, 0.7, 0.95, 1.0, 0.6, 0.0)


def scene() -> Scene:
    m = Mechanism("servo_press")
    strokes = m.parameter("strokes", 30.0, "1/min", low=0.0)
    slowing = m.parameter(
        "slowing", 0.5, low=0.0, high=0.9
    )  # by how much of its mean speed the crank is slower at the bottom
    drawing = m.parameter("drawing", 250e3, "N", low=0.0)
    r = m.parameter("r", 0.08, "m", low=0.0)
    l = m.parameter("l", 0.6, "m", low=0.0)
    mass = m.parameter("mass", 400.0, "kg", low=0.0)
    crank = m.link("crank", length=r, mass=90.0, centre=(0.02, 0.0), inertia=6.0)
    rod = m.link("rod", length=l, mass=80.0)
    ram = m.point_mass("ram", mass)
    main = m.revolute("main", m.ground, crank)
    m.revolute("crankpin", crank.tip, rod)
    m.revolute("wrist", rod.tip, ram)
    guide = m.prismatic("guide", m.ground, ram, axis=(0, -1))
    height = 1000 * (r + l - m.coordinate(guide))
    m.force(
        "part",
        ram,
        y=drawing * table(height, HEIGHTS, SHARES, beyond="hold") * (m.rate(guide) > 0),
    )
    m.force("counterbalance", ram, y=mass * 9.81)
    m.output("height", height / 1000, unit="m")
    m.output("power", m.results.effort(main) * m.rate(main), unit="W")
    turn = 2 * pi / 60 * strokes
    # From the top, where the crank is at a right angle; it is slowest half a turn later, at the
    # bottom.
    law = expression(lambda t: pi / 2 + turn * t + slowing * ca.sin(turn * t))
    # A whole stroke at any rate; no instant lies at the bottom, where the force jumps.
    return Scene(
        m,
        {"main": law},
        t=(0, 2, 720),
        over=("main", "90 deg", "450 deg", 720),
        posture={"rod": -pi / 2},
    )

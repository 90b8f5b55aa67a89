"""A planetary gear: a sun drives three planets in a ring that stands still, and their carrier stirs
slowly.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import planetary, wheel
from lagrange_casadi.motion import polynomial

SUN, PLANET, RING = 24, 18, 60
"""Numbers of teeth: the carrier makes one turn for RING/SUN + 1 = 3.5 of the sun."""


def scene() -> Scene:
    m = Mechanism("planetary_gear")
    module = m.parameter("module", 0.002, "m", low=5e-4)
    rpm = m.parameter("rpm", 1450.0, "1/min", low=1.0)
    torque = m.parameter("torque", 90.0, "N m", low=0.0)
    unsteady = m.parameter("unsteady", 0.3, "1", low=0.0, high=1.0)
    width = 0.025
    sun = wheel(m, "sun", radius=module * SUN / 2, width=width, teeth=SUN)
    ring = wheel(
        m,
        "ring",
        radius=module * RING * 0.6,
        bore=module * RING / 2,
        width=width,
        teeth=RING,
        internal=True,
    )
    carrier = m.link(
        "carrier", length=module * (SUN + PLANET) / 2, mass=1.2, centre=(0, 0), inertia=8e-4
    )
    main = m.revolute("input", m.ground, sun)
    output = m.revolute("output", m.ground, carrier)
    m.weld("housing", m.ground, ring)
    planetary(
        m,
        "set",
        sun,
        carrier,
        ring,
        teeth=(SUN, PLANET, RING),
        module=module,
        planets=3,
        width=width,
    )
    # A stirrer of four blades.
    m.torque("stirred", carrier, -torque * (1.0 + unsteady * ca.sin(4.0 * m.coordinate(output))))
    m.output("power", m.results.effort(main) * m.rate(main), unit="W")
    return Scene(
        m, {"input": polynomial(0.0, 2 * pi / 60 * rpm)}, over=("input", 0, "1260 deg", 421)
    )

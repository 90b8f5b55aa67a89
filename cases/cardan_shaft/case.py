"""A cardan shaft: two universal joints, in phase or not, lead a shaft's turning to one that stands
parallel beside it.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = SpatialMechanism("cardan_shaft")
    rpm = m.parameter("rpm", 600.0, "1/min")
    aside = m.parameter("aside", 0.15, "m", low=0.01, high=0.3)
    phase = m.parameter("phase", 0.0, "rad", low=-pi / 2, high=pi / 2)
    load = m.parameter("load", 80.0, "N m")
    length = 0.5
    middle = (0.05, 0.0, 0.0)
    shaft = m.link("shaft", length=0.1, mass=3.0, centre=middle, inertia=(0.02, 0.012, 0.012))
    tube = m.link("tube", length=length, mass=2.0)
    output = m.link("output", length=0.1, mass=3.0, centre=middle, inertia=(0.05, 0.03, 0.03))
    along = (1.0, 0.0, 0.0)
    m.revolute("bearing", m.ground, shaft, axis=along)
    m.universal("first", shaft.tip, tube, axis=(0.0, 0.0, 1.0), second=(0.0, 1.0, 0.0))
    # In phase, the second joint's pins on the tube are parallel to the first one's.
    fork = (0.0, ca.cos(phase), ca.sin(phase))
    m.universal("second", output, tube.tip, axis=(0.0, -ca.sin(phase), ca.cos(phase)), second=fork)
    m.cylindrical("far", m.ground.at(0.6, aside, 0.0), output, axis=along)
    m.torque("load", output, x=-load)
    posture = {"first:turn_1": 0.3, "first:turn_2": 0.0, "far:turn": 0.0, "far:slide": 0.0}
    return Scene(
        m,
        {"bearing": polynomial(0.0, 2 * pi / 60 * rpm)},
        over=("bearing", 0.0, 2 * pi, 361),
        posture=posture,
    )

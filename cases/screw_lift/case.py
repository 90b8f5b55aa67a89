"""A screw lift: a spindle that a motor turns raises and lowers a table by a nut, whose thread has
friction and locks itself.
"""

from math import pi

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

RADIUS = 0.0135
"""The mean radius of a trapezoidal thread of 30 mm with a pitch of 6 mm [m]."""


def scene() -> Scene:
    m = SpatialMechanism("screw_lift")
    payload = m.parameter("payload", 800.0, "kg", low=0.0)
    lead = m.parameter("lead", 0.006, "m", low=0.001, high=0.04)
    mu = m.parameter("mu", 0.12, "1", low=0.0, high=0.5)
    stroke = m.parameter("stroke", 0.2, "m", low=0.01, high=0.8)
    period = m.parameter("period", 8.0, "s", low=1.0)
    spindle = m.link(
        "spindle", length=0.9, mass=5.0, centre=(0.45, 0, 0), inertia=(6e-4, 0.34, 0.34)
    )
    table = m.link("table", length=0.4, mass=60.0, centre=(0, 0, 0), inertia=(2.0, 2.0, 3.5))
    motor = m.revolute(
        "motor", m.ground.at(0, 0, -0.45), spindle, axis=(0, 0, 1), turned=[("y", "-90 deg")]
    )
    guide = m.prismatic("guide", m.ground, table, axis=(0, 0, 1))
    thread = m.screw(
        "thread", spindle.at(0.45), table, axis=(1, 0, 0), lead=lead, turned=[("y", "90 deg")]
    )
    m.friction("flanks", thread, mu=mu, radius=RADIUS)
    m.force("weight", table, z=-9.81 * payload)
    m.output("power", m.results.effort(motor) * m.rate(motor), unit="W")
    m.output(
        "lifting_power",
        (9.81 * (payload + 60.0) + 60.0 * m.results.acceleration(guide)) * m.rate(guide),
        unit="W",
    )
    # The spindle carries a right-handed thread, and turns backward while the nut rises; heights are
    # from the middle of the stroke.
    turning = harmonic(0.0, pi * stroke / lead, 1.0 / period, pi)
    return Scene(m, {"motor": turning}, t=(0, period, 240), posture={"thread": 0.0})

"""A robot on four legs that sways on its feet, which stay where they are: torques with the least
sum of squares, and the friction that the feet need.
"""

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic, polynomial

HEIGHT, WIDE, LEAN = 0.3, 0.08, 0.12
"""Height of the trunk, width of a hip, and how far a knee is behind its hip [m]."""

LEGS = {"FL": (0.2, 1.0), "FR": (0.2, -1.0), "RL": (-0.2, 1.0), "RR": (-0.2, -1.0)}
"""Where each leg is along the trunk [m], and on which side."""


def scene() -> Scene:
    m = SpatialMechanism("quadruped")
    payload = m.parameter("payload", 2.0, "kg", low=0.0, high=10.0)
    friction = m.parameter("friction", 0.8, low=0.0)
    trunk = m.link(
        "trunk",
        between=((-0.2, 0.0, HEIGHT), (0.2, 0.0, HEIGHT)),
        mass=8.0,
        centre=(0.0, 0.0, HEIGHT),
        inertia=(0.03, 0.12, 0.13),
    )
    m.free("base", m.ground, trunk, at=(0.0, 0.0, HEIGHT))
    load = m.point_mass("load", payload)
    m.weld("strap", trunk, load, at=(0.0, 0.0, HEIGHT + 0.08))
    for leg, (x, side) in LEGS.items():
        y = 0.05 * side
        hip, thigh = (x, y, HEIGHT), (x, y + WIDE * side, HEIGHT)
        knee, foot = (x - LEAN, y + WIDE * side, HEIGHT / 2), (x, y + WIDE * side, 0.0)
        upper = m.link(f"{leg}_hip", between=(hip, thigh), mass=0.6)
        middle = m.link(f"{leg}_thigh", between=(thigh, knee), mass=0.9)
        lower = m.link(f"{leg}_calf", between=(knee, foot), mass=0.2)
        roll = m.revolute(f"{leg}_roll", trunk, upper, at=hip, axis=(1.0, 0.0, 0.0))
        pitch = m.revolute(f"{leg}_pitch", upper, middle, at=thigh, axis=(0.0, 1.0, 0.0))
        bend = m.revolute(f"{leg}_knee", middle, lower, at=knee, axis=(0.0, 1.0, 0.0))
        for joint in (roll, pitch, bend):
            m.drive(
                f"{joint.name}_motor", joint, rotor_inertia=4e-5, ratio=9.0, effort=24.0, speed=20.0
            )
        m.contact(f"{leg}_foot", lower.tip, friction=friction)
    laws = {
        "base:slide_1": harmonic(0.0, 0.03, 1.0),
        "base:slide_2": harmonic(0.0, 0.02, 0.5),
        "base:slide_3": harmonic(0.0, 0.01, 1.0),
        "base:turn_1": harmonic(0.0, 0.05, 0.5),
        "base:turn_2": harmonic(0.0, 0.05, 1.0, 0.5),
        "base:turn_3": polynomial(0.0),
    }
    drives = [f"{leg}_{joint}" for leg in LEGS for joint in ("roll", "pitch", "knee")]
    return Scene(m, laws, t=(0.0, 2.0, 101), drives=drives)

"""A wheel suspension of five bars: the hub goes up and down, and a load acts where the tyre stands.

All is declared by hard points: places in ground axes, in one posture of reference.
"""

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

WHEEL = (0.0, 0.7, 0.3)
BARS = {
    "upper_front": ((0.25, 0.35, 0.4), (0.15, 0.65, 0.42)),
    "upper_rear": ((-0.25, 0.35, 0.38), (-0.15, 0.65, 0.4)),
    "lower_front": ((0.3, 0.25, 0.2), (0.12, 0.65, 0.18)),
    "lower_rear": ((-0.3, 0.25, 0.22), (-0.12, 0.65, 0.2)),
    "toe": ((0.15, 0.3, 0.29), (0.05, 0.62, 0.28)),
}
"""Where the bars are held on the body, and on the hub."""


def scene() -> Scene:
    m = SpatialMechanism("five_link_suspension")
    travel = m.parameter("travel", 0.05, "m", low=0.0, high=0.08)
    stand, side = m.parameter("stand", 4000.0, "N"), m.parameter("side", 2500.0, "N")
    x, y, z = WHEEL
    hub = m.link(
        "hub",
        between=((x, y - 0.1, z), WHEEL),
        mass=18.0,
        centre=(x, y - 0.03, z),
        inertia=(0.4, 0.6, 0.4),
    )
    for name, (inner, outer) in BARS.items():
        bar = m.link(name, between=(inner, outer), mass=0.9)
        m.spherical(f"{name}_body", m.ground, bar, at=inner)
        m.spherical(f"{name}_hub", bar, hub, at=outer)
    m.free("wheel", m.ground, hub, at=WHEEL)
    spring = m.at(hub, x, y - 0.08, z - 0.02)
    m.spring(
        "strut", m.ground.at(0.0, 0.45, 0.75), spring, stiffness=30e3, length=0.62, damping=1.8e3
    )
    m.force("tyre", m.at(hub, x, y, 0.0), y=-side, z=stand)
    return Scene(m, {"wheel:slide_3": harmonic(0.0, travel, 1.0)}, t=(0.0, 1.0, 201))

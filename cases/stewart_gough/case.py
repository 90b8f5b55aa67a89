"""A Stewart-Gough platform: its pose is given, and the efforts in its six legs make it."""

from math import cos, pi, radians, sin

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

BASE, TOP = (12, 108, 132, 228, 252, 348), (48, 72, 168, 192, 288, 312)
"""Where the legs stand on their circles [deg]."""


def scene() -> Scene:
    m = SpatialMechanism("stewart_gough")
    payload = m.parameter("payload", 6.0, "kg", low=0.1)
    height = m.parameter("height", 0.6, "m", low=0.5, high=0.7)
    centre = (0.01, -0.015, 0.03)
    platform = m.link(
        "platform", length=0.3, mass=payload, centre=centre, inertia=(0.11, 0.12, 0.2)
    )
    # Heave, sway and surge, then yaw, pitch and roll. The third direction is at right angles to
    # both given ones: -x.
    m.free("pose", m.ground, platform, axis=(0.0, 0.0, 1.0), second=(0.0, 1.0, 0.0))
    posture: dict[str, float] = {}
    for k, (low, high) in enumerate(zip(BASE, TOP, strict=True)):
        cylinder, piston = (
            m.link(f"cylinder{k}", length=0.4, mass=1.2),
            m.link(f"piston{k}", length=0.45, mass=0.7),
        )
        foot, head = _on_circle(0.5, low), _on_circle(0.3, high)
        # A leg stands upright where the angles of its joint are zero.
        upright = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
        m.universal(
            f"U{k}",
            m.ground.at(*foot),
            cylinder,
            axis=(1.0, 0.0, 0.0),
            second=(0.0, 1.0, 0.0),
            turned=upright,
        )
        m.prismatic(f"P{k}", cylinder, piston, axis=(1.0, 0.0, 0.0))
        m.spherical(f"S{k}", piston.tip, platform.at(*head))
        posture |= {f"U{k}:turn_1": 0.0, f"U{k}:turn_2": 0.0, f"P{k}": 0.2}
    m.force("tool", platform.at(*centre), x=20.0, y=-10.0, z=-60.0)
    m.torque("twist", platform.at(*centre), x=1.0, y=2.0, z=-1.5)
    law = (
        harmonic(height, 0.03, 4 / (2 * pi)),
        harmonic(0.0, 0.04, 2 / (2 * pi), 0.5),
        harmonic(0.0, -0.05, 3 / (2 * pi)),
        harmonic(0.0, 0.15, 1.5 / (2 * pi), 1.0),
        harmonic(0.0, 0.08, 3.5 / (2 * pi)),
        harmonic(0.0, -0.1, 2.5 / (2 * pi), 0.3),
    )
    return Scene(
        m, {"pose": law}, t=(0.0, 2.0, 201), posture=posture, drives=[f"P{k}" for k in range(6)]
    )


def _on_circle(radius: float, angle: float) -> tuple[float, float, float]:
    """A place, to a tenth of a millimetre."""
    return round(radius * cos(radians(angle)), 4), round(radius * sin(radians(angle)), 4), 0.0

"""A delta robot: three arms and six bars move a platform that does not turn; its place is given,
and the arms drive.
"""

from math import cos, pi, sin

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

HIP, ANKLE, HALF = 0.2, 0.06, 0.04
"""How far the arms' axes and the bars' ends on the platform are from the middle, and half the
distance between two bars [m].
"""


def scene() -> Scene:
    m = SpatialMechanism("delta")
    upper = m.parameter("upper", 0.3, "m", low=0.2, high=0.4)
    lower = m.parameter("lower", 0.65, "m", low=0.5, high=0.9)
    payload = m.parameter("payload", 0.5, "kg", low=0.05)
    platform = m.link(
        "platform", length=0.1, mass=payload, centre=(0.0, 0.0, 0.0), inertia=(4e-4, 4e-4, 6e-4)
    )
    m.free("tool", m.ground, platform)
    posture = {f"tool:turn_{k}": 0.0 for k in (1, 2, 3)}
    for k in range(3):
        c, s = cos(2 * pi * k / 3), sin(2 * pi * k / 3)
        arm = m.link(f"arm{k}", length=upper, mass=0.4)
        # An arm is level and points outward at zero, and turns downward.
        m.revolute(
            f"motor{k}",
            m.ground.at(HIP * c, HIP * s, 0.0),
            arm,
            axis=(-s, c, 0.0),
            turned=((c, s, 0.0), (-s, c, 0.0)),
        )
        for side, name in ((-HALF, "left"), (HALF, "right")):
            bar = m.link(f"{name}{k}", length=lower, mass=0.12)
            m.spherical(f"{name}_knee{k}", arm.at(upper, side, 0.0), bar)
            m.spherical(
                f"{name}_ankle{k}",
                bar.tip,
                platform.at(ANKLE * c - side * s, ANKLE * s + side * c, 0.0),
            )
        posture[f"motor{k}"] = 0.4
    laws = {
        "tool:slide_1": harmonic(0.0, 0.12, 2.0),
        "tool:slide_2": harmonic(0.0, 0.08, 2.0, pi / 2),
        "tool:slide_3": harmonic(-0.62, 0.05, 4.0),
    }
    return Scene(
        m, laws, t=(0.0, 0.5, 201), posture=posture, drives=[f"motor{k}" for k in range(3)]
    )

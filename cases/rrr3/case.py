"""The 3-RRR planar parallel robot: a triangular platform on three legs, three drives."""

from math import cos, pi, sin

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import harmonic

BASE, PLATFORM, LEG = 0.5, 0.12, 0.28


def corner(radius: float, i: int) -> tuple[float, float]:
    angle = 2 * pi * i / 3 + pi / 6
    return radius * cos(angle), radius * sin(angle)


def scene() -> Scene:
    m = Mechanism("rrr3")
    platform = m.link("platform", length=0.2, mass=1.5, centre=(0.0, 0.0), inertia=0.01)
    posture, motion = {"platform": 0.0}, {}
    for i in range(3):
        (fx, fy), (px, py) = corner(BASE, i), corner(PLATFORM, i)
        upper, lower = (
            m.link(f"upper{i}", length=LEG, mass=0.8),
            m.link(f"lower{i}", length=LEG, mass=0.5),
        )
        m.revolute(f"drive{i}", m.ground.at(fx, fy), upper)
        m.revolute(f"knee{i}", upper.tip, lower)
        m.revolute(f"foot{i}", lower.tip, platform.at(px, py))
        # The elbow that lies clockwise of the line from the drive to the platform.
        inward = 2 * pi * i / 3 + pi / 6 + pi
        posture[f"upper{i}"], posture[f"lower{i}"] = inward - 0.8, inward + 0.8
        motion[f"drive{i}"] = harmonic(inward - 0.8, 0.2, 1.0, 2 * pi * i / 3)
    return Scene(m, motion=motion, t=(0, 1, 201), posture=posture)

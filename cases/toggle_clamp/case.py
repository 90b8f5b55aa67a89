"""A toggle clamp: a pneumatic cylinder pushes the knee of two links almost straight, which press a
jaw on a part.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import cylinder, strut
from lagrange_casadi.motion import move, moves

LINK = 0.12
"""Length of both links [m]."""
REAR = -0.36
"""The cylinder is mounted so far beside the line of the jaw [m], as high as the straight knee."""
OPEN, SHUT = 35 * pi / 180, 2.5 * pi / 180
"""Angle of both links from the line of the jaw, open and clamped [rad]."""


def scene() -> Scene:
    m = Mechanism("toggle_clamp")
    stiffness = m.parameter("stiffness", 8e6, "N/m", low=0.0)
    thick = m.parameter("thick", 0.5e-3, "m", low=0.0)  # by which the part is pressed together
    time = m.parameter("time", 0.4, "s", low=0.0)
    upper, lower = (m.link(name, length=LINK, mass=0.35) for name in ("upper", "lower"))
    jaw = m.point_mass("jaw", 0.9)
    m.revolute("frame", m.ground, upper)
    m.revolute("knee", upper.tip, lower)
    m.revolute("foot", lower.tip, jaw)
    guide = m.prismatic("guide", m.ground, jaw, axis=(0, -1))
    ram = cylinder(
        m,
        "ram",
        m.ground.at(REAR, -LINK),
        upper.tip,
        closed=0.28,
        open=0.38,
        bore=0.05,
        rod=0.02,
        barrel_mass=0.5,
        rod_mass=0.2,
    )
    strut(
        m, "opener", m.ground.at(REAR, 0.0), upper.tip, closed=0.28, open=0.42, stiffness=400.0,
        length=0.28, damping=30.0,
    )  # fmt: skip
    reach = 2 * LINK * ca.cos(SHUT) - thick
    pressed = ca.fmax(0.0, stiffness * (m.coordinate(guide) - reach))
    m.force("part", jaw, y=pressed)
    m.output("clamping", pressed, unit="N")

    def out(angle: float) -> float:
        x, y = -LINK * ca.sin(angle) - REAR, LINK * (1 - ca.cos(angle))
        return float(ca.sqrt(x * x + y * y)) - 0.28

    closing = moves([move(out(SHUT), time=time, law="modified_sine")], start=out(OPEN))
    return Scene(
        m,
        {ram.slide.name: closing},
        t=(0, 0.4, 401),
        posture={"upper": -pi / 2 - OPEN, "lower": -pi / 2 + OPEN},
    )

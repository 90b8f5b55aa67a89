"""An arm of six revolute joints with a payload, as robots are described: each axis on the link
before it.
"""

from math import pi

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

LENGTHS = (0.16, 0.42, 0.39, 0.12, 0.1, 0.08)
"""The lengths of the links [m]."""

MASSES = (3.7, 8.4, 2.3, 1.2, 1.2, 0.2)
"""Their masses [kg]."""


def scene() -> Scene:
    m = SpatialMechanism("arm6")
    payload = m.parameter("payload", 5.0, "kg", low=0.0, high=20.0)
    links = [
        m.link(f"link{k}", length=l, mass=mass)
        for k, (l, mass) in enumerate(zip(LENGTHS, MASSES, strict=True), 1)
    ]
    tool = m.link(
        "tool", length=0.1, mass=payload, centre=(0.05, 0.01, 0.0), inertia=(0.01, 0.02, 0.02)
    )
    along, up = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    # Upright at zero: turn, shoulder, elbow, and a wrist of three axes.
    m.revolute("turn", m.ground, links[0], axis=up, turned=[("y", "-90 deg")])
    m.revolute("shoulder", links[0].tip, links[1], axis=up)
    m.revolute("elbow", links[1].tip, links[2], axis=up)
    m.revolute("roll", links[2].tip, links[3], axis=along)
    m.revolute("pitch", links[3].tip, links[4], axis=up)
    m.revolute("flange", links[4].tip, links[5], axis=along)
    m.weld("grip", links[5].tip, tool)
    m.path("hand", tool.at(0.05))
    laws = {
        "turn": harmonic(0.0, 1.0, 0.5),
        "shoulder": harmonic(0.6, 0.4, 0.5, pi / 3),
        "elbow": harmonic(1.0, 0.5, 0.5, pi / 2),
        "roll": harmonic(0.0, 1.2, 0.5, 0.4),
        "pitch": harmonic(0.7, 0.5, 1.0),
        "flange": harmonic(0.0, 2.0, 0.5, 1.0),
    }
    return Scene(m, laws, t=(0.0, 2.0, 201))

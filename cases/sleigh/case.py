"""A skate that may not slip sideways, led along a curve, with a boom whose bending is wanted."""

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import expression, polynomial

RADIUS, TURNING = 4.0, 0.8


def scene() -> Scene:
    m = Mechanism("sleigh")
    m.set_gravity(0, 0)
    cross, pivot = m.link("cross", length=0.1, mass=0.0), m.link("pivot", length=0.1, mass=0.0)
    body, boom = m.link("body", length=1.0, mass=40.0), m.link("boom", length=1.5, mass=6.0)
    m.prismatic("X", m.ground, cross, axis=(1, 0))
    across = m.prismatic("Y", cross, pivot, axis=(0, 1))
    m.revolute("heading", pivot, body)
    m.weld("stem", body.at(0.6), boom, angle=2.0)
    m.weld("weight", boom.tip, m.point_mass("lamp", 3.0))
    # The blade at the body's base: no velocity across its direction (paper eq. 3).
    (vx, vy), direction = m.velocity(body), m.direction(body)
    m.nonholonomic("blade", -ca.sin(direction) * vx + ca.cos(direction) * vy, replaces=across)
    return Scene(
        m,
        motion={
            "X": expression(lambda t: RADIUS * ca.sin(TURNING * t)),
            "Y": expression(lambda t: RADIUS - RADIUS * ca.cos(TURNING * t)),
            "heading": polynomial(0, TURNING),
        },
        t=(0, 5, 251),
    )

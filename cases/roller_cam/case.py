"""A disc cam that lifts a valve by a roller, against a spring: from the lift to the profile and the
contact's force.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import disc_cam
from lagrange_casadi.motion import dwell, move, moves, polynomial

RISE, TOP, FALL = 100 * pi / 180, 20 * pi / 180, 150 * pi / 180
"""Angles of the cam [rad] for the way up, the rest at the top, and the way back."""
START = 50 * pi / 180
"""The instants begin within the way up, at this angle of the cam [rad]."""
GUIDED, ASIDE = 0.05, 0.003
"""The guide holds the stem so far from its roller, and the spring acts so
far beside its axis [m].
"""


def scene() -> Scene:
    m = Mechanism("roller_cam")
    lift = m.parameter("lift", 0.02, "m", low=0.0)
    base = m.parameter("base", 0.045, "m", low=0.0)
    offset = m.parameter("offset", 0.006, "m", low=-0.02, high=0.02)
    speed = m.parameter("speed", 60.0, "rad/s", low=0.0)
    stiffness = m.parameter("stiffness", 12e3, "N/m", low=0.0)
    preload = m.parameter("preload", 300.0, "N", low=0.0)
    cam = m.link("cam", length=0.05, mass=1.8, centre=(0, 0), inertia=2.2e-3)
    stem = m.link("stem", length=0.12, mass=0.5)
    shaft = m.revolute("shaft", m.ground, cam)
    guide = m.prismatic(
        "guide", m.ground.at(offset, 0), stem.at(GUIDED), axis=(0, 1), angle="90 deg"
    )
    cycle = [
        move(lift, time=RISE, law="cycloidal", name="rise"),
        dwell(TOP, name="top"),
        move(0, time=FALL, law="cycloidal", name="fall"),
        dwell(name="rest"),
    ]
    law = moves(cycle, cyclic=True, period=2 * pi)
    disc_cam(
        m,
        "contact",
        shaft,
        guide,
        law,
        base_radius=base,
        point=stem.base,
        roller=0.012,
        width=0.014,
    )
    least = ((base + 0.012) ** 2 - offset**2) ** 0.5
    m.force(
        "spring",
        stem.at(0.11, ASIDE),
        y=-preload - stiffness * (m.coordinate(guide) - GUIDED - least),
    )
    return Scene(
        m, {"shaft": polynomial(START, speed)}, t=(0, 2 * pi / 60, 220), posture={"guide": 0.1}
    )

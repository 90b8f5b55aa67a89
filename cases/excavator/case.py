"""An excavator that levels the ground: its bucket follows a line, and three cylinders make it do
so.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import harmonic, polynomial

STROKE = 4.0
"""Seconds that a stroke takes, from rest to rest."""
FAR, NEAR, LEVEL, ANGLE = 7.0, 4.5, -1.2, -2.9
"""The bucket's pin goes from far to near [m] at a level [m], the bucket at an angle [rad]."""


def scene() -> Scene:
    m = Mechanism("excavator")
    digging = m.parameter("digging", 20e3, "N", low=0.0)
    filling = m.parameter("filling", 800.0, "kg", low=0.0)
    bore = m.parameter("bore", 0.12, "m", low=0.0)
    boom = m.link("boom", length=5.5, mass=1400.0)
    stick = m.link("stick", length=3.3, mass=700.0)  # its base is the lug behind the elbow
    bucket = m.link("bucket", length=1.4, mass=500.0, centre=(0.6, 0.3), inertia=120.0)
    m.revolute("foot", m.ground, boom)
    m.revolute("elbow", boom.tip, stick.at(0.5))
    m.revolute("wrist", stick.tip, bucket)
    m.weld("load", bucket.at(0.7, 0.35), m.point_mass("earth", filling))
    ends = {
        "boom": (m.ground.at(0.5, -0.6), boom.at(2.4, 0.2), 1.5),
        "stick": (boom.at(2.9, 0.5), stick.at(0.0, 0.25), 1.6),
        "bucket": (stick.at(0.9, 0.35), bucket.at(-0.35, 0.25), 1.5),
    }
    power = 0.0
    for name, (rear, front, length) in ends.items():
        barrel, rod = (
            m.link(f"{name}_barrel", length=length, mass=90.0),
            m.link(f"{name}_rod", length=length, mass=50.0),
        )
        m.revolute(f"{name}_rear", rear, barrel)
        cylinder = m.prismatic(f"{name}_cylinder", barrel, rod.base, axis=(1, 0))
        m.revolute(f"{name}_front", rod.tip, front)
        push = m.results.effort(cylinder)
        m.output(f"{name}_pressure", push / (pi / 4 * bore**2), unit="Pa")
        power += push * m.rate(cylinder)
    m.output("power", power, unit="W")
    m.path("teeth", bucket.tip)
    m.force("cut", bucket.tip, x=digging)
    along = harmonic((FAR + NEAR) / 2, (FAR - NEAR) / 2, 1 / (2 * STROKE), pi / 2)
    return Scene(
        m,
        motion={"bucket": (along, polynomial(LEVEL), polynomial(ANGLE))},
        t=(0, STROKE, 201),
        posture={"boom": 0.6, "stick": -1.2} | {f"{name}_cylinder": 1.0 for name in ends},
        drives=[f"{name}_cylinder" for name in ends],
    )

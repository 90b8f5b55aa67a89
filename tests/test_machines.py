"""Machines from practice, against what is known of them without any equation of motion."""

from math import pi

import casadi as ca
import numpy as np
import pytest
from balance import assert_balanced

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.equations.derive import derive
from lagrange_casadi.motion import expression, polynomial

DRAW = 4.0
"""Seconds that a stroke takes."""


def excavator():
    """The bucket levels the ground: it goes straight and keeps its direction, and three cylinders make it do so."""
    m = Mechanism("excavator")
    digging = m.parameter("digging", 20e3, "N", low=0.0)
    filling = m.parameter("filling", 800.0, "kg", low=0.0)
    boom = m.link("boom", length=5.5, mass=1400.0)
    stick = m.link("stick", length=3.3, mass=700.0)  # its base is the lug behind the elbow
    bucket = m.link("bucket", length=1.4, mass=500.0, centre=(0.6, 0.3), inertia=120.0)
    earth = m.point_mass("earth", filling)
    m.revolute("foot", m.ground, boom)
    m.revolute("elbow", boom.tip, stick.at(0.5))
    m.revolute("wrist", stick.tip, bucket)
    m.weld("load", bucket.at(0.7, 0.35), earth)
    ends = {
        "boom": (m.ground.at(0.5, -0.6), boom.at(2.4, 0.2), 1.5),
        "stick": (boom.at(2.9, 0.5), stick.at(0.0, 0.25), 1.6),
        "bucket": (stick.at(0.9, 0.35), bucket.at(-0.35, 0.25), 1.5),
    }
    for name, (rear, front, length) in ends.items():
        barrel, rod = m.link(f"{name}_barrel", length=length, mass=90.0), m.link(f"{name}_rod", length=length, mass=50.0)
        m.revolute(f"{name}_rear", rear, barrel)
        m.prismatic(f"{name}_cylinder", barrel, rod.base, axis=(1, 0))
        m.revolute(f"{name}_front", rod.tip, front)
    teeth = bucket.tip
    m.force("cut", teeth, x=digging)
    m.path("teeth", teeth)
    # From far to near along a level line, at rest at both ends, the bucket's floor level.
    far, near, level = 7.0, 4.5, -1.2
    law = expression(lambda t: far + (near - far) * (t / DRAW - ca.sin(2 * pi * t / DRAW) / (2 * pi)))
    return Scene(
        m,
        motion={"bucket": (law, polynomial(level), polynomial(-2.9))},
        t=(0, DRAW, 201),
        posture={"boom": 0.6, "stick": -1.2} | {f"{name}_cylinder": 1.0 for name in ends},
        drives=[f"{name}_cylinder" for name in ends],
    )


def along(values, at):
    """The integral of values over what they are along, by trapezia."""
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(at)))


def test_cylinders_lift_what_goes_up():
    """Over a stroke from rest to rest: their work is the change of potential energy, less the work of the ground."""
    scene = excavator()
    assert derive(scene).newton is None
    found = evaluate(scene, t=(0, DRAW, 4001))
    assert found.certified
    assert np.abs([found.motion(joint).rate[[0, -1]] for joint in scene.drives]).max() < 1e-12
    work = sum(along(found.effort(joint), found.motion(joint).value) for joint in scene.drives)
    lifted = 0.0
    for name, body in found.description["bodies"].items():
        pose, centre = found.pose(name), body.get("centre", {"x": (body["length"] or 0.0) / 2, "y": 0.0})
        turned = 0.0 if pose.angle is None else centre["x"] * np.sin(pose.angle) + centre["y"] * np.cos(pose.angle)
        height = pose.y + turned
        lifted += body["mass"] * 9.81 * (height[-1] - height[0])
    ground = 20e3 * (found.output("teeth_x")[-1] - found.output("teeth_x")[0])
    assert ground == pytest.approx(-2.5 * 20e3)
    assert work == pytest.approx(lifted - ground, rel=1e-6)


def test_an_excavator_against_newton_euler():
    dig = [lambda place: [(("bucket", 1.4, 0), 20e3, 0.0, 0.0)]]
    for t in (0.0, 1.3, 3.1):
        assert_balanced(excavator(), t=t, nudge=1e-4, loads=dig)

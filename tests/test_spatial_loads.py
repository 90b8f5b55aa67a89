"""Loads of mechanisms in space, against closed forms."""

import math

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("joint", ["relative", "hard"])
def test_a_torsion_spring_turns_back_about_its_joints_axis(joint):
    """A rod on a tilted shaft, whose own turning is another drive's: the spring adds to the one effort, and to nothing else."""
    efforts, reactions = [], []
    for stiffness in (0.0, 7.0):
        m = SpatialMechanism("door")
        if joint == "relative":
            frame, door = m.link("frame", length=0.3, mass=1.0), m.link("door", length=0.5, mass=2.0)
            m.revolute("mast", m.ground, frame, axis=(0.0, 0.6, 0.8))
            hinge = m.revolute("hinge", frame.tip, door, axis=(1.0, 2.0, 2.0), turned=[("z", "35 deg"), ("x", "20 deg")])
        else:
            frame = m.link("frame", between=((0, 0, 0), (0.3, 0, 0)), mass=1.0)
            door = m.link("door", between=((0.3, 0, 0), (0.3, 0.3, 0.4)), mass=2.0)
            m.revolute("mast", m.ground, frame, at=(0, 0, 0), axis=(0.0, 0.6, 0.8))
            hinge = m.revolute("hinge", frame, door, at=(0.3, 0, 0), axis=(1.0, 2.0, 2.0))
        m.torsion_spring("coil", hinge, stiffness=stiffness, angle="20 deg", damping=0.3 if stiffness else 0.0)
        laws = {"mast": motion.harmonic(0.2, 0.5, 1.0), "hinge": motion.harmonic(0.4, 0.7, 1.5)}
        found = evaluate(Scene(m, laws, t=(0, 1, 41)))
        assert found.certified
        efforts.append([found.effort(name) for name in laws])
        reactions.append([found.series[f"reaction:hinge:{member}"] for member in ("fx", "fy", "fz", "mx", "my", "mz")])
    turned = found.motion("hinge")
    added = 7.0 * (turned.value - math.radians(20)) + 0.3 * turned.rate
    assert np.max(np.abs(efforts[1][1] - efforts[0][1] - added)) < 1e-13
    assert np.max(np.abs(efforts[1][0] - efforts[0][0])) < 1e-13
    assert np.max(np.abs(np.array(reactions[1]) - reactions[0])) < 1e-13
    size = np.sqrt(sum(found.series[f"load:coil:m{axis}"] ** 2 for axis in "xyz"))
    assert np.max(np.abs(size - np.abs(added))) < 1e-13

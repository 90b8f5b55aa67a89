"""What a sweep keeps of a design of which a peak cannot be told."""

import casadi as ca
import numpy as np
import pytest
from internals import Status, check_sweep

from lagrange_casadi import Mechanism, Scene, motion, sweep

pytestmark = pytest.mark.quick


def test_a_design_without_its_peak_is_marked(tmp_path):
    """A load of 200 000 teeth, or none: a status, no number, and a file that is sound."""
    m = Mechanism("saw")
    m.set_gravity(0, 0)
    width = m.parameter("width", 10.0, "rad")
    arm = m.link("arm", length=0.5, mass=1.0)
    angle = m.coordinate(m.revolute("pin", m.ground, arm))
    m.force("push", arm.tip, x=2.0 * ca.cos(angle) + 1e-3 * ca.fmod(angle, width))
    scene = Scene(m, {"pin": motion.polynomial(0.0, 1.0)}, t=(0.0, 2.0, 51), wanted=["load:push"])
    path = tmp_path / "saw.h5"
    found = sweep(scene, {"width": [10.0, 1e-5]}, out=path)
    assert found["status"][1] == Status.PEAK_NOT_TOLD
    assert np.isnan(found["peak:load:push:fx"][1])
    assert not check_sweep(path)
    assert "take more instants" in found.statuses[Status.PEAK_NOT_TOLD][1]
    assert found["status"][0] == Status.OK
    assert abs(found["peak:load:push:fx"][0] - 2.0) < 1e-6

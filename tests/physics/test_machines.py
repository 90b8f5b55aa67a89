"""Machines from practice, against what is known of them without any equation of motion."""

from __future__ import annotations

import numpy as np
from conftest import CASES

from lagrange_casadi import evaluate, load_case


def test_a_slow_pump_has_the_torque_of_its_torque_factor():
    """API Specification 11E: the rods' load times A R sin(alpha) / (C sin(beta)), by the pump's
    geometry alone; A is the arc's.
    """
    scene = load_case(CASES / "beam_pump").scene
    slow, loads = {"spm": 1e-5}, (0.0, 14e3)
    empty, full = (
        evaluate(scene, parameters=slow | {"fluid": x}, over=("shaft", 0, "360 deg", 181))
        for x in loads
    )
    assert empty.certified
    assert full.certified
    a, r, c, p, (x, y) = 3.3, 1.0, 2.8, 3.6, (2.8, 3.5)
    angle = full.motion("shaft").value
    pin = r * np.cos(angle), r * np.sin(angle)
    along, up = x - pin[0], y - pin[1]
    far = np.hypot(along, up)
    beta = np.arccos((c**2 + p**2 - far**2) / (2 * c * p))
    lean = np.arctan2(up, along) + np.arccos((p**2 + far**2 - c**2) / (2 * p * far))
    factor = -a * r / c * np.sin(lean - angle) / np.sin(beta)
    load = full.output("rod_load") - empty.output("rod_load")
    assert set(np.round(load)) == {0.0, 14e3}
    torque = full.effort("shaft") - empty.effort("shaft")
    assert np.abs(torque - factor * load).max() < 1e-12 * np.abs(full.effort("shaft")).max()

"""Machines from practice, against what is known of them without any equation of motion, and
against Newton-Euler.
"""

from __future__ import annotations

import numpy as np
import pytest
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


def added(name, parameter):
    """A case with all, and what a parameter adds to the force of its cylinder."""
    scene = load_case(CASES / name).scene
    full, without = (
        evaluate(scene, parameters=values, backend="vm") for values in ({}, {parameter: 0.0})
    )
    return full, full.effort("ram") - without.effort("ram")


def test_a_toggle_clamp_presses_as_the_equilibrium_of_its_knee_says():
    solution, force = added("toggle_clamp", "stiffness")
    knee = solution.pose("lower")
    tangent = knee.x / knee.y
    lean = np.arctan2(knee.y + 0.12, knee.x + 0.36)
    pressed = force * (np.cos(lean) / (2 * tangent) - np.sin(lean) / 2)
    clamping = solution.output("clamping")
    assert clamping[-1] == pytest.approx(8e6 * 0.5e-3, rel=1e-9)
    assert clamping == pytest.approx(pressed, abs=1e-9 * clamping[-1])
    # With the strut that opens the clamp the cylinder has a tenth of the jaw's force to bear.
    assert solution.effort("ram")[-1] < clamping[-1] / 10
    assert 0 < solution.output("ram_stroke").min() < solution.output("ram_stroke").max() < 1


def test_a_scissor_lift_raises_a_load_by_virtual_work():
    """F dq = m (g + a) dy, with the height of two stages 2 l sin(phi), and q by the cosine law."""
    solution, force = added("scissor_lift", "load")
    phi = solution.pose("rising0").angle
    sine, cosine = np.sin(phi), np.cos(phi)
    reach = np.hypot(0.9 * cosine - 0.25, 0.9 * sine + 0.12)
    slope = (0.25 * 0.9 * sine + 0.12 * 0.9 * cosine) / reach
    height = solution.output("height")
    assert height == pytest.approx(2 * 1.2 * sine, rel=1e-12)
    turn, speed = solution.motion("left0").acceleration, solution.motion("left0").rate
    rising = 2 * 1.2 * (cosine * turn - sine * speed**2)
    assert force == pytest.approx(500.0 * (9.81 + rising) * 2 * 1.2 * cosine / slope, rel=1e-9)

"""Machines from practice, against what is known of them without any equation of motion, and
against Newton-Euler.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import CASES
from machines import shown

from lagrange_casadi import evaluate, load_case


def test_a_lift_at_rest_is_held_by_the_slope_of_its_potential():
    """The ram's force is dV/dq: of the load, the links and the ram itself, by the angle of the
    links alone.
    """
    scene = shown("Scissor lift")["scene"]
    found = evaluate(scene, parameters={"speed": 0.0}, t=(0, 0, 1))
    turn, s, c, g = math.acos(1.1 / 1.2), 0.9, 0.3, 9.81
    q = math.sqrt(s**2 + c**2 - 2 * s * c * math.cos(turn))
    dq = s * c * math.sin(turn) / q
    leaning = s * math.cos(turn) / q - s * math.sin(turn) * dq / q**2
    lifted = (3 * 5000.0 + 12.0 * g * 2 * (0.5 + 1.5 + 2.5)) * 1.2 * math.cos(turn)
    own = g * ((4.0 - 3.0) * 0.15 * leaning + 3.0 * s * math.cos(turn))
    assert found.effort("ram")[0] == pytest.approx((lifted + own) / dq, rel=1e-13)


def test_a_wheel_of_four_slots_moves_by_its_closed_form():
    """Place, rate and acceleration of every textbook; the crank gives what the wheel's inertia
    takes.
    """
    found = evaluate(shown("Geneva drive")["scene"], parameters={"omega": 20.0})
    k, angle, wheel = math.sin(math.pi / 4), found.motion("main").value, found.motion("axle")
    under = 1 + k**2 - 2 * k * np.cos(angle)
    np.testing.assert_allclose(
        wheel.value, -np.arctan2(k * np.sin(angle), 1 - k * np.cos(angle)), rtol=0, atol=1e-14
    )
    np.testing.assert_allclose(
        wheel.rate, -20.0 * k * (np.cos(angle) - k) / under, rtol=0, atol=1e-12 * 20.0 * 2.5
    )
    bend = k * (1 - k**2) * np.sin(angle) / under**2
    np.testing.assert_allclose(
        wheel.acceleration, 20.0**2 * bend, rtol=0, atol=1e-12 * 20.0**2 * 5.41
    )
    taken = 1.5e-3 * wheel.acceleration * wheel.rate / 20.0
    assert np.abs(found.effort("main") - taken).max() < 1e-12 * np.abs(taken).max()


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

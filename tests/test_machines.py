"""Machines from practice, against what is known of them without any equation of motion."""

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case
from lagrange_casadi.equations.derive import derive


def along(values, at):
    """The integral of values over what they are along, by trapezia."""
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(at)))


def test_cylinders_lift_what_goes_up():
    """Over a stroke from rest to rest: their work is the change of potential energy, less the work of the ground."""
    scene = load_case(CASES / "excavator").scene
    assert derive(scene).newton is None
    found = evaluate(scene, t=(0, 4, 4001))
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


def test_a_slow_pump_has_the_torque_of_its_torque_factor():
    """API Specification 11E: the rods' load times A R sin(alpha) / (C sin(beta)), by the pump's geometry alone; A is the arc's."""
    scene = load_case(CASES / "beam_pump").scene
    slow, loads = {"spm": 1e-5}, (0.0, 14e3)
    empty, full = (evaluate(scene, parameters=slow | {"fluid": x}, over=("shaft", 0, "360 deg", 181)) for x in loads)
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


def test_a_turn_of_a_pump_lifts_the_fluid_once():
    """What the fluid adds is its force times the rods' speed: over a turn, times the stroke. Weights add nothing."""
    scene = load_case(CASES / "beam_pump").scene
    empty, full = (evaluate(scene, parameters={"fluid": x}, t=(0, 6, 6001)) for x in (0.0, 14e3))
    rate = full.motion("well").rate
    power = 14e3 * np.where(rate > 0, rate, 0.0)
    turned = 2 * np.pi / 6
    gap = (full.effort("shaft") - empty.effort("shaft")) * turned - power
    assert np.abs(gap).max() < 1e-12 * np.abs(full.output("power")).max()
    assert abs(along(empty.effort("shaft"), empty.motion("shaft").value)) < 1e-9 * np.abs(empty.effort("shaft")).max()
    stroke = np.ptp(full.motion("well").value)
    assert along(full.effort("shaft"), full.motion("shaft").value) == pytest.approx(14e3 * stroke, rel=1e-6)

"""Drives at other joints than those whose motion is given."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from five_bars import five_bar
from mechanisms import slider_crank

from lagrange_casadi import Mechanism, Scene, evaluate, motion
from lagrange_casadi.errors import AssemblyError, DeclarationError, UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")


def test_weights_may_be_parameters():
    scene = five_bar(lambda h: {"O": 1.0, "C": h, "A": 3.0})
    for heavier in (2.0, 5.0):
        told = evaluate(scene, parameters={"heavier": heavier})
        same = evaluate(five_bar({"O": 1.0, "C": heavier, "A": 3.0}))
        for joint in "OCA":
            assert np.allclose(told.effort(joint), same.effort(joint), rtol=1e-12, atol=1e-12)
    assert "3 drives (O, C, A) for 2 degrees of freedom" in told.notes[0]
    with pytest.raises(AssemblyError):
        evaluate(scene, parameters={"heavier": -1.0})


def test_where_drives_cannot_hold_the_motion_on_the_way_there_is_no_result():
    """A piston cannot turn the crank through its dead centre."""
    scene = replace(slider_crank(), drives=["guide"])
    says = "the drives guide cannot produce the motion"
    with pytest.raises(AssemblyError, match=rf"{says} (at|after) t = 0\.0(39|4)"):
        evaluate(scene, t=(0.01, 0.08, 71))
    with pytest.raises(AssemblyError, match=f"{says} at t = 0 s"):
        evaluate(scene, t=(0.0, 0.0, 1))


@pytest.mark.parametrize(
    ("drives", "error", "told"),
    [
        ("O", DeclarationError, "drives: expected a list of joints, or weights by joint, got 'O'"),
        (["O", "O"], DeclarationError, "drives: a joint is listed twice in O, O"),
        (
            ["O"],
            DeclarationError,
            (
                "drives: 1 cannot make 2 independent motions; expected at least 2 joints for .* O,"
                " C, got O"
            ),
        ),
        ([], DeclarationError, "drives: 0 cannot make 2 independent motions; .* got none"),
        (["O", "X"], UnknownNameError, "unknown joint in drives 'X'; valid: O, C, A"),
        (
            ["O", "hung"],
            DeclarationError,
            "drives: joint 'hung' has no coordinate for an effort",
        ),
        (
            {"O": -1.0, "C": 1.0},
            DeclarationError,
            "drives: expected a positive weight of joint 'O', got -1.0",
        ),
        (
            {"O": math.nan, "C": 1.0},
            DeclarationError,
            "drives: expected a positive weight of joint 'O', got nan",
        ),
        (
            {"O": ca.SX.sym("w"), "C": 1.0},
            DeclarationError,
            "the weight of joint 'O' depends on w, which is not a parameter",
        ),
        (3, DeclarationError, "drives: expected a list of joints, or weights by joint, got 3"),
    ],
)
def test_misuse_is_told(drives, error, told):
    with pytest.raises(error, match=told):
        five_bar(drives)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("ratio", [1e-5, 1e-2, 1e4])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_gear_of_any_ratio_holds(ratio, precision):
    """A drive that turns slowly or fast beside the motion bears the torque by that much more or
    less.
    """
    m = Mechanism("geared")
    arm = m.link("arm", length=1.0, mass=2.0)
    wheel = m.link("wheel", length=0.1, mass=0.0, centre=(0.0, 0.0), inertia=0.0)
    main, motor = m.revolute("main", m.ground, arm), m.revolute("motor", m.ground.at(2, 0), wheel)
    m.gear("mesh", main, motor, ratio=ratio)
    scene = Scene(m, {"main": motion.polynomial(0.3, 1.0)}, t=(0, 1, 11), drives=["motor"])
    found = evaluate(scene, precision=precision)
    torque = 2.0 * 9.81 * 0.5 * np.cos(0.3 + found.t)
    assert found.certified
    assert np.abs(found.effort("motor") * ratio / torque - 1.0).max() < (
        1e-12 if precision == "double" else 1e-5
    )

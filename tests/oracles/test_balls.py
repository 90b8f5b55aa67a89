"""Joints with three turns that loops set: no posture of theirs is special, in every way of
evaluating them.
"""

import numpy as np
import pytest
from spatial_bridge import postures
from spatial_solutions import evaluated, scene_of

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import harmonic


def turns_of(solution):
    """The turns of the ball."""
    return [
        output.part
        for output in solution.outputs
        if output.group == "motion" and "turn_" in output.part and not output.member
    ]


def test_in_gimbal_lock_and_beside_it_turns_are_as_the_oracle_has_them():
    """All else is looked at with other mechanisms (test_spatial_evaluate)."""
    (drawn, scene), (_, solution) = (of("locked", 0) for of in (scene_of, evaluated))
    turns = turns_of(solution)
    assert len(turns) == 3
    members = [f"motion:{turn}{end}" for turn in turns for end in ("", "_rate", "_acceleration")]
    assert set(solution.undetermined) == set(members) - {f"motion:{turns[1]}"}
    (note,) = solution.notes
    assert note.startswith(
        f"joint '{turns[0].partition(':')[0]}' is in gimbal lock at t = 0.2 s: two of its rotations"
    )
    beside = evaluate(scene, t=(0.1, 0.3, 8), backend="vm")
    assert beside.certified
    assert not beside.undetermined
    for k in (3, 4):
        places = postures(drawn, drawn.move(float(beside.t[k]))[0])
        for turn in turns_of(beside):
            gap = beside.motion(turn).value[k] - places[turn]
            assert abs(gap - 2 * np.pi * round(gap / (2 * np.pi))) < 1e-11, turn
    step = 1e-4
    near = evaluate(scene, t=(0.12 - step, 0.12 + step, 3), backend="vm")
    for turn in turns_of(near):
        told = near.motion(turn)
        assert told.rate[1] == pytest.approx(
            (told.value[2] - told.value[0]) / (2 * step), rel=1e-4, abs=1e-5
        )
        assert told.acceleration[1] == pytest.approx(
            (told.rate[2] - told.rate[0]) / (2 * step), rel=1e-4, abs=1e-4
        )


def hung(pin, block):
    """A plate that hangs on a block which slides, its tip on a rail, a point of it at a height."""
    m = SpatialMechanism("hung")
    place = block(m)
    inertia = (5e-3, 0.02, 0.022)
    plate = m.link("plate", length=0.5, mass=1.0, centre=(0.25, 0.05, 0.0), inertia=inertia)
    m.prismatic("x", m.ground, place, axis=(1, 0, 0))
    pin(m, place, plate)
    m.slot("rail", m.ground.at(0, 0.3, 0.1), plate.tip, axis=(1, 0, 0))
    m.constraint("level", m.place(plate.at(0.2, 0.2, 0.0))[2] - 0.05)
    return m


@pytest.mark.parametrize(
    ("pin", "sign"),
    [
        (lambda m, block, plate: m.spherical("pin", block, plate), 1),
        (lambda m, block, plate: m.spherical("pin", plate, block), -1),
        (lambda m, block, plate: m.revolute("pin", block, plate, axis=(0, 0, 1)), 1),
    ],
    ids=["spherical", "turned round", "revolute"],
)
def test_a_body_hangs_on_a_point_mass(pin, sign):
    """As it does on a block without inertia: no joint holds a direction at a point."""

    def solved(pin, block, sign):
        rough = {"pin:turn_1": 0.2 * sign, "pin:turn_2": -0.2 * sign, "pin:turn_3": 0.6 * sign}
        laws = {"x": harmonic(0.1, 0.1, 1.0)}
        return evaluate(Scene(hung(pin, block), laws, t=(0.0, 1.0, 21), posture=rough))

    body = solved(
        lambda m, block, plate: m.spherical("pin", block, plate),
        lambda m: m.link("block", length=0.1, mass=0.5, centre=(0, 0, 0), inertia=(0, 0, 0)),
        1,
    )
    point = solved(pin, lambda m: m.point_mass("block", 0.5), sign)
    assert point.certified
    size = np.abs(body.effort("x")).max()
    np.testing.assert_allclose(point.effort("x"), body.effort("x"), rtol=0.0, atol=1e-12 * size)
    forces, there = sign * point.reaction("pin").fx, body.reaction("pin").fx
    np.testing.assert_allclose(forces, there, rtol=0.0, atol=1e-12 * size)

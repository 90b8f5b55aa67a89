"""Joints with three turns that loops set: no posture of theirs is special, in every way of
evaluating them.
"""

import dataclasses
import functools

import numpy as np
import pytest
from balls import platform, suspension
from internals import Output
from spatial_bodies import GROUND
from spatial_bridge import coordinate, declared, plain, postures
from spatial_oracle import REACTION

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import harmonic

LOCK = 0.2
MADE = {
    "free": lambda: suspension(0, LOCK),
    "on a leg": lambda: platform(0, LOCK),
    "under a leg": lambda: platform(1, LOCK, reverse=True),
}
AROUND = (0.1, 0.3, 9)
"""The fifth instant is that of the lock."""


@functools.cache
def made(name):
    """What was drawn, the scene of it, and what is true at the instants."""
    drawn = plain(MADE[name]())
    scene = dataclasses.replace(declared(drawn, AROUND[0]), t=AROUND, xi=(0, 1, 3))
    return (
        drawn,
        scene,
        {k: drawn.solve(float(t)) for k, t in enumerate(np.linspace(*AROUND)) if k in (4, 5)},
    )


def turns_of(solution):
    """The turns of the ball."""
    return [
        output.part
        for output in solution.outputs
        if output.group == "motion" and "turn_" in output.part and not output.member
    ]


def compare(drawn, solution, true, rounding=1e-12):
    """All forces, and where bodies are, beside the oracle's."""
    force = max(
        float(np.abs(x[:3].astype(float)).max())
        for one in true.values()
        for x in one.reactions.values()
    )
    moment = force * drawn.solve(0.0).size
    sizes = [force] * 3 + [moment] * 3
    for k, one in true.items():
        for (joint, number), effort in one.efforts.items():
            own = solution.effort(coordinate(drawn.mechanism.joint(joint), number))[k]
            assert abs(own - float(effort)) < rounding * moment, joint
        for joint, reaction in one.reactions.items():
            for member, value, size in zip(REACTION, reaction, sizes, strict=True):
                own = solution.outputs.get(
                    Output("reaction", joint, member), np.zeros_like(solution.t)
                )[k]
                assert abs(own - float(value)) < rounding * size, (joint, member)
        for body, pose in one.poses.items():
            if body != GROUND and body not in solution.description.bars:
                assert np.allclose(
                    solution.pose(body).axes[k], np.array(pose.R, float).T, rtol=0, atol=rounding
                ), body


@pytest.mark.parametrize(
    "name",
    ["on a leg", *(pytest.param(name, marks=pytest.mark.long) for name in ("free", "under a leg"))],
)
def test_in_gimbal_lock_and_beside_it_all_is_as_the_oracle_has_it(name):
    drawn, scene, true = made(name)
    solution = evaluate(scene, backend="vm")
    assert solution.certified
    compare(drawn, solution, true)
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
        places = postures(drawn, float(beside.t[k]))
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

"""Joints with three turns that loops set: no posture of theirs is special, in every way of evaluating them."""

import dataclasses

import numpy as np
import pytest
from balls import platform, suspension
from spatial_bodies import GROUND, Rod
from spatial_bridge import coordinate, declared, plain, postures
from spatial_oracle import REACTION, SECTION

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.designs.engine import DesignEngine
from lagrange_casadi.equations.balls import axes_of, quaternion_of
from lagrange_casadi.instants.refusal import Status
from lagrange_casadi.instants.rung import Rung
from lagrange_casadi.quantities import Output

LOCK = 0.2
MADE = {
    "free": lambda: suspension(0, LOCK),
    "on a leg": lambda: platform(0, LOCK),
    "under a leg": lambda: platform(1, LOCK, reverse=True),
}
AROUND = (0.1, 0.3, 9)
"""The fifth instant is that of the lock."""


@pytest.fixture(scope="module", params=MADE)
def made(request):
    """What was drawn, the scene of it, and what is true at the instants."""
    drawn = plain(MADE[request.param]())
    scene = dataclasses.replace(declared(drawn, AROUND[0]), t=AROUND, xi=(0, 1, 3))
    return drawn, scene, {k: drawn.solve(float(t)) for k, t in enumerate(np.linspace(*AROUND)) if k in (0, 4, 5)}


def compare(drawn, solution, true, rounding=1e-12):
    """All forces, and where bodies are, beside the oracle's."""
    force = max(float(np.abs(x[:3].astype(float)).max()) for one in true.values() for x in one.reactions.values())
    moment = force * drawn.solve(0.0).size
    sizes = [force] * 3 + [moment] * 3
    for k, one in true.items():
        for (joint, number), effort in one.efforts.items():
            own = solution.effort(coordinate(drawn.mechanism.joint(joint), number))[k]
            assert abs(own - float(effort)) < rounding * moment, joint
        for joint, reaction in one.reactions.items():
            for member, value, size in zip(REACTION, reaction, sizes, strict=True):
                own = solution.outputs.get(Output("reaction", joint, member), np.zeros_like(solution.t))[k]
                assert abs(own - float(value)) < rounding * size, (joint, member)
        for body, pose in one.poses.items():
            if body != GROUND and body not in solution.description["bars"]:
                assert np.allclose(solution.pose(body).axes[k], np.array(pose.R, float).T, rtol=0, atol=rounding), body
        for rod in (body.name for body in drawn.mechanism.bodies if isinstance(body, Rod)):
            for i, xi in enumerate(solution.xi):
                told = one.sections[rod].at(float(xi)).astype(float)
                own = np.array([getattr(solution.section(rod), name)[k, i] for name in SECTION])
                if rod in solution.description["bars"]:
                    # A bar's cross-section has axes of its own.
                    told, own = (np.array([x[0], np.hypot(*x[1:3]), 0, x[3], np.hypot(*x[4:]), 0]) for x in (told, own))
                assert (np.abs(own - told) < rounding * np.array(sizes)).all(), rod


@pytest.mark.parametrize("backend", ["vm", "c", "lanes"])
def test_forces_in_gimbal_lock_are_the_oracles(made, backend):
    drawn, scene, true = made
    solution = evaluate(scene, backend=backend)
    assert solution.certified
    compare(drawn, solution, true)


def test_what_gimbal_lock_leaves_of_three_turns_is_told_and_the_rest_is_named(made):
    drawn, scene, _ = made
    turns = [name for name in scene.mechanism.coordinates if Output("motion", name) and ":turn_" in name and name[0] in "tS"]
    turns = [name for name in turns if f"motion:{name}" in evaluate(scene, wanted=["motion"]).series]
    assert len(turns) == 3
    members = [f"motion:{name}{end}" for name in turns for end in ("", "_rate", "_acceleration")]
    solution = evaluate(scene)
    assert set(solution.undetermined) == set(members) - {f"motion:{turns[1]}"}
    # With no instant in the lock all three are told, before it and behind it.
    beside = evaluate(scene, t=(0.1, 0.3, 8))
    assert beside.certified
    assert not beside.undetermined
    for k in (0, 3, 4, 7):
        places = postures(drawn, float(beside.t[k]))
        for name in turns:
            gap = beside.motion(name).value[k] - places[name]
            assert abs(gap - 2 * np.pi * round(gap / (2 * np.pi))) < 1e-11, name


def test_rates_of_three_turns_are_their_derivatives(made):
    _, scene, _ = made
    turns = [name for name in scene.mechanism.coordinates if f"motion:{name}" in evaluate(scene).series and ":turn_" in name]
    step = 1e-4
    near = evaluate(scene, t=(0.12 - step, 0.12 + step, 3))
    for name in turns:
        told = near.motion(name)
        assert told.rate[1] == pytest.approx((told.value[2] - told.value[0]) / (2 * step), rel=1e-4, abs=1e-5)
        assert told.acceleration[1] == pytest.approx((told.rate[2] - told.rate[0]) / (2 * step), rel=1e-4, abs=1e-4)


def test_other_ways_to_evaluate_a_ball(made):
    drawn, scene, true = made
    counted = evaluate(scene, newton=4)
    assert counted.certified
    compare(drawn, counted, true, 1e-9)
    single = evaluate(scene, precision="single", wanted=["effort", "reaction"])
    exact = evaluate(scene, wanted=["effort", "reaction"])
    size = max(np.abs(values).max() for values in exact.outputs.values())
    for output, values in exact.outputs.items():
        assert np.abs(values - single.outputs[output]).max() < 1e-3 * size, output

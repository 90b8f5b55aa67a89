"""What the spatial oracle leaves open, and what it refuses.

Its forces are held against published numbers in test_spatial_oracle, and against the package, with
which it shares nothing, in test_spatial_evaluate.
"""

import dataclasses

import numpy as np
import pytest
from spatial_algebra import InconsistentError
from spatial_bodies import (
    Joint,
    Mechanism,
    Rigid,
)
from spatial_draft import direction, frame
from spatial_mechanisms import rssr, rsur
from spatial_motion import OpenLoopError
from spatial_oracle import solve
from spatial_reference import Entry
from spatial_wheels import wheel

pytestmark = pytest.mark.quick


def close(found, told, size=1.0):
    assert np.allclose(np.asarray(found, dtype=float), told, rtol=0, atol=1e-13 * size), (
        found,
        told,
    )


def test_shafts_and_cross_at_one_point_leave_their_forces_open_and_no_moment():
    instant = Entry("hooke_joint").instant(1)
    found = solve(instant.mechanism, instant.drives, instant.guess, pushed=instant.pushed)
    joints = ("bearing_in", "cross", "bearing_out")
    assert found.open == {(joint, m) for joint in joints for m in ("fx", "fy", "fz")}


def test_a_coupler_between_spheres_may_spin_and_one_at_a_universal_joint_may_not():
    assert np.max(np.abs(rssr(0).solve(0.1).idle["coupler"]), initial=0.0) > 0.1
    assert all(np.max(np.abs(way), initial=0.0) < 1e-9 for way in rsur(0).solve(0.1).idle.values())


def test_a_spin_that_is_driven_changes_no_force_of_a_slender_coupler():
    one = rssr(1)
    free, drives = one.solve(0.0), one.drives(0.0)
    mechanism = one.mechanism
    R = np.array(one.guess["coupler"][1])
    # The last turn of this sphere is about the coupler, which stands so at coordinates zero.
    zero = free.poses["crank"].R.T @ R
    turns = [-zero[:, 2], zero[:, 1], zero[:, 0]]
    first = Joint(
        "A",
        "spherical",
        "crank",
        "coupler",
        mechanism.joint("A").at_parent,
        frame=turns,
        orientation=zero,
    )
    joints = [first if j.name == "A" else j for j in mechanism.joints]
    spun = dataclasses.replace(mechanism, joints=joints)
    found = solve(spun, drives | {("A", 2): (0.0, 3.0, 40.0)}, one.guess)
    assert abs(found.poses["coupler"].w @ R[:, 0]) > 1
    close(found.efforts["A", 2], 0)
    for name, reaction in free.reactions.items():
        close(found.reactions[name], reaction, 100)


def test_a_loop_out_of_reach_is_refused():
    one = rssr(0)
    far = [
        dataclasses.replace(j, at_parent=(9, 9, 9)) if j.name == "Q" else j
        for j in one.mechanism.joints
    ]
    with pytest.raises(OpenLoopError, match="does not close"):
        solve(Mechanism(one.mechanism.bodies, far), one.drives(0.0), one.guess)


def test_forces_that_nothing_balances_are_refused():
    told = {("J", k): (0.0, 0.0, 1.0) for k in range(6)}
    body = Rigid("body", 1.0, inertia=np.eye(3))
    with pytest.raises(InconsistentError, match="do not balance"):
        solve(Mechanism([body], [Joint("J", "free", "ground", "body")]), told, pushed=[("J", 0)])


def test_drives_that_contradict_each_other_are_refused():
    door = Rigid("door", 20.0)
    hinges = [Joint(f"H{z}", "revolute", "ground", "door", (0, 0, z), (0, 0, z)) for z in (0, 2)]
    with pytest.raises(OpenLoopError, match="contradict"):
        solve(Mechanism([door], hinges), {("H0", 0): (0.3, 1.0, 2.0), ("H2", 0): (0.3, 1.5, 2.0)})


def test_a_frame_is_right_handed():
    rng = np.random.default_rng(0)
    with pytest.raises(AssertionError, match="right-handed"):
        solve(
            Mechanism(
                [Rigid("body", 1.0)],
                [Joint("J", "weld", "ground", "body", orientation=-frame(direction(rng), rng))],
            ),
            {},
        )


def test_a_motion_that_skids_is_told_by_name():
    rolls = wheel(1)
    faster = dataclasses.replace(
        rolls,
        laws=rolls.laws | {("shaft", 0): dataclasses.replace(rolls.laws["shaft", 0], speed=9.0)},
    )
    with pytest.raises(InconsistentError, match="the motion does not fulfil 'rolling'"):
        faster.solve(0.3)

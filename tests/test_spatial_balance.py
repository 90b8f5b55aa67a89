"""The spatial oracle against closed forms, one for each thing that it can be told, and what it
refuses.
"""

import dataclasses
import math

import numpy as np
import pytest
from arithmetic import DOUBLE
from spatial_algebra import InconsistentError, cross
from spatial_bodies import (
    Coupling,
    Joint,
    Load,
    Mechanism,
    Rigid,
    Rod,
    Spring,
    second_moments,
    uniform,
)
from spatial_draft import direction, frame, joint
from spatial_mechanisms import rssr, rsur
from spatial_motion import OpenLoopError
from spatial_oracle import solve
from spatial_reference import Entry
from spatial_wheels import wheel

pytestmark = pytest.mark.quick

G = 9.81
UPRIGHT = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]


def close(found, told, size=1.0):
    assert np.allclose(np.asarray(found, dtype=float), told, rtol=0, atol=1e-13 * size), (
        found,
        told,
    )


def test_a_screw_lifts_what_it_turns():
    lead, inertia, mass, alpha = 0.3, 0.02, 4.0, 5.0
    nut = Rigid("nut", mass, inertia=np.diag([0.01, 0.01, inertia]))
    found = solve(
        Mechanism([nut], [Joint("J", "screw", "ground", "nut", lead=lead)]),
        {("J", 0): (0.7, 2.0, alpha)},
    )
    s = lead / (2 * math.pi)
    close(found.efforts["J", 0], (inertia + mass * s * s) * alpha + mass * G * s, 10)
    lift = mass * (G + s * alpha)
    close(found.reactions["J"], [0, 0, lift, 0, 0, -s * lift], 100)
    close(found.poses["nut"].r, [0, 0, s * 0.7])


def test_a_bead_on_a_line_is_pushed_along_and_held_across():
    line, turns = np.array([0.6, 0.0, 0.8]), [(0, 0, 0)] * 3
    bead = Rigid("bead", 2.0, inertia=np.eye(3))
    told = {("J", 0): (0.5, 1.0, 3.0)} | {("J", 1 + k): turn for k, turn in enumerate(turns)}
    found = solve(
        Mechanism([bead], [Joint("J", "slot", "ground", "bead", axis=line)]),
        told,
        pushed=[("J", 0)],
    )
    close(found.efforts["J", 0], 2 * (3 + G * 0.8), 10)
    close(found.reactions["J"], [-2 * G * 0.8 * 0.6, 0, 2 * G - 2 * G * 0.8 * 0.8, 0, 0, 0], 10)


def test_a_puck_on_an_incline():
    across, up = np.array([0.0, 1.0, 0.0]), np.array([0.8, 0.0, 0.6])
    puck = Rigid("puck", 3.0, inertia=np.diag([0.1, 0.2, 0.3]))
    plane = Joint(
        "J",
        "planar",
        "ground",
        "puck",
        axis=up,
        axis2=across,
        orientation=np.array([up, across, cross(up, across)]).T,
    )
    told = {("J", 0): (0.1, 1.0, 2.0), ("J", 1): (0.2, 2.0, 4.0), ("J", 2): (0.4, 3.0, 5.0)}
    found = solve(Mechanism([puck], [plane]), told)
    close([found.efforts["J", k] for k in range(3)], [3 * (2 + G * 0.6), 3 * 4.0, 0.3 * 5], 10)
    close(found.reactions["J"], [*(3 * G * 0.8 * cross(up, across)), 0, 0, 0], 100)
    close(found.poses["puck"].r, 0.1 * up + 0.2 * across)
    close(found.poses["puck"].R[:, 0], math.cos(0.4) * up + math.sin(0.4) * across)


def test_a_universal_joint_carries_its_second_axis():
    first, second = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    spin = Joint("J", "universal", "ground", "top", axis=first, axis2=second)
    top = Rigid("top", 1.0, inertia=np.diag([0.2, 0.2, 0.2]))
    found = solve(
        Mechanism([top], [spin], gravity=(0, 0, 0)),
        {("J", 0): (0.5, 3.0, 0.0), ("J", 1): (0.2, 7.0, 0.0)},
    )
    carried = np.array([math.cos(0.5), math.sin(0.5), 0.0])
    close(found.poses["top"].w, 3 * first + 7 * carried)
    close(found.reactions["J"][3:], 0.2 * 3 * 7 * np.cross(first, carried))
    close([found.efforts["J", 0], found.efforts["J", 1]], [0, 0])


def test_gears_share_a_load_by_their_ratio():
    """A wheel drives another of twice its teeth, on skew shafts; the second one lifts a weight by a
    rack.
    """
    axes = [np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])]
    wheels = [
        Rigid(f"w{i}", 1.0, inertia=np.eye(3) * inertia) for i, inertia in enumerate((0.1, 0.4))
    ]
    joints = [
        Joint(f"J{i}", "revolute", "ground", f"w{i}", (i, 0, 0), axis=axis)
        for i, axis in enumerate(axes)
    ]
    joints.append(Joint("L", "prismatic", "ground", "load"))
    couplings = [
        Coupling("mesh", {("J0", 0): 1, ("J1", 0): 2}, 0.3),
        Coupling("rack", {("L", 0): 1, ("J1", 0): 0.05}),
    ]
    mechanism = Mechanism([*wheels, Rigid("load", 6.0)], joints, couplings=couplings)
    found = solve(mechanism, {("J0", 0): (1.0, 2.0, 8.0)})
    assert not found.open
    close(found.coordinates["J1", 0], [-0.35, -1.0, -4.0])
    close(found.coordinates["L", 0], [0.0175, 0.05, 0.2])
    lift = 6 * (G + 0.2)
    close(found.multipliers["rack"], lift, 100)
    # What turns the second wheel is its inertia and the rack: 2 mesh + 0.05 rack = 0.4 (-4).
    mesh = (0.4 * -4 - 0.05 * lift) / 2
    close(found.multipliers["mesh"], mesh, 100)
    close(found.efforts["J0", 0], 0.1 * 8 - mesh, 10)
    close(found.reactions["J1"], [0, 0, G, 0, 0, 0], 100)
    close(found.reactions["L"], np.zeros(6), 100)


def test_springs_and_dampers_pull_along_the_line_between_their_points():
    cage = Rigid("cage", 2.0, inertia=np.eye(3))
    spring = Spring((("ground", (3, 0, 0)), ("cage", (0, 0, 0))), stiffness=100, free=2, damping=7)
    guide = Joint("J", "prismatic", "ground", "cage")
    found = solve(Mechanism([cage], [guide], springs=[spring]), {("J", 0): (4.0, 0.5, 0.0)})
    tension = 100 * (5 - 2) + 7 * 0.5 * 4 / 5
    close(found.efforts["J", 0], 2 * G + tension * 0.8, 1000)
    close(found.reactions["J"][:3], [-tension * 0.6, 0, 0], 1000)


@pytest.mark.parametrize("turning", [False, True])
def test_a_load_may_turn_with_its_body(turning):
    arm = uniform("arm", 2.0, 1.0)
    load = Load("arm", (2, 0, 0), (0, 5, 0), (2, 0, 1), turning)
    pin = Joint("J", "revolute", "ground", "arm")
    found = solve(
        Mechanism([arm], [pin], gravity=(0, 0, 0), loads=[load]), {("J", 0): (math.pi / 3, 0, 0)}
    )
    close(found.efforts["J", 0], -1 - 10 * (1.0 if turning else 0.5), 10)
    along = [1.0, math.sqrt(3)] if turning else [2.0, 0.0]
    close(found.reactions["J"][3:], [-along[0], -along[1], 0], 10)


def test_a_collar_loads_a_cantilever_where_it_is():
    beam, collar = uniform("beam", 2.0, 3.0), Rigid("collar", 5.0)
    joints = [
        Joint("W", "weld", "ground", "beam"),
        Joint("P", "prismatic", "beam", "collar", axis=(1, 0, 0)),
    ]
    found = solve(Mechanism([beam, collar], joints), {("P", 0): (1.2, 0.3, 4.0)})
    close(found.efforts["P", 0], 20, 10)
    for x in (0.0, 0.6, 1.19, 1.21, 2.0):
        beyond = 5.0 * (x < 1.2)
        shear, moment = beyond + 1.5 * (2 - x), beyond * (1.2 - x) + 1.5 * (2 - x) ** 2 / 2
        for from_base in (False, True):
            own = found.sections["beam"].at(x / 2, from_base)
            close(own, [-4 * beyond, 0, -G * shear, 0, G * moment, 0], 100)


def test_second_moments_are_what_a_solid_bar_has():
    """A bar whose section is a tapered, sheared rectangle, against quadrature of its matter in
    three dimensions.
    """
    rho, length, lean = 700.0, 0.9, 0.3

    def wide(xi):
        return 0.1 * (1 - 0.4 * xi)

    def high(xi):
        return 0.06 * (1 - 0.5 * xi)

    def yy(xi):
        return rho * high(xi) * wide(xi) ** 3 / 12

    def zz(xi):
        return rho * wide(xi) * high(xi) ** 3 / 12 + lean**2 * yy(xi)

    bar = Rod(
        "bar",
        length,
        lambda xi: rho * wide(xi) * high(xi),
        **second_moments(yy, zz, lambda xi: lean * yy(xi)),
    )
    rng = np.random.default_rng(3)
    told = {("J", k): tuple(rng.normal(size=3)) for k in range(6)}
    found = solve(
        Mechanism([bar], [joint(rng, "J", "free", "ground", "bar")], gravity=(1, 2, -9)), told
    )
    pose, (nodes, weights) = found.poses["bar"], DOUBLE.gauss
    for start in (0.0, 0.3, 0.7):
        force = moment = np.zeros(3)
        for u, p in zip(
            start + (nodes + 1) / 2 * (1 - start), weights / 2 * (1 - start), strict=True
        ):
            for v, q in zip(nodes, weights, strict=True):
                for w, r in zip(nodes, weights, strict=True):
                    y = v * wide(u) / 2
                    at = np.array([u * length, y, w * high(u) / 2 + lean * y])
                    mass = rho * wide(u) * high(u) * p * q * r / 4 * length
                    needed = mass * (pose.acceleration(at) - np.array([1, 2, -9]))
                    force, moment = (
                        force - needed,
                        moment - np.cross(pose.R @ (at - [start * length, 0, 0]), needed),
                    )
        own = found.sections["bar"].at(start)
        close(own, [*(pose.R.T @ force), *(pose.R.T @ moment)], 100)
        if start == 0.0:
            close([found.efforts["J", k] for k in range(3)], -pose_axes(found, force), 100)


def pose_axes(found, force):
    """A force along a free joint's slides."""
    frame_ = found.balance.motion.axes["J"]
    return np.array([axis.direction @ force for axis in frame_[:3]])


def test_two_hinges_of_one_door_share_what_they_bear():
    door = Rigid("door", 20.0, (0.4, 0, 1), np.diag([7, 8, 1]))
    hinges = [Joint(f"H{z}", "revolute", "ground", "door", (0, 0, z), (0, 0, z)) for z in (0, 2)]
    found = solve(Mechanism([door], hinges), {("H0", 0): (0.3, 1.0, 2.0)})
    assert len(found.wrenches.null) == 5
    assert found.open == {(f"H{z}", m) for z in (0, 2) for m in ("fx", "fy", "fz", "mx", "my")}
    close(found.loose_reactions["H0"][:3] + found.loose_reactions["H2"][:3], np.zeros((3, 5)))
    close(found.efforts["H0", 0], (1 + 20 * 0.16) * 2, 10)
    total = found.reactions["H0"] + found.reactions["H2"]
    centre = 0.4 * np.array([math.cos(0.3), math.sin(0.3)])
    close(total[:2], 20 * (2 * np.array([-centre[1], centre[0]]) - centre), 100)
    close(total[2], 20 * G, 1000)


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

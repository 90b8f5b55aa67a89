"""The spatial oracle against numbers from elsewhere, in doubles and in many digits."""

import dataclasses

import numpy as np
import pytest
from spatial_bodies import AXES
from spatial_oracle import solve
from spatial_reference import NAMES, Entry, numbers

COMPUTED = [n for n in NAMES if n.split("_")[0] not in ("sdfast", "opensim", "adams")]


def solved(instant, digits):
    return solve(instant.mechanism, instant.drives, instant.guess, digits, instant.pushed)


def differences(instant, found, weighed=False):
    """The largest difference from an entry's numbers, by kind, relative to the largest of that kind
    in the instant.

    Where it is ``weighed``, weights are among the forces: a falling body's other forces are their
    differences.
    """
    data, gaps, sizes = instant.data, {}, {}
    if weighed:
        weight = sum(float(body.mass) for body in instant.mechanism.bodies) * max(
            abs(float(g)) for g in instant.mechanism.gravity
        )
        sizes = {"force": [weight], "moment": [weight * found.size]}

    def compare(kind, given, own):
        given = np.atleast_1d(numbers(given))
        gaps.setdefault(kind, [0.0]).extend(float(abs(x)) for x in given - np.atleast_1d(own))
        sizes.setdefault(kind, [0.0]).extend(float(abs(x)) for x in given)

    for (joint, k), name in instant.efforts.items():
        turns = k in instant.mechanism.joint(joint).turning
        compare("moment" if turns else "force", data["efforts"][name], found.efforts[joint, k])
    for joint, given in data.get("reactions", {}).items():
        for kind, part in (("force", slice(3)), ("moment", slice(3, 6))):
            if kind in given:
                compare(kind, given[kind], found.reactions[joint][part])
    idle = {
        name for name, motions in found.idle.items() if np.max(np.abs(motions), initial=0.0) > 1e-9
    }
    for rod, given in data.get("sections", {}).items():
        for one in given:
            own, R = found.sections[rod].at(numbers(one["xi"]).item()), found.sections[rod].axes()
            compare("force", one["force"], R @ own[:3])
            compare("moment", one["moment"], R @ own[3:])
            local = numbers(one["local"])
            if rod in idle:
                # The spin is anyone's. What is along the rod is not, nor the resultants across it.
                local, own = (
                    np.array([x[0], x[1:3] @ x[1:3], 0 * x[0], x[3], x[4:] @ x[4:], 0 * x[0]])
                    for x in (local, own)
                )
                local[1::3], own[1::3] = local[1::3] ** 0.5, own[1::3] ** 0.5
            compare("force", local[:3], own[:3])
            compare("moment", local[3:], own[3:])
    for name, pose in data["poses"].items():
        compare("place", pose["r"], found.poses[name].r)
        if name not in idle:
            compare("direction", np.ravel(pose["R"]), np.ravel(found.poses[name].R))
    return {kind: max(gaps[kind]) / (max(sizes[kind]) or 1.0) for kind in gaps}


@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_are_met_in_doubles(name):
    entry = Entry(name)
    for k in range(entry.count):
        instant = entry.instant(k)
        for kind, gap in differences(
            instant, solved(instant, None), weighed=name not in COMPUTED
        ).items():
            assert gap < 2e-14, (kind, k, gap)


@pytest.mark.parametrize("name", COMPUTED)
def test_the_numbers_are_met_in_thirty_digits(name):
    entry = Entry(name)
    instant = entry.instant(entry.count - 1)
    for kind, gap in differences(instant, solved(instant, 40)).items():
        assert gap < 1e-28, (kind, gap)


@pytest.mark.parametrize("name", [n for n in NAMES if n.startswith(("sdfast", "opensim"))])
def test_published_reactions_in_the_childs_axes(name):
    """SD/FAST's are printed to six decimals; OpenSim's are doubles."""
    entry, accuracy = Entry(name), 5e-7 if name.startswith("sdfast") else 2e-11
    for k in range(entry.count):
        instant = entry.instant(k)
        found = solved(instant, None)
        assert all(abs(effort) < 1e-10 for effort in found.efforts.values())
        for joint, given in instant.data["published_child_axes"].items():
            R = found.poses[instant.mechanism.joint(joint).child].R
            own = np.concatenate(
                [R.T @ found.reactions[joint][:3], R.T @ found.reactions[joint][3:]]
            )
            told = [float(x) for x in (*given["force"], *given["torque"])]
            assert np.max(np.abs(own - told)) < accuracy


@pytest.mark.parametrize("name", [n for n in NAMES if n.startswith("adams")])
def test_published_forces_on_the_ground(name):
    """Adams' accelerations scatter by up to 7e-4 from row to row."""
    entry = Entry(name)
    for k in range(entry.count):
        instant = entry.instant(k)
        found, joint = solved(instant, None), instant.mechanism.joints[0]
        force, moment = found.reactions["joint"][:3], found.reactions["joint"][3:]
        arm = (found.poses["pendulum"].at(joint.at_child) - joint.at_parent).astype(float)
        published = {
            key: np.array([float(x) for x in told])
            for key, told in instant.data["published"].items()
        }
        assert all(
            abs(effort) < 1e-10 * (1 + np.linalg.norm(arm)) for effort in found.efforts.values()
        )
        assert np.max(np.abs(-force - published["force"])) < 7e-4
        assert np.max(np.abs(-(moment + np.cross(arm, force)) - published["torque"])) < 7e-4 * (
            1 + np.linalg.norm(arm)
        )


@pytest.mark.parametrize("k", range(3))
def test_a_sphere_driven_by_three_angles_moves_as_one_driven_by_its_orientation(k):
    """The angles are those of R = Rx Ry Rz, each axis carried by the turns before."""
    instant = Entry("sdfast_chain").instant(k)
    q, rate, acceleration = (numbers(row) for row in instant.data["gimbal_xyz_angles"])
    told = {("gimbal", i): (q[i], rate[i], acceleration[i]) for i in range(3)}
    joints = [
        dataclasses.replace(j, orientation=AXES) if j.name == "gimbal" else j
        for j in instant.mechanism.joints
    ]
    found = solve(
        dataclasses.replace(instant.mechanism, joints=joints),
        instant.drives | told,
        instant.guess,
        40,
    )
    pose = instant.data["poses"]["body3"]
    assert np.max(np.abs(found.poses["body3"].R - numbers(pose["R"]))) < 1e-28
    for name, given in instant.data["reactions"].items():
        told = numbers([*given["force"], *given["moment"]])
        assert np.max(np.abs(found.reactions[name] - told)) < 1e-25
    assert max(abs(effort) for effort in found.efforts.values()) < 1e-25

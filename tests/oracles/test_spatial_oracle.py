"""The spatial oracle against numbers from elsewhere."""

import numpy as np
import pytest
from spatial_oracle import solve
from spatial_reference import NAMES, instants, numbers

COMPUTED = [n for n in NAMES if n.split("_")[0] not in ("sdfast", "opensim", "adams")]


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

    for (joint, k), effort in instant.efforts.items():
        turns = k in instant.mechanism.joint(joint).turning
        compare("moment" if turns else "force", effort, found.efforts[joint, k])
    for joint, given in data.get("reactions", {}).items():
        for kind, part in (("force", slice(3)), ("moment", slice(3, 6))):
            if kind in given:
                compare(kind, given[kind], found.reactions[joint][part])
    idle = {
        name for name, motions in found.idle.items() if np.max(np.abs(motions), initial=0.0) > 1e-9
    }
    for rod, given in data.get("sections", {}).items():
        for one in given:
            own, R = found.sections[rod].at(numbers(one["xi"])), found.poses[rod].R
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
def test_the_numbers_are_met(name):
    for k, instant in enumerate(instants(name)):
        found = solve(instant.mechanism, instant.drives, instant.guess, instant.pushed)
        gaps = differences(instant, found, weighed=name not in COMPUTED)
        assert max(gaps.values()) < 2e-14, (k, gaps)
        for joint, given in instant.data.get("published_child_axes", {}).items():
            R = found.poses[instant.mechanism.joint(joint).child].R
            printed = numbers([given["force"], given["torque"]])
            gap = np.abs(found.reactions[joint].reshape(2, 3) @ R - printed).max()
            assert gap < (5e-7 if name.startswith("sdfast") else 2e-11), (k, joint)

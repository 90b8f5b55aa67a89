"""Planar mechanisms told in space, turned anyhow: forces in their plane are the same, and out of it
is only what is open.
"""

import numpy as np
import pytest
from conftest import CASES, PLANAR
from internals import Output
from spatial_draft import orientation
from spatial_twin import planar, twin

from lagrange_casadi import derive, evaluate, load_case

DYADS = (
    "slider_crank",
    "engine",
    "four_bar",
    "quick_return",
    "six_bar",
    "andrews_squeezer",
    "jansen_leg",
)
"""Those that are made of dyads alone."""

SECTION = {"axial": "axial", "shear": "shear_y", "bending": "bending_z"}
XI = (0, 1, 7)
ROUNDING = 1e-12


def both(name, seed):
    """A case at an instant, its scene in space, and how its plane lies there."""
    scene, R = (
        load_case(CASES / name).scene,
        orientation(np.random.default_rng([PLANAR.index(name), seed])),
    )
    start, stop = scene.span
    flat = planar(scene, start + 0.37 * (stop - start), xi=XI)
    return flat, twin(scene, flat, R), R


@pytest.mark.parametrize("name", PLANAR)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.sampled(29)
def test_a_planar_mechanism_is_the_same_in_space(name, seed):
    """What is in the plane is known and as it was; what is out of it is nothing, or open and not
    told.
    """
    flat, scene, R = both(name, seed)
    told = evaluate(scene, wanted=["all"], backend="vm", xi=XI)
    assert told.certified
    size = max(
        1.0,
        *(
            abs(values[-1])
            for key, values in flat.outputs.items()
            if key.group == "reaction" and key.member[0] == "f"
        ),
    )
    for key, values in flat.outputs.items():
        if key.group in ("effort", "multiplier"):
            assert told.outputs[key][0] == pytest.approx(
                values[-1], abs=ROUNDING * max(size, abs(values[-1]))
            ), key
    for joint in flat.description["joints"]:
        compare_reaction(flat, told, scene.mechanism.joints[joint], R, size)
    for link in {key.part for key in flat.outputs if key.group == "section"}:
        one, other = flat.section(link), told.section(link)
        for member in SECTION:
            gap = getattr(other, SECTION[member])[0] - getattr(one, member)[-1]
            assert np.max(np.abs(gap)) <= ROUNDING * size, (link, member)
        for member in ("shear_z", "torsion", "bending_y"):
            values = getattr(other, member)[0]
            assert np.all(np.isnan(values) | (np.abs(values) <= ROUNDING * size)), (link, member)


def compare_reaction(flat, told, joint, R, size):
    """On the joint's own axes: what is in the plane is known, what is out of it or askew may be
    open.
    """
    axes, name = np.eye(3), joint.name
    if joint.parent.body.name in told.description["bodies"]:
        axes = told.pose(joint.parent.body.name).axes[0].T
    x, y, z = (
        flat.outputs.get(Output("reaction", name, member), [0.0])[-1]
        for member in ("fx", "fy", "mz")
    )
    force, couple = R @ [x, y, 0.0], R @ [0.0, 0.0, z]
    for letter, direction in zip("uvw", (axes @ np.array(joint.triad, float).T).T, strict=True):
        out = abs(direction @ R[:, 2])
        for kind, vector, known in (("f", force, out < 1e-9), ("m", couple, out > 1 - 1e-9)):
            output = Output("reaction", name, f"{kind}{letter}")
            value = told.outputs.get(output, [0.0])[0]
            if known or not np.isnan(value):
                assert value == pytest.approx(vector @ direction, abs=ROUNDING * size), output
            else:
                assert output in told.indeterminate


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", DYADS)
def test_dyads_need_no_iteration_however_their_plane_lies(name):
    assert derive(both(name, 0)[1]).newton is None

"""Planar mechanisms told in space, turned anyhow: forces in their plane are the same, and out of it is only what is open."""

import numpy as np
import pytest
from conftest import CASES
from spatial_bridge import instants
from spatial_draft import orientation
from spatial_twin import planar, twin

from lagrange_casadi import derive, load_case

NAMES = ("slider_crank", "engine", "four_bar", "quick_return", "six_bar", "andrews_squeezer", "rrr3", "arm", "jansen_leg")
DYADS = ("slider_crank", "engine", "four_bar", "quick_return", "six_bar", "andrews_squeezer", "jansen_leg")
"""Those that are made of dyads alone."""

ROUNDING = 1e-12


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.sampled(15)
def test_a_planar_mechanism_is_the_same_in_space(name, seed):
    rng = np.random.default_rng([NAMES.index(name), seed])
    scene, R = load_case(CASES / name).scene, orientation(rng)
    start, stop = scene.span
    t = start + 0.37 * (stop - start)
    flat = planar(scene, t)
    space = twin(scene, t, flat, R)
    found = {key: float(row[0]) for key, row in instants(space, [t]).items()}
    m = scene.mechanism
    forces = [abs(value) for key, value in flat.items() if key.startswith("reaction") and key[-2:] in ("fx", "fy")]
    size = max(1.0, *forces)
    for joint in scene.motion:
        assert found[f"effort:{joint}"] == pytest.approx(flat[f"effort:{joint}"], abs=ROUNDING * size)
    for joint in space.mechanism.joints.values():
        axes = np.eye(3)
        if joint.parent.body is not space.mechanism.ground and joint.parent.body.oriented:
            names = ((f"pose:{joint.parent.body.name}:{axis}{of}" for of in "xyz") for axis in "xyz")
            axes = np.array([[found[key] for key in row] for row in names]).T
        force = R @ [flat[f"reaction:{joint.name}:fx"], flat[f"reaction:{joint.name}:fy"], 0.0]
        told = dict(zip("uvw", (axes @ np.array(joint.triad, float).T).T, strict=True))
        for letter, direction in told.items():
            # What ideal joints leave open acts out of the plane.
            if abs(direction @ R[:, 2]) < 1e-9:
                assert found[f"reaction:{joint.name}:f{letter}"] == pytest.approx(force @ direction, abs=ROUNDING * size)
            elif f"reaction:{joint.name}:mz" in flat and f"reaction:{joint.name}:m{letter}" in found:
                moment = flat[f"reaction:{joint.name}:mz"] * (direction @ R[:, 2])
                assert found[f"reaction:{joint.name}:m{letter}"] == pytest.approx(moment, abs=ROUNDING * size)
    for link in m.links:
        for own, other in (("n0", "n0"), ("fy0", "f0"), ("fy1", "f1"), ("fy2", "f2"), ("n1", "n1"), ("n2", "n2"), ("mz0", "m0")):
            if f"section:{link}:law:{other}" in flat:
                one = flat[f"section:{link}:law:{other}"]
                assert found[f"section:{link}:law:{own}"] == pytest.approx(one, abs=ROUNDING * max(size, abs(one)))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", DYADS)
def test_dyads_need_no_iteration_however_their_plane_lies(name):
    scene = load_case(CASES / name).scene
    t = scene.span[0] + 0.37 * (scene.span[1] - scene.span[0])
    assert derive(twin(scene, t, planar(scene, t), orientation(np.random.default_rng(1)))).newton is None

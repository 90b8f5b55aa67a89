"""Shaking force and moment: beside what the ground's joints bear, and the classics of balancing."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    density,
    evaluate,
    load_case,
    shaking,
)
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def weightless(name, about=()):
    """A case without gravity, and with its shaking force and moment."""

    def freeze(mechanism, *, own=Mechanism.freeze):
        if "shaking_fx" not in mechanism.outputs:
            mechanism.gravity = tuple(0.0 for _ in mechanism.gravity)
            shaking(mechanism, about=about)
        own(mechanism)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Mechanism, "freeze", freeze)
        return load_case(CASES / name).scene


@pytest.mark.parametrize("name", ["four_bar", "rrr3", "arm", "arm6"])
def test_without_weight_and_loads_it_is_what_the_ground_bears(name):
    """The ground's joints hold the mechanism with the opposite of it: the sum of their forces,
    moments and efforts.
    """
    scene = weightless(name)
    space = scene.mechanism.space
    wanted = ["reaction", "effort", "output"]
    solution = evaluate(scene, t=(*scene.t[:2], 17), wanted=wanted, backend="vm", certificate=False)
    force, moment = np.zeros((2, 3, 17))
    for joint in scene.mechanism.joints.values():
        if joint.parent.body is not scene.mechanism.ground:
            continue
        values = {
            m: solution.series.get(f"reaction:{joint.name}:{m}", np.zeros(17))
            for m in ("fx", "fy", "fz", "mx", "my", "mz")
        }
        f, m = (np.array([values[f"{kind}{x}"] for x in "xyz"]) for kind in "fm")
        assert {axis.kind for axis in joint.axes} <= {
            "angle"
        } or f"effort:{joint.name}" not in solution.series
        m[2] += solution.series.get(f"effort:{joint.name}", 0.0)  # all these drives turn about z
        place = np.array(
            [float(scene.mechanism.number(x, scene.mechanism.values())) for x in joint.parent.place]
        )
        force += f
        moment += m + np.cross(place, f.T).T
    size = np.abs(force).max() + np.abs(moment).max()
    for k, x in enumerate("xyz"[: 2 + space]):
        np.testing.assert_allclose(
            solution.output(f"shaking_f{x}"), -force[k], rtol=0, atol=1e-12 * size
        )
    for k, x in enumerate("xyz"):
        if space or x == "z":
            np.testing.assert_allclose(
                solution.output(f"shaking_m{x}"), -moment[k], rtol=0, atol=1e-12 * size
            )


def test_about_another_point():
    """The moment about a point is less by the arm's moment of the force."""
    first, second = (
        evaluate(scene, wanted=["output"], t=(0, 0.08, 9), backend="vm", certificate=False)
        for scene in (weightless("slider_crank"), weightless("slider_crank", about=(0.2, 0.1)))
    )
    fx, fy = first.output("shaking_fx"), first.output("shaking_fy")
    np.testing.assert_allclose(
        second.output("shaking_mz"),
        first.output("shaking_mz") - (0.2 * fy - 0.1 * fx),
        rtol=0,
        atol=1e-12 * np.abs(fy).max(),
    )


def test_mistakes():
    m = Mechanism("late")
    with pytest.raises(DeclarationError, match="there are no bodies yet"):
        shaking(m)
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    with pytest.raises(DeclarationError, match=r"expected a place \(x, y\) for about"):
        shaking(m, about=(1.0, 2.0, 3.0))
    shaking(m)
    m.weld("held", arm.tip, m.point_mass("late", 1.0))
    with pytest.raises(DeclarationError, match="call shaking after all bodies"):
        Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0, 1, 5))


def test_of_slices_with_rotary_inertia():
    """Each effort of a ball is the moment about its turn's axis, the opposite of the shaking
    moment's there.
    """
    m = SpatialMechanism("thick")
    m.set_gravity(0, 0, 0)
    slices = {"yy": density.polynomial(0.02, 0.03), "zz": 0.05, "yz": 0.004}
    bar = m.link("bar", length=0.8, density=density.thick(density.polynomial(3.0, 1.0), **slices))
    m.spherical("O", m.ground, bar)
    shaking(m)
    laws = [polynomial(0.1, 2.0, 1.5), polynomial(0.2, -3.0), polynomial(0.3, 1.0, -2.0)]
    solution = evaluate(Scene(m, {"O": laws}, t=(0, 0.3, 5)), backend="vm", certificate=False)
    a, b = (solution.series[f"motion:O:turn_{k}"] for k in (1, 2))
    axes = (
        np.array([1 + 0 * a, 0 * a, 0 * a]),
        np.array([0 * a, np.cos(a), np.sin(a)]),
        np.array([np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)]),
    )
    moment = np.array([solution.output(f"shaking_m{x}") for x in "xyz"])
    for k, axis in enumerate(axes):
        told = -(moment * axis).sum(axis=0)
        np.testing.assert_allclose(
            told,
            solution.series[f"effort:O:turn_{k + 1}"],
            rtol=0,
            atol=1e-12 * np.abs(moment).max(),
        )

"""The cases in space against numbers from elsewhere, closed forms, statics and energies that are
worked out here.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from conftest import CASES
from spatial_reference import Entry

from lagrange_casadi import evaluate, load_case
from lagrange_casadi.motion import polynomial


def scene_of(name):
    return load_case(CASES / name).scene


def vm(scene, **keywords):
    return evaluate(scene, backend="vm", certificate=False, **keywords)


def test_the_benchmarks_slider_at_its_start():
    slide = vm(scene_of("spatial_slider_crank"), t=(0, 0, 1), wanted=["motion"]).motion("guide")
    assert (slide.value[0], slide.rate[0], slide.acceleration[0]) == pytest.approx(
        (0.2, 0.24, 1.44), abs=1e-14
    )


def test_a_shaft_out_of_phase_pulsates():
    """Hooke's joint twice: without inertia the torque follows the speed, between cos^2 and 1/cos^2
    of the tube's angle.
    """
    square = 1 - (0.15 / 0.5) ** 2
    parameters = {"phase": math.pi / 2}
    slow = vm(
        scene_of("cardan_shaft"), parameters=parameters | {"rpm": 1e-3}, wanted=["effort", "motion"]
    )
    ratio = slow.motion("far:turn").rate / slow.motion("bearing").rate
    assert (ratio.min(), ratio.max()) == pytest.approx((square, 1 / square), rel=1e-12)
    assert np.max(np.abs(slow.effort("bearing") - 80.0 * ratio)) < 1e-7
    assert (slow.effort("bearing").min(), slow.effort("bearing").max()) == pytest.approx(
        (72.8, 80 / 0.91), abs=1e-7
    )
    fast = vm(scene_of("cardan_shaft"), parameters=parameters, wanted=["effort"]).effort("bearing")
    assert np.mean(fast[:-1]) == pytest.approx(80.0, abs=1e-11)
    assert np.ptp(fast) > 4 * np.ptp(slow.effort("bearing"))


REFERENCES = {
    "rssr": ("rssr", (0.0, 0.6, 61), {"drive": "O"}),
    "spatial_slider_crank": ("spatial_slider_crank_slender", (0.25, 1.0, 76), {"drive": "A"}),
    "stewart_gough": ("stewart_6ups", (0.0, 0.95, 96), {f"leg{k}": f"P{k}" for k in range(6)}),
}


@pytest.mark.parametrize("name", REFERENCES)
def test_the_reference_numbers(name):
    """Efforts, reactions, and of sections what does not depend on the axes of the cross-section."""
    entry, t, drives = REFERENCES[name]
    scene, data = scene_of(name), Entry(entry).data
    if name == "rssr":
        scene = dataclasses.replace(scene, motion={"O": polynomial(0.4, 10, 3)})
    found = vm(scene, t=t, xi=(0, 1, 5))
    largest = {"N": 0.0, "N m": 0.0}
    gaps = {"N": [], "N m": []}

    def compare(unit, told, own):
        largest[unit] = max(largest[unit], abs(told))
        gaps[unit].append(abs(told - own))

    for instant in data["instants"]:
        (i,) = np.flatnonzero(np.abs(found.t - float(instant["t"])) < 1e-12)
        for drive, joint in drives.items():
            compare(
                found.unit(f"effort:{joint}"),
                float(instant["efforts"][drive]),
                found.effort(joint)[i],
            )
        for joint, told in instant["reactions"].items():
            own = scene.mechanism.joints[joint]
            sign = 1 if own.child.body.name == data["mechanism"]["joints"][joint]["child"] else -1
            for unit, word, kind in (("N", "force", "f"), ("N m", "moment", "m")):
                for axis, value in zip("xyz", told[word], strict=True):
                    if f"reaction:{joint}:{kind}{axis}" in found.series:
                        compare(
                            unit,
                            sign * float(value),
                            found.series[f"reaction:{joint}:{kind}{axis}"][i],
                        )
                    else:
                        assert float(value) == 0.0
        for link, rows in instant["sections"].items():
            if f"section:{link}" not in {name.rpartition(":")[0] for name in found.names()}:
                continue
            section = found.section(link)
            for row in rows:
                k = round(4 * float(row["xi"]))
                axial, y, z, torsion, about_y, about_z = map(float, row["local"])
                compare("N", axial, section.axial[i, k])
                compare("N", math.hypot(y, z), section.shear[i, k])
                compare("N m", torsion, section.torsion[i, k])
                compare("N m", math.hypot(about_y, about_z), section.bending[i, k])
    for unit, row in gaps.items():
        assert len(row) > 10
        assert max(row) < 1e-12 * largest[unit], unit


def test_bricards_loop_moves_and_one_force_is_open():
    scene = scene_of("bricard")
    found = vm(scene, t=(0, 1, 257))
    angles = [found.motion(f"J{k}").value for k in range(6)]
    first, second = np.cos(angles[0]), np.cos(angles[1])
    for k in range(6):
        assert np.max(np.abs(np.cos(angles[k]) - (first, second)[k % 2])) < 1e-13
    assert np.max(np.abs(first + second + first * second)) < 1e-13
    open_of = {
        str(output).split(":")[1] for output in found.indeterminate if output.group == "reaction"
    }
    assert open_of == {f"J{k}" for k in range(6)}
    assert all(np.isnan(found.outputs[output]).all() for output in found.indeterminate)
    assert np.isnan(found.section("link3").axial).all()

"""Peaks between instants: against closed forms, against far finer instants, and where a quantity
has a kink, a jump or a pole.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import LENGTH, MASS, G, parallelogram, pendulum

from lagrange_casadi import Scene, evaluate, load, motion, save
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.peaks import forces, refine, shortfall


def vm(scene, **keywords):
    return evaluate(scene, backend="vm", certificate=False, **keywords)


def refined(scene, solution, names=None):
    return {peak.name: peak for peak in refine(scene, solution, names)}


def test_the_shortfall_of_a_cosine():
    """The effort is a cosine: what its instants miss is known exactly."""
    speed, start = 3.0, 0.1
    scene = pendulum(motion.polynomial(start, speed), t=(0, 2.0, 11), wanted=["effort"])
    counts = [12, 24, 57]
    rows = shortfall(scene, counts)
    for count, row in zip(counts, rows, strict=True):
        missed = 1 - np.abs(np.cos(start + speed * np.linspace(0, 2.0, count))).max()
        assert row.count == count
        assert row.sampled_worst == row.sampled_median == pytest.approx(missed, rel=1e-10)
        assert abs(row.refined_worst) < 1e-14


@settings(max_examples=10)
@given(st.floats(0.3, 5.0), st.floats(-3.0, 3.0), st.sampled_from([1, -1]), st.integers(9, 40))
def test_peaks_over_a_drive_are_those_over_time(speed, start, sign, count):
    """Of a pendulum that turns forward or backward: its effort is m g l/2 where it lies level,
    at the time at which its drive is there.
    """
    law, stop = motion.polynomial(start, sign * speed), start + sign * 4.0
    scene = pendulum(law, over=("pin", start, stop, count))
    found = evaluate(scene, backend="vm")
    peak = refined(scene, found, ["effort:pin"])["effort:pin"]
    assert abs(peak.value) == pytest.approx(MASS * G * LENGTH / 2, rel=1e-12)
    away = abs(math.remainder(peak.over, math.pi))
    assert away < (1e-6 if peak.t in found.t else 1e-11)
    assert peak.t == pytest.approx((peak.over - start) / (sign * speed), abs=1e-9)
    assert (np.diff(found.over.values) * sign > 0).all()


def test_a_solution_brings_its_parameters_and_outputs(tmp_path, slider_crank):
    """Also from a file, and at some of the instants; what is open stays open."""
    scene, asked = slider_crank.scene, {"parameters": {"l": 0.25}, "wanted": ["section:rod"]}
    solution, fine = (vm(scene, t=(0, 0.08, count), **asked) for count in (101, 100_001))
    save(solution, tmp_path / "x.h5")
    peaks = refine(scene, load(tmp_path / "x.h5"))
    for peak in peaks:
        assert peak.value == pytest.approx(fine.peak(peak.name).value, rel=1e-8)
    half = solution.during(slice(0, 50))
    assert all(peak.t < half.t[-1] for peak in refine(scene, half, [peaks[0].name]))
    scene = parallelogram(pendulum=True)
    solution = evaluate(scene)
    peaks = refined(scene, solution)
    assert math.isnan(peaks["reaction:A:fx"].value)
    assert "reaction:A:fx" not in forces(solution)
    assert np.isfinite([peaks[name].value for name in forces(solution)]).all()


def test_misuse_is_named(slider_crank):
    scene, asked = slider_crank.scene, {"wanted": ["effort"]}
    solution = vm(scene, t=(0, 0.08, 5), **asked)
    other = Scene(scene.mechanism, {"O": motion.polynomial(0, 1.0)}, posture=scene.posture)
    for ask, says in (
        (lambda: refine(scene, solution, ["effort:none"]), "'effort:none' .did you mean 'effort:O"),
        (lambda: refine(scene, solution, ["section:rod:bending"]), "link 'rod' were not evaluated"),
        (lambda: refine(other, solution), "of 'slider_crank' is not one of this scene of"),
        (lambda: refine(pendulum(motion.polynomial(0)), solution), "is not one of this scene"),
        (lambda: shortfall(scene, []), "at least one number of instants"),
        (lambda: shortfall(scene, [9], ["reaction:guide:fx"]), "all peaks are zero or indeterm"),
        (lambda: shortfall(scene, [9], parameters={"r": 0.3}), "cannot be closed"),
    ):
        with pytest.raises((DeclarationError, AssemblyError), match=says):
            ask()

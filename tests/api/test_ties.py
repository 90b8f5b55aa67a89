"""Peaks that tie exactly: what is said of them, and that it is true of the largest of both."""

import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from internals import PeakKind, slope_lines
from mechanisms import slider_crank

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, prepare, sensitivities
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.quick


def pendulum():
    """It swings as far to either side.

    With a bias the effort on one side grows as that on the other shrinks; with the rest not.
    """
    m = Mechanism("pendulum")
    m.set_gravity(0, 0)
    l = m.parameter("l", 0.8, "m")
    swing = m.parameter("swing", 0.6, "rad")
    bias = m.parameter("bias", 0.0, "N m")
    arm = m.link("arm", length=l, mass=2.0)
    m.revolute("O", m.ground, arm)
    m.torque("twist", arm, bias)
    return Scene(m, {"O": harmonic(0.0, swing, 1.0)}, t=(0.0, 1.0, 38))


def bar():
    """A force at the tip, and one of twice its size against it in the middle: the shear is as large
    on both sides.
    """
    m = Mechanism("bar")
    m.set_gravity(0, 0)
    tip, middle = m.parameter("tip", 10.0, "N"), m.parameter("middle", 20.0, "N")
    arm = m.link("arm", length=1.0, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.force("pull", arm.tip, y=tip)
    m.force("push", arm.at(0.5), y=-middle)
    return Scene(m, {"O": polynomial(0.0)}, wanted=["section", "effort"], t=(0.0, 1.0, 5))


@pytest.mark.parametrize("backend", ["auto", "vm"])
def test_a_pendulum_ties_where_a_bias_tells_its_sides_apart(backend):
    scene = pendulum()
    f = prepare(scene, wanted=["effort"], backend=backend)
    gradient = f.gradient()
    assert gradient.tied.tolist() == [True]
    # The largest size grows with the bias whichever sign this has: it has a kink.
    sizes = [abs(f.peaks(bias=bias).value[0]) for bias in (-1e-3, 0.0, 1e-3)]
    assert sizes[0] == pytest.approx(sizes[1] + 1e-3, abs=1e-9)
    assert sizes[2] == pytest.approx(sizes[1] + 1e-3, abs=1e-9)
    assert abs(gradient["effort:O"]["bias"]) == pytest.approx(1.0, abs=1e-12)
    # With a bias of its own one side is larger.
    assert f.gradient(bias=0.1).tied.tolist() == [False]
    assert f.gradient(bias=1e-7).tied.tolist() == [False]


def test_what_changes_alike_is_no_tie():
    """Two turns of the same motion, and both sides of a pendulum without a bias."""
    m = Mechanism("plain")
    m.set_gravity(0, 0)
    arm = m.link("arm", length=m.parameter("l", 0.8, "m"), mass=2.0)
    m.revolute("O", m.ground, arm)
    f = prepare(
        Scene(m, {"O": harmonic(0.0, 0.6, 1.0)}, t=(0.0, 2.0, 57)),
        wanted=["effort", "section", "reaction"],
    )
    gradient = f.gradient()
    assert not gradient.tied.any()
    step = 1e-6
    slope = (abs(f.peaks(l=0.8 + step).value[0]) - abs(f.peaks(l=0.8 - step).value[0])) / (2 * step)
    assert abs(gradient["effort:O"]["l"]) == pytest.approx(slope, rel=1e-8)


def test_along_a_link():
    scene = bar()
    f = prepare(scene)
    gradient = f.gradient()
    tied = dict(zip(f.quantities, gradient.tied.tolist(), strict=True))
    assert tied["section:arm:shear"]
    assert not tied["section:arm:bending"]
    assert not tied["effort:O"]
    assert not f.gradient(middle=20.5).tied.any()
    assert abs(gradient["section:arm:shear"]["tip"]) == pytest.approx(1.0)
    grown = abs(f.peaks(tip=10.1).value[f.quantities.index("section:arm:shear")])
    shrunk = abs(f.peaks(tip=9.9).value[f.quantities.index("section:arm:shear")])
    assert grown == pytest.approx(10.1)
    assert shrunk == pytest.approx(10.1)


def test_kinks_between_instants():
    """Two tents as high, each by a parameter of its own, whose tips no instant meets."""
    m = Mechanism("tents")
    m.set_gravity(0, 0)
    a, b = m.parameter("a", 2.0, "N m"), m.parameter("b", 2.0, "N m")
    arm = m.link("arm", length=1.0, mass=1.0)
    angle = m.coordinate(m.revolute("O", m.ground, arm))
    first, second = (ca.fmax(0.0, 1 - ca.fabs(angle - place) / 0.3) for place in (0.413, 1.627))
    m.torque("push", arm, a * first + b * second)
    f = prepare(Scene(m, {"O": polynomial(0.0, 1.0)}, wanted=["effort"], t=(0.0, 2.0, 41)))
    gradient = f.gradient()
    assert gradient.kinds.tolist() == [PeakKind.SWITCH]
    assert gradient.tied.tolist() == [True]
    assert f.gradient(b=1.99).tied.tolist() == [False]


def test_solutions_say_it_too():
    scene = pendulum()
    solution = evaluate(scene, wanted=["effort", "sensitivity:bias"], certificate=False)
    change = sensitivities(scene, solution).peak("effort:O")
    assert change.tied
    (line,) = [
        line for line in slope_lines(solution, scene, "auto") if line.startswith("  effort:O")
    ]
    assert line.endswith("equally large elsewhere, with other derivatives")
    other = evaluate(scene, parameters={"bias": 0.1}, wanted=["effort"], certificate=False)
    assert not sensitivities(scene, other).peak("effort:O").tied


def test_a_peak_at_an_end_of_its_link():
    f = prepare(load_case(CASES / "slider_crank").scene, wanted=["section:rod"])
    gradient = f.gradient()
    kinds = dict(zip(f.quantities, gradient.kinds.tolist(), strict=True))
    assert kinds["section:rod:shear"] == PeakKind.LINK_END
    assert kinds["section:rod:bending"] == PeakKind.SMOOTH
    assert kinds["section:rod:axial"] == PeakKind.END


def test_nothing_ties_where_a_load_jumps():
    """A case as it is: the cut of the shaper sets in at a jump, and nothing ties."""
    f = prepare(load_case(CASES / "quick_return").scene, wanted=["effort", "reaction"])
    gradient = f.gradient()
    assert not gradient.tied.any()
    assert np.isfinite(gradient.slopes).all()
    assert math.isfinite(gradient["effort:O"]["r"])


def test_of_nothing_there_are_no_peaks():
    scene = slider_crank()
    assert sensitivities(scene, evaluate(scene, backend="vm", certificate=False)).peaks([]) == []

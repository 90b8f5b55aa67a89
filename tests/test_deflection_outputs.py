"""Deflections at every instant, against the elastic curve of a whole solution; in sweeps, searches,
files and exported C.
"""

import numpy as np
import pytest
from strong import STEEL, press, robot, slider

from lagrange_casadi import (
    Scene,
    SpatialMechanism,
    beams,
    best,
    derive,
    evaluate,
    load,
    optimise,
    prepare,
    refine,
    save,
    sweep,
)
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

I_SECTION = beams.i_section(0.04, 0.03, 0.004, 0.005)
LINKS = {
    "held at its drive": lambda: (slider(), "crank"),
    "sliding": lambda: (press(I_SECTION, sliding=True), "rod"),
    "steps": lambda: (
        press(beams.stepped([0.4], [beams.round_bar(0.03), beams.round_bar(0.02)])),
        "rod",
    ),
    "tapered": lambda: (
        press(beams.tapered(beams.rectangle(0.06, 0.02), beams.rectangle(0.02, 0.03))),
        "rod",
    ),
    "tube in space": lambda: (robot(beams.tube(0.04, 0.003)), "upper"),
    "C in space": lambda: (robot(beams.c_section(0.04, 0.03, 0.004, 0.005)), "upper"),
}
ONE_CYCLE = 0.2094395


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", LINKS)
def test_series_are_the_largest_along_the_link(name):
    """Against all zeros of slopes along the elastic curve, by other code."""
    scene, link = LINKS[name]()
    solution = evaluate(scene, wanted=[f"deflection:{link}"], backend="vm", certificate=False)
    exact = np.abs(solution.deflection(link).largest()[0])
    found = solution.array(f"deflection:{link}:across")
    assert exact.max() > 1e-6
    assert np.abs(found - exact).max() <= (1e-8 if name == "tapered" else 1e-9) * exact.max()


def test_what_is_not_wanted_is_not_derived():
    """``all`` is told from section forces; series are those that are named."""
    scene = slider()
    section, bent = (
        derive(scene, w).instructions["instant"]
        for w in (["section"], ["section", "deflection:rod"])
    )
    assert section < bent
    assert not [output for output in derive(scene, ["all"]).outputs if output.group == "deflection"]


def test_a_link_that_nothing_bends():
    """Its derivatives are nothing, and are numbers."""
    m = SpatialMechanism("turntable")
    d = m.parameter("d", 0.02, "m", low=0.0)
    m.set_gravity(0.0, 0.0, 0.0)
    arm = m.link("arm", length=0.5, beam=beams.Beam(beams.round_bar(d), STEEL))
    m.revolute("O", m.ground, arm, axis=(0, 0, 1))
    scene = Scene(
        m, {"O": polynomial(0.3, 20.0)}, wanted=["deflection:arm", "sensitivity:d"], t=(0, 0.1, 3)
    )
    solution = evaluate(scene, backend="vm", certificate=False)
    assert solution.array("deflection:arm:across").max() < 1e-18
    assert np.abs(solution.sensitivities.array("deflection:arm:across", "d")).max() < 1e-15


def test_sweeps_keep_its_peak_and_best_limits_it():
    """Between instants, against a fine cycle."""
    swept = sweep(slider(), {"h": [0.006, 0.01, 0.02]}, wanted=["deflection:rod"])
    fine = evaluate(
        slider(), parameters={"h": 0.006}, t=(0, ONE_CYCLE, 4097), backend="vm", certificate=False
    )
    peaks = swept["peak:deflection:rod:across"]
    assert peaks[0] == pytest.approx(abs(fine.deflection("rod").peak().value), rel=1e-6)
    (chosen,) = best(swept, minimise="h", where="peak:deflection:rod:across<=1e-4")
    assert 0 < chosen.number == np.flatnonzero(peaks <= 1e-4)[0]


@pytest.mark.long
def test_the_lightest_that_is_stiff_is_found():
    scene, limit = slider(), 5e-5
    found = optimise(
        scene,
        minimise="mass:rod",
        over={"h": (0.004, 0.04)},
        subject_to=[f"peak:deflection:rod:across <= {limit}"],
    )
    assert found.converged
    assert found.feasible
    solution = evaluate(
        scene,
        parameters=found.values,
        t=(0, ONE_CYCLE, 1025),
        wanted=["section:rod"],
        backend="vm",
        certificate=False,
    )
    assert abs(solution.deflection("rod").peak().value) == pytest.approx(limit, rel=1e-5)


@pytest.mark.long
def test_gradients_of_peaks_are_exact():
    """Against differences of peaks, at which the place along the link and the time move."""
    f = prepare(slider(), wanted=["deflection"])
    base = {"r": 0.1, "l": 0.4, "h": 0.014}
    slopes = f.gradient(base)
    for name in ("deflection:crank:across", "deflection:rod:across"):
        k = f.quantities.index(name)
        for parameter, value in base.items():
            step = 1e-5 * value
            ends = [
                f.peaks({**base, parameter: value + way * step}).value[k].copy() for way in (1, -1)
            ]
            assert slopes[name][parameter] == pytest.approx(
                (ends[0] - ends[1]) / (2 * step), rel=1e-6
            )


def test_files_and_peaks_between_instants(tmp_path):
    scene = slider()
    solution = evaluate(scene, wanted=["deflection:rod"], t=(0, ONE_CYCLE, 33), backend="vm")
    assert solution.certified
    save(solution, tmp_path / "a.h5")
    again = load(tmp_path / "a.h5")
    assert again.unit("deflection:rod:across") == "m"
    np.testing.assert_array_equal(
        again.array("deflection:rod:across"), solution.array("deflection:rod:across")
    )
    fine = evaluate(
        scene, wanted=["deflection:rod"], t=(0, ONE_CYCLE, 8193), backend="vm", certificate=False
    )
    (peak,) = (peak for peak in refine(scene, solution) if peak.name == "deflection:rod:across")
    assert peak.value == pytest.approx(fine.array("deflection:rod:across").max(), rel=1e-6)
    assert peak.value > 1.001 * solution.array("deflection:rod:across").max()


def test_what_cannot_be_told_is_one_line():
    with pytest.raises(
        DeclarationError,
        match=r"table: deflection:rod:across is not a polynomial of the rate; want section:rod",
    ):
        evaluate(slider(), wanted=["deflection:rod"], table=64)
    m = SpatialMechanism("odd")
    bars = {
        "paper": beams.Beam(beams.rectangle(0.02, 0.01), beams.Material("paper", 700.0)),
        "odd": beams.Beam(beams.polygon([(0, 0), (0.02, 0), (0, 0.03)]), STEEL),
    }
    for name, beam in bars.items():
        m.revolute(f"at_{name}", m.ground, m.link(name, length=1.0, beam=beam), axis=(0, 0, 1))
    scene = Scene(m, {f"at_{name}": polynomial(0.0) for name in bars}, t=(0, 0, 1))
    with pytest.raises(
        DeclarationError,
        match="output 'deflection:odd': there is no formula for torsion of a polygon; use",
    ):
        derive(scene, ["deflection:odd"])
    with pytest.raises(
        DeclarationError,
        match="material 'paper' has no elasticity and no shear_modulus, which output",
    ):
        derive(scene, ["deflection"])

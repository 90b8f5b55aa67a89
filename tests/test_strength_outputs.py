"""Stress and utilisation at every instant, against what is told of a whole solution; in files,
prepared scenes and optima.
"""

import numpy as np
import pytest
from strong import press, robot, slider

from lagrange_casadi import (
    Mechanism,
    Scene,
    beams,
    derive,
    evaluate,
    load,
    optimise,
    prepare,
    refine,
    save,
)
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import harmonic

I_SECTION = beams.i_section(0.04, 0.03, 0.004, 0.005)
LINKS = {
    "rectangle": lambda: (press(beams.rectangle(0.03, 0.012)), "rod"),
    "sliding": lambda: (press(I_SECTION, sliding=True), "rod"),
    "steps": lambda: (
        press(beams.stepped([0.4], [beams.round_bar(0.03), beams.round_bar(0.02)])),
        "rod",
    ),
    "tapered": lambda: (
        press(beams.tapered(I_SECTION, beams.i_section(0.03, 0.02, 0.003, 0.005))),
        "rod",
    ),
    "tube in space": lambda: (robot(beams.tube(0.04, 0.003)), "upper"),
    "C in space": lambda: (robot(beams.c_section(0.04, 0.03, 0.004, 0.005)), "upper"),
}


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", LINKS)
def test_series_are_the_largest_along_the_link(name):
    """Against all zeros of slopes along the link, by other code; a cross-section that changes is
    followed less closely.
    """
    scene, link = LINKS[name]()
    solution = evaluate(
        scene, wanted=[f"stress:{link}", f"safety:{link}"], backend="vm", certificate=False
    )
    exact, safety = np.abs(solution.stress(link).largest("von_mises").value), solution.safety(link)
    found = solution.array(f"stress:{link}:von_mises")
    assert np.all(found <= exact * (1.0 + 1e-12))
    assert np.abs(found - exact).max() <= (1e-5 if name in ("tapered",) else 1e-10) * exact.max()
    used = {way: solution.array(f"utilisation:{link}:{way}").max() for way in ("yield", "buckling")}
    assert 1.0 / used["yield"] == pytest.approx(safety.against("yield"), rel=1e-9)
    assert 1.0 / used["buckling"] == pytest.approx(safety.against("buckling"), rel=1e-8)


def test_corners_of_a_polygon_may_be_parameters():
    m = Mechanism("swing")
    h = m.parameter("h", 0.03, "m")
    shape = beams.polygon([(0.0, 0.0), (h, 0.005), (1.1 * h, 0.03), (0.01, 0.02)])
    arm = m.link("arm", length=0.5, beam=beams.Beam(shape, beams.material("C45+QT")))
    m.revolute("O", m.ground, arm)
    scene = Scene(m, motion={"O": harmonic(0.1, 0.5, 0.5)}, t=(0.0, 2.0, 21))
    wanted = ["stress:arm", "section:arm"]
    solution = evaluate(
        scene, parameters={"h": 0.04}, wanted=wanted, backend="vm", certificate=False
    )
    exact = solution.stress("arm").largest("von_mises").value
    np.testing.assert_allclose(solution.array("stress:arm:von_mises"), exact, rtol=1e-10)


def test_what_is_not_wanted_is_not_derived():
    """``all`` is told from section forces; series are those that are named."""
    scene = slider(200e6)
    wants = (["section"], ["life", "section"], ["stress:rod", "section"])
    sections, life, stress = (derive(scene, wanted).instructions["instant"] for wanted in wants)
    assert sections == life < stress
    assert not [
        output
        for output in derive(scene, ["all"]).outputs
        if output.group in ("stress", "utilisation")
    ]


@pytest.mark.long
def test_gradients_of_peaks_of_stress_and_utilisation_are_exact():
    """Against differences of peaks, at which the place along the link and the time move."""
    f = prepare(slider(), wanted=["stress", "safety"])
    base = {"r": 0.1, "l": 0.4, "h": 0.014}
    slopes = f.gradient(base)
    for name in (
        "stress:crank:von_mises",
        "stress:rod:von_mises",
        "utilisation:rod:yield",
        "utilisation:rod:buckling",
    ):
        k = f.quantities.index(name)
        for parameter, value in base.items():
            step = 1e-5 * value
            ends = [
                f.peaks({**base, parameter: value + way * step}).value[k].copy() for way in (1, -1)
            ]
            size = abs(slopes[name][parameter]) + 1e-3 * abs(slopes.value[k]) / value
            assert abs(slopes[name][parameter] - (ends[0] - ends[1]) / (2 * step)) <= 1e-5 * size


def test_the_lightest_that_is_safe_is_found():
    scene = slider()
    limits = ["least:safety:rod >= 2", "least:safety:crank>=2"]
    found = optimise(
        scene,
        minimise="mass:all",
        over={"h": (0.004, 0.04)},
        subject_to=limits,
        starts=2,
        screen=16,
    )
    assert found.converged
    assert found.feasible
    assert found.unit == "kg"
    h = found.values["h"]
    assert found.objective == pytest.approx(15.0 + 7850.0 * 0.012 * h * 0.5)
    solution = evaluate(
        scene, parameters={"h": h}, t=(0, 0.2094395, 1001), wanted=["safety"], certificate=False
    )
    assert min(solution.safety(link).factor for link in ("crank", "rod")) == pytest.approx(
        2.0, rel=1e-4
    )


@pytest.mark.parametrize(
    ("limit", "told"),
    [
        ("least:yield:rod <= 2", "as least:safety:rod >= 2"),
        ("least:yield:rod >= -1", "as least:safety:rod >= 2"),
        ("least:yield:ram >= 2", "safety:ram"),
    ],
)
def test_limits_on_safety_that_cannot_be_held(limit, told):
    with pytest.raises(DeclarationError, match=told):
        optimise(slider(200e6), minimise="mass:all", over={"h": (0.004, 0.04)}, subject_to=[limit])


def test_a_mass_of_what_is_not_there():
    with pytest.raises(UnknownNameError, match="part with a mass 'cranck'"):
        optimise(slider(), minimise="mass:cranck", over={"h": (0.004, 0.04)})


def test_files_keep_what_was_wanted(tmp_path):
    scene = slider(200e6)
    solution = evaluate(scene, wanted=["stress:rod", "safety:rod", "life:rod"])
    save(solution, tmp_path / "a.h5")
    again = load(tmp_path / "a.h5")
    for name in ("stress:rod:von_mises", "utilisation:rod:yield", "utilisation:rod:buckling"):
        assert again.unit(name) == ("Pa" if name.startswith("stress") else "1")
        np.testing.assert_array_equal(again.array(name), solution.array(name))
    assert again.life("rod") == solution.life("rod")


def test_no_table_holds_what_is_largest_along_a_link():
    with pytest.raises(
        DeclarationError,
        match=r"table: stress:rod:von_mises is not a polynomial of the rate; want section:rod",
    ):
        evaluate(slider(), wanted=["stress:rod"], table=64)


def test_peaks_between_instants_are_sought():
    """A coarse cycle refined, against a fine one."""
    scene = slider()
    coarse, fine = (
        evaluate(scene, t=(0, 0.2094395, n), wanted=["stress:rod"], backend="vm", certificate=False)
        for n in (33, 8193)
    )
    (peak,) = (peak for peak in refine(scene, coarse) if peak.name == "stress:rod:von_mises")
    assert peak.value == pytest.approx(fine.array("stress:rod:von_mises").max(), rel=1e-7)
    assert peak.value > coarse.array("stress:rod:von_mises").max()

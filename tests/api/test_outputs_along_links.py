"""Stress, utilisation and deflection at every instant, against what is told of a whole solution; in
files, prepared scenes, sweeps and optima.
"""

import numpy as np
import pytest
from strong import STEEL, press, robot, slider

from lagrange_casadi import (
    Mechanism,
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
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import harmonic, polynomial

ONE_CYCLE = 0.2094395
I_SECTION = beams.i_section(0.04, 0.03, 0.004, 0.005)
LINKS = {
    "held at its drive": lambda: (slider(), "crank"),
    "rectangle": lambda: (press(beams.rectangle(0.03, 0.012)), "rod"),
    "sliding": lambda: (press(I_SECTION, sliding=True), "rod"),
    "steps": lambda: (
        press(beams.stepped([0.4], [beams.round_bar(0.03), beams.round_bar(0.02)])),
        "rod",
    ),
    "tapered I": lambda: (
        press(beams.tapered(I_SECTION, beams.i_section(0.03, 0.02, 0.003, 0.005))),
        "rod",
    ),
    "tapered rectangle": lambda: (
        press(beams.tapered(beams.rectangle(0.06, 0.02), beams.rectangle(0.02, 0.03))),
        "rod",
    ),
    "tube in space": lambda: (robot(beams.tube(0.04, 0.003)), "upper"),
    "C in space": lambda: (robot(beams.c_section(0.04, 0.03, 0.004, 0.005)), "upper"),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", LINKS)
def test_series_are_the_largest_along_the_link(name):
    """Against all zeros of slopes along the link and its elastic curve, by other code; a
    cross-section that changes is followed less closely.
    """
    scene, link = LINKS[name]()
    wanted = [f"stress:{link}", f"safety:{link}", f"deflection:{link}"]
    solution = evaluate(scene, wanted=wanted, backend="vm", certificate=False)
    exact, safety = np.abs(solution.stress(link).largest("von_mises").value), solution.safety(link)
    found = solution.array(f"stress:{link}:von_mises")
    tapered = name.startswith("tapered")
    assert np.all(found <= exact * (1.0 + 1e-12))
    assert np.abs(found - exact).max() <= (1e-5 if tapered else 1e-10) * exact.max()
    used = {way: solution.array(f"utilisation:{link}:{way}").max() for way in ("yield", "buckling")}
    for way, accuracy in (("yield", 1e-9), ("buckling", 1e-8)):
        assert used[way] == pytest.approx(1.0 / safety.against(way), rel=accuracy)
    exact = np.abs(solution.deflection(link).largest()[0])
    found = solution.array(f"deflection:{link}:across")
    assert exact.max() > 1e-6
    assert np.abs(found - exact).max() <= (1e-8 if tapered else 1e-9) * exact.max()


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
    wants = ([], ["life"], ["stress:rod"], ["deflection:rod"])
    sections, life, stress, bent = (
        derive(scene, [*wanted, "section"]).instructions["instant"] for wanted in wants
    )
    assert sections == life < min(stress, bent)
    groups = {output.group for output in derive(scene, ["all"]).outputs}
    assert not groups & {"stress", "utilisation", "deflection"}


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


@pytest.mark.long
@pytest.mark.parametrize(
    ("names", "accuracy", "least"),
    [
        (
            [
                *("stress:crank:von_mises", "stress:rod:von_mises"),
                *("utilisation:rod:yield", "utilisation:rod:buckling"),
            ],
            1e-5,
            1e-3,
        ),
        (["deflection:crank:across", "deflection:rod:across"], 1e-6, 0.0),
    ],
    ids=["strength", "deflection"],
)
def test_gradients_of_peaks_are_exact(names, accuracy, least):
    """Against differences of peaks, at which the place along the link and the time move."""
    f = prepare(slider(), wanted=["stress", "safety", "deflection"])
    base = {"r": 0.1, "l": 0.4, "h": 0.014}
    slopes = f.gradient(base)
    for name in names:
        k = f.quantities.index(name)
        for parameter, value in base.items():
            step = 1e-5 * value
            ends = [
                f.peaks({**base, parameter: value + way * step}).value[k].copy() for way in (1, -1)
            ]
            size = abs(slopes[name][parameter]) + least * abs(slopes.value[k]) / value
            difference = (ends[0] - ends[1]) / (2 * step)
            assert abs(slopes[name][parameter] - difference) <= accuracy * size


def test_the_lightest_that_is_safe_is_found():
    scene = slider()
    limits = ["least:safety:rod >= 2", "least:safety:crank>=2"]
    found = optimise(
        scene,
        minimise="mass:all",
        over={"h": (0.004, 0.04)},
        subject_to=limits,
        starts=1,
        screen=4,
    )
    assert found.converged
    assert found.feasible
    assert found.unit == "kg"
    h = found.values["h"]
    assert found.objective == pytest.approx(15.0 + 7850.0 * 0.012 * h * 0.5)
    solution = evaluate(
        scene,
        parameters={"h": h},
        t=(0, ONE_CYCLE, 1001),
        wanted=["safety"],
        backend="vm",
        certificate=False,
    )
    assert min(solution.safety(link).factor for link in ("crank", "rod")) == pytest.approx(
        2.0, rel=1e-4
    )


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


def test_sweeps_keep_the_peak_of_a_deflection_and_best_limits_it():
    """Between instants, against a fine cycle."""
    grid = {"h": [0.006, 0.01, 0.02]}
    swept = sweep(slider(), grid, wanted=["deflection:rod"], backend="vm")
    fine = evaluate(
        slider(), parameters={"h": 0.006}, t=(0, ONE_CYCLE, 4097), backend="vm", certificate=False
    )
    peaks = swept["peak:deflection:rod:across"]
    assert peaks[0] == pytest.approx(abs(fine.deflection("rod").peak().value), rel=1e-6)
    (chosen,) = best(swept, minimise="h", where="peak:deflection:rod:across<=1e-4")
    assert 0 < chosen.number == np.flatnonzero(peaks <= 1e-4)[0]


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


def test_files_keep_what_was_wanted_and_peaks_are_sought_between_instants(tmp_path):
    """A coarse cycle refined, against a fine one."""
    scene = slider(200e6)
    wanted = ["stress:rod", "safety:rod", "life:rod", "deflection:rod"]
    coarse = evaluate(scene, t=(0, ONE_CYCLE, 33), wanted=wanted, backend="vm")
    assert coarse.certified
    save(coarse, tmp_path / "a.h5")
    again = load(tmp_path / "a.h5")
    units = {
        "stress:rod:von_mises": "Pa",
        "utilisation:rod:yield": "1",
        "utilisation:rod:buckling": "1",
        "deflection:rod:across": "m",
    }
    for name, unit in units.items():
        assert again.unit(name) == unit
        np.testing.assert_array_equal(again.array(name), coarse.array(name))
    assert again.life("rod") == coarse.life("rod")
    fine = evaluate(
        scene,
        t=(0, ONE_CYCLE, 8193),
        wanted=["stress:rod", "deflection:rod"],
        backend="vm",
        certificate=False,
    )
    peaks = {peak.name: peak.value for peak in refine(scene, coarse)}
    for name, accuracy in (("stress:rod:von_mises", 1e-7), ("deflection:rod:across", 1e-6)):
        assert peaks[name] == pytest.approx(fine.array(name).max(), rel=accuracy)
        assert peaks[name] > coarse.array(name).max()


def test_what_cannot_be_told_is_one_line():
    for wanted, series in (("stress", "von_mises"), ("deflection", "across")):
        told = rf"table: {wanted}:rod:{series} is not a polynomial of the rate; want section:rod"
        with pytest.raises(DeclarationError, match=told):
            evaluate(slider(), wanted=[f"{wanted}:rod"], table=64)
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

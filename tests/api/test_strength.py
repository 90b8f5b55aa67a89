"""Strength: factors of safety and lives beside sums worked out by hand, between instants, as series
and peaks of outputs, in sweeps, as limits of searches, on the command line and in pictures.
"""

import math
import re

import numpy as np
import pytest
from commands import command
from strong import STEEL, press, robot, slider

from lagrange_casadi import (
    Mechanism,
    Scene,
    beams,
    best,
    evaluate,
    figures,
    load,
    optimise,
    refine,
    save,
    sweep,
)
from lagrange_casadi.errors import DeclarationError, NoDesignError
from lagrange_casadi.motion import harmonic, polynomial
from lagrange_casadi.peaks import refine_safety

BAR = beams.rectangle(0.012, 0.006)
NOTCH = beams.Notch(0.3, axial=2.0, bending=1.8, sensitivity=0.8)
ONE_CYCLE = 0.2094395
QUIET = {"backend": "vm", "certificate": False}


def test_a_notch_counts_in_fatigue_by_its_sensitivity():
    """K_f = 1 + q (K_t - 1): as a notch of this factor would that counts in full."""
    notches = [NOTCH], [beams.Notch(0.3, axial=1.8, bending=1.64)], []
    one, other, plain = (
        evaluate(press(BAR, notch), **QUIET).safety("rod").against("fatigue") for notch in notches
    )
    assert one == pytest.approx(other, rel=1e-12)
    assert one < 0.99 * plain


I_SECTION = beams.i_section(0.04, 0.03, 0.004, 0.005)


def stub():
    """A short bar with thin flanges, where shear counts as much as bending does."""
    m = Mechanism("stub")
    shape = beams.i_section(0.04, 0.03, 0.008, 0.001)
    bar = m.link("bar", length=0.02, beam=beams.Beam(shape, STEEL))
    m.revolute("O", m.ground, bar)
    m.force("load", bar.tip, y=4e3)
    return Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0, 1, 11)), "bar"


LINKS = {
    "short": stub,
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
        press(
            beams.along(
                [0.0, 0.4, 1.0],
                [
                    beams.rectangle(0.06, 0.02),
                    beams.rectangle(0.03, 0.02),
                    beams.rectangle(0.012, 0.01),
                ],
            )
        ),
        "rod",
    ),
    "tube in space": lambda: (robot(beams.tube(0.04, 0.003)), "upper"),
    "C in space": lambda: (robot(beams.c_section(0.04, 0.03, 0.004, 0.005)), "upper"),
}


@pytest.mark.sampled(4)
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


def test_lives_and_masses_of_designs_and_the_lightest_that_is_safe():
    scene, grid = slider(5e6), {"l": [0.3, 0.4], "h": [0.006, 0.05]}
    swept = sweep(scene, grid, wanted=["safety", "life:crank"])
    worn = evaluate(scene, parameters={"h": 0.006}, wanted=["life:crank"], **QUIET).life("crank")
    assert swept["life:crank"][1, 0] == pytest.approx(worn.cycles, rel=1e-9)
    assert worn.cycles < math.inf
    l, h = swept["l"][:, None], swept["h"][None]
    np.testing.assert_allclose(swept["mass:rod"], 7850.0 * 0.012 * h * l)
    np.testing.assert_allclose(swept["mass:all"], 15.0 + 7850.0 * 0.012 * h * (l + 0.1))
    safe = swept["least:yield:crank"] >= 20.0
    assert 0 < safe.sum() < 4
    (chosen,) = best(swept, minimise="mass:all", where="least:yield:crank>=20")
    assert chosen.number == np.where(safe, swept["mass:all"], np.inf).argmin()


def test_fatigue_along_a_taper_has_the_same_bits_whatever_other_designs():
    scene, heights = slider(200e6, tip=0.01), [0.012, 0.02, 0.05, 0.09]
    together, *each = (
        sweep(scene, {"h": some}, wanted=["safety:rod"])["least:fatigue:rod"]
        for some in (heights, *([height] for height in heights))
    )
    np.testing.assert_array_equal(together, np.concatenate(each))


def test_files_keep_what_was_wanted_and_peaks_are_sought_between_instants(tmp_path):
    """A coarse cycle refined, against a fine one."""
    scene, wanted = slider(200e6), ["stress:rod", "safety:rod", "life:rod", "deflection:rod"]
    coarse = evaluate(scene, t=(0, ONE_CYCLE, 33), wanted=wanted, backend="vm")
    assert coarse.certified
    save(coarse, tmp_path / "a.h5")
    again = load(tmp_path / "a.h5")
    units = {"stress:rod:von_mises": "Pa", "utilisation:rod:yield": "1"}
    for name, unit in (units | {"deflection:rod:across": "m"}).items():
        assert again.unit(name) == unit
        np.testing.assert_array_equal(again.array(name), coarse.array(name))
    assert again.life("rod") == coarse.life("rod")
    fine = evaluate(scene, t=(0, ONE_CYCLE, 8193), wanted=wanted[::3], **QUIET)
    peaks = {peak.name: peak.value for peak in refine(scene, coarse)}
    for name, accuracy in (("stress:rod:von_mises", 1e-7), ("deflection:rod:across", 1e-6)):
        assert peaks[name] == pytest.approx(fine.array(name).max(), rel=accuracy)
        assert peaks[name] > coarse.array(name).max()


@pytest.mark.parametrize(
    "name",
    ["rod", *(pytest.param(x, marks=pytest.mark.long) for x in ("sliding", "notched", "space"))],
)
def test_least_factors_of_designs_are_those_of_a_solution(name):
    """Loads that travel are looked at one by one; in space most fibres are sheared."""
    notches, span = [beams.Notch(0.6, bending=2.5, sensitivity=0.8)], (0, ONE_CYCLE, 41)
    scene, link = {
        "rod": lambda: (slider(200e6), "rod"),
        "sliding": lambda: (press(beams.rectangle(0.03, 0.012), sliding=True, t=span), "rod"),
        "notched": lambda: (press(I_SECTION, notches, t=span), "rod"),
        "space": lambda: (robot(beams.rectangle(0.03, 0.02)), "upper"),
    }[name]()
    (parameter, value), *_ = scene.mechanism.values().items()
    swept = sweep(scene, {parameter: [value, 1.1 * value]}, wanted=[f"safety:{link}"])
    for x in swept[parameter]:
        found = swept.select(**{parameter: x})
        asked = {"parameters": {parameter: x}, "wanted": [f"section:{link}"]}
        safety = refine_safety(scene, evaluate(scene, **asked, **QUIET), link)
        least = {way: found[f"least:{way}:{link}"].item() for way in ("safety", *WAYS)}
        assert least["safety"] == min(least.values())
        for way, accuracy in WAYS.items():
            assert least[way] == pytest.approx(safety.against(way), rel=accuracy)


WAYS = {"yield": 1e-9, "fatigue": 1e-9, "buckling": 1e-3}


def test_strength_that_is_open_has_no_number(tmp_path):
    """Of bars side by side equilibrium leaves the axial forces open, as evaluations say; one that
    nothing holds is told.
    """
    m = Mechanism("bars")
    beam = beams.Beam(beams.rectangle(0.02, 0.01), STEEL.but(endurance=200e6))
    bar = m.link("bar", length=m.parameter("l", 1.0, "m"), mass=1.0)
    for k, x in enumerate((0.0, 0.5, 0.9)):
        leg = m.link(f"a{k}", length=0.2, beam=beam)
        m.revolute(f"G{k}", m.ground.at(x, 0.0), leg)
        m.revolute(f"B{k}", leg.tip, bar.at(x))
    m.weld("held", bar.tip, m.link("arm", length=0.3, beam=beam))
    posture = {"a0": 1.2, "a1": 1.2, "a2": 1.2, "bar": 0.0, "arm": 0.0}
    wanted = ["safety:a0", "life:a1", "section:arm"]
    scene = Scene(m, {"G0": harmonic(1.2, 0.3, 1.0)}, wanted, t=(0, 1, 5), posture=posture)
    says = "equilibrium does not determine axial, so its strength is not evaluated"
    with pytest.raises(DeclarationError, match=says):
        evaluate(scene, **QUIET).safety("a0")
    found = sweep(scene, {"l": [1.0, 1.1]}, out=tmp_path / "bars.h5")
    assert command("check", tmp_path / "bars.h5") == 0
    for name in ("least:safety:a0", "least:yield:a0", "least:fatigue:a0", "life:a1"):
        assert np.isnan(found[name]).all(), name
    assert np.isfinite(found["peak:section:arm:bending"]).all()
    with pytest.raises(NoDesignError, match="section:a0:axial is indeterminate for all of them"):
        optimise(scene, minimise="peak:utilisation:a0:fatigue", over={"l": (0.95, 1.1)}, screen=4)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("names", ["", "endurance", "ultimate", "endurance ultimate"])
def test_fatigue_is_open_alike_in_solutions_and_sweeps(names):
    """It is left out by name where the material lacks a number, and the other factors stay."""
    lacking = names.split()
    material = STEEL.but(**dict.fromkeys(lacking))
    scene = press(beams.rectangle(0.03, 0.012), material=material, t=(0, 0.2, 5))
    safety = evaluate(scene, **QUIET).safety("rod")
    found = sweep(scene, {"r": [0.1]}, wanted=["safety:rod"])
    why = f"material 'C45+QT' has no {' and no '.join(lacking)}"
    assert safety.not_evaluated == ((f"fatigue: {why}",) if lacking else ())
    ways = {verdict.against for verdict in safety.verdicts}
    assert ways == {way for way in WAYS if f"least:{way}:rod" in found.columns}
    assert ways == {*WAYS} - ({"fatigue"} if lacking else set())
    if lacking:
        limit = {"over": {"r": (0.05, 0.1)}, "subject_to": ["least:fatigue:rod >= 2"]}
        with pytest.raises(DeclarationError, match=re.escape(why)):
            optimise(scene, minimise="r", **limit)
        with pytest.raises(DeclarationError, match=r"no .*, which output 'life:rod' needs"):
            sweep(scene, {"r": [0.1]}, wanted=["life:rod"])


def test_the_lightest_that_does_not_tire_and_is_stiff_is_found():
    """What limits it is used up, by the code that judges one solution, and what a limit costs is
    the slope of the mass over that of the use.
    """
    scene, asked = slider(80e6), {"minimise": "mass:all", "over": {"h": (0.004, 0.04)}}
    asked |= {"starts": 1, "screen": 4}

    def used(h):
        found = evaluate(scene, parameters={"h": h}, wanted=["section:crank"], **QUIET)
        return 1.0 / found.safety("crank").against("fatigue")

    found = optimise(scene, **asked, subject_to=["least:fatigue:crank >= 2"])
    (limit,), h = found.limits, found.values["h"]
    assert (found.converged, found.feasible, limit.active) == (True, True, True)
    # The worst place is the base of the crank, at which a solution and a search look alike.
    assert used(h) == pytest.approx(0.5, rel=1e-7)
    slope = (used(h * 1.001) - used(h * 0.999)) / (0.002 * h)
    assert limit.multiplier == pytest.approx(-7850.0 * 0.012 * 0.5 / slope, rel=1e-3)
    found = optimise(scene, **asked, subject_to=["peak:deflection:rod:across <= 5e-5"])
    fine = evaluate(scene, parameters=found.values, t=(0, ONE_CYCLE, 1025), **QUIET)
    assert abs(fine.deflection("rod").peak().value) == pytest.approx(5e-5, rel=1e-4)


def test_pictures_show_what_is_told():
    """The map of stress, Haigh's diagram with its notches, and bars."""
    notch = beams.Notch(0.5, axial=3.0, bending=3.0)
    solution = evaluate(press(BAR, [notch], t=(0, 0.2, 21)), xi=(0, 1, 21), **QUIET)
    specs = [
        figures.StrengthPlot("strength_rod", "rod"),
        figures.UtilisationPlot("utilisation", ("rod",)),
        figures.DeflectionPlot("deflection", "rod"),
    ]
    assert {spec.name for spec in specs[:2]} <= {
        one.name for one in figures.default_figures(solution)
    }
    strength, bars, bent = (spec.draw(solution) for spec in specs)
    peak = solution.deflection("rod").peak().value
    assert f"largest: {1e3 * peak:.4g} mm" in bent.axes[0].get_title().replace("\u2212", "-")
    mapped, diagram = strength.axes[:2]
    shown = np.ravel(mapped.collections[0].get_array())
    grid = solution.stress("rod").grid("von_mises").T.ravel() / 1e6
    np.testing.assert_allclose(shown, grid)
    line = {one.get_label(): one.get_xydata() for one in diagram.get_lines()}
    assert line["Goodman"].tolist() == [[0.0, 350.0], [700.0, 0.0]]
    worst, safety = (line["in notches"] @ [1 / 700, 1 / 350]).max(), solution.safety("rod")
    assert worst == pytest.approx(1 / safety.against("fatigue"), rel=1e-12)
    widths = [bar.get_width() for bar in bars.axes[0].patches]
    assert widths == [1 / verdict.factor for verdict in safety.verdicts]

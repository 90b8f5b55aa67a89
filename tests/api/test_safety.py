"""Factors of safety and lives: against sums worked out beside them, in Python and on the command
line.
"""

import math

import numpy as np
import pytest
import strong
from internals import cycles, factor, outputs
from places import FOLDERS

from lagrange_casadi import beams, evaluate, export, prepare
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.usefixtures("interpreted")

BAR = beams.rectangle(0.012, 0.006)
NOTCH = beams.Notch(0.3, axial=2.0, bending=1.8, sensitivity=0.8)


@pytest.fixture(scope="module")
def scene():
    return strong.press(BAR, [NOTCH])


@pytest.fixture(scope="module")
def pressed(scene):
    return evaluate(scene, certificate=False)


def test_yield_is_the_strength_over_the_largest_stress(pressed):
    found = pressed.safety("rod")
    assert found.against("yield") == pytest.approx(
        490e6 / pressed.stress("rod").peak("von_mises").value
    )
    assert pressed.safety("rod", yield_criterion="tresca").against("yield") == pytest.approx(
        490e6 / pressed.stress("rod").peak("tresca").value
    )


def test_fatigue_by_hand_along_the_edges(pressed):
    """At the corners there is no shear: largest and smallest stress over time at each ratio, the
    notch's beside, then Goodman.
    """
    law, grid = pressed.section("rod").law, np.linspace(0.0, 1.0, 4001)
    worst = np.inf
    for places, k_n, k_m in ((grid, 1.0, 1.0), (np.array([0.3]), 1.8, 1.64)):
        u = np.broadcast_to(places, (pressed.t.size, places.size))
        for side, sign in ((s, e) for s in ("base", "tip") for e in (-1, 1)):
            n, m = (law.at(force, u, side) for force in ("axial", "bending"))
            stress = k_n * n / (0.012 * 0.006) + sign * k_m * m / (0.006 * 0.012**2 / 6)
            high, low = stress.max(axis=0), stress.min(axis=0)
            worst = min(worst, factor((high - low) / 2, (high + low) / 2, strong.STEEL).min())
    assert pressed.safety("rod").against("fatigue") == pytest.approx(worst, rel=2e-5)


def test_buckling_by_hand(pressed):
    found = pressed.safety("rod")
    law = pressed.section("rod").law
    compression, moment = -law.reached("axial")[1][0], np.abs(law.extreme("bending")[1])
    euler = math.pi**2 * 210e9 * (0.006 * 0.012**3 / 12) / 0.4**2
    weak = math.pi**2 * 210e9 * (0.012 * 0.006**3 / 12) / 0.2**2
    factors = []
    for n, m in zip(compression, moment, strict=True):
        if n > 0:
            a, b, e = n / min(euler, weak), m / (490e6 * 0.006 * 0.012**2 / 6), n / euler
            # Euler's load in the plane bends, the lower of both is the column's.
            factors.append(2 / ((a + b + e) + math.sqrt((a + b + e) ** 2 - 4 * a * e)))
    assert found.against("buckling") == pytest.approx(min(factors), rel=1e-9)
    assert found.governs.factor == found.factor == min(v.factor for v in found.verdicts)
    assert found.utilisation == 1 / found.factor


def test_life_by_hand():
    """A rod that breaks in time: one swing a turn at the worst edge, its life by the S-N line;
    hours by the span of time.
    """
    rough = strong.STEEL.but(endurance=30e6)
    scene = strong.press(beams.rectangle(0.012, 0.004), material=rough)
    solution = evaluate(scene, certificate=False)
    found = solution.life("rod")
    assert 1e3 < found.cycles < 1e6
    assert found.hours == pytest.approx(found.cycles * 0.2094395 / 3600)
    assert found.damage == pytest.approx(1 / found.cycles)
    values = solution.stress("rod").at(found.xi)
    k = solution.stress("rod").fibres(found.xi).index(found.fibre)
    high, low = values[0, k].max(), values[0, k].min()
    amplitude, mean = (high - low) / 2, max((high + low) / 2, 0.0)
    assert found.cycles <= cycles(amplitude / (1 - mean / 700e6), rough) * (1 + 1e-9)
    assert found.cycles == pytest.approx(
        float(cycles(amplitude / (1 - mean / 700e6), rough)), rel=0.2
    )


def test_a_stout_rod_lasts():
    found = evaluate(strong.press(beams.round_bar(0.04)), certificate=False).life("rod")
    assert (found.damage, found.cycles, found.hours) == (0.0, math.inf, math.inf)


def test_a_material_without_an_endurance_limit_leaves_fatigue_open():
    solution = evaluate(
        strong.press(BAR, material=beams.material("EN AW-6082-T6")), certificate=False
    )
    found = solution.safety("rod")
    assert found.not_evaluated == ("fatigue: material 'EN AW-6082-T6' has no endurance",)
    assert math.isnan(found.against("fatigue"))
    with pytest.raises(DeclarationError, match="has no endurance, which a life needs"):
        solution.life("rod")


def test_strength_is_wanted_as_other_outputs_are(scene):
    names = outputs(scene.mechanism)
    assert [n for n in names if n.endswith(":rod")][-4:] == [
        "stress:rod",
        "safety:rod",
        "life:rod",
        "deflection:rod",
    ]
    solution = evaluate(scene, wanted=["safety:rod"], certificate=False)
    assert solution.links_with_sections == ("rod",)
    assert not any(name.startswith(("effort", "reaction")) for name in solution.series)
    assert evaluate(scene, wanted=["life"], certificate=False).links_with_sections == ("rod",)
    with pytest.raises(
        DeclarationError,
        match=r"output 'stress:crank': link 'crank' has no beam.* links with a beam: rod",
    ):
        evaluate(scene, wanted=["stress:crank"])
    for call in (
        lambda: prepare(scene, wanted=["life"]),
        lambda: export(scene, "x", wanted=["life:rod"]),
    ):
        with pytest.raises(DeclarationError, match="have instants, but a life needs a whole cycle"):
            call()


CASE = """
import sys
sys.path[:0] = {folders!r}
import strong
from lagrange_casadi import beams
def scene():
    return strong.press(beams.rectangle(0.012, {width}), [beams.Notch(0.3, bending=1.8)])
"""


def written(here, width):
    (here / "case.py").write_text(CASE.format(folders=FOLDERS, width=width))
    return ["run", "case.py", "--no-figures", "--no-certificate", "--backend", "vm"]


def test_run_tells_what_governs(here, capsys):
    assert (
        main([*written(here, 0.006), "--want", "stress:rod,safety:rod", "--want", "life:rod"]) == 0
    )
    out = capsys.readouterr().out
    found = evaluate(strong.press(BAR, [beams.Notch(0.3, bending=1.8)]), certificate=False)
    safety, peak = found.safety("rod"), found.stress("rod").peak("von_mises")
    assert (
        f"  stress:rod:von_mises        {peak.value / 1e6:>13.6g} MPa  at t = {peak.t:.5g} s, xi/l"
        " ="
        f" {round(peak.xi, 4):g}" in out
    )
    assert f"{safety.utilisation:>8.4g} |" in out
    assert f"| {safety.governs.against} governs" in out
    for verdict in safety.verdicts:
        assert f"    {verdict.against:<18} {verdict.factor:>8.4g} " in out
    assert "lives, 0.20944 s repeated:\n  life:rod " in out


def test_run_says_that_a_part_fails(here, capsys):
    assert main([*written(here, 0.0005), "--want", "safety,life"]) == 0
    out = capsys.readouterr().out
    assert " governs, FAILS\n" in out
    assert "stresses" not in out
    assert "an estimate: the S-N line begins at 1000 cycles" in out

"""What moves along a link and stays at its tip, or at its base, misses that by rounding: sections
must not see it by chance.
"""

import numpy as np
import pytest
from exported import by_c99, compare, expected, exported, instants, solve
from internals import FORCES, DesignEngine, EvaluationMethod

from lagrange_casadi import Mechanism, Scene, evaluate, refine, sweep
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

LENGTH = 0.37
PIVOT = (0.3, 0.05)
SHIFT = {"vm": 1e-12, "c": 1e-12, "lanes": 1e-12, "single": 2e-5}


def rail(end):
    """A crank moves a pin in the slot of a rail; an arm beside the rail holds the pin at the rail's
    tip, or at its base.
    """
    m = Mechanism("rail")
    l = m.parameter("l", LENGTH, "m")
    crank, coupler = m.link("crank", length=0.1, mass=0.3), m.link("coupler", length=0.35, mass=0.5)
    arm, bar = m.link("arm", length=l, mass=0.0), m.link("bar", length=l, mass=0.7)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("C", m.ground.at(*PIVOT), arm)
    m.revolute("B", arm.tip, coupler.tip)
    m.revolute("R", m.ground.at(*PIVOT), bar if end == "tip" else bar.tip)
    m.slot("S", bar, coupler.tip, axis=(1, 0))
    at = 1.0 if end == "tip" else 0.0
    m.output("felt", m.results.section(bar, at).shear, unit="N")
    lean = 1.5 if end == "tip" else 1.5 - np.pi
    return Scene(
        m,
        {"O": polynomial(0.3, 5.0)},
        t=(0, 1.2, 13),
        posture={"arm": 1.5, "bar": lean},
        xi=(0, 1, 5),
    ), at


@pytest.mark.sampled(4)
@pytest.mark.parametrize("end", ["tip", "base"])
@pytest.mark.parametrize("way", SHIFT)
def test_sections_see_it_at_the_tip_and_never_at_the_base(way, end):
    """The section at either end bears what the pin does to the bar: nothing else is between."""
    scene, at = rail(end)
    method = {"precision": "single"} if way == "single" else {"backend": way}
    solution = evaluate(scene, **method)
    off = solution.series["section:bar:S:station"] - at
    assert 0.0 < np.abs(off).max() < (1e-6 if way == "single" else 1e-14)
    assert solution.certified
    angle, slot = solution.pose("bar").angle, solution.reaction("S")
    pushed = -(slot.fy * np.cos(angle) - slot.fx * np.sin(angle))  # on the bar, along its n
    borne = pushed if end == "tip" else -pushed
    within = SHIFT[way] * np.abs(pushed).max()
    column = -1 if end == "tip" else 0
    law = solution.section("bar").law
    for side in ("tip", "base"):
        assert np.abs(law.at("shear", np.full((13, 1), at), side)[:, 0] - borne).max() < within
    assert np.abs(solution.section("bar").shear[:, column] - borne).max() < within
    assert np.abs(solution.section("bar").bending[:, column]).max() < within
    assert np.abs(solution.output("felt") - borne).max() < within
    # No place along it sees more than its ends and what lies between them.
    fine = np.abs(law.on_grid("shear", np.linspace(0, 1, 2001))).max(axis=1)
    _, most = law.extreme("shear")
    assert np.abs(np.abs(most) - fine).max() < 1e-3 * fine.max()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("end", ["tip", "base"])
def test_sweeps_have_the_refined_peaks(end):
    scene, _ = rail(end)
    solution = evaluate(scene)
    names = [f"section:bar:{force}" for force in FORCES]
    refined = {peak.name: peak.value for peak in refine(scene, solution, names)}
    for way in ("c", "lanes"):
        designs = DesignEngine.of(scene, method=EvaluationMethod(way))
        outcome = designs.evaluate(np.array([[LENGTH]]))
        found = dict(zip(map(str, designs.quantities), outcome.value[0], strict=True))
        for name, value in refined.items():
            assert abs(found[name] - value) < 1e-11 * abs(value), (way, name)


@pytest.mark.parametrize("end", ["tip", "base"])
def test_sections_that_sweeps_keep_see_it_in_single_precision_too(end):
    scene, at = rail(end)
    kept = sweep(
        scene,
        {"l": [LENGTH]},
        wanted=["section:bar"],
        precision="single",
        xi=(0, 1, 3),
        keep="histories",
    )
    shear = evaluate(scene).section("bar").shear[:, -1 if at else 0]
    found = kept["history:section:bar:shear"][0][:, -1 if at else 0]
    assert np.abs(found - shear).max() < SHIFT["single"] * np.abs(shear).max()


@pytest.mark.long
@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_sees_what_the_api_does(precision, tmp_path):
    for end in ("tip", "base"):
        scene, _ = rail(end)
        folder = tmp_path / end
        made, told = exported(scene, folder, precision=precision)
        solution = solve(scene, precision)
        found = by_c99(folder, told, instants(solution.t, precision))
        compare(
            found,
            expected(scene, told, solution),
            told,
            made,
            solution,
            exact=precision == "double",
        )

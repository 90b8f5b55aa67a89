"""Stations at one place of a link, whose shares are open where their sum is not; and what acts
beyond the link's ends.
"""

import itertools
import subprocess

import casadi as ca
import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from exported import by_c99, compare, expected, exported, instants, solve
from internals import FORCES, DesignEngine, EvaluationMethod, load
from internals import runs_save as save

from lagrange_casadi import Mechanism, Scene, codegen, derive, evaluate, refine
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

LOADS = {
    "beam": [(("bar", 0.9, 0.0), 3.0, -7.0, 0.0)],
    "rail": [(("block", 0.3, 0.0), 1.0, -4.0, 0.0)],
    "shaper": [(("rail", 0.31, 0.0), 20.0, 3.0, 0.0)],
}
RATIOS = np.append(np.linspace(0.0, 1.0, 27), (0.123, 0.4567, 0.777))


def unique(scene, parameters=None, **method):
    """The section forces that are given, (link, force): what the oracle calls unique, each right at
    all ratios and instants.
    """
    solution, m = evaluate(scene, parameters=parameters, **method), scene.mechanism
    assert solution.certified
    values, program = m.values(parameters), derive(scene)
    open_, exact = {}, {}
    for t in solution.t:
        found, drives = columns_at(program, float(t), values)
        solved = oracle_of(m, values, loads=[lambda place: LOADS.get(m.name, [])]).solve(
            drives, postures(m, found, drives, 0.0)
        )
        for link, u in itertools.product(solution.links_with_sections, RATIOS):
            told = solved.open_sections[link](u)
            for force, there, value in zip(FORCES, told, solved.sections[link](u), strict=True):
                open_[link, force] = open_.get((link, force), False) or there
                exact.setdefault((link, force), []).append(value)
    given = {key for key in open_ if solution.determined(f"section:{':'.join(key)}")}
    size = max(abs(x) for forces in exact.values() for x in forces)
    for link, force in given:
        assert not open_[link, force], f"{force} of {link} is given, and is not unique"
        law = solution.section(link).law
        true = np.reshape(exact[link, force], (solution.t.size, -1))
        mine = law.on_grid(force, RATIOS)
        assert (
            np.abs(mine - true).max()
            < (1e-5 if method.get("precision") == "single" else 1e-11) * size
        ), (link, force)
        peak = solution.peak(f"section:{link}:{force}")
        assert abs(peak.value) >= np.abs(mine).max()
        assert (
            abs(peak.value - law.at(force, np.full((solution.t.size, 1), peak.xi))).min() < 2 * size
        )
        assert f"section:{link}:{force}" in solution.errors
    withheld = {f"{force} of {link}" for (link, force), told in open_.items() if not told} - {
        f"{f} of {l}" for l, f in given
    }
    assert not withheld, "unique, and withheld"
    return {force for _, force in given}


def beam(
    *places, tip=False, root=True, defaults=(0.4, 0.4, 0.4), joint="revolute", y=0.0, **keywords
):
    """A beam of a metre on the ground: a pin at its base, one at its tip, and joints at ``places``
    of the parameters a, b, c, l.
    """
    m = Mechanism("beam")
    a, b, c = (m.parameter(name, value, "m") for name, value in zip("abc", defaults, strict=True))
    l = m.parameter("l", 1.0, "m")
    bar = m.link("bar", length=l, mass=2.0)
    if root:
        m.revolute("root", m.ground, bar)
    if tip:
        m.revolute("tip", bar.tip, m.ground.at(l, 0))
    for name, place in zip("ABC", places, strict=False):
        x, y = place(a, b, c, l), -y
        getattr(m, joint if name == "A" else "revolute")(name, m.ground.at(x, y), bar.at(x, y))
    m.force("load", bar.at(0.9), x=3.0, y=-7.0)
    return Scene(m, {}, posture={"bar": 0.0}, t=(0, 0, 1), xi=(0, 1, 11), **keywords)


def at_a(a, b, c, l):
    return a


def at_b(a, b, c, l):
    return b


def at_c(a, b, c, l):
    return c


BENT = {"shear", "bending"}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "method", [{"backend": b} for b in ("vm", "c", "lanes")] + [{"precision": "single"}], ids=str
)
def test_two_pins_at_one_place_bear_one_sum(method):
    """What both bear together holds the beam on its base's pin; along it, the base and they share
    the thrust.
    """
    assert unique(beam(at_a, at_b), **method) == BENT
    assert unique(beam(at_a, at_b, root=False, joint="weld"), **method) == {*FORCES}


def test_a_beam_on_two_pins_at_one_place_is_the_one_of_a_textbook():
    """Supports at 0 and s, weight W, load F at x: the bending over the second support is -(F (x -
    s) + W (1 - s)^2 / 2).
    """
    section = evaluate(beam(at_a, at_b), xi=(0, 1, 6)).section("bar")
    over = 7.0 * 0.5 + 2.0 * 9.81 * 0.6**2 / 2
    np.testing.assert_allclose(section.bending[0, 2], -over, rtol=1e-13)
    left = 2.0 * 9.81 * 0.4**2 / 2
    np.testing.assert_allclose(section.shear[0, 0], (over - left) / 0.4, rtol=1e-13)


def test_it_is_judged_for_the_places_as_they_are():
    """Three supports at three places are one too many; at two they are not."""
    scene = beam(at_a, at_b)
    assert unique(scene) == BENT
    assert unique(scene, {"b": 0.7}) == set()
    assert unique(scene, {"a": 0.7}) == set()
    assert unique(scene, {"a": 0.7, "b": 0.7}) == BENT


@pytest.mark.sampled(5)
@pytest.mark.parametrize("apart", [1e-3, 1e-6, 1e-8, 1e-11])
def test_what_is_nearly_at_one_place_is_not(apart):
    solution = evaluate(beam(at_a, lambda a, b, c, l: a + apart))
    assert not any(solution.determined(f"section:bar:{force}") for force in FORCES)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize(
    ("first", "second"),
    [
        (lambda a, b, c, l: l / 3, lambda a, b, c, l: l - 2 * l / 3),
        (lambda a, b, c, l: a + b, lambda a, b, c, l: 3 * (a + b) / 3),
        (lambda a, b, c, l: (a + b + c) / 7, lambda a, b, c, l: a / 7 + b / 7 + c / 7),
        (lambda a, b, c, l: 0.3, lambda a, b, c, l: 0.1 + 0.2),
    ],
)
def test_a_place_may_be_written_in_two_ways(first, second, precision):
    assert unique(beam(first, second), {"a": 0.1, "b": 0.2, "l": 1.1}, precision=precision) == BENT


def test_equal_but_for_rounding_of_other_parameters():
    assert unique(beam(at_c, lambda a, b, c, l: a + b), {"a": 0.1, "b": 0.2, "c": 0.3}) == BENT


@pytest.mark.parametrize("precision", ["double", "single"])
def test_what_is_one_place_up_to_a_bound_is_judged_beyond_it(precision):
    """Within the bound it cannot be told from one place, at whatever values it is looked at."""
    scene = beam(at_a, lambda a, b, c, l: ca.fmin(a, 2.0))
    assert unique(scene, {"a": 1.5, "l": 3.0}, precision=precision) == BENT
    assert unique(scene, {"a": 2.5, "l": 3.0}, precision=precision) == set()


def test_places_beside_the_axis_are_at_the_same_station():
    assert unique(beam(at_a, at_b, root=False, joint="weld", y=0.2)) == {*FORCES}
    assert unique(beam(at_a, at_b, y=0.2)) == set()  # here the thrust has an arm


def test_three_at_one_place():
    scene = beam(at_a, at_b, at_c)
    assert unique(scene) == BENT
    for moved in "abc":
        assert unique(scene, {moved: 0.6}) == set()
    assert unique(scene, {"a": 0.6, "b": 0.6, "c": 0.6}) == BENT


def test_two_at_one_place_whose_sum_is_open():
    """A pin at the tip shares with them."""
    assert unique(beam(at_a, at_b, tip=True)) == set()
    assert unique(beam(at_a, at_b, joint="weld")) == set()


def test_a_station_at_the_tip_and_one_at_the_base():
    """Where a parameter puts them: they join what is there."""
    assert unique(beam(at_a, tip=True), {"a": 1.0}) == BENT
    assert unique(beam(at_a, tip=True), {"a": 0.0}) == BENT
    assert unique(beam(at_a, tip=True), {"a": 0.5}) == set()
    assert unique(beam(at_a, at_b, tip=True), {"a": 1.0, "b": 0.0}) == BENT
    assert unique(beam(at_a, joint="weld"), {"a": 0.0}) == {*FORCES}
    assert unique(beam(at_a, at_b, root=False, joint="weld"), {"a": 1.0, "b": 1.0}) == {*FORCES}


def test_what_the_joints_bear_is_open_all_the_same():
    solution = evaluate(beam(at_a, at_b))
    for joint, member in itertools.product("AB", ("fx", "fy")):
        assert f"reaction:{joint}:{member}" in solution.undetermined
    assert np.all(solution.series["section:bar:B:f"] == 0.0)
    assert solution.determined("section:bar:A:f")


def test_a_station_alone_keeps_its_own_load():
    """Also where it may be open for other parameters."""
    solution = evaluate(beam(at_a, at_b), parameters={"a": 0.2, "b": 0.6})
    assert {f"section:bar:{joint}:f" for joint in "AB"} < set(solution.undetermined)
    alone = evaluate(beam(at_a))
    np.testing.assert_allclose(alone.series["section:bar:A:f"], alone.reaction("A").fy, rtol=1e-14)


def test_a_crank_on_two_bearings():
    """It turns, and drives: the torque acts where the bearings are."""
    m = Mechanism("bearings")
    a = m.link("a", length=0.5, mass=1.0)
    m.revolute("O", m.ground, a.at(0.2))
    m.revolute("P", m.ground, a.at(0.2))
    m.force("f", a.tip, y=-3.0)
    solution = evaluate(Scene(m, {"O": polynomial(0.3, 1.0)}, t=(0, 1, 5)))
    assert set(solution.undetermined) == {
        f"reaction:{joint}:{member}" for joint in "OP" for member in ("fx", "fy")
    }
    np.testing.assert_allclose(
        solution.section("a").law.at("shear", np.full((5, 1), 0.0))[:, 0], 0.0, atol=1e-14
    )
    assert solution.certified


def pair(**keywords):
    """A crank carries a bar that lies along it, on a weld and a pin at places of the parameters a
    and b.
    """
    m = Mechanism("pair")
    a, b = m.parameter("a", 0.4, "m"), m.parameter("b", 0.4, "m")
    crank, bar = m.link("crank", length=1.0, mass=1.0), m.link("bar", length=1.0, mass=2.0)
    m.revolute("O", m.ground, crank)
    m.weld("A", crank.at(a), bar.at(a))
    m.revolute("B", crank.at(b), bar.at(b))
    return Scene(m, {"O": polynomial(0.3, 2.0, -0.5)}, t=(0, 1.0, 5), xi=(0, 1, 11), **keywords)


def test_a_weld_and_a_pin_between_two_links():
    assert unique(pair()) == {*FORCES}
    assert unique(pair(), {"b": 0.7}) == set()


def shaper(slots, length, base, **keywords):
    """A crank's pin slides along a rail, in as many slots as have names; the rail is pinned to the
    ground at ``base``.
    """
    m = Mechanism("shaper")
    crank, rail = m.link("crank", length=0.2, mass=1.0), m.link("rail", length=length, mass=2.0)
    m.revolute("O", m.ground.at(0, 0.5), crank)
    m.revolute("R", m.ground, rail.at(base))
    for name in slots:
        m.slot(name, rail, crank.tip, axis=(1, 0))
    m.force("f", rail.at(0.31), x=20.0, y=3.0)
    lean = 1.2 if base == 0.0 else 1.2 + np.pi
    return Scene(
        m,
        {"O": polynomial(0.3, 6.0)},
        posture={"rail": lean},
        t=(0, 1.0, 41),
        xi=(0, 1, 12),
        **keywords,
    )


SHAPERS = {"within": (0.9, 0.0), "past the tip": (0.6, 0.0), "before the base": (0.9, 0.45)}


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", SHAPERS)
def test_what_slides_along_together_is_felt_as_a_sum(name):
    """The slots are at one place, which moves: within the rail, past its tip and back, before its
    base and back.
    """
    one, two = (evaluate(shaper(slots, *SHAPERS[name])) for slots in ("S", "ST"))
    station = two.series["section:rail:S:station"]
    low, high = station.min() < 0.0, station.max() > 1.0
    assert (low, high) == (name == "before the base", name == "past the tip")
    assert unique(shaper("ST", *SHAPERS[name]), t=(0, 1.0, 4)) == {*FORCES}
    peaks = [
        {p.name: p for p in refine(shaper(slots, *SHAPERS[name]), s)}
        for slots, s in (("S", one), ("ST", two))
    ]
    for force in FORCES:
        mine, true = (peak[f"section:rail:{force}"].value for peak in peaks)
        assert mine == pytest.approx(true, rel=1e-11)


def test_a_table_holds_the_sums():
    """Also of what slides before the base: the sum is smooth there."""
    for name in ("within", "before the base"):
        one = evaluate(shaper("S", *SHAPERS[name]))
        two = evaluate(shaper("ST", *SHAPERS[name]), table=1e-6)
        for force in FORCES:
            mine, true = (solution.array(f"section:rail:{force}") for solution in (two, one))
            np.testing.assert_allclose(mine, true, atol=1e-6 * np.abs(true).max())


def rail(guides=("P", "Q"), **keywords):
    """A rail turns about its base; a block slides along it on two guides a tenth apart, one too
    many, ``x`` to ``x + 0.2`` far.
    """
    m = Mechanism("rail")
    x = m.parameter("x", 1.1, "m")
    base, block = m.link("rail", length=1.0, mass=2.0), m.link("block", length=0.3, mass=1.5)
    m.revolute("O", m.ground, base)
    for k, name in enumerate(guides):
        m.prismatic(name, base, block.at(0.1 * k), axis=(1, 0))
    m.force("push", block.tip, x=1.0, y=-4.0)
    motion = {"O": polynomial(0.3, 1.0, -0.4), guides[0]: polynomial(x, 0.2)}
    return Scene(m, motion, posture={"block": 0.3}, t=(0, 1.0, 6), xi=(0, 1, 11), **keywords)


def given(scene, parameters, **method):
    """The forces of the rail that are given, and right beside the same mechanism with one guide,
    which shares nothing.
    """
    two = evaluate(scene, parameters=parameters, **method)
    one = evaluate(rail(("P",)), parameters=parameters)
    found = {force for force in FORCES if two.determined(f"section:rail:{force}")}
    for force in found:
        mine, true = (solution.array(f"section:rail:{force}") for solution in (two, one))
        np.testing.assert_allclose(
            mine,
            true,
            atol=(2e-5 if method.get("precision") == "single" else 1e-12) * np.abs(true).max(),
        )
    return found


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "method", [{"backend": b} for b in ("vm", "c", "lanes")] + [{"precision": "single"}], ids=str
)
def test_what_acts_beyond_the_ends_is_felt_as_a_sum(method):
    scene = rail()
    assert given(scene, {"x": 1.1}, **method) == {*FORCES}
    assert given(scene, {"x": -0.5}, **method) == {*FORCES}


def test_what_passes_an_end_is_felt_by_itself():
    """The guides share moments only in the plane of the rail: along it nothing is open."""
    for x in (0.85, 0.95, 0.3, -0.15, -0.05):
        assert given(rail(), {"x": x}) == {"axial"}, x


def test_the_oracle_says_the_same_beyond_the_ends():
    for x in (1.1, 0.85, 0.3, -0.5):
        unique(rail(), {"x": x})


@pytest.mark.sampled(3)
@pytest.mark.parametrize("length", [0.3, 1.0, 3.0])
def test_guides_that_pass_before_the_base_are_not_felt(length):
    """A bar carries the line of two guides, both always before its base or past its tip; it is held
    by both.
    """
    m = Mechanism("guided")
    bar = m.link("bar", length=length, mass=1.4)
    x = m.parameter("x", -1.0, "m")
    m.prismatic("P", bar.at(0.4 * length, -0.1), m.ground.at(0, 0.1), axis=(1, 0))
    m.prismatic("Q", bar.at(0.5 * length, -0.1), m.ground.at(0.1 * length, 0.1), axis=(1, 0))
    scene = Scene(m, {"P": polynomial(x * length, 0.1)}, posture={"bar": 0.0}, t=(0, 1.0, 3))
    assert unique(scene) == {*FORCES}
    assert unique(scene, {"x": 1.2}) == {*FORCES}
    assert unique(scene, {"x": 0.2}) == {"axial"}


def test_sweeps_judge_each_design():
    scene = beam(at_a, at_b)
    p = np.array([[0.4, 0.4, 0.4, 1.0], [0.4, 0.7, 0.4, 1.0], [0.7, 0.7, 0.4, 1.0]])
    for method in (
        EvaluationMethod("vm"),
        EvaluationMethod("c"),
        EvaluationMethod("lanes"),
        EvaluationMethod("c", precision="single"),
    ):
        designs = DesignEngine.of(scene, method=method)
        outcome = designs.evaluate(p, histories=True)
        assert np.all(outcome.status == 0)
        found = dict(zip(designs.quantities, outcome.value.T, strict=True))
        series = dict(zip(designs.columns, np.moveaxis(outcome.series, 1, 0), strict=True))
        for k, values in enumerate(p):
            one = evaluate(scene, parameters=dict(zip("abcl", values.tolist(), strict=True)))
            for force in BENT:
                name = f"section:bar:{force}"
                assert np.isfinite(found[name][k]) == one.determined(name)
                if one.determined(name):
                    np.testing.assert_allclose(found[name][k], one.peak(name).value, rtol=1e-5)
            for name in ("section:bar:A:f", "section:bar:B:f"):
                assert np.isfinite(series[name][k]).all() == one.determined(name)


def test_beyond_the_ends_in_a_sweep():
    designs = DesignEngine.of(rail(), method=EvaluationMethod("lanes"))
    outcome = designs.evaluate(np.array([[1.1], [0.95], [0.3], [-0.5]]))
    assert np.all(outcome.status == 0)
    found = dict(zip(designs.quantities, outcome.value.T, strict=True))
    assert np.isfinite(found["section:rail:axial"]).all()
    for force in BENT:
        assert np.isfinite(found[f"section:rail:{force}"]).tolist() == [True, False, False, True]


def test_a_file_keeps_the_sums(tmp_path):
    solution = evaluate(beam(at_a, at_b))
    save(solution, tmp_path / "beam.h5")
    again = load(tmp_path / "beam.h5")
    assert again.determined("section:bar:bending")
    np.testing.assert_array_equal(again.section("bar").bending, solution.section("bar").bending)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_has_the_sums_and_a_status_for_what_is_open(precision, tmp_path):
    scene = pair()
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    assert {link["name"] for link in told["links"]} == {"crank", "bar"}
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    compare(found, expected(scene, told, solution), told, made, solution)
    program = """
        #include "pair.h"
        int main(void) {
          pair_model model;
          pair_inputs inputs = {0};
          pair_outputs outputs;
          const pair_parameters together = {(pair_real) 0.7, (pair_real) 0.7}, apart = {(pair_real) 0.4, (pair_real) 0.7};
          if (pair_prepare(&model, &together) != PAIR_OK || pair_evaluate(&model, &inputs, &outputs) != PAIR_OK) return 1;
          if (pair_prepare(&model, &apart) != PAIR_OK) return 2;
          return pair_evaluate(&model, &inputs, &outputs) == PAIR_UNDETERMINED ? 0 : 3;
        }
    """  # noqa: E501
    (tmp_path / "program.c").write_text(program)
    sources = [tmp_path / "program.c", tmp_path / "pair.c"]
    subprocess.run(
        [*codegen.find_compiler().command, "-std=c99", *sources, "-o", tmp_path / "program", "-lm"],
        check=True,
    )
    assert subprocess.run([tmp_path / "program"], check=False).returncode == 0

"""Stations at one place of a link, whose shares are open where their sum is not; and what acts
beyond the link's ends.
"""

import itertools
import subprocess

import casadi as ca
import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from internals import DesignEngine, EvaluationMethod
from mechanisms import pins_of
from oracle import SECTION

from lagrange_casadi import Mechanism, Scene, derive, evaluate, export, refine
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

LOADS = {
    "beam": [(("bar", 0.9, 0.0), 3.0, -7.0, 0.0)],
    "rail": [(("block", 0.3, 0.0), 1.0, -4.0, 0.0)],
    "shaper": [(("rail", 0.31, 0.0), 20.0, 3.0, 0.0)],
}
RATIOS = np.append(np.linspace(0.0, 1.0, 9), (0.123, 0.4567, 0.777))


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
            for force, there, value in zip(SECTION, told, solved.sections[link](u), strict=True):
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
        assert abs(peak.value) >= np.abs(mine).max() * (1 - 1e-14)
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


A, B, C = (lambda a, b, c, l: a), (lambda a, b, c, l: b), (lambda a, b, c, l: c)
BENT, ALL, NONE = {"shear", "bending"}, {*SECTION}, set()


def pair():
    """A crank carries a bar that lies along it, on a weld and a pin at places of the parameters a
    and b.
    """
    m = Mechanism("pair")
    a, b = m.parameter("a", 0.4, "m"), m.parameter("b", 0.4, "m")
    crank, bar = m.link("crank", length=1.0, mass=1.0), m.link("bar", length=1.0, mass=2.0)
    m.revolute("O", m.ground, crank)
    m.weld("A", crank.at(a), bar.at(a))
    m.revolute("B", crank.at(b), bar.at(b))
    return Scene(m, {"O": polynomial(0.3, 2.0, -0.5)}, t=(0, 1.0, 5), xi=(0, 1, 11))


def rail():
    """A rail turns about its base; a block slides along it on two guides a tenth apart, one too
    many, ``x`` to ``x + 0.2`` far.
    """
    m = Mechanism("rail")
    x = m.parameter("x", 1.1, "m")
    base, block = m.link("rail", length=1.0, mass=2.0), m.link("block", length=0.3, mass=1.5)
    m.revolute("O", m.ground, base)
    for k, name in enumerate("PQ"):
        m.prismatic(name, base, block.at(0.1 * k), axis=(1, 0))
    m.force("push", block.tip, x=1.0, y=-4.0)
    motion = {"O": polynomial(0.3, 1.0, -0.4), "P": polynomial(x, 0.2)}
    return Scene(m, motion, posture={"block": 0.3}, t=(0, 1.0, 6), xi=(0, 1, 11))


def guided():
    """A bar carries the line of two guides, both before its base or past its tip where x is below 0
    or above 1; it is held by both.
    """
    m = Mechanism("guided")
    bar = m.link("bar", length=m.parameter("l", 1.0, "m"), mass=1.4)
    x, l = m.parameter("x", -1.0, "m"), bar.length
    m.prismatic("P", bar.at(0.4 * l, -0.1), m.ground.at(0, 0.1), axis=(1, 0))
    m.prismatic("Q", bar.at(0.5 * l, -0.1), m.ground.at(0.1 * l, 0.1), axis=(1, 0))
    return Scene(m, {"P": polynomial(x * l, 0.1)}, posture={"bar": 0.0}, t=(0, 1.0, 3))


BEAMS = {
    "two pins": (lambda: beam(A, B), BENT),
    "a weld and a pin": (lambda: beam(A, B, root=False, joint="weld"), ALL),
    "a weld and a pin beside the axis": (lambda: beam(A, B, root=False, joint="weld", y=0.2), ALL),
    "where the thrust has an arm": (lambda: beam(A, B, y=0.2), NONE),
    "a pin at the tip shares": (lambda: beam(A, B, tip=True), NONE),
    "a weld, a pin, and one at the base": (lambda: beam(A, B, joint="weld"), NONE),
    "three": (lambda: beam(A, B, C), BENT),
    "a crank and its bar": (pair, ALL),
    "beyond the ends": (rail, ALL),
    "before the base": (guided, ALL),
}
ELSEWHERE = [
    *((lambda: beam(A, B), moved, NONE) for moved in ({"b": 0.7}, {"a": 0.7})),
    (lambda: beam(A, B), {"a": 0.7, "b": 0.7}, BENT),
    *((lambda: beam(A, B, C), {moved: 0.6}, NONE) for moved in "abc"),
    (lambda: beam(A, B, C), {"a": 0.6, "b": 0.6, "c": 0.6}, BENT),
    (lambda: beam(C, lambda a, b, c, l: a + b), {"a": 0.1, "b": 0.2, "c": 0.3}, BENT),
    # One place up to a bound, beyond it two.
    (lambda: beam(A, lambda a, b, c, l: ca.fmin(a, 2.0)), {"a": 1.5, "l": 3.0}, BENT),
    (lambda: beam(A, lambda a, b, c, l: ca.fmin(a, 2.0)), {"a": 2.5, "l": 3.0}, NONE),
    # What parameters put at the tip or at the base joins what is there.
    (lambda: beam(A, tip=True), {"a": 1.0}, BENT),
    (lambda: beam(A, tip=True), {"a": 0.0}, BENT),
    (lambda: beam(A, tip=True), {"a": 0.5}, NONE),
    (lambda: beam(A, B, tip=True), {"a": 1.0, "b": 0.0}, BENT),
    (lambda: beam(A, joint="weld"), {"a": 0.0}, ALL),
    (lambda: beam(A, B, root=False, joint="weld"), {"a": 1.0, "b": 1.0}, ALL),
    (pair, {"b": 0.7}, NONE),
    # Guides share moments only in the plane of the rail: along it nothing is open.
    *((rail, {"x": x}, {"axial"}) for x in (0.85, 0.95, 0.3, -0.15, -0.05)),
    (rail, {"x": -0.5}, ALL),
    *((guided, {"x": x, "l": l}, ALL) for x in (-1.0, 1.2) for l in (0.3, 3.0)),
    (guided, {"x": 0.2}, {"axial"}),
]
WRITTEN = [
    (lambda a, b, c, l: l / 3, lambda a, b, c, l: l - 2 * l / 3),
    (lambda a, b, c, l: a + b, lambda a, b, c, l: 3 * (a + b) / 3),
    (lambda a, b, c, l: (a + b + c) / 7, lambda a, b, c, l: a / 7 + b / 7 + c / 7),
    (lambda a, b, c, l: 0.3, lambda a, b, c, l: 0.1 + 0.2),
]
ELSEWHERE += [
    (lambda ways=ways: beam(*ways), {"a": 0.1, "b": 0.2, "l": 1.1}, BENT) for ways in WRITTEN
]


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "method", [{"backend": b} for b in ("vm", "c", "lanes")] + [{"precision": "single"}], ids=str
)
@pytest.mark.parametrize("name", BEAMS)
def test_what_bears_at_one_place_bears_one_sum(name, method):
    made, forces = BEAMS[name]
    assert unique(made(), **method) == forces


@pytest.mark.parametrize(("made", "parameters", "forces"), ELSEWHERE)
def test_it_is_judged_for_the_places_as_they_are(made, parameters, forces):
    assert unique(made(), parameters, backend="vm") == forces


@pytest.mark.sampled(3)
@pytest.mark.parametrize("apart", [1e-3, 1e-6, 1e-8, 1e-11])
def test_what_is_nearly_at_one_place_is_not(apart):
    solution = evaluate(beam(A, lambda a, b, c, l: a + apart))
    assert not any(solution.determined(f"section:bar:{force}") for force in SECTION)


SHAPERS = {"within": (0.9, 0.0), "past the tip": (0.6, 0.0), "before the base": (0.9, 0.45)}


def shaper(slots, length, base):
    """A crank's pin slides along a rail, in as many slots as have names; the rail is pinned to the
    ground at ``base``.
    """
    m = Mechanism("shaper")
    crank, rail = m.link("crank", length=0.2, mass=1.0), m.link("rail", length=length, mass=2.0)
    pins_of(m, O=(m.ground.at(0, 0.5), crank), R=(m.ground, rail.at(base)))
    for name in slots:
        m.slot(name, rail, crank.tip, axis=(1, 0))
    m.force("f", rail.at(0.31), x=20.0, y=3.0)
    lean = {"rail": 1.2 if base == 0.0 else 1.2 + np.pi}
    return Scene(m, {"O": polynomial(0.3, 6.0)}, posture=lean, t=(0, 1.0, 41), xi=(0, 1, 12))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", SHAPERS)
def test_what_slides_along_together_is_felt_as_a_sum(name):
    """The slots are at one place, which moves: within the rail, past its tip and back, before its
    base and back.
    """
    one, two = (shaper(slots, *SHAPERS[name]) for slots in ("S", "ST"))
    solutions = evaluate(one), evaluate(two)
    station = solutions[1].series["section:rail:S:station"]
    low, high = station.min() < 0.0, station.max() > 1.0
    assert (low, high) == (name == "before the base", name == "past the tip")
    assert unique(two, t=(0, 1.0, 4)) == ALL
    peaks = [
        {p.name: p.value for p in refine(*case)} for case in zip((one, two), solutions, strict=True)
    ]
    for force in SECTION:
        true, mine = (peak[f"section:rail:{force}"] for peak in peaks)
        assert mine == pytest.approx(true, rel=1e-11)


@pytest.mark.parametrize(
    ("made", "p"),
    [
        (lambda: beam(A, B), [[0.4, 0.4, 0.4, 1.0], [0.4, 0.7, 0.4, 1.0], [0.7, 0.7, 0.4, 1.0]]),
        (rail, [[1.1], [0.95], [0.3], [-0.5]]),
    ],
)
def test_sweeps_judge_each_design(made, p):
    scene = made()
    ones = [
        evaluate(scene, parameters=dict(zip(scene.mechanism.parameters, row, strict=True)))
        for row in p
    ]
    for method in (EvaluationMethod("lanes"), EvaluationMethod("c", precision="single")):
        designs = DesignEngine.of(scene, method=method)
        outcome = designs.evaluate(np.array(p), histories=True)
        assert np.all(outcome.status == 0)
        for name, found in zip(map(str, designs.quantities), outcome.value.T, strict=True):
            assert np.isfinite(found).tolist() == [one.determined(name) for one in ones], name
        for name, found in zip(
            map(str, designs.columns), np.moveaxis(outcome.series, 1, 0), strict=True
        ):
            if name.startswith("section:"):
                told = [np.isfinite(row).all() for row in found]
                assert told == [one.determined(name) for one in ones], name


def test_exported_c_has_a_status_for_what_is_open(tmp_path):
    export(pair(), tmp_path)
    program = """
        #include "pair.h"
        int main(void) {
          pair_model model;
          pair_inputs inputs = {0};
          pair_outputs outputs;
          const pair_parameters together = {0.7, 0.7}, apart = {0.4, 0.7};
          if (pair_prepare(&model, &together) != PAIR_OK) return 1;
          if (pair_evaluate(&model, &inputs, &outputs) != PAIR_OK) return 2;
          if (pair_prepare(&model, &apart) != PAIR_OK) return 3;
          return pair_evaluate(&model, &inputs, &outputs) == PAIR_UNDETERMINED ? 0 : 4;
        }
    """
    (tmp_path / "program.c").write_text(program)
    sources = [tmp_path / "program.c", tmp_path / "pair.c"]
    subprocess.run(
        ["cc", "-std=c99", *sources, "-o", tmp_path / "program", "-lm"],
        check=True,
    )
    assert subprocess.run([tmp_path / "program"], check=False).returncode == 0

"""Load cases of links, in equilibrium by the data that they hold and the same as sections; load
spectra, and loads of bearings.
"""

import csv
import dataclasses
import json
import re

import numpy as np
import pytest
from mechanisms import parallelogram, pins_of

from lagrange_casadi import (
    Mechanism,
    Scene,
    beams,
    bearing_loads,
    errors,
    evaluate,
    link_load_cases,
    load_case,
    write_load_cases,
    write_spectrum,
)
from lagrange_casadi.motion import dwell, move, moves, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.fixture(scope="module")
def crank_rod():
    return evaluate(load_case("slider_crank").scene, wanted=["all"], backend="vm")


def field(case, r):
    """Weight and inertia of a unit of mass at a place of the link."""
    acceleration, omega, alpha, gravity = map(
        np.array, (case.acceleration, case.omega, case.alpha, case.gravity)
    )
    return gravity - acceleration - np.cross(alpha, r) - np.cross(omega, np.cross(omega, r))


def sums(case, about, loads=None):
    """Force and moment about a place of the loads."""
    force, moment = np.zeros(3), np.zeros(3)
    for load in case.loads if loads is None else loads:
        force += load.force
        moment += load.moment + np.cross(np.subtract(load.at, about), load.force)
    return force, moment


@pytest.mark.parametrize(
    ("name", "links"),
    [
        ("slider_crank", ("crank", "rod", "slider")),
        ("four_bar", ("crank", "coupler", "rocker")),
        ("arm6", ("link2", "link5", "tool")),
        ("engine", ("rod", "piston")),
        ("cad_press", ("Rod", "Ram")),  # rigid bodies
        ("sleigh", ("body", "boom")),  # a constraint acts on the body
        ("planetary_gear", ("set_planet_1", "carrier")),
    ],
)
def test_loads_and_inertia_are_in_equilibrium(name, links):
    scene = load_case(name).scene
    solution = evaluate(scene, wanted=["all"], backend="vm")
    for link in links:
        for case in link_load_cases(solution, link, scene=scene):
            assert max(case.residual) < 1e-12
            force, moment = sums(case, case.centre)
            largest = max(np.linalg.norm(load.force) for load in case.loads)
            assert np.abs(force + case.mass * field(case, case.centre)).max() < 1e-12 * largest
            inertia, omega = np.array(case.inertia), np.array(case.omega)
            if solution.description.bodies[link].length is not None:
                spun = inertia @ case.alpha + np.cross(omega, inertia @ omega)
                scale = np.abs([load.moment for load in case.loads]).max()
                assert np.abs(moment - spun).max() < 1e-12 * max(largest, scale)


def test_instants_are_those_that_govern(crank_rod):
    cases = link_load_cases(crank_rod, "rod")
    named = {name: case.t for case in cases for name in case.governs}
    expected = [f"section:rod:{force}" for force in ("axial", "shear", "bending")]
    expected += ["reaction:A:resultant", "reaction:B:resultant"]
    assert sorted(named) == sorted(expected)
    for name, t in named.items():
        assert crank_rod.peak(name).t == t
    assert [case.t for case in cases] == sorted({case.t for case in cases})


def test_instants_at_which_friction_is_at_rest_are_left_out():
    m = Mechanism("lift")
    cage = m.link("cage", length=0.2, mass=5.0, centre=(0.0, 0.0), inertia=0.01)
    mast = m.prismatic("mast", m.ground, cage, axis=(0, 1))
    m.friction("guide", mast, mu=0.2, length=0.1)
    m.force("wind", cage, x=30.0)
    lift = Scene(m, {"mast": moves([move(0.5, time=0.4), dwell(0.2)])}, t=(0, 0.6, 61))
    solution = evaluate(lift, wanted=["all"], backend="vm")
    for case in link_load_cases(solution, "cage"):
        assert 0.0 < case.t < 0.4
        assert [load.name for load in case.loads][-2:] == ["load:guide", "load:wind"]
    with pytest.raises(errors.DeclarationError, match=r"at rest at t = 0.5 s, .* effort:"):
        link_load_cases(solution, "cage", [0.2, 0.5])


REFUSED = {
    "link": (lambda s, _: link_load_cases(s, "rood"), r"unknown link 'rood'.*'rod'"),
    "instant": (lambda s, _: link_load_cases(s, "rod", [9.0]), "t = 9 s is no instant.*nearest is"),
    "format": (lambda s, to: write_load_cases(first_of(s), to, ["k"]), "unknown format 'k'; val"),
    "load": (
        lambda s, to: write_load_cases(first_of(s), to, ["inp"], {"C": "PIN"}),
        "unknown load 'C'; valid: A, B, rod",
    ),
    "beam": (lambda s, to: write_load_cases(first_of(s), to, ["beam"]), "'beam' needs a link wi"),
    **{
        f"nodes {nodes}": (
            lambda s, to, nodes=nodes: write_load_cases(first_of(s), to, ["inp"], nodes), words
        )
        for nodes, words in (
            (("pin", "PIN"), "A and B are at several places, but each has the node 'pin'"),
            ((7, "7"), "each has the node '7'; expected a node for each"),
            (("PIN, 2", 3), "expected names or numbers of nodes, got 'PIN, 2'"),
            (("", 3), "expected names or numbers of nodes, got ''"),
        )
        for nodes in [dict(zip("AB", nodes, strict=True))]
    },
    **{
        name: (lambda s, to, name=name: write_spectrum(s, name, to / "s.csv"), words)
        for name, words in (
            ("section:rod:bending", "give a ratio too, as in 'section:rod:bending@0.5'"),
            ("section:rod:bending@1.5", "expected section:LINK:FORCE@RATIO"),
            ("effort:O@0.5", "expected section:LINK:FORCE@RATIO"),
            ("section:rod:bending@x", "expected section:LINK:FORCE@RATIO"),
            ("section:rod:twist@0.5", "unknown section force 'twist'; valid: axial, shear, bend"),
        )
    },
}  # fmt: skip


def test_node_sets_have_names_of_the_mesh_and_are_told_apart(crank_rod, tmp_path):
    """CalculiX adds nodes to a set of the same name, be it in capitals or not."""
    write_load_cases(first_of(crank_rod), tmp_path, ["inp"], {"A": "PIN", "B": 7, "rod": "ALL"})
    text = (tmp_path / "rod_1.inp").read_text()
    for words in ("\n*CLOAD\nPIN, 1, ", "\n7, 1, ", "\nALL, GRAV, "):
        assert words in text
    m = Mechanism("press")
    crank = m.link("crank", length=0.1, mass=1.0)
    steel = beams.Beam(beams.rectangle(0.06, 0.03), beams.material("S355"))
    rod, ram = m.link("rod", length=0.4, beam=steel), m.point_mass("ram", 15.0)
    pins_of(m, O=(m.ground, crank), tip=(crank.tip, rod), Tip=(rod.tip, ram))
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    m.force("base", rod.at(0.13, 0.02), x=-3000.0, y=500.0)
    scene = Scene(m, {"O": polynomial(0, 30.0)}, t=(0, 0.2, 21), posture={"rod": 1.5})
    write_load_cases(first_of(evaluate(scene, wanted=["all"])), tmp_path, ["beam"])
    text = (tmp_path / "rod_1.beam.inp").read_text()
    sets = dict(re.findall(r"^\*NSET, NSET=(\w+)\n(\d+)$", text, re.MULTILINE))
    assert len({name.upper() for name in sets}) == len(sets) == 6
    base, tip, within = re.findall(r"^(\w+), \d(?:, 3)?$", text.partition("*BOUNDARY")[2], re.M)[:3]
    x = {number: float(at) for number, at in re.findall(r"^(\d+), (\S+), 0, 0$", text, re.M)}
    assert (x[sets[base]], x[sets[tip]]) == (0.0, 0.4)
    assert 0.0 < x[sets[within]] < 0.4
    assert abs(x[sets["base"]] - 0.13) < 1e-12


def first_of(solution):
    return link_load_cases(solution, "rod")[:1]


def open_link():
    """A link between cranks of which one is too many."""
    solution = evaluate(parallelogram(), wanted=["all"], backend="vm")
    joint = solution.description.joints[solution.indeterminate[0].part]
    ends = (end.body for end in (joint.child, joint.parent))
    link_load_cases(solution, next(body for body in ends if body != "ground"))


def out_of_balance(solution):
    """A reaction that is a little wrong."""
    output = next(o for o in solution.outputs if str(o) == "reaction:B:fx")
    wrong = {**solution.outputs, output: solution.outputs[output] * (1 + 1e-7)}
    link_load_cases(dataclasses.replace(solution, outputs=wrong), "rod")


def of_sleigh(**asked):
    solution = evaluate(load_case("sleigh").scene, wanted=["all"], t=(0, 1, 5))
    link_load_cases(solution, "body", **asked)


LEAN = {"wanted": ["motion", "reaction:A"], "t": (0, 0.08, 5)}
REFUSED |= {
    "open": (lambda s, _: open_link(), "does not determine .*reaction:"),
    "balance": (lambda s, _: out_of_balance(s), r"link 'rod' at t = .* not in equilibrium"),
    "lean": (
        lambda s, _: link_load_cases(evaluate(load_case("slider_crank").scene, **LEAN), "rod"),
        r"link 'rod' need reaction:B, .*\['all'\]",
    ),
    "bearing": (
        lambda s, _: bearing_loads(
            evaluate(load_case("slider_crank").scene, **LEAN | {"wanted": ["effort"]}), "O"
        ),
        "reaction of joint 'O' was not evaluated",
    ),
    "slides": (
        lambda s, _: bearing_loads(
            evaluate(load_case("slider_crank").scene, t=(0, 0.08, 5)), "guide"
        ),
        "joint 'guide' does not turn, or its motion was not evaluated",
    ),
    "rows": (lambda s, _: of_sleigh(), "along which directions blade act"),
    "other": (
        lambda s, _: of_sleigh(scene=load_case("slider_crank").scene),
        "other parameters, bodies or joints|is not one of",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_told_is_named(crank_rod, what, tmp_path):
    asked, words = REFUSED[what]
    with pytest.raises((errors.DeclarationError, errors.CertificateError), match=words):
        asked(crank_rod, tmp_path)
    assert list(tmp_path.iterdir()) == []


def rows(path):
    lines = path.read_text().splitlines()
    lines = lines[1:] if lines[0].startswith("# ") else lines
    return list(csv.DictReader(lines))


def test_files_hold_the_load_cases(crank_rod, tmp_path):
    cases, folder = link_load_cases(crank_rod, "rod"), tmp_path / "loads"
    files = write_load_cases(cases, folder, ["json", "csv", "inp"])
    assert sorted(files) == sorted(path.name for path in folder.iterdir())
    expected = [dataclasses.asdict(case) for case in cases]
    assert all(case.pop("rod") is None for case in expected)
    kept = json.loads((folder / "rod.json").read_text())
    assert kept["cases"] == json.loads(json.dumps(expected))
    found = [float(row["fx [N]"]) for row in rows(folder / "rod.csv")]
    assert found == [load.force[0] for case in cases for load in case.loads]
    found = [float(row["alpha_z [rad/s^2]"]) for row in rows(folder / "rod.inertia.csv")]
    assert found == [case.alpha[2] for case in cases]
    text = (folder / "rod_1.inp").read_text()
    assert "\n*CLOAD\nA, 1, " in text
    assert "\nrod, CENTRIF, " in text


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("reaction:crankpin:fx", "N"),
        ("section:rod:bending@0.5", "N m"),
        ("stress:rod@0.25", "Pa"),
    ],
)
def test_classes_hold_the_cycles(name, unit, tmp_path):
    """No class is wider than its share, and each holds as many cycles as the exact ranges in it."""
    engine = evaluate(load_case("connecting_rod").scene, wanted=["all"], t=(0, 0.07, 141))
    found, path = [], tmp_path / "spectrum.csv"
    for classes in (0, 20):
        write_spectrum(engine, name, path, classes=classes)
        found.append([{k: float(x) for k, x in row.items()} for row in rows(path)])
    assert path.read_text().startswith(f"# {name} [{unit}], counted over ")
    exact, classed = found
    assert sum(row["cycles"] for row in exact) == sum(row["cycles"] for row in classed)
    assert all(row["range_low"] == row["range"] == row["range_high"] for row in exact)
    widest = max(row["range"] for row in exact)
    for row in classed:
        low, high = row["range_low"] * (1 - 1e-12), row["range_high"] * (1 + 1e-12)
        inside = [one["range"] for one in exact if low <= one["range"] <= high]
        assert abs(row["range"] - inside[0]) <= widest / 20

"""Load cases of links: in equilibrium by the data that they hold, and the same as sections."""

import csv
import dataclasses
import json
import math
import re
import shutil
import subprocess

import numpy as np
import pytest
from mechanisms import parallelogram

from lagrange_casadi import (
    Mechanism,
    Scene,
    beams,
    errors,
    evaluate,
    link_load_cases,
    load_case,
    write_load_cases,
)
from lagrange_casadi.cli import main
from lagrange_casadi.motion import dwell, move, moves, polynomial


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


def rod(case, start, stop):
    """Force, and moment about the start, of weight and inertia of a piece of a uniform rod."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    force, moment = np.zeros(3), np.zeros(3)
    for node, weight in zip(nodes, weights, strict=True):
        x = start + (node + 1) / 2 * (stop - start)
        mass = case.mass * (stop - start) / (2 * case.centre[0]) * weight / 2
        push = mass * field(case, np.array([x, 0.0, 0.0]))
        force, moment = force + push, moment + np.cross([x - start, 0.0, 0.0], push)
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
            if solution.description["bodies"][link]["length"] is not None:
                spun = inertia @ case.alpha + np.cross(omega, inertia @ omega)
                scale = np.abs([load.moment for load in case.loads]).max()
                assert np.abs(moment - spun).max() < 1e-12 * max(largest, scale)


@pytest.mark.parametrize("link", ["crank", "rod"])
def test_loads_beyond_a_section_are_its_forces(crank_rod, link):
    """Sections come from the graphs of the derivation, load cases do not."""
    length = crank_rod.description["bodies"][link]["length"]
    every = link_load_cases(crank_rod, link, crank_rod.t[::97].tolist())
    assert [case.t for case in every] == crank_rod.t[::97].tolist()
    law = crank_rod.section(link).law
    for k, case in enumerate(every):
        for ratio in (0.0, 0.3, 0.9):
            at = [ratio * length, 0.0, 0.0]
            force, moment = sums(case, at, [x for x in case.loads if x.at[0] > at[0] + 1e-9])
            more = rod(case, at[0], length)
            found = [*(force + more[0])[:2], (moment + more[1])[2]]
            for name, value in zip(("axial", "shear", "bending"), found, strict=True):
                expected = law.at(name, np.full((crank_rod.t.size, 1), ratio))[97 * k, 0]
                assert abs(value - expected) < 1e-12 * law.bound(name, np.array([ratio]))


def test_instants_are_those_that_govern(crank_rod):
    cases = link_load_cases(crank_rod, "rod")
    named = {name: case.t for case in cases for name in case.governs}
    expected = [f"section:rod:{force}" for force in ("axial", "shear", "bending")]
    expected += ["reaction:A:resultant", "reaction:B:resultant"]
    assert sorted(named) == sorted(expected)
    for name, t in named.items():
        assert crank_rod.peak(name).t == t
    assert [case.t for case in cases] == sorted({case.t for case in cases})


@pytest.mark.parametrize(
    ("name", "link", "moment"),
    [("sleigh", "cross", "reaction:X:mz"), ("arm6", "link5", "reaction:pitch:moment")],
)
def test_what_governs_is_a_quantity_of_the_solution(name, link, moment):
    """Moments of reactions have another name in a plane than in space."""
    scene = load_case(name).scene
    solution = evaluate(scene, wanted=["all"], backend="vm")
    cases = link_load_cases(solution, link, scene=scene)
    named = {name: case.t for case in cases for name in case.governs}
    assert moment in named
    for name, t in named.items():
        values, _ = solution.extremes(name)
        (value,) = values[solution.t == t]
        assert abs(value) >= abs(solution.peak(name).value) * (1 - 1e-12)


def test_what_is_not_known_is_named(crank_rod):
    with pytest.raises(errors.UnknownNameError, match=r"unknown link 'rood'.*'rod'"):
        link_load_cases(crank_rod, "rood")
    with pytest.raises(errors.DeclarationError, match=r"t = 9 s is no instant.*nearest is"):
        link_load_cases(crank_rod, "rod", [9.0])
    lean = evaluate(load_case("slider_crank").scene, wanted=["motion", "reaction:A"], backend="vm")
    with pytest.raises(
        errors.DeclarationError, match=r"link 'rod' need reaction:B, which.*\['all'\]"
    ):
        link_load_cases(lean, "rod")
    sleigh = evaluate(load_case("sleigh").scene, wanted=["all"], t=(0, 1, 5), backend="vm")
    with pytest.raises(errors.DeclarationError, match="along which directions blade act"):
        link_load_cases(sleigh, "body")
    with pytest.raises(errors.DeclarationError, match="other parameters, bodies or joints"):
        link_load_cases(sleigh, "body", scene=load_case("four_bar").scene)


def test_what_equilibrium_does_not_determine_is_named():
    solution = evaluate(parallelogram(), wanted=["all"], backend="vm")
    part = solution.indeterminate[0].part
    joint = solution.description["joints"][part]
    link = next(joint[end]["body"] for end in ("child", "parent") if joint[end]["body"] != "ground")
    with pytest.raises(errors.DeclarationError, match=f"does not determine .*reaction:{part}"):
        link_load_cases(solution, link)


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


def test_loads_out_of_equilibrium_are_refused(crank_rod):
    output = next(o for o in crank_rod.outputs if str(o) == "reaction:B:fx")
    wrong = {**crank_rod.outputs, output: crank_rod.outputs[output] * (1 + 1e-7)}
    with pytest.raises(errors.CertificateError, match=r"link 'rod' at t = .* not in equilibrium"):
        link_load_cases(dataclasses.replace(crank_rod, outputs=wrong), "rod")


def test_files_hold_the_load_cases(crank_rod, tmp_path):
    cases = link_load_cases(crank_rod, "rod")
    files = write_load_cases(cases, tmp_path / "loads", ["json", "csv", "inp"])
    assert sorted(files) == sorted(path.name for path in (tmp_path / "loads").iterdir())
    kept = json.loads((tmp_path / "loads" / "rod.json").read_text())
    expected = [dataclasses.asdict(case) for case in cases]
    assert all(case.pop("rod") is None for case in expected)
    assert kept["cases"] == json.loads(json.dumps(expected))
    with (tmp_path / "loads" / "rod.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["fx [N]"]) for row in rows] == [x.force[0] for c in cases for x in c.loads]
    with (tmp_path / "loads" / "rod.inertia.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["alpha_z [rad/s^2]"]) for row in rows] == [c.alpha[2] for c in cases]
    text = (tmp_path / "loads" / "rod_1.inp").read_text()
    assert "\n*CLOAD\nA, 1, " in text
    assert "\nrod, CENTRIF, " in text
    with pytest.raises(errors.UnknownNameError, match="unknown format 'k'; valid: json"):
        write_load_cases(cases, tmp_path / "loads", ["k"])


def entries(text):
    """Bulk data in fields of 16 and of 8 characters: word and fields."""
    found = []
    for line in text.splitlines():
        wide = 16 if "*" in line[:8] else 8
        fields = [line[k : k + wide].strip() for k in range(8, len(line), wide)]
        if line[:1] == "$":
            continue
        if line[:8].strip(" *"):
            found.append((line[:8].strip(" *"), []))
        found[-1][1].extend(float(x) if x else None for x in fields)
    return found


def test_bulk_data_of_nastran_is_in_equilibrium(tmp_path):
    """The force of RACC is along the angular acceleration that is given, that of A outward."""
    solution = evaluate(load_case("arm6").scene, wanted=["all"], backend="vm")
    case = link_load_cases(solution, "link2")[0]
    write_load_cases([case], tmp_path, ["nas"], {"shoulder": "700"})
    force, moment, inertia = np.zeros(3), np.zeros(3), []
    places = {700: case.loads[0].at}
    assert [load.name for load in case.loads] == [
        *("reaction:shoulder", "effort:shoulder", "reaction:elbow", "effort:elbow")
    ]
    places[1] = case.loads[2].at
    known = entries((tmp_path / "link2_1.nas").read_text())
    sets = [fields[0] for word, fields in known if word != "LOAD"]
    word, combined = known[-1]
    assert (word, combined[:2]) == ("LOAD", [10.0, 1.0])
    assert dict(zip(combined[3::2], combined[2::2], strict=True)) == dict.fromkeys(sets, 1.0)
    for word, fields in known[:-1]:
        vector = np.array(fields[4:7] if word != "GRAV" else fields[3:6])
        if word == "GRAV":
            inertia.append((fields[2] * vector, 0.0 * vector, 0.0 * vector))
        elif word == "RFORCE":
            turns = fields[3], (fields[7:9] or [0.0])[-1]
            inertia.append((0.0 * vector, *(math.tau * turn * vector for turn in turns)))
        elif word == "FORCE":
            force += fields[3] * vector
            arm = np.subtract(places[fields[1]], case.centre)
            moment += np.cross(arm, fields[3] * vector)
        else:
            moment += fields[3] * vector
    assert len(inertia) == 3
    gravity, omega, alpha = map(sum, zip(*inertia, strict=True))
    nodes, weights = np.polynomial.legendre.leggauss(3)
    largest = max(np.linalg.norm(load.force) for load in case.loads)
    for node, weight in zip(nodes, weights, strict=True):
        at = np.array([(1 + node) * case.centre[0], 0.0, 0.0])
        outward = -np.cross(omega, np.cross(omega, at))
        push = case.mass * weight / 2 * (gravity + outward + np.cross(alpha, at))
        force, moment = force + push, moment + np.cross(at - case.centre, push)
    assert np.abs([force, moment]).max() < 1e-8 * largest


def test_nodes_have_names_of_the_mesh(crank_rod, tmp_path):
    cases = link_load_cases(crank_rod, "rod")[:1]
    write_load_cases(cases, tmp_path, ["inp", "nas"], {"A": "PIN", "B": 7, "rod": "ALL"})
    text = (tmp_path / "rod_1.inp").read_text()
    assert "\n*CLOAD\nPIN, 1, " in text
    assert "\n7, 1, " in text
    assert "\nALL, GRAV, " in text
    assert "$   1: A at 0, 0, 0 m\n$   7: B at" in (tmp_path / "rod_1.nas").read_text()
    with pytest.raises(errors.UnknownNameError, match=r"unknown load 'C'; valid: A, B, rod"):
        write_load_cases(cases, tmp_path, ["inp"], {"C": "PIN"})
    with pytest.raises(errors.DeclarationError, match="format 'beam' needs a link with a beam"):
        write_load_cases(cases, tmp_path, ["beam"])


@pytest.mark.parametrize(
    ("nodes", "words"),
    [
        ({"A": "pin", "B": "PIN"}, "A and B are at several places, but each has the node 'pin'"),
        ({"A": "b"}, "A and B are at several places, but each has the node 'b'"),
        ({"A": 7, "B": "7"}, "each has the node '7'; expected a node for each"),
        ({"A": "PIN, 2"}, "expected names or numbers of nodes, got 'PIN, 2'"),
        ({"A": ""}, "expected names or numbers of nodes, got ''"),
    ],
)
def test_every_place_needs_a_node_of_its_own(crank_rod, nodes, words, tmp_path):
    cases = link_load_cases(crank_rod, "rod")[:1]
    with pytest.raises(errors.DeclarationError, match=words):
        write_load_cases(cases, tmp_path / "loads", ["inp"], nodes)
    assert not (tmp_path / "loads").exists()


def press(material):
    """A slider-crank whose joints have names of node sets of a model."""
    m = Mechanism("press")
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.4, beam=beams.Beam(beams.rectangle(0.06, 0.03), material))
    ram = m.point_mass("ram", 15.0)
    m.revolute("O", m.ground, crank)
    m.revolute("tip", crank.tip, rod)
    m.revolute("Tip", rod.tip, ram)
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    m.force("base", rod.at(0.13, 0.02), x=-3000.0, y=500.0)
    return Scene(m, {"O": polynomial(0, 30.0)}, t=(0, 0.2, 21), posture={"rod": 1.5})


def test_node_sets_of_a_model_are_told_apart(tmp_path):
    """CalculiX adds nodes to a set of the same name, be it in capitals or not."""
    solution = evaluate(press(beams.material("S355")), wanted=["all"], backend="vm")
    cases = link_load_cases(solution, "rod")
    assert cases == link_load_cases(solution, "rod")
    write_load_cases(cases[:1], tmp_path, ["beam"])
    text = (tmp_path / "rod_1.beam.inp").read_text()
    sets = dict(re.findall(r"^\*NSET, NSET=(\w+)\n(\d+)$", text, re.MULTILINE))
    assert len({name.upper() for name in sets}) == len(sets) == 6
    base, tip, within = re.findall(r"^(\w+), \d(?:, 3)?$", text.partition("*BOUNDARY")[2], re.M)[:3]
    x = {number: float(at) for number, at in re.findall(r"^(\d+), (\S+), 0, 0$", text, re.M)}
    assert (x[sets[base]], x[sets[tip]]) == (0.0, 0.4)
    assert 0.0 < x[sets[within]] < 0.4
    assert abs(x[sets["base"]] - 0.13) < 1e-12


CASE = """from test_load_cases import beams, press


def scene():
    return press(beams.Material("spruce", 450.0{}))
"""


@pytest.mark.parametrize(
    ("moduli", "why"),
    [
        ("", "material 'spruce' has no elasticity"),
        (", elasticity=11e9, shear_modulus=0.7e9", "has Poisson's ratio 6.857 by its moduli"),
    ],
)
def test_the_command_leaves_out_a_model_that_cannot_be_made(moduli, why, tmp_path, capfd):
    case, out = tmp_path / "press.py", tmp_path / "out"
    case.write_text(CASE.format(moduli))
    asked = ["loads", str(case), "--link", "rod", "--out", str(out)]
    assert main(asked) == 0
    printed = capfd.readouterr().out
    assert "format beam is left out" in printed
    assert why in printed
    assert {path.suffix for path in out.iterdir()} == {".json", ".csv", ".inp", ".nas"}
    assert main([*asked, "--format", "beam"]) == 2
    assert why in capfd.readouterr().err


def test_the_command_writes_load_cases(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    asked = ["loads", "slider_crank", "--link", "rod", "--out", "loads"]
    assert main([*asked, "--t", "0:0.08:5", "--every", "--format", "csv"]) == 0
    printed = capfd.readouterr().out
    assert "rod at t = 0.04 s, residual" in printed
    assert "wrote loads: 5 load cases in 2 files" in printed
    assert main([*asked[:3], "rood", *asked[4:]]) == 2
    assert "unknown link 'rood'" in capfd.readouterr().err
    asked = ["loads", "slider_crank", "--spectrum", "section:rod:bending@0.5", "--bearing", "A"]
    assert main([*asked, "--out", "spectra"]) == 0
    found = sorted(path.name for path in (tmp_path / "spectra").iterdir())
    assert found == ["bearings.csv", "section_rod_bending_0.5.csv"]
    assert main(["loads", "slider_crank", "--out", "none"]) == 2
    assert "expected --link, --spectrum or --bearing" in capfd.readouterr().err


BEAM = """*NODE, NSET=all
{nodes}
*ELEMENT, TYPE=B32, ELSET=rod
{elements}
*NSET, NSET=A
1
*NSET, NSET=B
{last}
*MATERIAL, NAME=m
*ELASTIC
2.1e11, 0.3
*DENSITY
{density}
*BEAM SECTION, ELSET=rod, MATERIAL=m, SECTION=RECT
0.01, 0.01
0., 1., 0.
*BOUNDARY
A, 1, 4
B, 2, 3
*STEP
*STATIC
*INCLUDE, INPUT=rod_1.inp
*CLOAD
{angular}
*NODE PRINT, NSET=all
RF
*END STEP
"""


def forces_of_nodes(folder, **texts):
    """Run a beam in CalculiX: forces of nodes by elements (nodes, 3), with those of supports."""
    (folder / "beam.inp").write_text(BEAM.format(**texts))
    command = ["ccx", "beam"]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout
    rows = (line.split() for line in (folder / "beam.dat").read_text().splitlines())
    return np.array([[float(x) for x in row[1:]] for row in rows if len(row) == 4])


@pytest.mark.skipif(not shutil.which("ccx"), reason="needs CalculiX")
def test_a_beam_in_calculix_leaves_its_supports_without_force(crank_rod, tmp_path):
    """Forces of the elements at each node are the applied loads, and nothing is left for the
    supports at A and B.
    """
    case = link_load_cases(crank_rod, "rod")[0]
    write_load_cases([case], tmp_path, ["inp"])
    count, length = 8, 2 * case.centre[0]
    x = np.linspace(0.0, length, 2 * count + 1)
    places = x[:, None] * np.eye(3)[0]
    # Masses of nodes: quadratic elements take loads that are linear along them by Simpson's rule.
    masses = np.zeros((x.size, 1))
    for k in range(0, 2 * count, 2):
        masses[k : k + 3, 0] += case.mass * np.array([1, 4, 1]) / (6 * count)
    angular = -masses * np.cross(case.alpha, places)
    triples = ((2 * k + 1, 2 * k + 2, 2 * k + 3) for k in range(count))
    texts = {
        "nodes": "\n".join(f"{k}, {at:.12g}, 0., 0." for k, at in enumerate(x, 1)),
        "elements": "\n".join(f"{a}, {a}, {b}, {c}" for a, b, c in triples),
        "last": x.size,
        "density": f"{case.mass / (length * 1e-4):.12g}",
        "angular": "\n".join(f"{k}, 2, {push[1]:.12g}" for k, push in enumerate(angular, 1)),
    }
    applied = np.array([mass * field(case, at) for mass, at in zip(masses, places, strict=True)])
    for load, node in zip(case.loads, (0, -1), strict=True):
        applied[node] += load.force
    largest = max(np.linalg.norm(load.force) for load in case.loads)
    supports = forces_of_nodes(tmp_path, **texts) - applied
    assert np.abs(supports).max() < 1e-6 * largest
    texts["angular"] = "1, 2, 0."
    supports = forces_of_nodes(tmp_path, **texts) - applied + angular
    assert np.abs(supports).max() > 1e-2 * largest

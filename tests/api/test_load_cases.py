"""Load cases of links, in equilibrium by the data that they hold and the same as sections; load
spectra, and loads of bearings.
"""

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
    bearing_loads,
    errors,
    evaluate,
    link_load_cases,
    load_case,
    write_load_cases,
    write_spectrum,
)
from lagrange_casadi.cli import main
from lagrange_casadi.motion import dwell, harmonic, move, moves, polynomial

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


@pytest.fixture(scope="module")
def engine():
    return evaluate(load_case("connecting_rod").scene, wanted=["all"], t=(0, 0.07, 141))


def rows(path):
    first, *lines = path.read_text().splitlines()
    assert first.startswith("# ")
    return [{k: float(x) for k, x in row.items()} for row in csv.DictReader(lines)]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("reaction:crankpin:fx", "N"),
        ("section:rod:bending@0.5", "N m"),
        ("stress:rod@0.25", "Pa"),
    ],
)
def test_classes_hold_the_cycles(engine, name, unit, tmp_path):
    file = tmp_path / "spectrum.csv"
    write_spectrum(engine, name, file, classes=0)
    assert file.read_text().startswith(f"# {name} [{unit}], counted over ")
    exact = rows(file)
    write_spectrum(engine, name, file, classes=20)
    classed = rows(file)
    total = sum(row["cycles"] for row in exact)
    assert sum(row["cycles"] for row in classed) == total
    widest = max(row["range"] for row in exact)
    for row in exact:
        assert row["range_low"] == row["range"] == row["range_high"]
    for row in classed:
        held = [
            one
            for one in exact
            if row["range_low"] <= one["range"] * (1 + 1e-12)
            and one["range"] <= row["range_high"] * (1 + 1e-12)
        ]
        assert held
        assert abs(row["range"] - held[0]["range"]) <= widest / 20


def test_loads_of_a_bearing_are_those_of_its_turns():
    """A disc off its axis: the load turns with it; in an arm that swings the speed is its mean."""
    m = Mechanism("disc")
    m.set_gravity(0.0, 0.0)
    disc = m.link("disc", length=0.1, mass=2.0, centre=(0.05, 0.0), inertia=0.01)
    m.revolute("O", m.ground, disc)
    turning = evaluate(Scene(m, {"O": polynomial(0, 50.0)}, t=(0, 0.1, 21)))
    found = bearing_loads(turning, "O")
    force = 2.0 * 0.05 * 50.0**2
    assert math.isclose(found.radial, force, rel_tol=1e-12)
    assert math.isclose(found.largest_radial, force, rel_tol=1e-12)
    assert math.isclose(found.speed, 50.0 * 60.0 / math.tau, rel_tol=1e-12)
    assert (found.axial, found.largest_axial) == (0.0, 0.0)
    swinging = evaluate(Scene(m, {"O": harmonic(0, 0.5, 1.0)}, t=(0, 1.0, 2001)))
    found = bearing_loads(swinging, "O", 10.0 / 3.0)
    # Four times 0.5 rad in a second.
    assert math.isclose(found.speed, 2.0 * 60.0 / math.tau, rel_tol=1e-5)
    rate = math.tau * 0.5 * np.abs(np.cos(math.tau * swinging.t))
    across = np.hypot(swinging.reaction("O").fx, swinging.reaction("O").fy)
    mean = np.sum(across ** (10 / 3) * rate) / np.sum(rate)
    assert math.isclose(found.radial, mean**0.3, rel_tol=1e-3)
    with pytest.raises(errors.DeclarationError, match="reaction of joint 'O' was not evaluated"):
        bearing_loads(
            evaluate(Scene(m, {"O": polynomial(0, 1)}, t=(0, 1, 3)), wanted=["effort"]), "O"
        )


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
            ("section:rod:twist@0.5", "unknown section force 'twist'; valid: axial, shear, bend"),
        )
    },
}  # fmt: skip


def first_of(solution):
    return link_load_cases(solution, "rod")[:1]


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_known_is_named(crank_rod, what, tmp_path):
    asked, words = REFUSED[what]
    with pytest.raises(errors.DeclarationError, match=words):
        asked(crank_rod, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_was_not_evaluated_is_named():
    scene = load_case("slider_crank").scene
    lean = evaluate(scene, wanted=["motion", "reaction:A"], t=(0, 0.08, 5))
    with pytest.raises(errors.DeclarationError, match=r"link 'rod' need reaction:B, .*\['all'\]"):
        link_load_cases(lean, "rod")
    sleigh = evaluate(load_case("sleigh").scene, wanted=["all"], t=(0, 1, 5))
    with pytest.raises(errors.DeclarationError, match="along which directions blade act"):
        link_load_cases(sleigh, "body")
    with pytest.raises(errors.DeclarationError, match="other parameters, bodies or joints"):
        link_load_cases(sleigh, "body", scene=scene)


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
    m.revolute("O", m.ground, crank)
    m.revolute("tip", crank.tip, rod)
    m.revolute("Tip", rod.tip, ram)
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


def test_the_command_writes_load_cases(here, capfd):
    asked = ["loads", "slider_crank", "--link", "rod", "--out", "loads"]
    assert main([*asked, "--t", "0:0.08:5", "--every", "--format", "csv"]) == 0
    printed = capfd.readouterr().out
    assert "rod at t = 0.04 s, residual" in printed
    assert "wrote loads: 5 load cases in 2 files" in printed
    assert main([*asked[:3], "rood", *asked[4:]]) == 2
    assert "unknown link 'rood'" in capfd.readouterr().err
    asked = ["loads", "slider_crank", "--spectrum", "section:rod:bending@0.5", "--bearing", "A"]
    assert main([*asked, "--out", "spectra"]) == 0
    found = sorted(path.name for path in (here / "spectra").iterdir())
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

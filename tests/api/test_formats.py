"""Models of other programs: the record, its JSON, and the case that is written of it."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from internals import MOVES, LawError, case_of, json_model, python
from internals import laws_parsed as parsed

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    errors,
    evaluate,
    load_case,
    read,
    save_model,
)
from lagrange_casadi.cli import main
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

ROD = {"name": "arm", "mass": 2.0, "rod": [[0, 0, 0], [0.5, 0, 0]]}
HINGE = {"name": "hinge", "kind": "revolute", "parent": "ground", "child": "arm"}
ARM = {"schema": "lagrange_casadi.model", "version": 1, "bodies": [ROD], "joints": [HINGE]}


def efforts(scene, count=5):
    start, stop = scene.span
    solution = evaluate(scene, t=(start, stop, count), wanted=["effort"])
    return np.array([solution.outputs[one] for one in solution.outputs if one.group == "effort"])


def write(folder, told, name="model.json"):
    path = Path(folder) / name
    path.write_text(told if isinstance(told, str) else json.dumps(told))
    return path


@pytest.mark.parametrize("name", ["arm6", "rrr3", "four_bar", "six_bar", "delta", "bricard"])
def test_a_case_comes_back_from_its_file(name, tmp_path):
    """Trees, loops, guides and bars, planar and in space: none of these has a load."""
    scene = load_case(name).scene
    save_model(scene, tmp_path / "model.json")
    there, back = efforts(scene), efforts(read(tmp_path / "model.json"))
    assert np.abs(back - there).max() < 1e-12 * np.abs(there).max()


def test_a_rod_keeps_its_sections(tmp_path):
    told = ARM | {"motions": {"hinge": "0.5 * sin(3 * t)"}, "gravity": [0, -9.81, 0]}
    solution = evaluate(read(write(tmp_path, told)), t=(0.0, 1.0, 7))
    angle = 0.5 * np.sin(3 * solution.t)
    rate, acceleration = 1.5 * np.cos(3 * solution.t), -4.5 * np.sin(3 * solution.t)
    effort = 2.0 * 0.5**2 / 3 * acceleration + 2.0 * 9.81 * 0.25 * np.cos(angle)
    assert np.allclose(solution.effort("hinge"), effort, rtol=1e-13, atol=1e-13)
    axial = 2.0 * 0.25 * rate**2 - 2.0 * 9.81 * np.sin(angle)
    assert np.allclose(solution.section("arm").axial[:, 0], axial, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("kind", ["spherical", "free", "universal"])
def test_turns_about_several_axes_are_counted_from_zero(kind, tmp_path):
    """At the start the body is turned about each axis: three turns have no difference."""
    m = SpatialMechanism("turned")
    body = m.link(
        "body", length=0.4, mass=2.0, centre=(0.2, 0.01, 0.02), inertia=(0.02, 0.03, 0.04)
    )
    axes = {"axis": (0, 0, 1), "second": (0, 1, 0)} if kind == "universal" else {}
    getattr(m, kind)("joint", m.ground, body, **axes)
    laws = {
        name: harmonic(0.1 + 0.2 * k, 0.3, 0.7, 0.3 * k) for k, name in enumerate(m.coordinates)
    }
    scene = Scene(m, laws, t=(0.0, 1.0, 5))
    save_model(scene, tmp_path / "model.json")
    there, back = efforts(scene), efforts(read(tmp_path / "model.json"))
    assert np.abs(back - there).max() < 1e-12 * np.abs(there).max()
    told = json.loads((tmp_path / "model.json").read_text())
    name, _ = told["motions"].popitem()  # which then rests where it is at the start
    start = float(evaluate(scene, t=(0.0, 0.0, 1)).motion(name).value[0])
    there = efforts(Scene(m, laws | {name: polynomial(start)}, t=(0.0, 1.0, 5)))
    back = efforts(read(write(tmp_path, told)))
    assert np.abs(back - there).max() < 1e-12 * np.abs(there).max()


def test_the_legs_of_a_platform_move_as_they_did(tmp_path):
    """The platform's pose has six motions, and is turned about all axes at the start."""
    scene = load_case("stewart_gough").scene
    save_model(scene, tmp_path / "model.json")
    there, back = (
        evaluate(one, t=(*scene.span, 3), wanted=["motion"])
        for one in (scene, read(tmp_path / "model.json"))
    )
    for leg in ("P0", "P3"):
        rate = there.motion(leg).rate
        assert np.abs(back.motion(leg).rate - rate).max() < 1e-12 * np.abs(rate).max()


def test_what_new_writes_gives_the_numbers_of_read(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["export", "stewart_gough", "--model", "legs.json"]) == 0
    assert main(["new", "legs", "--from", "legs.json"]) == 0
    assert "Loads are not exported: tool, twist." in capfd.readouterr().out
    text = (tmp_path / "legs" / "case.py").read_text()
    assert 'mass_piston0 = m.parameter("mass_piston0", 0.7, "kg", low=0.0)' in text
    assert max(map(len, text.splitlines())) <= 100
    again = efforts(load_case("legs").scene)
    assert np.array_equal(again, efforts(read("legs.json")))
    assert main(["new", "legs", "--from", "legs.json"]) == 2
    assert main(["new", "other", "--from", "legs.json", "--like", "arm"]) == 2
    assert main(["export", "arm6"]) == 2
    assert capfd.readouterr().err.splitlines() == [
        "error: legs exists: expected a new folder",
        "error: --like and --from exclude each other",
        "error: Missing option '--out' or '--model'.",
    ]


def test_what_rests_is_said(tmp_path):
    text = case_of(write(tmp_path, ARM))
    assert "# The file gives no motion of hinge: here it rests." in text
    assert '"hinge": polynomial(0.0)' in text


def test_the_schema_has_the_words_of_the_reader():
    schema = json.loads(Path("docs/model.schema.json").read_text())
    assert tuple(schema["properties"]) == json_model.TOP
    parts = {"body": json_model.BODY, "joint": json_model.JOINT}
    parts |= {"coupling": json_model.COUPLING, "frame": json_model.FRAME}
    for part, words in parts.items():
        assert tuple(schema["$defs"][part]["properties"]) == words
    assert set(schema["$defs"]["joint"]["properties"]["kind"]["enum"]) == set(MOVES)


def changed(**change):
    return ARM | change


MISUSE = {
    "no JSON": ("{", "no JSON"),
    "another schema": (changed(version=2), 'expected "schema": "lagrange_casadi.model", "version"'),
    "unknown key": (changed(links=[]), "unknown key 'links'; valid: schema, version"),
    "no joints": ({k: v for k, v in ARM.items() if k != "joints"}, "lacks 'joints'"),
    "no inertia": (
        changed(bodies=[{"name": "arm", "mass": 2.0}]),
        "bodies[0]: body 'arm' has a mass of 2 kg and no inertia",
    ),
    "no mass": (
        changed(bodies=[ROD | {"mass": 0}]),
        "no body that moves has a mass: give the bodies masses",
    ),
    "the ground": (changed(bodies=[ROD | {"name": "ground"}]), "body 'ground': the name is taken"),
    "negative mass": (changed(bodies=[ROD | {"mass": -2}]), "a mass of -2 kg is impossible"),
    "impossible inertia": (
        changed(bodies=[{"name": "arm", "mass": 2.0, "inertia": [1, 1, 3]}]),
        "body 'arm' (1, 1, 3 kg m^2, of which the last is too large by 1); correct them, or take",
    ),
    "gigantic": (
        changed(bodies=[ROD | {"mass": 1e300}]),
        "expected a finite number of at most 1e+12",
    ),
    "not a number": (changed(bodies=[ROD | {"mass": "2_0"}]), "at most 1e+12, got '2_0'"),
    "NaN": (json.dumps(changed(gravity=[0, 0, float("nan")])), "expected a finite number"),
    "short rod": (
        changed(bodies=[ROD, {"name": "far", "mass": 1, "rod": [[0, 0, 0], [1e12, 0, 0]]}])
        | {"joints": [HINGE, HINGE | {"name": "second", "child": "far"}]},
        "body 'arm': a rod of 0.5 m in a mechanism of 5e+11 m; expected at least 1e-09 of it",
    ),
    "unknown joint": (
        changed(joints=[HINGE | {"kind": "hinge"}]),
        "unknown kind 'hinge'; valid: rev",
    ),
    "no kind": (changed(joints=[HINGE | {"kind": ["weld"]}]), "unknown kind ['weld']; valid: rev"),
    "unknown body": (
        changed(joints=[HINGE | {"child": "leg"}]),
        "unknown body 'leg'; valid: ground",
    ),
    "to itself": (
        changed(joints=[HINGE | {"parent": "arm"}]),
        "joint 'hinge' joins 'arm' to itself",
    ),
    "disconnected": (
        changed(bodies=[ROD, ROD | {"name": "leg"}]),
        "bodies[1]: body 'leg' is not connected to the ground",
    ),
    "twice": (changed(bodies=[ROD, ROD]), "bodies[1]: body 'arm': the name is taken"),
    "skew axes": (
        changed(bodies=[ROD | {"axes": [[1, 0, 0], [1, 1, 0], [0, 0, 1]]}]),
        "bodies[0].axes: axes: expected three directions at right angles",
    ),
    "left-handed": (
        changed(bodies=[ROD | {"axes": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}]),
        "bodies[0].axes: axes: expected three directions at right angles, right-handed",
    ),
    "unknown motion": (changed(motions={"knee": "t"}), "unknown coordinate 'knee'; valid: hinge"),
    "unknown posture": (
        changed(posture={"knee": 1}),
        "posture: unknown coordinate 'knee'; valid: hinge",
    ),
    "coupled twist": (
        changed(
            joints=[HINGE | {"kind": "planar"}],
            couplings=[{"name": "gear", "first": "hinge:turn", "second": "hinge:turn", "ratio": 2}],
        ),
        "couplings[0]: unknown coordinate 'hinge:turn'; valid: none",
    ),
    "point of words": (
        changed(bodies=[ROD | {"point": "yes"}]),
        "bodies[0].point: expected true or false, got 'yes'",
    ),
    "code": (
        changed(motions={"hinge": "__import__('os')"}),
        "motion of 'hinge': '__import__('os')' is not supported; valid: numbers, pi, t",
    ),
}


OF_SHAPE = ("another schema", "unknown key", "no joints", "negative mass", "not a number")
OF_SHAPE = (*OF_SHAPE, "unknown joint", "no kind")


def test_the_schema_accepts_what_the_reader_does(tmp_path):
    """And refuses what is wrong in its shape; what no mechanism is, the reader alone sees."""
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schema = json.loads(Path("docs/model.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema).is_valid
    save_model(load_case("delta").scene, tmp_path / "model.json")
    assert valid(json.loads((tmp_path / "model.json").read_text()))
    assert valid(ARM)
    assert [what for what in OF_SHAPE if valid(MISUSE[what][0])] == []


@pytest.mark.parametrize("what", MISUSE)
def test_misuse_is_one_line_that_names_the_element(what, tmp_path):
    told, words = MISUSE[what]
    with pytest.raises(errors.ModelFileError, match=re.escape(words.replace("\\", ""))) as error:
        read(write(tmp_path, told))
    assert str(error.value).startswith("model.json: ")


def test_names_and_notes_of_a_file_are_no_code(tmp_path):
    end = '"""\nimport os\n# \u2028 \\'
    told = ARM | {"name": "a", "notes": [end], "bodies": [ROD | {"name": end}]}
    told |= {"joints": [HINGE | {"child": "b_" + re.sub(r"\W", "_", end.strip())}]}
    text = case_of(write(tmp_path, told))
    assert "\nimport os" not in text
    assert len(re.findall("import os", text)) == 2  # in comments
    read(write(tmp_path, told))


def test_parts_are_named_as_the_file_names_them(tmp_path):
    told = changed(
        bodies=[ROD | {"name": "upper arm"}],
        joints=[HINGE | {"name": "hinge 1", "child": "upper arm"}],
        motions={"hinge 1": "2 * t"},
    )
    scene = read(write(tmp_path, told, "my arm.json"))
    assert scene.mechanism.name == "my_arm"
    assert list(scene.motion) == ["hinge_1"]


@pytest.mark.parametrize(
    ("told", "written"),
    [
        ("2.0d*pi*time", "polynomial(0.0, 2 * pi)"),
        ("3", "polynomial(3.0)"),
        ("(1 + t)^2/2", "polynomial(0.5, 1.0, 0.5)"),
        ("0.2 * sin(3*t)", "expression(lambda t: 0.2 * ca.sin(3 * t))"),
        ("t/(1 + t)", "expression(lambda t: t / (1 + t))"),
    ],
)
def test_laws(told, written):
    assert str(python(told)) == written


NO_LAWS = ["", "x", "t.real", "lambda: 1", "[t]", "sin", "sin(t, t)", "1e400 * t", "9" * 400]
NO_LAWS += ["t" * 9, "(" * 500 + "t" + ")" * 500, "-" * 20000 + "t", "t if t else 1", "'t'", "f(t)"]


@pytest.mark.parametrize("told", NO_LAWS, ids=range(len(NO_LAWS)))
def test_no_laws(told):
    with pytest.raises(LawError):
        parsed(told)


def test_files_that_are_none(tmp_path):
    with pytest.raises(errors.PathError, match="No such file"):
        read(tmp_path / "none.json")
    (tmp_path / "folder.json").mkdir()
    with pytest.raises(errors.PathError, match="not a file"):
        read(tmp_path / "folder.json")
    with pytest.raises(errors.ModelFileError, match=r"unknown format '.step'; valid: .json"):
        read(tmp_path / "part.step")
    with pytest.raises(errors.ModelFileError, match=r"first: xacro arm.urdf.xacro > arm.urdf"):
        read(tmp_path / "arm.urdf.xacro")
    (tmp_path / "latin.json").write_bytes(b"\xff\xfe\xfa")
    with pytest.raises(errors.ModelFileError, match="no text in UTF-8"):
        read(tmp_path / "latin.json")


@pytest.mark.parametrize("plane", ["four_bar", "slider_crank"])
def test_forces_in_the_plane_are_those_of_space(plane, tmp_path):
    """What a plane leaves out is open in space; what it has is the same."""
    scene = load_case(plane).scene
    save_model(scene, tmp_path / "model.json")
    scenes = (scene, read(tmp_path / "model.json"))
    one, other = (evaluate(each, t=(*scene.span, 5)) for each in scenes)
    for joint in one.description["joints"]:
        there, back = one.reaction(joint), other.reaction(joint)
        assert np.abs(back.fx - there.fx).max() < 1e-10 * max(np.abs(there.fx).max(), 1.0)
        assert np.abs(back.fy - there.fy).max() < 1e-10 * max(np.abs(there.fy).max(), 1.0)


def test_links_that_meet_at_a_point_mass_come_back(tmp_path):
    """Pins at a mass have no angle: none is looked for that a file should move."""
    m = Mechanism("knuckle")
    crank, rod, rocker = (
        m.link(name, length=length, mass=1.0)
        for name, length in (("crank", 0.1), ("rod", 0.3), ("rocker", 0.25))
    )
    pin = m.point_mass("pin", 0.4)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, pin)
    m.revolute("C", rocker.tip, pin)
    m.revolute("D", m.ground.at(0.3, 0.0), rocker)
    scene = Scene(m, {"O": polynomial(0.3, 2.0)}, posture={"rod": 0.8, "rocker": 1.7})
    save_model(scene, tmp_path / "model.json")
    there, back = efforts(scene), efforts(read(tmp_path / "model.json"))
    assert np.abs(back - there).max() < 1e-12 * np.abs(there).max()


def test_a_scene_of_one_instant_comes_back(tmp_path):
    m = Mechanism("still")
    arm = m.link("arm", length=0.5, mass=2.0)
    m.revolute("hinge", m.ground, arm)
    save_model(Scene(m, {"hinge": polynomial(0.3)}, t=(0.5, 0.5, 1)), tmp_path / "model.json")
    scene = read(tmp_path / "model.json")
    assert scene.t == (0.5, 0.5, 1)
    assert evaluate(scene).effort("hinge") == pytest.approx(2.0 * 9.81 * 0.25 * np.cos(0.3))

"""Scenes: only what is wanted is derived; postures choose how loops are closed; what is refused."""

import ast
import math
import pickle
import re
from dataclasses import replace

import numpy as np
import pytest
from mechanisms import four_bar, pins_of, slider_crank

from lagrange_casadi import Mechanism, Scene, derive, evaluate, export, load_case, refine, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import (
    AssemblyError,
    DeclarationError,
    ParameterError,
    PostureError,
    UnknownNameError,
)
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize(
    ("wanted", "expected", "same"),
    [
        (["effort"], {"effort"}, ["effort"]),
        (["motion"], {"motion", "pose"}, ["motion"]),
        (["reaction:guide"], {"reaction"}, ["reaction:guide"]),
        (["section"], {"section"}, ["section:rod", "section:crank"]),
        (
            ["effort", "reaction"],
            {"effort", "reaction"},
            ["reaction:O", "reaction:A", "effort", "reaction:B", "reaction:guide"],
        ),
        (["section:rod", "effort"], {"section", "effort"}, ["effort", "section:rod"]),
    ],
)
def test_a_graph_holds_what_is_wanted_whatever_the_order(wanted, expected, same):
    """A kind alone is all of that kind."""
    program = derive(slider_crank(), wanted)
    names = (name for name in program.names if not name.startswith("_"))
    assert {name.split(":")[0] for name in names} == expected
    assert program.columns == derive(slider_crank(), same).columns


VALID = "valid: all, effort, motion, reaction:O, reaction:A, reaction:B, reaction:guide,"


@pytest.mark.parametrize(
    ("keywords", "says"),
    [
        ({"wanted": ["torque"]}, f"'torque'; {VALID} section:crank, section:rod, sensitivity:r"),
        ({"wanted": ["sections"]}, r"unknown output 'sections' \(did you mean 'section'\?\)"),
        ({"wanted": ["section:slider"]}, "'slider' is not a link and has no sections; links: cran"),
        ({"wanted": ["effort", "load"]}, f"'load': not an output of mechanism .*; {VALID}"),
        ({"wanted": ["safety"]}, "not an output of .*, because no link has a beam=; valid: all"),
        ({"wanted": []}, "no output wanted"),
        ({"posture": {"O": 90}}, r"posture of 'O': 90 rad is 5156\.62 deg, more than two turns"),
        (
            {"motion": {"X": polynomial(0)}},
            "unknown joint, path or body in motion 'X'; valid: O, A, guide, crank",
        ),
        ({"motion": {"B": polynomial(0)}}, "joint 'B' cannot be driven"),
        ({"motion": {"O": 3.0}}, "motion of joint 'O': expected a law"),
        (
            {"posture": {"stick": 1.0}},
            "unknown link or joint in posture 'stick'; valid: crank, rod, O, A, guide",
        ),
        ({"t": (0, 1, 0)}, "t: COUNT must be a whole number from 1 to 2\\^63 - 1, got 0"),
        ({"t": (0, 1, 1)}, "t: COUNT must be 2 or more to reach from 0 to 1, got 1"),
        ({"xi": (0, 1, 1)}, "xi: COUNT must be 2 or more to reach from 0 to 1, got 1"),
        ({"t": (0, 1, 1.5)}, "t: COUNT must be a whole number"),
        ({"t": (1, 0, 5)}, "t: STOP must be after START"),
        ({"t": (0, float("nan"), 5)}, "t: START and STOP must be finite"),
        ({"t": (-1e308, 1e308, 5)}, "t: START and STOP are too far apart"),
        ({"t": (0, 1)}, "t: expected"),
        ({"xi": (0, 1.5, 5)}, r"xi: ratios xi/l must lie in \[0, 1\], got 0 to 1.5"),
        ({"xi": (-0.1, 1, 5)}, r"xi: ratios"),
    ],
)
def test_misuse_is_named(keywords, says):
    base = slider_crank()
    with pytest.raises(DeclarationError, match=says):
        Scene(base.mechanism, **({"motion": base.motion, "posture": {"rod": 0.0}} | keywords))


def moved(scene, **changes):
    """A scene at its start."""
    at = replace(scene, t=(scene.t[0], scene.t[0], 1), wanted=("motion",), **changes)
    return evaluate(at)


def same(one, other):
    """Two solutions have their links at the same places; a turn more or less is none."""
    for name in one.description.bodies:
        a, b = one.pose(name), other.pose(name)
        turn = 0.0 if a.angle is None else math.remainder(a.angle[0] - b.angle[0], math.tau)
        if max(abs(a.x[0] - b.x[0]), abs(a.y[0] - b.y[0]), abs(turn)) > 1e-9:
            return False
    return True


def pasted(text):
    """The postures that a text has."""
    return [ast.literal_eval(posture) for posture in re.findall(r"posture=(\{[^}]*\})", text)]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("joint", ["A", "B", "C"])
@pytest.mark.parametrize("rocker", [1.5, -1.5])
def test_a_joints_coordinate_chooses_the_branch(joint, rocker):
    """Any joint of the loop: on the tree, closing it, at the ground; rough to 20 degrees, and in
    degrees.
    """
    scene = four_bar(rocker=rocker)
    solution = moved(scene)
    told = float(solution.motion(joint).value[0])
    for rough in (told + 0.35, told - 0.35, told + math.tau, f"{math.degrees(told):.1f} deg"):
        assert same(moved(scene, posture={joint: rough}), solution)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "case", ["four_bar", "six_bar", "andrews_squeezer", "quick_return", "slider_crank", "engine"]
)
def test_what_is_open_is_told_at_once_in_lines_to_paste(case):
    """It can be sent to another process."""
    scene = load_case(case).scene
    with pytest.raises(PostureError) as error:
        moved(scene, posture={})
    assert "\n" not in str(error.value)
    found = [moved(scene, posture=posture) for posture in pasted(str(error.value))]
    assert len(found) == (2 if len(error.value.assembly_modes) == 1 else 1)
    assert len(found) == 1 or not same(*found)
    told = pickle.loads(pickle.dumps(error.value))
    assert str(told) == str(error.value)
    assert (told.assembly_modes, told.lacking) == (error.value.assembly_modes, False)


OPEN_POSTURES = {
    "all loops, though the first way of one closes no other": (
        "andrews_squeezer", {}, r"'P3' can be .*'P4' can be .*'P6' can be", [{"k2", "k4", "k6"}],
    ),
    "what iterations need": (
        "rrr3", {},
        r"joint 'foot1', joint 'foot2' have no closed form; .* of lower0, lower1, lower2, platf",
        [{"lower0", "lower1", "lower2", "platform"}],
    ),
    "the rest": (
        "six_bar", {"rocker": "94 deg"}, "^(?!.*joint 'B')", [{"swing"}, {"swing"}],
    ),
    "no rounding": ("screw_lift", {}, r"or posture=\{'thread': '0 deg'\}", [{"thread"}] * 2),
}  # fmt: skip


@pytest.mark.parametrize("what", OPEN_POSTURES)
def test_what_a_posture_leaves_open(what):
    case, posture, says, names = OPEN_POSTURES[what]
    with pytest.raises(PostureError, match=says) as error:
        moved(load_case(case).scene, posture=posture)
    assert [set(one) for one in pasted(str(error.value))] == names


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("case", "many"), [("four_bar", 2), ("six_bar", 4), ("andrews_squeezer", 4), ("excavator", 16)]
)
def test_the_command_line_draws_the_ways_to_assemble(here, capfd, case, many):
    """Each is told with its posture, they differ, and ways that can be built come first."""
    assert main(["new", "own", "--like", case]) == 0
    text = (here / "own" / "case.py").read_text()
    text = re.sub(r"posture=(\{[^}]*\}( \| .*\})?|\w+)", "posture={}", text)
    (here / "own" / "case.py").write_text(text)
    (here / "results").mkdir()
    capfd.readouterr()
    assert main(["run", "own/case.py", "--out", "results/run.h5"]) == 2
    error = capfd.readouterr().err
    says = rf"results/own_postures.png draws the {many} of these"
    assert re.match(rf"error: the loops? closed by .* can be assembled in .*; {says}", error)
    assert [path.name for path in (here / "results").iterdir()] == ["own_postures.png"]
    assert (here / "results" / "own_postures.png").read_bytes()[:4] == b"\x89PNG"
    listed = error.split("\n", 1)[1] or error
    scene = load_case(case).scene
    ways = [moved(scene, posture=posture) for posture in pasted(listed)]
    assert len(ways) == many
    assert not any(same(one, other) for k, one in enumerate(ways) for other in ways[:k])
    if case == "excavator":
        names = [f"motion:{name}_cylinder" for name in ("boom", "stick", "bucket")]
        built = [all(way.array(name)[0] > 0.0 for name in names) for way in ways]
        assert built == sorted(built, reverse=True)


SHORT, LONG = (0.1, 0.05, 0.05), (0.1, 0.35, 0.25)


VALUES = dict(zip("pqr", LONG, strict=True))


def reaching(lengths, rocker=1.5, **more):
    """A four-bar whose links reach or do not reach each other."""
    m = Mechanism("four_bar")
    each = zip("pqr", lengths, strict=True)
    sides = [m.parameter(name, size, "m", low=0.0) for name, size in each]
    a, b, c = (m.link(name, length=l, mass=0.4) for name, l in zip("abc", sides, strict=True))
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, c.tip), C=(m.ground.at(0.3, 0.05), c))
    return Scene(m, {"O": polynomial(0.2, 6.0)}, posture={"c": rocker}, t=(0.0, 1.0, 101), **more)


def assert_equal(one, other):
    assert set(one.series) == set(other.series)
    for name, values in one.series.items():
        np.testing.assert_array_equal(values, other.series[name], err_msg=name)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("rocker", [1.5, -1.5])
@pytest.mark.parametrize(
    "options", [{}, {"backend": "vm"}, {"precision": "single"}, {"table": 64}], ids=str
)
def test_what_can_be_assembled_is_evaluated(options, rocker):
    """To the last bit as if these values were the defaults, in the branch of the posture, one
    design after another.
    """
    scene = reaching(SHORT, rocker)
    for q in (0.35, 0.3, 0.35):
        found = evaluate(scene, parameters=VALUES | {"q": q}, **options)
        assert_equal(found, evaluate(reaching((0.1, q, 0.25), rocker), **options))
        assert np.sign(np.sin(found.pose("c").angle[0])) == np.sign(rocker)


def test_a_scene_may_say_itself_with_what_it_is_assembled():
    scene = reaching(SHORT, assembly=VALUES)
    derive(scene)
    assert_equal(evaluate(scene, parameters=VALUES), evaluate(reaching(LONG)))
    with pytest.raises(AssemblyError, match="cannot be closed at t = 0 s"):
        evaluate(scene)
    for assembly, error in (
        ({"z": 1.0}, UnknownNameError),
        ({"p": -1.0}, ParameterError),
        ({"p": "x"}, ParameterError),
        (3, DeclarationError),
    ):
        with pytest.raises(error):
            reaching(LONG, assembly=assembly)


def test_everything_else_begins_with_values_that_can_be_assembled(tmp_path):
    """Sweeps with their first such design, peaks, and exported C."""
    axes = {"q": (0.05, 0.35, 4), "r": [0.25, 0.3]}
    one, other = (sweep(reaching(sides), axes, wanted=["effort"]) for sides in (SHORT, LONG))
    np.testing.assert_array_equal(one["peak:effort:O"], other["peak:effort:O"])
    np.testing.assert_array_equal(one["status"], other["status"])
    assert one["status"].min() == 0 < one["status"].max()
    with pytest.raises(AssemblyError, match="with the default parameters"):
        sweep(reaching(SHORT), {"q": (0.01, 0.05, 4)}, wanted=["effort"])
    scenes, names = (reaching(SHORT), reaching(LONG)), ["effort:O", "section:b:bending"]
    peaks = [refine(each, evaluate(each, parameters=VALUES), names) for each in scenes]
    assert peaks[0] == peaks[1]
    export(scenes[0], tmp_path / "one", parameters=VALUES)
    export(scenes[1], tmp_path / "other")
    digest = r"[0-9a-f]{32}|0x[0-9a-f]{8}u"  # of the scene
    for file in ("four_bar.h", "four_bar.c", "selftest.c"):
        texts = {re.sub(digest, "", path.read_text()) for path in tmp_path.glob(f"*/{file}")}
        assert len(texts) == 1
    with pytest.raises(AssemblyError, match="with the default parameters"):
        export(scenes[0], tmp_path / "none")

"""Postures: by directions or by joints' coordinates, and what they leave open told at once, in
lines that work when pasted.
"""

import ast
import math
import pickle
import re
from dataclasses import replace

import pytest
from internals import assemblies, draw_postures
from matplotlib.figure import Figure
from mechanisms import four_bar

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import AssemblyError, DeclarationError, PostureError, UnknownNameError
from lagrange_casadi.motion import polynomial

CLOSED = ["four_bar", "six_bar", "andrews_squeezer", "quick_return", "slider_crank", "engine"]


def moved(scene, **changes):
    """The poses of all links at the start, by name; a turn more or less is none."""
    solution = evaluate(
        replace(scene, t=(scene.t[0], scene.t[0], 1), wanted=("motion",), **changes), backend="vm"
    )
    return {name: solution.pose(name) for name in scene.mechanism.links}, solution


def same(first, second):
    return all(
        abs(first[name].x - second[name].x) < 1e-9
        and abs(first[name].y - second[name].y) < 1e-9
        and abs(math.remainder(float(first[name].angle[0] - second[name].angle[0]), math.tau))
        < 1e-9
        for name in first
    )


def pasted(error):
    """The postures of the lines that an error has."""
    return [ast.literal_eval(text) for text in re.findall(r"posture=(\{[^}]*\})", str(error))]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("joint", ["A", "B", "C"])
@pytest.mark.parametrize("rocker", [1.5, -1.5])
def test_a_joints_coordinate_chooses_the_branch(joint, rocker):
    """Any joint of the loop: on the tree, closing it, at the ground; rough to 20 degrees, and in
    degrees.
    """
    scene = four_bar(rocker=rocker)
    poses, solution = moved(scene)
    told = float(solution.motion(joint).value[0])
    for rough in (told + 0.35, told - 0.35, told + math.tau, f"{math.degrees(told):.1f} deg"):
        assert same(moved(scene, posture={joint: rough})[0], poses)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", ["six_bar", "andrews_squeezer", "rrr3", "engine", "quick_return"])
def test_all_joints_serve_as_well_as_directions(case):
    """Loops that are iterated get the directions of their links from the joints' coordinates, one
    after another.
    """
    scene = load_case(case).scene
    poses, solution = moved(scene)
    joints = {name: joint for name, joint in scene.mechanism.joints.items() if joint.coordinate}
    posture = {}
    for k, (name, joint) in enumerate(joints.items()):
        value = float(solution.motion(name).value[0])
        posture[name] = (
            value if joint.slides else math.remainder(value, math.tau) + 0.03 * (-1) ** k
        )
    assert same(moved(scene, posture=posture)[0], poses)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", CLOSED)
def test_what_is_open_is_told_at_once_in_lines_to_paste(case):
    scene = load_case(case).scene
    with pytest.raises(PostureError) as error:
        moved(scene, posture={})
    lines = pasted(error.value)
    assert lines
    assert "\n" not in str(error.value)
    found = [moved(scene, posture=line)[0] for line in lines]
    assert len(lines) == (2 if len(error.value.assembly_modes) == 1 else 1)
    if len(found) == 2:
        assert not same(*found)


def test_all_loops_are_told_where_the_first_way_of_one_closes_no_other():
    """Andrews' squeezer closes in one way of its first loop only; all three loops are told for that
    one.
    """
    scene = load_case("andrews_squeezer").scene
    with pytest.raises(PostureError, match=r"'P3' can be .*'P4' can be .*'P6' can be") as error:
        moved(scene, posture={})
    (posture,) = pasted(error.value)
    assert set(posture) == {"k2", "k4", "k6"}
    assert evaluate(replace(scene, posture={**posture, "k4": 1.58, "k5": -0.52})).certified


def test_what_no_way_closes_cannot_be_assembled():
    m = load_case("quick_return").scene
    with pytest.raises(AssemblyError, match="cannot be closed at the start"):
        evaluate(replace(m, posture={}, assembly={"r": 5.0}), parameters={"r": 5.0})


def test_names_that_iterations_need_are_told_at_once():
    scene = load_case("rrr3").scene
    says = (
        r"the loops closed by joint 'foot1', joint 'foot2' have no closed form; also give a rough"
        r" posture of lower0, lower1, lower2, platform; posture=\{'lower0': '\.\.\. deg',"
        r" .*'platform': '\.\.\. deg'\}$"
    )
    with pytest.raises(PostureError, match=says) as error:
        evaluate(replace(scene, posture={}))
    assert (error.value.assembly_modes, error.value.lacking) == ((), True)


def test_a_part_of_a_posture_leaves_the_rest_open():
    scene = load_case("six_bar").scene
    with pytest.raises(PostureError) as error:
        moved(scene, posture={"rocker": "94 deg"})
    assert [set(line) for line in pasted(error.value)] == [{"swing"}, {"swing"}]
    assert "joint 'B'" not in str(error.value)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("case", "many"),
    [("four_bar", 2), ("six_bar", 4), ("andrews_squeezer", 4), ("quick_return", 2)],
)
def test_all_ways_are_there_and_differ(case, many):
    scene = replace(load_case(case).scene, posture={})
    found, possible = assemblies(scene)
    assert len(found) == many <= possible
    for entries, solution in found:
        posture = ast.literal_eval(f"{{{entries}}}")
        own = {name: solution.pose(name) for name in scene.mechanism.links}
        assert same(moved(scene, posture=posture)[0], own)
        others = [other for text, other in found if text != entries]
        assert not any(same({name: other.pose(name) for name in own}, own) for other in others)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "command", [["run", "own"], ["info", "own"], ["export", "own", "--out", "c"], ["trade", "own"]]
)
def test_the_command_line_draws_the_ways(here, capfd, command):
    assert main(["new", "own", "--like", "four_bar"]) == 0
    text = (here / "own" / "case.py").read_text()
    (here / "own" / "case.py").write_text(text.replace(', posture={"rocker": 1.5}', ""))
    capfd.readouterr()
    assert main(command) == 2
    err = capfd.readouterr().err
    assert err.startswith("error: the loop closed by joint 'B' can be assembled in two ways")
    assert err.endswith(
        "; own_postures.png draws the 2 of these that close all loops, each with its posture\n"
    )
    assert err.count("\n") == 1
    assert sorted(path.name for path in here.iterdir()) == ["own", "own_postures.png"]
    assert (here / "own_postures.png").read_bytes()[:4] == b"\x89PNG"


def test_the_picture_is_named_by_the_case_and_lies_beside_the_results(here, capfd):
    """Ways that can be built come first: those without a negative length of a cylinder."""
    assert main(["new", "digger", "--like", "excavator"]) == 0
    text = (here / "digger" / "case.py").read_text()
    (here / "digger" / "case.py").write_text(re.sub(r"posture=.*", "posture={},", text))
    (here / "results").mkdir()
    capfd.readouterr()
    assert main(["run", "digger/case.py", "--out", "results/run.h5"]) == 2
    assert [path.name for path in (here / "results").iterdir()] == ["digger_postures.png"]
    error, *lines = capfd.readouterr().err.splitlines()
    assert "; results/digger_postures.png draws the 16 of these" in error
    scene = load_case("excavator").scene
    postures = [ast.literal_eval(line.partition("posture=")[2]) for line in lines]
    lengths = [
        [solution.array(f"motion:{name}_cylinder")[0] for name in ("boom", "stick", "bucket")]
        for _, solution in (moved(scene, posture=posture) for posture in postures[:3])
    ]
    assert [all(length > 0.0 for length in one) for one in lengths] == [True, True, False]


def test_where_nothing_can_be_drawn_there_is_no_file(here, capfd):
    assert main(["new", "own", "--like", "rrr3"]) == 0
    text = (here / "own" / "case.py").read_text()
    (here / "own" / "case.py").write_text(re.sub(r"posture=\w+", "posture={}", text))
    capfd.readouterr()
    assert main(["run", "own"]) == 2
    assert "draws" not in capfd.readouterr().err
    assert [path.name for path in here.iterdir()] == ["own"]


def double_slider(lengths=(0.3, 0.34)):
    """A crank that moves sliders along the line about which it turns: each closes a loop in four
    ways.
    """
    m = SpatialMechanism("double_slider")
    crank = m.link("crank", length=0.08, mass=0.1)
    turned = ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    m.revolute("A", m.ground.at(0.0, 0.1, 0.12), crank, axis=(1.0, 0.0, 0.0), turned=turned)
    for k, length in enumerate(lengths):
        rod = m.link(f"rod_{k}", length=length, mass=0.5)
        slider = m.link(f"slider_{k}", length=0.05, mass=2.0)
        m.spherical(f"ball_{k}", crank.tip, rod)
        axes = {"axis": (1.0, 0.0, 0.0), "second": (0.0, 1.0, 0.0)}
        m.universal(f"cross_{k}", slider, rod.tip, **axes)
        m.prismatic(f"guide_{k}", m.ground.at(0, 0.02 * k, 0.05 * k), slider, axis=(1, 0, 0))
    return Scene(m, {"A": polynomial(0.0, 6.0)}, t=(0.0, 1.0, 3))


def test_two_loops_with_sixteen_ways_are_drawn_whole(monkeypatch):
    """Each way has a number and its posture, in the table's order; ways that look the same share a
    picture; no title is cut, and no two of them overlap.
    """
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    postures, complete = draw_postures(double_slider(), None)
    (figure,) = figures
    assert (len(set(postures)), complete) == (16, True)
    chosen = [ast.literal_eval(posture.removeprefix("posture=")) for posture in postures]
    signs = [tuple(float(value.split()[0]) for value in one.values()) for one in chosen]
    one, other = 48.1897, 131.81
    assert sorted({first for first, _ in signs}) == [-other, -one, one, other]
    assert sorted({second for _, second in signs}) == [-150.0, -30.0, 30.0, 150.0]
    table = [text.get_text() for text in figure.texts]
    written = [" ".join(text.split()) for text in table if text.startswith("posture")]
    assert written == postures
    assert [text for text in table if text.isdigit()] == [str(k) for k in range(1, 17)]
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    # Ways with fewer slides at negative coordinates come first.
    assert titles == ["1, 2, 3, 4", "5, 6, 9, 10", "7, 8, 11, 12", "13, 14, 15, 16"]
    figure.draw_without_rendering()
    words = [*figure.texts, *(axes._left_title for axes in figure.axes)]
    boxes = [text.get_window_extent() for text in words]
    for k, box in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1
        assert not any(box.overlaps(after) for after in boxes[:k])
    # The last of them, which was not drawn before, is assembled by what is pasted.
    scene = replace(double_slider(), posture=chosen[-1])
    assert evaluate(replace(scene, wanted=("motion",)), backend="vm").certified


def test_of_more_ways_some_are_drawn_and_it_is_said_how_to_get_the_others(monkeypatch):
    """Sixty-four combinations; what is drawn differs in the first loop, and a part of a posture
    leads to the others.
    """
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    postures, complete = draw_postures(double_slider((0.3, 0.34, 0.38)), None)
    firsts = {posture.partition(",")[0] for posture in postures}
    assert (len(postures), len(firsts), complete) == (4, 4, False)
    words = "\n".join(text.get_text() for text in figures[0].texts)
    assert "4 of at most 64 ways to assemble it" in words
    assert "To see the others, put the first entry of a row" in words


def test_rounding_is_never_proposed():
    scene = replace(load_case("screw_lift").scene, posture={})
    with pytest.raises(PostureError, match=r"or posture=\{'thread': '0 deg'\}") as error:
        moved(scene)
    assert error.value.assembly_modes[0][1] == {"thread": 0.0}


def test_what_a_posture_may_tell():
    scene = four_bar()
    with pytest.raises(
        UnknownNameError, match="unknown link or joint in posture 'D'; valid: a, b, c, O, A, B, C"
    ):
        replace(scene, posture={"D": 1.0})
    with pytest.raises(
        DeclarationError, match=r"posture of 'B': 90 rad is 5156\.62 deg, more than two turns"
    ):
        replace(scene, posture={"B": 90})


def test_the_error_can_be_sent_to_another_process():
    with pytest.raises(PostureError) as error:
        evaluate(replace(four_bar(), posture={}))
    told = pickle.loads(pickle.dumps(error.value))
    assert (str(told), told.assembly_modes, told.lacking) == (
        str(error.value),
        error.value.assembly_modes,
        False,
    )

"""Model files that are large, damaged or hostile: each is read in a time that grows as the file
does, or refused in one line.
"""

import ast
import gc
import math
import random
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from drawn_models import law
from internals import LawError, case_of, python
from model_files import (
    LARGE,
    SMALL,
    SPRUNG,
    own,
    own_body,
    own_joint,
    sdf,
    sdf_joint,
    sdf_link,
)
from places import TESTS

from lagrange_casadi import errors, evaluate, read, save_model
from lagrange_casadi.motion import expression, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

FEW = {"hostile": (0, 110), "damaged": (0, 40)}
MANY = {"hostile": 3000, "damaged": 1000}


def efforts(scene):
    """All efforts at three instants, sorted: whatever they are called."""
    found = evaluate(scene, t=(*scene.span[:2], 3), wanted=["effort"])
    return np.sort(np.concatenate([*found.outputs.values()]))


def seconds(path):
    """The processor time that the case of a file takes, the least of two."""
    found = []
    for _ in range(2):
        gc.collect()
        start = time.process_time()
        case_of(path)
        found.append(time.process_time() - start)
    return min(found)


def check_growth(folder, name, few, many):
    """Check that many parts take as much longer as these are more, but for half of that; a square
    law would take as much again.
    """
    if name.endswith(".xml"):
        pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    path = folder / name.replace(" ", "_")
    path.write_text(LARGE[name](few))
    small = seconds(path)
    path.write_text(LARGE[name](many))
    assert seconds(path) < 1.6 * many / few * small
    return path


@pytest.mark.parametrize("name", LARGE)
def test_time_grows_as_the_file_does(name, tmp_path):
    check_growth(tmp_path, name, 40, 240)


@pytest.mark.long
@pytest.mark.parametrize("name", LARGE)
def test_three_thousand_links_take_seconds(name, tmp_path):
    path = check_growth(tmp_path, name, 600, 3000)
    assert name in ("bars.asmt", "arms.xml") or seconds(path) < 5.0


@pytest.mark.parametrize("name", ["arm.urdf", "arm.sdf"])
def test_blank_lines_take_no_longer_than_they_are(name, tmp_path):
    """So many in one element were joined one by one to those before."""
    text = SMALL[name].replace("<link", "\n" * 30_000_000 + "<link", 1)
    (path := tmp_path / name).write_text(text)
    start = time.process_time()
    case_of(path)
    assert time.process_time() - start < 5.0


@pytest.mark.long
def test_loops_in_a_net_are_refused_before_they_take_hours(tmp_path):
    count = 700
    bodies = [own_body(f"b{k}") for k in range(count)]
    joints = [own_joint(f"j{k}", f"b{k - 1}" if k else "ground", f"b{k}") for k in range(count)]
    joints += [own_joint(f"l{k}", "ground", f"b{k}", z=(0, 1, 1)) for k in range(1, count)]
    (path := tmp_path / "net.json").write_text(own(bodies, joints))
    with pytest.raises(errors.ModelFileError, match="joints in common"):
        case_of(path)


def text_of(chance, depth=0):
    """An expression of t whose value is a number for positive t, as text."""
    kind = chance.randrange(9 if depth < 5 else 2)
    one, other = (text_of(chance, depth + 1) if kind > 1 else "" for _ in range(2))
    return [
        "t",
        chance.choice(["2", "0.5", "pi", "3", "1e-3", "7"]),
        f"({one} {chance.choice('+-*')} {other})",
        f"{one} {chance.choice('+-')} {other}",
        f"-{one}",
        f"sin({one})",
        f"({one})^{chance.randrange(4)}",
        f"({one}) / (1.5 + cos({other}))",
        f"({one}) * ({other})",
    ][kind]


def value_of(told, t):
    """The value of what a case has for a motion."""
    import casadi as ca

    names = {"ca": ca, "pi": math.pi, "polynomial": polynomial, "expression": expression}
    law = eval(str(told), names)
    found, x = law.value if hasattr(law, "value") else law, ca.SX.sym("t")
    return float(ca.Function("law", [x], [found(x)])(t))


@pytest.mark.parametrize("seed", range(60))
def test_laws_have_the_values_of_their_texts(seed):
    """Python's own, as far as all parts without t are numbers of a machine."""
    text = text_of(random.Random(seed))
    names = {"sin": math.sin, "cos": math.cos, "pi": math.pi}
    told = python(text)
    for t in (0.3, 1.7):
        there = eval(text.replace("^", "**"), names | {"t": t})
        assert abs(value_of(told, t) - there) < 1e-9 * (abs(there) + 1.0), text


def test_no_law_hangs_or_ends_in_a_traceback(pytestconfig):
    """Each is refused, or is a text that Python compiles, inside a case, and evaluates."""
    found = []
    for seed in range(20_000 if pytestconfig.getoption("--long") else 300):
        try:
            told = python(law(random.Random(seed)))
        except LawError:
            continue
        compile(f"laws = {{\n    'x': {told},\n}}", "case", "exec")
        found.append(value_of(told, 0.3))
    assert len(found) > 50


FAR = {
    "many terms": ("+".join(["sin(t)"] * 600), None),
    "many powers": ("(((((((t+1)^3)^3)^3)^3)^3)^3)^3", None),
    "brackets": ("sin(" * 199 + "t" + ")" * 199, "100 pairs of parentheses"),
    "terms": ("t+" * 1100 + "t", "at most 1000 terms"),
    "signs": ("-" * 900 + "t", "100 pairs of parentheses"),
    "tower": ("9^9^9^9*t", "'9 \\*\\* 9 \\*\\* 9' is no number of at most 1e\\+12"),
    "large": ("1e12*1e12*t", "is no number of at most 1e\\+12"),
    "by zero": ("t/(2-2)", "'t / \\(2 - 2\\)' is no number"),
    "root": ("(-8)^(1/3)*t", "is no number"),
    "logarithm": ("log(0)*t", "is no number"),
    "exponential": ("exp(1000)", "is no number"),
}


@pytest.mark.parametrize("what", FAR)
def test_laws_are_bounded_before_they_are_evaluated(what, tmp_path):
    law, words = FAR[what]
    told = own([own_body("arm")], [own_joint("hinge", "ground", "arm")], motions={"hinge": law})
    (path := tmp_path / "model.json").write_text(told)
    if words is None:
        assert np.isfinite(evaluate(read(path), t=(0.0, 1e-4, 3)).effort("hinge")).all()
        return
    with pytest.raises(errors.ModelFileError, match=words):
        read(path)


def test_a_law_of_many_terms_comes_back(tmp_path):
    """In the file each has its pair of parentheses, more than a reader takes: it has samples."""
    motions = {"hinge": FAR["many terms"][0]}
    told = own([own_body("arm")], [own_joint("hinge", "ground", "arm")], motions=motions)
    (tmp_path / "model.json").write_text(told)
    scene = read(tmp_path / "model.json")
    save_model(scene, tmp_path / "again.json")
    scenes = (scene, read(tmp_path / "again.json"))
    there, back = (evaluate(one, t=(0.0, 1.0, 5)).motion("hinge").value for one in scenes)
    assert np.abs(there - back).max() < 1e-6 * np.abs(there).max()


def used(text):
    """The names that a text of Python uses."""
    keys = ("id", "attr", "name", "arg", "asname", "module")
    found = {getattr(node, key, None) for node in ast.walk(ast.parse(text)) for key in keys}
    return sorted(one for one in found if isinstance(one, str) and one.isidentifier())


PARTS = {
    "loop.json": ["crank", "rocker", "O", "A", "B", "C"],
    "kinds.json": ["b0", "b1", "b3", "j0", "j1", "j3", "j4", "base", "tip", "gear"],
    "gears.asmt": ["crank", "rocker", "sun", "wheel", "O", "S", "V", "teeth", "rod"],
    "arm.urdf": ["one", "two", "three", "lump", "j1", "j2", "j3"],
    "loop.urdf": ["crank", "rod", "rocker", "O", "A", "C"],
    "cell.urdf": ["crank0", "rod0", "rocker0", "O0", "A0", "B0", "C0"],
    "arm.sdf": ["one", "two", "three", "four", "j1", "j2", "j3", "j4"],
    "arm.xml": ["two", "three", "j_one", "j_two", "j_three"],
}


@pytest.mark.parametrize("name", SMALL)
def test_parts_may_have_the_names_that_a_case_uses(name, tmp_path):
    """All of them in turn: the forces are those of the file before."""
    if name.endswith(".xml"):
        pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    path, told, parts = tmp_path / name, SMALL[name], PARTS[name]
    path.write_text(told)
    words = {"ground", *re.findall(r"\w+", told)}
    names = [one for one in used(case_of(path)) if one not in words]
    there = efforts(read(path))
    assert {"Scene", "SpatialMechanism"} <= set(names)
    for k in range(0, len(names), len(parts)):
        text = told
        for old, new in zip(parts, names[k : k + len(parts)], strict=False):
            text = re.sub(rf"(?<!\w){old}(?!\w)", new, text)
        path.write_text(text)
        assert np.allclose(efforts(read(path)), there, rtol=1e-12, atol=1e-12), names[k:]


def test_springs_have_names_of_their_own(tmp_path):
    """Each slides between bodies whose names, with that of its joint, are those of the other."""
    links = sdf_link("b_spring_c"), sdf_link("c", "0.2 0 0 0 0 0")
    ends = ("a", "world", "b_spring_c"), ("a_spring_b", "b_spring_c", "c")
    joints = (sdf_joint(*one, "1 0 0", "prismatic", SPRUNG) for one in ends)
    (path := tmp_path / "slides.sdf").write_text(sdf(*links, *joints))
    assert list(read(path).motion) == ["a", "a_spring_b"]


def draw(kind, first, count, folder):
    """Draw and read so many files in a program of its own; what it said, a line each."""
    folder.mkdir()
    program = [sys.executable, str(TESTS), "drawn_models", kind]
    wrong, accepted, last = [], 0, first + count
    while first < last:
        done = subprocess.run(
            [*program, str(first), str(last - first)],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=60.0 + 25.0 * count,
            check=False,
        )
        said = done.stdout.splitlines()
        reached = [int(line) for line in said if line.isdigit()]
        accepted += said.count("accepted")
        wrong += [line for line in said if not line.isdigit() and line != "accepted"]
        if done.returncode:
            status, error = done.returncode, done.stderr[-300:]
            wrong.append(f"{kind} {reached[-1:]} ended with {status}: {error}")
        first = reached[-1] + 1 if reached else last
    assert accepted > count // 20
    return wrong


@pytest.mark.parametrize("kind", FEW)
def test_files_are_read_or_refused(kind, tmp_path):
    assert draw(kind, *FEW[kind], tmp_path / kind) == []


@pytest.mark.long
@pytest.mark.parametrize("kind", MANY)
@pytest.mark.parametrize("part", range(10))
def test_many_files_are_read_or_refused(kind, part, tmp_path):
    count = MANY[kind] // 10
    assert draw(kind, count * part, count, tmp_path / kind) == []

"""The mex function of an exported folder, as Octave builds and calls it."""

import math
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lagrange_casadi import evaluate, export, load_case

ABSENT = [tool for tool in ("octave-cli", "mkoctfile", "gcc") if shutil.which(tool) is None]
pytestmark = pytest.mark.skipif(bool(ABSENT), reason=f"there is no {', '.join(ABSENT)}")

XI = (0.0, 0.3, 1.0)
ALLOWED = 16.0
"""Estimates of the error within which other compilers and libraries are."""

ROUNDING = {"double": 2.0**-53, "single": 2.0**-24}
METHODS = {
    ("slider_crank", "double"): {},
    ("slider_crank", "single"): {"precision": "single"},
    ("slider_crank", "table"): {"precision": "single", "table": 1e-6, "wanted": ["effort"]},
    ("sleigh", "double"): {},
    ("quick_return", "double"): {},
    ("quick_return", "single"): {"precision": "single"},
    ("andrews_squeezer", "single"): {"precision": "single"},
    ("beam_pump", "newton"): {"newton": 3},
    ("cardan_shaft", "double"): {},
    ("arm6", "single"): {"precision": "single"},
}


def octave(script, folder):
    """What a script prints in a folder."""
    path = folder / "script_of_the_test.m"
    path.write_text(script)
    command = ["octave-cli", "--quiet", "--no-history", "--norc", path.name]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A function that exports a case, has build_mex.m build it, and returns the folder, the
    contract and the scene.
    """

    @cache
    def build(name, method):
        folder = tmp_path_factory.mktemp("mex") / name
        loaded = load_case(Path(__file__).parents[2] / "cases" / name)
        agreed = export(loaded.scene, folder, name=loaded.name, **METHODS[name, method])
        before = {path.name for path in folder.iterdir()}
        octave("build_mex();", folder)
        assert {path.name for path in folder.iterdir()} - before == {
            f"{agreed.prefix}_mex.mex",
            "script_of_the_test.m",
        }
        return folder, agreed, loaded.scene

    return build


def written(values):
    return f"[{' '.join(f'{value:.17g}' for value in np.ravel(values))}]"


SHOW = """1;
function show(kind, found)
  for name = fieldnames(found)'
    printf('%s %s', kind, name{1}); printf(' %.17g', found.(name{1})); printf('\\n');
  end
end
"""


def shown(text):
    """The members that a script printed, by kind and name."""
    rows = (line.split() for line in text.splitlines())
    return {(row[0], row[1]): np.array(row[2:], float) for row in rows}


@pytest.mark.sampled(10)
@pytest.mark.parametrize(("name", "method"), METHODS)
def test_every_output_over_a_cycle(name, method, built):
    folder, agreed, scene = built(name, method)
    exact = evaluate(scene, wanted=METHODS[name, method].get("wanted"), backend="vm")
    limit = ALLOWED * ROUNDING[agreed.precision]
    if method == "table":
        limit = 1e-6
    script = (
        f"{SHOW}inputs = {agreed.prefix}_mex('motion', {written(exact.t)});\noutputs ="
        f" {agreed.prefix}_mex(inputs);\n"
    )
    script += "show('inputs', inputs); show('outputs', outputs);\n"
    for link in agreed.links:
        script += (
            f"show('{link.name}', {agreed.prefix}_mex('section', outputs, '{link.name}',"
            f" {written(XI)}));\n"
        )
    found = shown(octave(script, folder))
    visible = {("inputs", m.name) for m in agreed.inputs if not m.rest_of} | {("outputs", "status")}
    visible |= {("outputs", m.name) for m in agreed.outputs}
    visible |= {(link.name, force) for link in agreed.links for force in agreed.table.forces}
    assert found.keys() == visible
    assert not found["outputs", "status"].any()
    for member in agreed.outputs:
        expected = exact.series[member.source]
        off = found["outputs", member.name] - expected
        off = np.remainder(off + math.pi, math.tau) - math.pi if "pi]" in member.range else off
        scale = ROUNDING[agreed.precision] / ROUNDING["double"]
        allowed = ALLOWED * scale * exact.errors[member.source] + limit * np.abs(expected).max()
        assert np.max(np.abs(off)) <= allowed, member.name
    for link in agreed.links:
        law = exact.section(link.name).law
        for force in agreed.table.forces:
            expected = law.at(force, np.tile(XI, (exact.t.size, 1)))
            error = exact.errors[f"section:{link.name}:{force}"]
            allowed = ALLOWED * scale * error + limit * np.abs(expected).max()
            assert (
                np.max(np.abs(found[link.name, force].reshape(len(XI), -1).T - expected)) <= allowed
            ), (link.name, force)


def test_parameters_change_what_they_should(built):
    """As the API has it; and what is not named has its default."""
    folder, _, scene = built("slider_crank", "double")
    script = f"{SHOW}p = struct('m3', single(0.5), 'r', 0.05);\n"
    t = (0.0, 0.01, 0.02)
    script += (
        f"o = slider_crank_mex(slider_crank_mex('motion', {written(t)}', p), p); show('outputs',"
        " o);\n"
    )
    script += (
        "show('rod', slider_crank_mex('section', o, 'rod', 0.3, p)); show('sized', struct('is',"
        " size(o.effort_O)));\n"
    )
    found = shown(octave(script, folder))
    expected = evaluate(scene, t=(0, 0.02, 3), parameters={"m3": 0.5, "r": 0.05}, backend="vm")
    np.testing.assert_allclose(
        found["outputs", "effort_O"], expected.series["effort:O"], rtol=1e-13
    )
    forces = expected.section("rod").law.at("shear", np.full((3, 1), 0.3))
    np.testing.assert_allclose(found["rod", "shear"], forces.ravel(), rtol=1e-12)
    assert found["sized", "is"].tolist() == [3, 1]


GIVEN = """
i = struct('O', [0 1], 'O_rate', [7 7], 'O_acceleration', [0 0]);
o = slider_crank_mex(i);
"""
MISUSE = {
    "slider_crank_mex()": "expected (inputs), ('motion', t) or ('section', outputs, link, xi)",
    "slider_crank_mex('move', 0)": "expected (inputs), ('motion', t)",
    "slider_crank_mex('motion')": "expected (inputs), ('motion', t)",
    "slider_crank_mex(i, struct(), 1)": "expected (inputs), ('motion', t)",
    "[a, b] = slider_crank_mex(i)": "one result",
    "slider_crank_mex(7)": "inputs must be one struct, by member names",
    "slider_crank_mex([i i])": "inputs must be one struct, by member names",
    "slider_crank_mex(rmfield(i, 'O_rate'))": "inputs lack the member 'O_rate'",
    "slider_crank_mex(setfield(i, 'P', 1))": (
        "inputs have no member 'P'; valid: O, O_rate, O_acceleration."
    ),
    "slider_crank_mex(setfield(i, 'O_rate', [1 2 3]))": (
        "member 'O_rate' of inputs has 3 numbers, and 'O' has 2"
    ),
    "slider_crank_mex(setfield(i, 'O_rate', 'ab'))": (
        "member 'O_rate' of inputs must be a vector of real numbers"
    ),
    "slider_crank_mex(setfield(i, 'O_rate', [1 2i]))": (
        "member 'O_rate' of inputs must be a vector of real numbers"
    ),
    "slider_crank_mex(setfield(i, 'O_rate', int32([1 2])))": (
        "member 'O_rate' of inputs must be a vector of real numbers"
    ),
    "slider_crank_mex(setfield(i, 'O_rate', sparse([1 2])))": (
        "member 'O_rate' of inputs must be a vector of real numbers"
    ),
    "slider_crank_mex(setfield(i, 'O', ones(2, 2)))": (
        "member 'O' of inputs must be a vector of real numbers"
    ),
    "slider_crank_mex(i, 3)": "parameters must be one struct, by member names",
    "slider_crank_mex(i, struct('R', 1))": (
        "parameters have no member 'R'; valid: r, l, m1, m2, m3."
    ),
    "slider_crank_mex(i, struct('r', [1 2]))": "parameter 'r' must be one real number",
    "slider_crank_mex(i, struct('r', '1'))": "parameter 'r' must be one real number",
    "slider_crank_mex(i, struct('r', -1))": "a parameter is not finite, or out of its range",
    "slider_crank_mex(i, struct('r', NaN))": "a parameter is not finite",
    "slider_crank_mex('motion', 'now')": "times must be a vector of real numbers",
    "slider_crank_mex('motion', [0 Inf])": "t(2) = Inf s: the time is not finite",
    "slider_crank_mex('section', i, 'rod', 0)": "outputs have no member 'O'; valid: motion_A, ",
    "slider_crank_mex('section', rmfield(o, 'effort_O'), 'rod', 0)": (
        "outputs lack the member 'effort_O'"
    ),
    "slider_crank_mex('section', o, 'slider', 0)": (
        "there is no link 'slider' with sections; valid: crank, rod."
    ),
    "slider_crank_mex('section', o, 2, 0)": "a link must be given by its name",
    "slider_crank_mex('section', o, 'rod', {0})": "ratios xi must be a vector of real numbers",
    "slider_crank_mex('section', o, 'rod', [0 1.5])": "xi(2) = 1.5: a ratio must be from 0 to 1",
    "slider_crank_mex('section', o, 'rod', NaN)": "xi(1) = NaN: a ratio must be from 0 to 1",
    "slider_crank_mex('message', 'x')": "a status must be one number",
}


def test_misuse_is_told_in_one_sentence(built):
    folder, _, _ = built("slider_crank", "double")
    tries = "".join(
        f"try\n {call};\n disp('nothing is said');\ncatch e\n disp(e.message);\nend\n"
        for call in MISUSE
    )
    lines = octave(GIVEN + tries, folder).splitlines()
    for (call, expected), line in zip(MISUSE.items(), lines, strict=True):
        assert line.startswith("slider_crank_mex: "), (call, line)
        assert expected.lower() in line.lower(), (call, line)
        assert line.endswith("."), (call, line)
